"""Both kinds of a bus, for tests of what a node promises."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol

import rclpy

from kompass.bus.node import LifecycleNode, Node, Transitions
from kompass.components.base.node import ComponentNode
from kompass.rclpy_ext.executor import TaskExecutor
from kompass.rclpy_ext.node import PlainNode
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.lifecycle import VirtualLifecycleNode
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import World
from tests.support.domains import give_back, next_domain
from tests.support.patience import patient

DYING = "dying_server"

# Offers a service of std_srvs that never answers, and says so.
_SERVER = f"""
import rclpy
from std_srvs.srv import Trigger

rclpy.init()
node = rclpy.create_node({DYING!r})
node.create_service(Trigger, "dying", lambda request, response: response)
print("offered", flush=True)
import time
time.sleep(60)
"""


class Bus(Protocol):
    """Where a test has its nodes: each in a process, or at least a participant, of its own.

    Attributes
    ----------
    errors
        What callbacks have raised.
    """

    errors: list[Exception]

    def node(self, name: str, namespace: str = "") -> Node: ...
    def lifecycle(self, name: str, component: Transitions) -> LifecycleNode: ...
    def until(self, condition: Callable[[], object], timeout: float = 5.0) -> None:
        """Let time pass until a condition holds."""

    def rest(self, seconds: float) -> None:
        """Let time pass."""

    def hold(self, node: Node) -> None:
        """Let a node handle nothing."""

    def go_on(self, node: Node) -> None:
        """Let it handle things again."""

    def dying_server(self) -> Callable[[], None]:
        """A service "/dying" (std_srvs/srv/Trigger) that does not answer; what kills it."""


class RclpyBus:
    """rclpy on DDS."""

    def __init__(self) -> None:
        self.errors: list[Exception] = []
        self._domain = next_domain()
        self._spun: dict[Any, TaskExecutor] = {}
        self._held: set[Any] = set()
        self._contexts: list[Any] = []
        rclpy.init(args=[], domain_id=self._domain)

    def node(self, name: str, namespace: str = "") -> Node:
        context = rclpy.Context()
        rclpy.init(args=[], context=context, domain_id=self._domain)
        self._contexts.append(context)
        node: Node = PlainNode(name, namespace=namespace or None, context=context)
        self._spin(node, TaskExecutor(context))
        return node

    def lifecycle(self, name: str, component: Transitions) -> LifecycleNode:
        node: LifecycleNode = ComponentNode(name, component)
        self._spin(node, TaskExecutor())
        return node

    def until(self, condition: Callable[[], object], timeout: float = 5.0) -> None:
        deadline = time.monotonic() + patient(timeout)
        while not condition():
            assert time.monotonic() < deadline, f"not within {patient(timeout):g} s"
            self._turn()

    def rest(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._turn()

    def hold(self, node: Node) -> None:
        self._held.add(node)

    def go_on(self, node: Node) -> None:
        self._held.discard(node)

    def dying_server(self) -> Callable[[], None]:
        server = subprocess.Popen(
            [sys.executable, "-c", f"import kompass\n{_SERVER}"],
            env={**os.environ, "ROS_DOMAIN_ID": str(self._domain)},
            stdout=subprocess.PIPE,
        )
        assert server.stdout is not None
        assert server.stdout.readline() == b"offered\n"

        def kill() -> None:
            server.kill()
            server.wait()
            assert server.stdout is not None
            server.stdout.close()

        return kill

    def close(self) -> None:
        for node, executor in self._spun.items():
            executor.shutdown()
            node.destroy_node()
        for context in self._contexts:
            context.try_shutdown()
        rclpy.shutdown()
        give_back(self._domain)

    def _spin(self, node: Any, executor: TaskExecutor) -> None:
        executor.add_node(node)
        self._spun[node] = executor

    def _turn(self) -> None:
        for node, executor in self._spun.items():
            if node not in self._held:
                try:
                    executor.spin_once(timeout_sec=0.002)
                except Exception as error:  # noqa: BLE001 - the test looks at it
                    self.errors.append(error)


class VirtualBus:
    """Nodes in virtual time."""

    def __init__(self) -> None:
        self.errors: list[Exception] = []
        self.world = World(seed=1)

    def node(self, name: str, namespace: str = "") -> Node:
        node = VirtualNode(self.world.process(name), name, namespace)
        self._give(node)
        return node

    def lifecycle(self, name: str, component: Transitions) -> LifecycleNode:
        node = VirtualLifecycleNode(self.world.process(name), name, component)
        self._give(node)
        return node

    def until(self, condition: Callable[[], object], timeout: float = 5.0) -> None:
        ended = self.world.scheduler.run_while(lambda: not condition(), round(timeout * 1e9))
        assert ended, f"not within {timeout:g} s"

    def rest(self, seconds: float) -> None:
        self.world.scheduler.run_for(round(seconds * 1e9))

    def hold(self, node: Node) -> None:
        node.process.stop()  # type: ignore[attr-defined]

    def go_on(self, node: Node) -> None:
        node.process.go_on()  # type: ignore[attr-defined]

    def dying_server(self) -> Callable[[], None]:
        from std_srvs.srv import Trigger

        process = self.world.process(DYING)
        VirtualNode(process, DYING).create_service(Trigger, "dying", lambda _, response: response)
        return process.kill

    def _give(self, node: VirtualNode) -> None:
        VirtualExecutor(node.process, self.errors.append).add_node(node)

    def close(self) -> None:
        self.world.__exit__()


@contextmanager
def bus_of(kind: str) -> Iterator[Bus]:
    """A bus of rclpy or a virtual one."""
    bus = RclpyBus() if kind == "rclpy" else VirtualBus()
    try:
        yield bus
    finally:
        bus.close()
