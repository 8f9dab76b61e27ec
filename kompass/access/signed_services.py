"""Services whose types have no place for a proof: as they are, and through ``~/signed_call``."""

from __future__ import annotations

import array
from collections.abc import Awaitable, Callable
from typing import Any

from kompass_interfaces.srv import SignedCall
from rclpy.serialization import deserialize_message, serialize_message

from kompass.access.gatekeeper import Gatekeeper, NotAdmitted
from kompass.bus.node import Node
from kompass.rclpy_ext.deferred_service import create_deferred_service, defer_answers

SIGNED_CALL = "signed_call"
# Takes request and response; the response, or a coroutine of it.
Answer = Callable[[Any, Any], Any]
# Takes request, response and a sentence; the response that says it.
Refuse = Callable[[Any, Any, str], Any]


class NoSuchService(Exception):
    """The node does not offer it; the message says what it offers."""


class SignedServices:
    """Services of a node that change it, for who may; their types are those of other stacks.

    Parameters
    ----------
    node
        Offers them.
    gatekeeper
        Of that node.
    """

    def __init__(self, node: Node, gatekeeper: Gatekeeper) -> None:
        self._node, self._gatekeeper = node, gatekeeper
        self._offered: dict[str, tuple[Any, Answer]] = {}
        self._name = f"{node.get_name()}/{SIGNED_CALL}"
        create_deferred_service(node, SignedCall, self._name, self._on_signed, _failed)

    def offer(self, kind: Any, suffix: str, answer: Answer, refuse: Refuse) -> None:
        """Offer a service ``<node>/<suffix>``."""
        name = f"{self._node.get_name()}/{suffix}"
        guarded = self.guard(kind, suffix, answer, refuse)
        defer_answers(self._node, self._node.create_service(kind, name, guarded))

    def guard(self, kind: Any, suffix: str, answer: Answer, refuse: Refuse) -> Answer:
        """Answer signed calls of a service; what is to answer the unsigned ones."""
        self._offered[suffix] = (kind, answer)

        def respond(request: Any, response: Any) -> Any:
            try:
                self._gatekeeper.admit_unsigned(f"{self._node.get_name()}/{suffix}")
            except NotAdmitted as error:
                return refuse(request, response, str(error))
            return answer(request, response)

        return respond

    async def answer(self, suffix: str, request: bytes) -> bytes:
        """Answer a request of somebody who has been let in.

        Parameters
        ----------
        suffix
            The service is ``<node>/<suffix>``.
        request
            As ROS serialises it; the answer too.

        Raises
        ------
        NoSuchService
            When it is not offered.
        """
        offered = self._offered.get(suffix)
        if offered is None:
            known = ", ".join(self._offered)
            raise NoSuchService(f"service = {suffix!r}: there is none; known are {known}")
        kind, answer = offered
        answered = answer(deserialize_message(request, kind.Request), kind.Response())
        if isinstance(answered, Awaitable):
            answered = await answered
        return bytes(serialize_message(answered))

    async def _on_signed(
        self, request: SignedCall.Request, response: SignedCall.Response
    ) -> SignedCall.Response:
        try:
            self._gatekeeper.admit(self._name, request)
        except NotAdmitted as error:
            response.message = str(error)
            return response
        try:
            answered = await self.answer(request.service, bytes(request.request))
        except NoSuchService as error:
            response.message = str(error)
            return response
        response.success = True
        response.response = array.array("B", answered)
        return response


def wrap(suffix: str, request: Any) -> SignedCall.Request:
    """A request to the service ``<node>/<suffix>``, to be signed and sent to ``~/signed_call``."""
    return SignedCall.Request(service=suffix, request=array.array("B", serialize_message(request)))


def unwrap(answer: SignedCall.Response, kind: Any) -> Any:
    """The answer of the service itself.

    Raises
    ------
    NotAdmitted
        When it was not asked.
    """
    if not answer.success:
        raise NotAdmitted(answer.message)
    return deserialize_message(bytes(answer.response), kind.Response)


def _failed(response: SignedCall.Response, error: Exception) -> SignedCall.Response:
    response.message = f"{type(error).__name__}: {error}"
    return response
