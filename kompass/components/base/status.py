"""Publish a component's health, under both names that recipes listen to."""

import time

from automatika_ros_sugar.msg import ComponentStatus
from rclpy.lifecycle import LifecycleNode

from kompass.components.base.health import Health
from kompass.rclpy_ext.topic import LATCHED


class StatusPublisher:
    """A change goes out at once, and the same again at ``rate`` Hz, so silence means something.

    Published on ``<node>/status`` and ``<node>_status``; latched, so a late listener knows.
    """

    def __init__(self, node: LifecycleNode, rate: float) -> None:
        names = (f"{node.get_name()}/status", f"{node.get_name()}_status")
        qos = LATCHED.to_ros()
        self._publishers = [node.create_publisher(ComponentStatus, name, qos) for name in names]
        self._period = 1.0 / rate
        self._last: ComponentStatus | None = None
        self._sent = 0.0

    def set_rate(self, rate: float) -> None:
        """Repeat at another rate [Hz] from now on."""
        self._period = 1.0 / rate

    def publish(self, health: Health, *, always: bool = False) -> None:
        """Send when something changed or the period has passed, or ``always``."""
        message = health.to_msg()
        now = time.monotonic()
        due = always or now - self._sent >= 0.95 * self._period
        if message == self._last and not due:
            return
        self._last, self._sent = message, now
        for publisher in self._publishers:
            publisher.publish(message)
