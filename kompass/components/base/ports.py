"""The subscriptions and publishers behind a running component's inputs and outputs."""

import time
from collections.abc import Callable, Mapping
from typing import Any

from rclpy.lifecycle import LifecycleNode

from kompass.components.base.topics import DeclaredTopics
from kompass.rclpy_ext.topic import SENSOR, QoSConfig, Topic

SENSOR_TYPES = {"LaserScan", "PointCloud2", "Imu", "Odometry", "Image", "Range"}


class Input:
    """Subscription that keeps the newest message. Ages are of the monotonic clock [s]."""

    def __init__(self, topic: Topic, qos: QoSConfig | None = None) -> None:
        self.topic = topic
        self.message: Any = None
        self.received: float | None = None
        self.on_message: Callable[[Any], None] | None = None
        fitting = SENSOR if topic.msg_type in SENSOR_TYPES else QoSConfig()
        self._qos = topic.qos_profile or qos or fitting
        self._subscription: Any = None

    @property
    def is_open(self) -> bool:
        """Whether it is subscribed."""
        return self._subscription is not None

    def open(self, node: LifecycleNode) -> None:
        """Subscribe; nothing happens when it is."""
        if self.is_open:
            return
        self._subscription = node.create_subscription(
            self.topic.ros_msg_type, self.topic.name, self._receive, self._qos.to_ros()
        )

    def close(self, node: LifecycleNode) -> None:
        """Unsubscribe and forget the last message."""
        if self._subscription is not None:
            node.destroy_subscription(self._subscription)
            self._subscription = None
        self.clear()

    def clear(self) -> None:
        """Forget the last message."""
        self.message, self.received = None, None

    def age(self) -> float:
        """Seconds since the newest message; infinite before the first."""
        return float("inf") if self.received is None else time.monotonic() - self.received

    def _receive(self, message: Any) -> None:
        self.message = message
        self.received = time.monotonic()
        if self.on_message is not None:
            self.on_message(message)


class InputPorts:
    """The inputs of a component by key: there while it is configured, open while it is active.

    Parameters
    ----------
    qos
        Quality of service of keys whose message type alone does not tell it.
    """

    def __init__(self, qos: Mapping[str, QoSConfig]) -> None:
        self._qos = qos
        self._inputs: dict[str, list[Input]] = {}

    def __getitem__(self, key: str) -> list[Input]:
        return self._inputs[key]

    def make(self, declared: DeclaredTopics) -> None:
        """Make an input, still closed, for each declared topic."""
        for key, topics in declared.items():
            self._inputs[key] = [Input(topic, self._qos.get(key)) for topic in topics]

    def open(self, node: LifecycleNode, wanted: Callable[[str], bool]) -> None:
        """Subscribe to those whose key is wanted."""
        for key, sources in self._inputs.items():
            if wanted(key):
                for source in sources:
                    source.open(node)

    def close(self, node: LifecycleNode) -> None:
        """Unsubscribe from all."""
        for sources in self._inputs.values():
            for source in sources:
                source.close(node)

    def forget(self) -> None:
        """Drop all; they must be closed."""
        self._inputs = {}

    def change(self, node: LifecycleNode, key: str, index: int, topic: Topic) -> None:
        """Take another topic in one place; nothing happens when the key has not been made."""
        if key not in self._inputs:
            return
        old, new = self._inputs[key][index], Input(topic, self._qos.get(key))
        new.on_message = old.on_message
        if old.is_open:
            new.open(node)
            old.close(node)
        self._inputs[key][index] = new


class OutputPorts:
    """The publishers of a component by key: there while it is configured.

    Parameters
    ----------
    qos
        Quality of service of keys that need another one than the usual.
    """

    def __init__(self, qos: Mapping[str, QoSConfig]) -> None:
        self._qos = qos
        self._publishers: dict[str, list[Any]] = {}

    def __getitem__(self, key: str) -> list[Any]:
        return self._publishers[key]

    def make(self, node: LifecycleNode, declared: DeclaredTopics) -> None:
        """Make a publisher for each declared topic."""
        for key, topics in declared.items():
            self._publishers[key] = [self._make(node, key, topic) for topic in topics]

    def destroy(self, node: LifecycleNode) -> None:
        """Give all publishers back."""
        for publishers in self._publishers.values():
            for publisher in publishers:
                node.destroy_publisher(publisher)
        self._publishers = {}

    def publish(self, key: str, message: Any, index: int = 0) -> None:
        """Publish; nothing happens when there is no such output."""
        publishers = self._publishers.get(key, [])
        if index < len(publishers):
            publishers[index].publish(message)

    def change(self, node: LifecycleNode, key: str, index: int, topic: Topic) -> None:
        """Take another topic in one place; nothing happens when the key has not been made."""
        if key not in self._publishers:
            return
        publisher = self._make(node, key, topic)
        node.destroy_publisher(self._publishers[key][index])
        self._publishers[key][index] = publisher

    def _make(self, node: LifecycleNode, key: str, topic: Topic) -> Any:
        qos = topic.qos_profile or self._qos.get(key) or QoSConfig()
        return node.create_publisher(topic.ros_msg_type, topic.name, qos.to_ros())
