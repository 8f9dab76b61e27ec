"""Signs requests to the services of one node, for who has the key of its robot."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple, TypeVar

from std_msgs.msg import String

from kompass.access.gatekeeper import CHALLENGE, answered_challenge
from kompass.bus.node import Node
from kompass.rclpy_ext.reply import Reply
from kompass.rclpy_ext.topic import LATCHED
from kompass.signing.canonical import PROOF
from kompass.signing.key import RobotKey
from kompass.signing.proof import make_proof, read_answer, read_challenge

MOST_CALLS = 3  # of one request: whoever is started anew again and again is not waited for

T = TypeVar("T")


class _Known(NamedTuple):
    """A challenge of the server, and the key that it has."""

    challenge: str
    key: RobotKey


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
        self._heard = self._is_foreign = False
        self._known: _Known | None = None
        self._subscription = node.create_subscription(
            String, f"{server}/{CHALLENGE}", self._hear, LATCHED.to_ros()
        )

    def close(self) -> None:
        """Hear nothing any more."""
        self._node.destroy_subscription(self._subscription)

    @property
    def is_ready(self) -> bool:
        """Whether anything was heard of the server: before that, nothing is asked. Any thread."""
        return self._heard

    @property
    def key(self) -> RobotKey | None:
        """The key that the server has, if it is among ours and was heard of. Any thread."""
        known = self._known
        return None if known is None else known.key

    def sign(self, service: str, request: Any) -> Any:
        """Give a request its proof, and return it. Any thread.

        It stays unsigned where it has no place for a proof, or the server's key is not among ours:
        what that means is for the server to say.

        Parameters
        ----------
        service
            Full name of the service.
        """
        if PROOF in request.get_fields_and_field_types():
            known = self._known
            if known is not None:
                request.proof = make_proof(known.key, known.challenge, service, request)
            elif self._keys and not self._is_foreign:
                # Somebody's word kept the server's from us; its answer tells the challenge.
                request.proof = make_proof(self._keys[0], "", service, request)
            else:
                request.proof = ""
        return request

    def learn(self, message: str, proof: str) -> bool:
        """Take the challenge that a server answers a proof with that is too old. Any thread.

        The topic of the challenges is open to all: what was heard there may be an old one that
        somebody repeats. The answer is for one proof, and only who has the key can make it.

        Parameters
        ----------
        message
            Of the answer.
        proof
            Of the request.

        Returns
        -------
        bool
            Whether the request is to be signed and sent once more.
        """
        answer = answered_challenge(message)
        if answer is None or not proof:
            return False
        for key in self._keys:
            challenge = read_answer(answer, proof, key)
            if challenge is not None:
                self._known = _Known(challenge, key)
                return True
        if self._known is None and not self._is_foreign:
            self._is_foreign = True
            return True
        return False

    def call(
        self,
        client: Any,
        service: str,
        request: Any,
        limit: float | None,
        read: Callable[[Any], T] = lambda answer: answer,
    ) -> Reply[T]:
        """Call a service by its full name and a client of rclpy, signed; as `Reply.of_service`.

        A proof that is too old is answered with another challenge: then the request is signed and
        sent once more.
        """

        def send(answered: Callable[[Any], None]) -> Callable[[], object]:
            calls: list[Any] = []
            given_up = threading.Event()

            def ask() -> None:
                call = client.call_async(self.sign(service, request))
                proof = getattr(request, PROOF, "")
                calls.append(call)
                call.add_done_callback(lambda done: judge(done, proof))

            def judge(done: Any, proof: str) -> None:
                if not done.cancelled() and done.exception() is None and len(calls) < MOST_CALLS:
                    message = getattr(done.result(), "message", "")
                    if self.learn(message, proof) and not given_up.is_set():
                        ask()
                        return
                answered(done)

            def forget() -> None:
                given_up.set()
                client.remove_pending_request(calls[-1])

            ask()
            return forget

        ready = lambda: self.is_ready and client.service_is_ready()  # noqa: E731
        return Reply(service, limit, ready=ready, send=send, read=read)

    def _hear(self, message: Any) -> None:
        found = read_challenge(message.data, self._keys)
        # What anybody says without a key does not take the place of what the robot has said.
        if found is not None:
            self._known, self._is_foreign = _Known(*found), False
        self._heard = True  # last: another thread signs as soon as it sees this
