"""Topics that pages want to look into for a while: one subscription each, whoever looks."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

from rclpy.exceptions import InvalidTopicNameException
from rclpy.node import Node
from rclpy.validate_full_topic_name import validate_full_topic_name

from kompass.message_types import ros_class
from kompass_console.link.graph.discovery import Graph
from kompass_console.link.graph.reader import Reader

MOST_TOPICS = 48  # of all pages together

_DEPTH = 100  # as of the monitor: rates and changes count every message
_LINGER = 3.0  # s for which a topic stays open that nobody looks into any more


class CannotOpen(Exception):
    """A topic cannot be looked into; the message is a sentence."""


class ReceivedMessage(NamedTuple):
    """A message and when it came (monotonic s)."""

    message: Any
    at: float


class TopicListener(Protocol):
    """Who looks into topics."""

    def hear(self, topic: str, message: Any, at: float) -> None:
        """A message has come. On the link's thread."""


class _WatchedTopic:
    def __init__(self, node: Node, topic: str, kind: str) -> None:
        self.topic = topic
        self.kind = kind
        self.listeners: tuple[TopicListener, ...] = ()
        self.newest: ReceivedMessage | None = None
        self.left_at = 0.0
        self._reader: Reader[Any] = Reader(
            node, ros_class(kind), lambda message: message, self._store, latched=True, depth=_DEPTH
        )

    def fit(self) -> None:
        """Take the quality of service that the publishers offer now."""
        self._reader.follow(f"/{self.topic}")

    def close(self) -> None:
        self._reader.close()

    def _store(self, message: Any) -> None:
        heard = ReceivedMessage(message, time.monotonic())
        self.newest = heard
        for listener in self.listeners:
            listener.hear(self.topic, heard.message, heard.at)


class TopicWatch:
    """Opens topics for listeners and closes them some time after the last has left.

    A topic stays open for a moment because pages look anew with every keystroke, and what it said
    last can then be shown at once.
    """

    def __init__(self, node: Node, run: Callable[[Callable[[], None]], None]) -> None:
        self._node = node
        self._run = run
        self._watched: dict[str, _WatchedTopic] = {}
        self._graph: Graph = {}
        self._lock = threading.Lock()

    def refresh(self, published: Graph) -> None:
        """Close what nobody looks into, and fit the rest to its publishers. The link's thread."""
        self._graph = published
        now = time.monotonic()
        with self._lock:
            idle = [
                t for t in self._watched.values() if not t.listeners and now - t.left_at > _LINGER
            ]
            for watched in idle:
                del self._watched[watched.topic]
            still_open = list(self._watched.values())
        for watched in idle:
            watched.close()
        for watched in still_open:
            watched.fit()

    def open(
        self, listener: TopicListener, wanted: dict[str, str | None]
    ) -> dict[str, ReceivedMessage]:
        """Let somebody hear topics; what they said last. Any thread.

        Parameters
        ----------
        wanted
            Names without slash, and types; None for the type that the topic has on the graph.

        Raises
        ------
        CannotOpen
            When a topic has another type, the type is not installed, or too many are open.
        """
        topics = {topic: self._checked(topic, kind) for topic, kind in wanted.items()}
        with self._lock:
            new = {topic: kind for topic, kind in topics.items() if topic not in self._watched}
            for topic, kind in topics.items():
                known = kind if topic in new else self._watched[topic].kind
                if known != kind:
                    raise CannotOpen(f"/{topic} is being looked at as {known}, not as {kind}.")
            if len(self._watched) + len(new) > MOST_TOPICS:
                raise CannotOpen(
                    f"More than {MOST_TOPICS} topics are being looked at; close another editor."
                )
            for topic, kind in new.items():
                self._watched[topic] = _WatchedTopic(self._node, topic, kind)
            for topic in topics:
                self._watched[topic].listeners += (listener,)
            new_ones = [self._watched[topic] for topic in new]

        def fit() -> None:
            for watched in new_ones:
                watched.fit()

        self._run(fit)
        return {topic: heard for topic in topics if (heard := self._watched[topic].newest)}

    def close(self, listener: TopicListener) -> None:
        """Let somebody hear nothing any more. Any thread."""
        with self._lock:
            for watched in self._watched.values():
                if listener in watched.listeners:
                    watched.listeners = tuple(
                        each for each in watched.listeners if each is not listener
                    )
                    watched.left_at = time.monotonic()

    def _checked(self, topic: str, kind: str | None) -> str:
        try:
            validate_full_topic_name(f"/{topic}")
        except InvalidTopicNameException as error:
            why = " ".join(str(error).split()).removeprefix("Invalid topic name: ")
            raise CannotOpen(f"/{topic:.60} is no name of a topic: {why}.") from None
        there = self._graph.get(f"/{topic}")
        if kind is None:
            if there is None:
                raise CannotOpen(f"Nobody publishes /{topic}, so its type is not known.")
            kind = there[0]
        if there is not None and kind not in there:
            raise CannotOpen(f"/{topic} has the type {', '.join(there)}, not {kind}.")
        try:
            ros_class(kind)
        except ValueError as error:
            raise CannotOpen(f"{str(error)[0].upper()}{str(error)[1:]}.") from None
        return kind
