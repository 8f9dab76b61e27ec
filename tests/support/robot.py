"""An independent rclpy client, as any other tool on the domain is one."""

import threading
import time
from collections.abc import Callable
from typing import Any, TypeVar

import rclpy
from rclpy.executors import SingleThreadedExecutor

from kompass.bus.clock import SYSTEM, Clock
from kompass.rclpy_ext.node import PlainNode
from kompass.rclpy_ext.reply import Reply
from tests.support.patience import PATIENCE
from tests.support.processes import wait_until
from tests.support.tester import LATCHED, Tester

__all__ = ["LATCHED", "Robot"]

T = TypeVar("T")


class Robot(Tester):
    """Sees and drives the robot of one domain."""

    patience = PATIENCE

    def __init__(self, domain: int) -> None:
        self.context = rclpy.Context()
        rclpy.init(args=[], context=self.context, domain_id=domain)
        super().__init__(PlainNode("independent_tester", context=self.context))
        self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self.node)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._spin)
        self._thread.start()

    def _spin(self) -> None:
        while not self._ended.is_set():
            self._executor.spin_once(timeout_sec=0.1)

    def close(self) -> None:
        """Leave the domain."""
        self._ended.set()
        self._thread.join()
        self._executor.shutdown()
        self._action.destroy()
        self.node.destroy_node()
        self.context.try_shutdown()

    @property
    def clock(self) -> Clock:
        """Of this machine."""
        return SYSTEM

    def wait_until(self, condition: Callable[[], object], timeout: float, what: str) -> None:
        """Wait until a condition holds, for as many patient seconds."""
        wait_until(condition, timeout, what)

    def rest(self, seconds: float) -> None:
        """Let time pass."""
        time.sleep(seconds)

    def do(self, work: Callable[[], T]) -> T:
        """Do something on the executor's thread, and return what it returns.

        rclpy's executor dies of what another thread destroys while it looks at it.
        """
        done: T = self.await_future(self._executor.create_task(work), 5, "the work")
        return done

    def answer(self, reply: Reply[T]) -> T:
        """Wait for an answer that is under way."""
        return reply.wait()

    def action_client(self, kind: Any, name: str) -> Any:
        """A client of an action."""
        return self.node.create_action_client(kind, name)

    def call_unsigned(self, kind: type, name: str, request: Any, timeout: float = 5.0) -> Any:
        """Call a service as who has no key of the robot."""
        client = self.node.create_client(kind, name)
        try:
            wait_until(client.service_is_ready, 10, f"service {name}")
            return self.await_future(client.call_async(request), timeout, f"answer of {name}")
        finally:
            self.node.destroy_client(client)
