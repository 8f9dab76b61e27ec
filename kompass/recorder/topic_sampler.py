"""Listen to topics without an executor: their readers are emptied ten times a second.

A callback per message costs an executor some 50 µs; taking what has gathered costs a tenth. Nothing
is late for it: the middleware stamps each message when it arrives.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable
from typing import Any, NamedTuple

from rclpy.node import Node

from kompass.message_types import ros_class
from kompass.rclpy_ext.qos import FOR_ANY_PUBLISHER, best_for
from kompass.rclpy_ext.subscription import take_all
from kompass.recorder.topics import SampledTopic

DEPTH = 500  # messages of a topic that may gather while the recorder is held up


class Taken(NamedTuple):
    """A message that arrived.

    Attributes
    ----------
    name
        The topic as it is called on the graph.
    received_ns, sent_ns
        Nanoseconds since the epoch, on this machine's clock and on the sender's.
    """

    topic: SampledTopic
    name: str
    latched: bool
    received_ns: int
    sent_ns: int
    raw: bytes


class _Reader:
    def __init__(self, topic: SampledTopic, name: str, kind: type[Any]) -> None:
        self.topic, self.name, self.kind = topic, name, kind
        self.offer = FOR_ANY_PUBLISHER
        self.subscription: Any = None
        self.last = 0


class TopicSampler:
    """Readers of standard topics, except of those that somebody else supplies.

    Parameters
    ----------
    node
        Must not be in an executor.
    """

    def __init__(self, node: Node, topics: Iterable[SampledTopic]) -> None:
        self._node = node
        self._readers = {}
        for topic in topics:
            try:
                kind = ros_class(topic.type)
            except ValueError as error:
                node.get_logger().warning(f"/{topic.name} is not recorded: {error}")
                continue
            name = node.resolve_topic_name(topic.name)
            self._readers[name] = _Reader(topic, name, kind)
        self._left_out: set[str] = set()
        for reader in self._readers.values():
            self._open(reader)

    def leave_out(self, names: Collection[str]) -> None:
        """Do not listen to these (as on the graph): they come from elsewhere."""
        self._left_out = set(names)
        for name, reader in self._readers.items():
            if name in self._left_out:
                self._close(reader)
            elif reader.subscription is None:
                self._open(reader)

    def fit(self) -> None:
        """Make each reader as reliable, and as latched, as all publishers of its topic are."""
        for name, reader in self._readers.items():
            if reader.subscription is None:
                continue
            best = best_for(self._node.get_publishers_info_by_topic(name), reader.offer)
            if best != reader.offer:
                self._close(reader)
                reader.offer = best
                self._open(reader)

    def drain(self, take: Callable[[Taken], None]) -> None:
        """Take all that has arrived."""
        for reader in self._readers.values():
            if reader.subscription is not None:
                self._drain(reader, take)

    def close(self) -> None:
        """Listen no more."""
        for reader in self._readers.values():
            self._close(reader)

    def _drain(self, reader: _Reader, take: Callable[[Taken], None]) -> None:
        period = int(reader.topic.period * 1e9)
        latched = reader.offer.latched
        for raw, info in take_all(reader.subscription):
            at = info["received_timestamp"] or time.time_ns()  # not every middleware stamps
            # A latched message is never left out: it may be the only one.
            if latched or at - reader.last >= period:
                reader.last = at
                sent = info["source_timestamp"] or at
                take(Taken(reader.topic, reader.name, latched, at, sent, raw))

    def _open(self, reader: _Reader) -> None:
        qos = reader.offer.profile(DEPTH)
        reader.subscription = self._node.create_subscription(
            reader.kind, reader.name, _never, qos, raw=True
        )

    def _close(self, reader: _Reader) -> None:
        if reader.subscription is not None:
            self._node.destroy_subscription(reader.subscription)
            reader.subscription = None


def _never(_: bytes) -> None:
    raise AssertionError("the node of the topic sampler is in an executor")
