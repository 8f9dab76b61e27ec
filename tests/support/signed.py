"""Calls of services as the console and the monitor make them: signed with the robot's key."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from automatika_ros_sugar.srv import (
    ChangeParameter,
    ChangeParameters,
    ConfigureFromFile,
    ExecuteMethod,
    ReplaceTopic,
)
from kompass_interfaces.srv import SignedCall
from lifecycle_msgs.srv import ChangeState

from kompass.access.signed_services import SIGNED_CALL, unwrap, wrap
from kompass.access.signer import Signer
from kompass.rclpy_ext.reply import Reply
from kompass.signing.canonical import PROOF
from kompass.store.robot_key import known_keys
from tests.support.processes import wait_until

OF_COMPONENTS = (
    *(ChangeParameter, ChangeParameters, ConfigureFromFile, ExecuteMethod, ReplaceTopic),
    ChangeState,
)
Wait = Callable[[Callable[[], object], float, str], None]


class SignedCalls:
    """Calls from one node.

    Parameters
    ----------
    node
        Asks.
    wait
        Waits until a condition holds, while the node works: for a node that another thread spins
        when left out.
    """

    def __init__(self, node: Any, wait: Wait = wait_until) -> None:
        self._node, self._wait = node, wait
        self._clients: dict[tuple[Any, str], Any] = {}
        self._signers: dict[str, Signer] = {}

    def begin(self, kind: Any, name: str, request: Any, timeout: float = 10.0) -> Reply[Any]:
        """Send a request to a service by its full name; the answer as it will come."""
        server, _, suffix = name.rpartition("/")
        if kind in OF_COMPONENTS:
            call = wrap(suffix, request)
            reply = self._signed(SignedCall, f"{server}/{SIGNED_CALL}", call, timeout, kind)
        elif PROOF in request.get_fields_and_field_types():
            reply = self._signed(kind, name, request, timeout)
        else:
            reply = Reply.of_service(self._client(kind, name), name, request, timeout)
        self._wait(reply.begin, 10, f"service {name}")
        return reply

    def _signed(
        self, kind: Any, name: str, request: Any, timeout: float, inner: Any = None
    ) -> Reply[Any]:
        server = name.rpartition("/")[0]
        if server not in self._signers:
            self._signers[server] = Signer(self._node, server, known_keys())

        def read(answer: Any) -> Any:
            return answer if inner is None else unwrap(answer, inner)

        client = self._client(kind, name)
        return self._signers[server].call(client, name, request, timeout, read)

    def _client(self, kind: Any, name: str) -> Any:
        if (kind, name) not in self._clients:
            self._clients[kind, name] = self._node.create_client(kind, name)
        return self._clients[kind, name]
