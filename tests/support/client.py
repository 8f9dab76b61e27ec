"""A client at a node, whichever bus and time it lives in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, TypeVar

from rclpy.qos import DurabilityPolicy, QoSProfile

from kompass.bus.clock import Clock
from kompass.rclpy_ext.reply import Reply
from tests.support.signed import SignedCalls

T = TypeVar("T")
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Client(ABC):
    """Asks and listens.

    Attributes
    ----------
    node
        Of the tester; that of rclpy or a virtual one.
    newest
        The newest message of each topic that was subscribed to.
    patience
        How many times longer everything may take than on a quiet machine.
    """

    patience: float = 1.0

    def __init__(self, node: Any) -> None:
        self.node = node
        self._calls = SignedCalls(node, self.wait_until)
        self.newest: dict[str, Any] = {}

    # -- what depends on the bus --------------------------------------------------------------

    @property
    @abstractmethod
    def clock(self) -> Clock:
        """Of the world that the robot is in."""

    @abstractmethod
    def close(self) -> None:
        """Leave."""

    @abstractmethod
    def wait_until(self, condition: Callable[[], object], timeout: float, what: str) -> None:
        """Wait until a condition holds; fails naming ``what`` after ``timeout`` seconds."""

    @abstractmethod
    def rest(self, seconds: float) -> None:
        """Let time pass."""

    @abstractmethod
    def do(self, work: Callable[[], T]) -> T:
        """Do something on the thread of the tester's node, and return what it returns."""

    @abstractmethod
    def answer(self, reply: Reply[T]) -> T:
        """Wait for an answer that is under way."""

    @abstractmethod
    def action_client(self, kind: Any, name: str) -> Any:
        """A client of an action."""

    # -- topics, services, actions ------------------------------------------------------------

    def subscribe(self, kind: type, topic: str, qos: QoSProfile | int = 10) -> None:
        """Keep the newest message of a topic in ``newest``."""
        self.node.create_subscription(
            kind, topic, lambda message: self.newest.__setitem__(topic, message), qos
        )

    def await_future(self, future: Any, timeout: float, what: str) -> Any:
        """The result of a future."""
        self.wait_until(future.done, timeout, what)
        return future.result()

    def call(self, kind: type, name: str, request: Any, timeout: float = 5.0) -> Any:
        """Call a service; signed, as the console does it, if the service changes something."""
        return self.answer(self._calls.begin(kind, name, request, timeout * self.patience))

    def send(self, client: Any, goal: Any) -> Any:
        """Send a goal to an action; its handle, accepted or not."""
        self.wait_until(client.server_is_ready, 10, "the action's server")
        # From the executor's own thread: rclpy may otherwise see the answer before the question.
        sent = self.do(lambda: client.send_goal_async(goal))
        return self.await_future(sent, 5, "the answer to the goal")

    def result(self, handle: Any, timeout: float = 60.0) -> Any:
        """How a goal ended: ``status`` and ``result``."""
        return self.await_future(self.asked_result(handle), timeout, "the end of the goal")

    def asked_result(self, handle: Any) -> Any:
        """A future of how a goal ends, asked for from the executor's own thread as in `send`."""
        return self.do(handle.get_result_async)

    def cancel(self, handle: Any, timeout: float = 5.0) -> Any:
        """Cancel a goal; the answer to that."""
        cancelled = self.do(handle.cancel_goal_async)
        return self.await_future(cancelled, timeout, "the answer to the cancellation")
