"""Cameras of the robot: found by type, read while a page looks, and never kept."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from rclpy.node import Node
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import CompressedImage, Image

from kompass.rclpy_ext.executor import MIDDLEWARE_ERRORS
from kompass_console.link.graph.discovery import Graph
from kompass_console.link.on_demand.extras import can_be_read
from kompass_console.link.on_demand.pictures import (
    LARGEST,
    Encoded,
    encode_compressed,
    encode_image,
)
from kompass_console.link.on_demand.raw_topic import RawTopic
from kompass_console.schema.look_models import CameraInfo, CameraSize
from kompass_console.schema.plain import plain

MOST_LISTED = 20
MOST_READ = 4  # of all pages together
PERIOD = 0.2  # s between two pictures at least

_REST = 2.0  # times as long as a picture takes is waited before the next one
_WIDEST: dict[CameraSize, int] = {"small": 320, "large": 960}  # px
_TYPES: dict[str, type[Any]] = {
    "sensor_msgs/msg/Image": Image,
    "sensor_msgs/msg/CompressedImage": CompressedImage,
}


class CannotLook(Exception):
    """A camera is not shown; the message is a sentence."""


class Picture(NamedTuple):
    """What a camera shows: `encoded`, or `problem` where that cannot be shown; `number` counts,
    `received` is when it came (monotonic s)."""

    number: int
    received: float
    encoded: Encoded | None
    problem: str = ""


@dataclass(eq=False, slots=True)
class Look:
    """One page's look at a camera; `newest` is the newest picture in the size that it asks for."""

    topic: str
    size: CameraSize
    newest: Picture | None = None


@dataclass(slots=True)
class _Read:
    message: type[Any]
    topic: RawTopic
    due: float = 0.0
    count: int = field(default=0)


class Cameras:
    """Reads on the one thread that calls `look`, for pages on any other.

    A picture is made once for each size that somebody looks at, whoever looks; each takes the place
    of the one before it.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._found: dict[str, type[Any]] = {}
        self._read: dict[str, _Read] = {}
        self._looks: tuple[Look, ...] = ()
        self._lock = threading.Lock()

    def refresh(self, published: Graph) -> None:
        """Take in what is published now."""
        found = {}
        for name, types in sorted(published.items()):
            kind = next((_TYPES[each] for each in types if each in _TYPES), None)
            if kind is not None and can_be_read(name):
                found[name] = kind
                if len(found) == MOST_LISTED:
                    break
        self._found = found

    def infos(self) -> list[CameraInfo]:
        """All cameras. Any thread."""
        return [
            CameraInfo(topic=name, compressed=kind is CompressedImage)
            for name, kind in self._found.items()
        ]

    @contextlib.contextmanager
    def looking(self, topic: str, size: CameraSize) -> Iterator[Look]:
        """A look at a camera for as long as the block lasts. Any thread.

        Raises
        ------
        CannotLook
            When there is no such camera, or as many are looked at as may be.
        """
        if topic not in self._found:
            raise CannotLook(f"{plain(topic, 100)} shows no pictures now; choose another camera.")
        look = Look(topic, size)
        with self._lock:
            topics = {each.topic for each in self._looks}
            if topic not in topics and len(topics) >= MOST_READ:
                raise CannotLook(
                    f"{MOST_READ} cameras are looked at on all pages; close one, or choose "
                    f"{plain(min(topics), 100)}."
                )
            self._looks += (look,)
        try:
            yield look
        finally:
            with self._lock:
                self._looks = tuple(each for each in self._looks if each is not look)

    def look(self) -> bool:
        """Read what is due; whether anybody looks."""
        found, looks = self._found, self._looks
        wanted = {look.topic for look in looks if look.topic in found}
        for name in [n for n, r in self._read.items() if n not in wanted or r.message != found[n]]:
            self._read.pop(name).topic.close()
        for name in sorted(wanted):
            read = self._read.get(name)
            if read is None:
                read = _Read(found[name], RawTopic(self._node, name, found[name]))
                self._read[name] = read
            began = time.monotonic()
            if began >= read.due:
                read.due = began + 1.0  # whatever goes wrong
                read.topic.fit()
                for raw in read.topic.take():
                    self._show(read, raw, [look for look in looks if look.topic == name])
                took = time.monotonic() - began
                read.due = began + max(PERIOD, _REST * took)
        return bool(wanted)

    def close(self) -> None:
        """Read nothing any more."""
        for read in self._read.values():
            read.topic.close()

    def _show(self, read: _Read, raw: bytes, looks: list[Look]) -> None:
        read.count += 1
        received = time.monotonic()
        try:
            if len(raw) > LARGEST:
                raise ValueError(
                    f"it has {len(raw) / 1e6:.1f} MB, and at most {LARGEST / 1e6:g} MB are shown"
                )
            message = deserialize_message(raw, read.message)
            encode = encode_compressed if read.message is CompressedImage else encode_image
            sizes: set[CameraSize] = {look.size for look in looks}
            made = {
                size: Picture(read.count, received, encode(message, _WIDEST[size]))
                for size in sizes
            }
        except (ValueError, *MIDDLEWARE_ERRORS) as error:
            problem = f"The picture is not shown: {plain(error)}."
            for look in looks:
                look.newest = Picture(read.count, received, None, problem)
            return
        for look in looks:
            look.newest = made[look.size]
