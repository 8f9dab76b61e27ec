"""A subscription that follows its publisher: another topic, another quality of service."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable
from typing import Any, Generic, TypeVar

from rclpy.node import Node

from kompass.rclpy_ext.qos import FOR_ANY_PUBLISHER, ReaderQoS, best_for
from kompass_console.schema.plain import plain

T = TypeVar("T")
_logger = logging.getLogger(__name__)


class Reader(Generic[T]):
    """Converts each message of one topic and hands it on.

    Parameters
    ----------
    convert
        Makes a value of a message; a message for which it raises ValueError is left out.
    store
        Takes the value, on the link's thread.
    latched
        Ask for the last message published before, when the publishers keep one; otherwise delivery
        is best effort, which every publisher can serve.
    depth
        Messages that may wait.
    paths
        To the fields that ``convert`` looks at; without them it is given the whole message.

    Attributes
    ----------
    topic
        That is read; None before any was.
    count
        Messages that came so far.
    """

    def __init__(
        self,
        node: Node,
        message_type: type[Any],
        convert: Callable[[Any], T],
        store: Callable[[T], None],
        *,
        latched: bool = False,
        depth: int = 1,
        paths: Iterable[tuple[str, ...]] | None = None,
    ) -> None:
        self._node = node
        self._paths = paths
        self._type = message_type
        self._convert = convert
        self._store = store
        self._latched = latched
        self._depth = depth
        self._subscription: Any = None
        self._qos = FOR_ANY_PUBLISHER
        self._complained = ""
        self.topic: str | None = None
        self.count = 0  # messages so far

    def follow(self, topic: str | None) -> bool:
        """Read `topic` from now on (None: nothing). True when that is another topic than before."""
        if topic is None:
            # Keep listening to the old one: its publisher may be restarting.
            return False
        qos = self._offered(topic)
        if topic == self.topic and qos == self._qos:
            return False
        moved = topic != self.topic
        self.close()
        self.topic, self._qos = topic, qos
        profile = qos.profile(self._depth)
        if self._paths is None:
            self._subscription = self._node.create_subscription(
                self._type, topic, self._received, profile
            )
        else:
            self._subscription = self._node.create_partial_subscription(
                self._type, topic, lambda fields, _: self._received(fields), profile, self._paths
            )
        return moved

    def close(self) -> None:
        """Stop reading."""
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None

    def _offered(self, topic: str) -> ReaderQoS:
        if not self._latched:
            return FOR_ANY_PUBLISHER
        return best_for(self._node.get_publishers_info_by_topic(topic), self._qos)

    def _received(self, message: Any) -> None:
        self.count += 1
        try:
            value = self._convert(message)
        except ValueError as error:
            if str(error) != self._complained:  # once, not at 50 Hz
                self._complained = str(error)
                _logger.warning("%s: message left out: %s", self.topic, plain(error))
            return
        self._store(value)
