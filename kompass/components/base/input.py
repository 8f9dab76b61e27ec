"""One input of a component: the newest message of a topic, and how old it is."""

import time
from collections.abc import Callable
from typing import Any

from rclpy.lifecycle import LifecycleNode

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
