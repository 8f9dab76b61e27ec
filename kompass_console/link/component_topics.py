"""What each component listens to and publishes, as the graph tells."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable

from rclpy.node import Node, NodeNameNonExistentError

from kompass_console.schema.models import InputInfo, StreamInfo

_PERIOD = 2.0  # s between two looks; a component's topics change when it is configured anew


class ComponentTopics:
    """Topics of components: those they subscribe to, and what each gives the others.

    Parameters
    ----------
    now
        The time in s.
    """

    def __init__(self, node: Node, *, now: Callable[[], float] = time.monotonic) -> None:
        self._node = node
        self._now = now
        self._inputs: dict[str, frozenset[str]] = {}
        self._outputs: dict[str, frozenset[str]] = {}
        self._looked = -_PERIOD

    def refresh(self, components: Iterable[str]) -> None:
        """Look again, now and then. On the link's thread."""
        now = self._now()
        if now - self._looked < _PERIOD:
            return
        self._looked = now
        names = list(components)
        find = self._node.get_subscriber_names_and_types_by_node
        self._inputs = {name: _topics(find, name) for name in names}
        find = self._node.get_publisher_names_and_types_by_node
        published = {name: _topics(find, name) for name in names}
        # Who is not there right now (killed, and not back yet) still is who has to publish it.
        self._outputs = {
            name: topics or self._outputs.get(name, frozenset())
            for name, topics in published.items()
        }

    def infos(self, component: str, streams: Iterable[StreamInfo]) -> list[InputInfo]:
        """Those of a component's inputs whose age is known, by name. Any thread."""
        topics = self._inputs.get(component, frozenset())
        return sorted(
            (
                InputInfo(topic=stream.topic, age=stream.age, stale=stream.stale, rate=stream.rate)
                for stream in streams
                if stream.topic is not None and stream.topic in topics
            ),
            key=lambda info: info.topic,
        )

    def outputs(self, component: str, streams: Iterable[StreamInfo]) -> list[str]:
        """Topics that a component publishes and another one or the console reads. Any thread."""
        read = {t for name, topics in self._inputs.items() if name != component for t in topics}
        read |= {stream.topic for stream in streams if stream.topic is not None}
        return sorted(self._outputs.get(component, frozenset()) & read)


def _topics(
    find: Callable[[str, str], list[tuple[str, list[str]]]], component: str
) -> frozenset[str]:
    namespace, _, name = component.rpartition("/")
    try:
        found = find(name, f"/{namespace}")
    except NodeNameNonExistentError:  # it has gone, or its status topic has another name
        return frozenset()
    return frozenset(topic for topic, _ in found)
