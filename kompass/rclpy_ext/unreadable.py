"""Bytes that are no message of their type: a publisher is cut off, or built with other messages.

rclpy raises where such a message is handled, and what raises there ends a program, or tells neither
the topic nor what to do. Such a message is left out, and told of now and then.
"""

from __future__ import annotations

import math
from typing import Any, Protocol

from rclpy.serialization import deserialize_message

from kompass.bus.clock import Clock
from kompass.message_types import type_name

AGAIN = 10.0  # s between two words on one topic


class Unreadable(ValueError):
    """Bytes are no message of a type."""


class Teller(Protocol):
    """What is needed of a node."""

    @property
    def clock(self) -> Clock: ...
    def write_log(self, level: str, text: str) -> None: ...


def read_message(data: bytes, kind: type[Any]) -> Any:
    """Make a message of its bytes (CDR).

    Raises
    ------
    Unreadable
        They are none of this type.
    """
    try:
        return deserialize_message(data, kind)
    except Exception as error:  # whatever the middleware, or a check of a field, raises
        raise Unreadable(f"{len(data)} bytes are no {type_name(kind)}") from error


class LeftOut:
    """Tells of the messages on one topic that cannot be read.

    Parameters
    ----------
    node
        In its log.
    topic
        For people.
    """

    def __init__(self, node: Teller, topic: str) -> None:
        self._node, self._topic = node, topic
        self._told, self._count = -math.inf, 0

    def tell(self, error: Exception) -> None:
        """One more."""
        self._count += 1
        now = self._node.clock.monotonic()
        if now - self._told < AGAIN:
            return
        count = "a message was" if self._count == 1 else f"{self._count} messages were"
        self._node.write_log(
            "error", f"{self._topic}: {count} left out: {error}; look at who publishes there"
        )
        self._told, self._count = now, 0
