"""Signs requests to the services of one node, for who has the key of its robot."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from rclpy.node import Node
from std_msgs.msg import String

from kompass.access.gatekeeper import CHALLENGE, STALE
from kompass.rclpy_ext.reply import Reply
from kompass.rclpy_ext.topic import LATCHED
from kompass.signing.canonical import PROOF
from kompass.signing.key import RobotKey
from kompass.signing.proof import make_proof, read_challenge

_MOST_CALLS = 3  # of one request: whoever is started anew again and again is not waited for

T = TypeVar("T")


class Signer:
    """Hears the challenges of a node. To be made and closed on the thread that spins ours.

    Parameters
    ----------
    node
        Spun by somebody.
    server
        The node whose services are asked, with its namespace.
    keys
        All that we have; the one is used that the server has.
    """

    def __init__(self, node: Node, server: str, keys: Iterable[RobotKey]) -> None:
        self._node, self._keys = node, list(keys)
        self._heard = ""
        self._found: tuple[str, RobotKey] | None = None
        self._waiting: list[Callable[[], None]] = []
        self._subscription = node.create_subscription(
            String, f"{server}/{CHALLENGE}", self._hear, LATCHED.to_ros()
        )

    def close(self) -> None:
        """Hear nothing any more."""
        self._node.destroy_subscription(self._subscription)

    @property
    def is_ready(self) -> bool:
        """Whether a challenge was heard: before that, nothing can be signed. Any thread."""
        return bool(self._heard)

    @property
    def challenge(self) -> str:
        """What was heard last. Any thread."""
        return self._heard

    def sign(self, service: str, request: Any) -> Any:
        """Give a request its proof, and return it. Any thread.

        It stays unsigned where it has no place for a proof, or the server's key is not among ours:
        what that means is for the server to say.

        Parameters
        ----------
        service
            Full name of the service.
        """
        found = self._found
        if found is not None and PROOF in request.get_fields_and_field_types():
            challenge, key = found
            request.proof = make_proof(key, challenge, service, request)
        return request

    def call(
        self,
        client: Any,
        service: str,
        request: Any,
        limit: float | None,
        read: Callable[[Any], T] = lambda answer: answer,
    ) -> Reply[T]:
        """Call a service by its full name and a client of rclpy, signed; as `Reply.of_service`.

        Whoever was started anew has another challenge, and says that the proof is too old: then the
        request is signed and sent once more as soon as the new one is heard.
        """

        def send(answered: Callable[[Any], None]) -> Callable[[], object]:
            calls: list[Any] = []
            given_up = threading.Event()

            def ask() -> None:
                if given_up.is_set():
                    return
                before = self._heard
                call = client.call_async(self.sign(service, request))
                calls.append(call)
                call.add_done_callback(lambda done: judge(done, before))

            def judge(done: Any, before: str) -> None:
                if not done.cancelled() and done.exception() is None:
                    again = done.result().message == STALE and len(calls) < _MOST_CALLS
                    if again:
                        self._on_next(before, ask)
                        return
                answered(done)

            def forget() -> None:
                given_up.set()
                client.remove_pending_request(calls[-1])

            ask()
            return forget

        ready = lambda: self.is_ready and client.service_is_ready()  # noqa: E731
        return Reply(service, limit, ready=ready, send=send, read=read)

    def _on_next(self, before: str, ask: Callable[[], None]) -> None:
        """Ask once another challenge was heard than the one before; on the node's thread."""
        if self._heard != before:
            ask()
        else:
            self._waiting.append(ask)

    def _hear(self, message: Any) -> None:
        found = read_challenge(message.data, self._keys)
        # What anybody says without a key does not take the place of what the robot has said.
        if found is None and self._found is not None:
            return
        self._found, self._heard = found, message.data
        waiting, self._waiting = self._waiting, []
        for ask in waiting:
            ask()
