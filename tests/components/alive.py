"""A component that really runs, in a thread of the test, and a client of its own beside it."""

import json
import threading
from collections.abc import Callable
from typing import Any

import rclpy
from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ExecuteMethod
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions

from kompass.components import Component
from kompass.rclpy_ext.reply import Reply
from tests.support.described import described_robot
from tests.support.domains import give_back, next_domain
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.signed import SignedCalls

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Alive:
    """Runs one component on a ROS domain of its own, for a robot that is described unless told."""

    def __init__(
        self, component: Component, *, activate: bool = True, describe: bool = True
    ) -> None:
        self.component = component
        if describe and component.lacks_robot:
            component.robot = described_robot()
        self._domain = domain = next_domain()
        rclpy.init(args=[], domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        self.client_context = rclpy.Context()
        rclpy.init(args=[], context=self.client_context, domain_id=domain)
        self._ended = threading.Event()
        node = component.create_node()
        executor = EventsExecutor()
        executor.add_node(node)
        if activate:
            node.trigger_configure()
            if not component.lacks_robot:
                node.trigger_activate()
        self.node = rclpy.create_node("tester", context=self.client_context)
        self._calls = SignedCalls(self.node)
        self.statuses: list[ComponentStatus] = []
        self.node.create_subscription(
            ComponentStatus, f"{component.node_name}/status", self.statuses.append, LATCHED
        )
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
        self.component.leave()
        self.node.destroy_node()
        rclpy.shutdown()
        self.client_context.try_shutdown()
        give_back(self._domain)

    def call(self, kind: type, name: str, request: Any, timeout: float = 10.0) -> Any:
        """Call a service of the component; signed, if the service changes something."""
        return self._begin(kind, name, request, timeout).wait()

    def begin(self, kind: type, name: str, request: Any) -> Callable[[], Any]:
        """Call a service; the returned function gives the answer once it is there."""
        reply = self._begin(kind, name, request, 60.0)
        return lambda: reply.result() if reply.done() else None

    def _begin(self, kind: type, name: str, request: Any, timeout: float) -> Reply[Any]:
        full = f"/{self.component.node_name}/{name}"
        return self._calls.begin(kind, full, request, patient(timeout))

    def do(self, work: Callable[[], Any]) -> Any:
        """Do something on the client's thread; what it returns.

        rclpy may else see the answer to a goal before it knows the question.
        """
        done = self._client_executor.create_task(work)
        wait_until(done.done, 5, "the work")
        return done.result()

    def execute(self, name: str, timeout: float = 10.0, **kwargs: Any) -> Any:
        """Call a component action, as rules do."""
        request = ExecuteMethod.Request(name=name, kwargs_json=json.dumps(kwargs))
        return self.call(ExecuteMethod, "execute_method", request, timeout)

    def publisher(self, kind: type, topic: str, qos: Any = 10) -> Any:
        """A publisher that the component has found."""
        publisher = self.node.create_publisher(kind, topic, qos)
        wait_until(lambda: publisher.get_subscription_count() > 0, 10, f"a listener on {topic}")
        return publisher

    def hear(self, kind: type, topic: str, qos: Any = 10) -> list[Any]:
        """All messages of a topic from now on."""
        heard: list[Any] = []
        self.node.create_subscription(kind, topic, heard.append, qos)
        return heard
