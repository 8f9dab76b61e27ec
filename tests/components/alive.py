"""A component that really runs, and a client of its own beside it: on DDS, or in virtual time."""

from __future__ import annotations

import json
import threading
import time
from abc import abstractmethod
from collections.abc import Callable
from typing import Any, TypeVar

import rclpy
from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ExecuteMethod
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.signals import SignalHandlerOptions

from kompass.bus.clock import SYSTEM, Clock
from kompass.bus.node import LifecycleNode, Transitions
from kompass.components import Component
from kompass.rclpy_ext.reply import Reply
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.lifecycle import VirtualLifecycleNode
from kompass.virtual.process import World
from tests.support.client import LATCHED, Client
from tests.support.described import described_robot
from tests.support.domains import give_back, next_domain
from tests.support.patience import PATIENCE
from tests.support.processes import wait_until
from tests.support.virtual_time import InVirtualTime, node_in

__all__ = ["LATCHED", "Alive", "OnDds", "Virtual"]

T = TypeVar("T")


class Alive(Client):
    """Asks and hears one component, which runs.

    Attributes
    ----------
    component
        The component, for what a test must look at.
    statuses
        All that it has told of its health.
    """

    component: Component

    def __init__(self, node: Any, component: Component) -> None:
        super().__init__(node)
        self.component = component
        self.statuses: list[ComponentStatus] = []
        node.create_subscription(
            ComponentStatus, f"{component.node_name}/status", self.statuses.append, LATCHED
        )

    @abstractmethod
    def close(self) -> None:
        """End the component as its process would; nothing happens the second time."""

    def call(self, kind: type, name: str, request: Any, timeout: float = 10.0) -> Any:
        """Call a service of the component; signed, if the service changes something."""
        return super().call(kind, self._full(name), request, timeout)

    def begin(self, kind: type, name: str, request: Any) -> Callable[[], Any]:
        """Call a service; the returned function gives the answer once it is there."""
        reply: Reply[Any] = self._calls.begin(kind, self._full(name), request, 60 * self.patience)
        return lambda: reply.result() if reply.done() else None

    def _full(self, name: str) -> str:
        return f"/{self.component.node_name}/{name}"

    def execute(self, name: str, timeout: float = 10.0, **kwargs: Any) -> Any:
        """Call a component action, as rules do."""
        request = ExecuteMethod.Request(name=name, kwargs_json=json.dumps(kwargs))
        return self.call(ExecuteMethod, "execute_method", request, timeout)

    def publisher(self, kind: type, topic: str, qos: Any = 10) -> Any:
        """A publisher that the component has found."""
        publisher = self.node.create_publisher(kind, topic, qos)
        self.wait_until(
            lambda: publisher.get_subscription_count() > 0, 10, f"a listener on {topic}"
        )
        return publisher

    def hear(self, kind: type, topic: str, qos: Any = 10) -> list[Any]:
        """All messages of a topic from now on."""
        heard: list[Any] = []
        self.node.create_subscription(kind, topic, heard.append, qos)
        return heard


class OnDds(Alive):
    """On a ROS domain of its own, in threads of the test."""

    patience = PATIENCE

    def __init__(
        self, component: Component, *, activate: bool = True, describe: bool = True
    ) -> None:
        if describe:
            _describe(component)
        self._domain = domain = next_domain()
        rclpy.init(args=[], domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        self.client_context = rclpy.Context()
        rclpy.init(args=[], context=self.client_context, domain_id=domain)
        self._ended = threading.Event()
        node = component.create_node()
        executor = self._executor = EventsExecutor()
        executor.add_node(node)
        if activate:
            _activate(component, node)
        super().__init__(rclpy.create_node("tester", context=self.client_context), component)
        self._client_executor = SingleThreadedExecutor(context=self.client_context)
        self._client_executor.add_node(self.node)
        self._threads = [
            threading.Thread(target=self._spin, args=(one,))
            for one in (executor, self._client_executor)
        ]
        for thread in self._threads:
            thread.start()

    def _spin(self, executor: Any) -> None:
        while not self._ended.is_set():
            executor.spin_once(timeout_sec=0.05)

    def close(self) -> None:
        """End the component as its process would; nothing happens the second time."""
        if self._ended.is_set():
            return
        self._ended.set()
        for thread in self._threads:
            thread.join()
        # Else it keeps what the node destroys: a server of an action, that answers nobody.
        for executor in (self._executor, self._client_executor):
            executor.shutdown()
        self.component.leave()
        self.node.destroy_node()
        rclpy.shutdown()
        self.client_context.try_shutdown()
        give_back(self._domain)

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
        """Do something on the client's thread; what it returns.

        rclpy may else see the answer to a goal before it knows the question.
        """
        done = self._client_executor.create_task(work)
        wait_until(done.done, 5, "the work")
        result: T = done.result()
        return result

    def answer(self, reply: Reply[T]) -> T:
        """Wait for an answer that is under way."""
        return reply.wait()

    def action_client(self, kind: Any, name: str) -> Any:
        """A client of an action."""
        return ActionClient(self.node, kind, name)


class Virtual(InVirtualTime, Alive):
    """In a virtual world of its own, in a process as the host makes one."""

    def __init__(
        self, component: Component, *, activate: bool = True, describe: bool = True
    ) -> None:
        if describe:
            _describe(component)
        self.world = World()
        process = self.world.process(component.node_name)
        executor = VirtualExecutor(process, component.on_callback_error)

        def make(name: str, transitions: Transitions, namespace: str) -> LifecycleNode:
            return VirtualLifecycleNode(process, name, transitions, namespace)

        node = component.create_node(make=make)
        executor.add_node(node)
        if activate:
            _activate(component, node)
        super().__init__(node_in(self.world, "tester"), component)

    def logged(self, text: str) -> bool:
        """Whether a node has written a line that holds a text."""
        return any(text in entry.text for entry in self.world.log)

    def close(self) -> None:
        """End the component as its process would; nothing happens the second time."""
        self.component.leave()
        self.world.__exit__()


def _describe(component: Component) -> None:
    """For a robot that is described, unless a test does that."""
    if component.lacks_robot:
        component.robot = described_robot()


def _activate(component: Component, node: LifecycleNode) -> None:
    node.trigger_configure()
    if not component.lacks_robot:
        node.trigger_activate()
