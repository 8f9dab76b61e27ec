"""Asks the drive manager of the stack for motion: signed, and past it there is no way."""

import json
from collections.abc import Awaitable, Callable
from typing import Any, NamedTuple

from automatika_ros_sugar.srv import ExecuteMethod
from kompass_interfaces.srv import SignedCall

from kompass.access.gatekeeper import NotAdmitted
from kompass.access.signed_services import SIGNED_CALL, unwrap, wrap
from kompass.access.signer import MOST_CALLS, Signer
from kompass.bus.node import Node
from kompass.store.robot_key import robot_key

STATE = "drive_state"  # topic of a drive manager, by which it is found
SEARCH = 5.0  # s
LOOK = 0.05  # s between two looks at whether there is an answer


class Done(NamedTuple):
    """How a call ended: whether it succeeded, and why not, or what it returned."""

    success: bool
    text: str


class GateClient:
    """Calls actions of the one drive manager that there is.

    Parameters
    ----------
    node
        Asks.
    sleep
        Waits on the executor of the node.
    """

    def __init__(self, node: Node, sleep: Callable[[float], Awaitable[None]]) -> None:
        self._node, self._sleep = node, sleep
        self._servers: dict[str, tuple[Signer, Any]] = {}

    async def call(self, action: str, limit: float, **arguments: Any) -> Done:
        """Have the drive manager carry out an action.

        Parameters
        ----------
        limit
            For which it is waited [s].
        """
        gates = self._gates()
        if len(gates) != 1:
            found = " and ".join(gates) or "none"
            return Done(False, f"one drive manager is needed to drive the robot; found: {found}")
        server = gates[0]
        signer, client = self._server(server)
        if not await self._until(lambda: signer.is_ready and client.service_is_ready(), SEARCH):
            return Done(False, f"{server} does not take calls")
        request = ExecuteMethod.Request(name=action, kwargs_json=json.dumps(arguments))
        name, call = f"{server}/{SIGNED_CALL}", wrap("execute_method", request)
        for _ in range(MOST_CALLS):
            asked = client.call_async(signer.sign(name, call))
            if not await self._until(asked.done, limit):
                client.remove_pending_request(asked)
                return Done(False, f"{server} did not answer within {limit:g} s")
            if not signer.learn(asked.result().message, call.proof):
                break
        try:
            answer = unwrap(asked.result(), ExecuteMethod)
        except NotAdmitted as error:
            return Done(False, str(error))
        return Done(answer.success, answer.error_msg or answer.response_json)

    def _gates(self) -> list[str]:
        """Full names of the nodes that tell what they let through to the wheels."""
        topic = self._node.resolve_topic_name(STATE)
        infos = self._node.get_publishers_info_by_topic(topic)
        return sorted({f"{info.node_namespace.rstrip('/')}/{info.node_name}" for info in infos})

    def _server(self, server: str) -> tuple[Signer, Any]:
        if server not in self._servers:
            signer = Signer(self._node, server, [robot_key()])
            client = self._node.create_client(SignedCall, f"{server}/{SIGNED_CALL}")
            self._servers[server] = signer, client
        return self._servers[server]

    async def _until(self, condition: Callable[[], bool], seconds: float) -> bool:
        deadline = self._node.clock.monotonic() + seconds
        while not condition():
            if self._node.clock.monotonic() >= deadline:
                return False
            await self._sleep(LOOK)
        return True
