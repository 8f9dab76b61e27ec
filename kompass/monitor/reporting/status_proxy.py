"""Speak for components that cannot: publish their failure on their own status topics."""

from __future__ import annotations

from typing import Any

from automatika_ros_sugar.msg import ComponentStatus
from rclpy.node import Node

from kompass.components.base.health import Health
from kompass.rclpy_ext.topic import LATCHED


class StatusProxy:
    """Says for each silent component, again and again, that it failed and why.

    Publishers exist only while they are needed: a latched failure of yesterday must not reach a
    listener of today.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._silent: dict[str, tuple[ComponentStatus, list[Any]]] = {}

    def speaks_for(self, component: str) -> bool:
        """Whether a component is spoken for."""
        return component in self._silent

    def begin(self, component: str, reason: str) -> ComponentStatus:
        """Say that a component failed; what is said."""
        self.end(component)
        health = Health()
        health.set_fail_component([component], reason)
        message = health.to_msg()
        publishers = [
            self._node.create_publisher(ComponentStatus, name, LATCHED.to_ros())
            for name in (f"{component}/status", f"{component}_status")
        ]
        self._silent[component] = (message, publishers)
        for publisher in publishers:
            publisher.publish(message)
        return message

    def end(self, component: str) -> None:
        """It speaks for itself again."""
        _, publishers = self._silent.pop(component, (None, []))
        for publisher in publishers:
            self._node.destroy_publisher(publisher)

    def repeat(self) -> dict[str, ComponentStatus]:
        """Say it again; what is said, by component."""
        for message, publishers in self._silent.values():
            for publisher in publishers:
                publisher.publish(message)
        return {name: message for name, (message, _) in self._silent.items()}
