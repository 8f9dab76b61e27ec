"""What each component listens to, as the graph tells."""

from __future__ import annotations

import time
from collections.abc import Iterable

from rclpy.node import Node, NodeNameNonExistentError

from kompass_console.schema.models import InputInfo, StreamInfo

_PERIOD = 2.0  # s between two looks; a component's inputs change when it is configured anew


class Inputs:
    """Topics that components subscribe to, and the ages of those that the console reads too."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._topics: dict[str, frozenset[str]] = {}
        self._looked = -_PERIOD

    def refresh(self, components: Iterable[str]) -> None:
        """Look again, now and then. On the link's thread."""
        now = time.monotonic()
        if now - self._looked < _PERIOD:
            return
        self._looked = now
        self._topics = {name: self._subscribed(name) for name in components}

    def infos(self, component: str, streams: Iterable[StreamInfo]) -> list[InputInfo]:
        """Those of a component's topics whose age is known, by name. Any thread."""
        topics = self._topics.get(component, frozenset())
        return sorted(
            (
                InputInfo(topic=stream.topic, age=stream.age, stale=stream.stale)
                for stream in streams
                if stream.topic is not None and stream.topic in topics
            ),
            key=lambda info: info.topic,
        )

    def _subscribed(self, component: str) -> frozenset[str]:
        namespace, _, name = component.rpartition("/")
        try:
            found = self._node.get_subscriber_names_and_types_by_node(name, f"/{namespace}")
        except NodeNameNonExistentError:  # it has gone, or its status topic has another name
            return frozenset()
        return frozenset(topic for topic, _ in found)
