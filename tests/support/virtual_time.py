"""A client in a virtual world, in which time passes while something is waited for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from kompass.bus.clock import Clock
from kompass.rclpy_ext.reply import Reply
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import World
from kompass.virtual.scheduler import nanoseconds
from tests.support.client import Client

ANSWER = 60.0  # s for which an answer is waited for
PERIOD = 0.005  # s between two looks at what is waited for

T = TypeVar("T")


class InVirtualTime(Client):
    """Lets time pass only while it waits, and then as fast as it can be worked out.

    Attributes
    ----------
    world
        Which it is in.
    """

    world: World

    @property
    def clock(self) -> Clock:
        """Of its world."""
        return self.world.clock

    def wait_until(self, condition: Callable[[], object], timeout: float, what: str) -> None:
        """Let time pass until a condition holds, for so many virtual seconds.

        It is asked between two events, so that it may itself wait, for an answer say.
        """
        deadline = self.clock.monotonic() + timeout
        while not condition():
            assert self.clock.monotonic() < deadline, f"not within {timeout:g} s: {what}"
            self.rest(PERIOD)

    def rest(self, seconds: float) -> None:
        """Let virtual time pass."""
        self.world.scheduler.run_for(nanoseconds(seconds))

    def do(self, work: Callable[[], T]) -> T:
        """Do something at the tester's node; nothing else happens there meanwhile."""
        return work()

    def answer(self, reply: Reply[T]) -> T:
        """Wait for an answer that is under way."""
        self.wait_until(lambda: reply.begin() and reply.done(), ANSWER, "an answer")
        return reply.result()

    def action_client(self, kind: Any, name: str) -> Any:
        """A client of an action."""
        return self.node.create_action_client(kind, name)


def node_in(world: World, name: str) -> VirtualNode:
    """A node in a process of its own."""
    process = world.process(name)
    node = VirtualNode(process, name)
    VirtualExecutor(process).add_node(node)
    return node
