"""Speak for components that cannot: publish their failure on their own status topics."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from automatika_ros_sugar.msg import ComponentStatus
from rclpy.serialization import serialize_message

from kompass.bus.node import Node
from kompass.components.base.health import Health
from kompass.monitor.introspection.catalog import status_topics
from kompass.rclpy_ext.topic import LATCHED

STATUS_TYPE = "automatika_ros_sugar/msg/ComponentStatus"


class StatusProxy:
    """Says for each silent component, again and again, that it failed and why.

    Publishers exist only while they are needed: a latched failure of yesterday must not reach a
    listener of today.

    Parameters
    ----------
    node
        Publishes.
    heard
        Hands a message to the engine: topic, type, message, and its bytes (CDR).
    """

    def __init__(self, node: Node, heard: Callable[[str, str, Any, bytes], None]) -> None:
        self._node, self._heard = node, heard
        self._silent: dict[str, tuple[ComponentStatus, list[Any]]] = {}

    def pass_on(self, topic: str, type_name: str, message: Any, raw: bytes) -> None:
        """Hand a message to the engine, unless it came from here and was handed over already."""
        if topic.removesuffix("/status").removesuffix("_status") not in self._silent:
            self._heard(topic, type_name, message, raw)

    def begin(self, component: str, reason: str) -> None:
        """Say that a component failed, from now on."""
        self.end(component)
        health = Health()
        health.set_fail_component([component], reason)
        publishers = [
            self._node.create_publisher(ComponentStatus, name, LATCHED.to_ros())
            for name in status_topics(component)
        ]
        self._silent[component] = (health.to_msg(), publishers)
        self._say(component)

    def end(self, component: str) -> None:
        """Let a component speak for itself again."""
        _, publishers = self._silent.pop(component, (None, []))
        for publisher in publishers:
            self._node.destroy_publisher(publisher)

    def repeat(self) -> None:
        """Say it again for each; to be called several times a second."""
        for component in list(self._silent):
            self._say(component)

    def _say(self, component: str) -> None:
        message, publishers = self._silent[component]
        for publisher in publishers:
            publisher.publish(message)
        raw = serialize_message(message)
        for topic in status_topics(component):
            self._heard(topic, STATUS_TYPE, message, raw)
