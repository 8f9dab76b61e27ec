"""Further topics of the graph that can be drawn: found by type, read while a page shows them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Any

from geometry_msgs.msg import PolygonStamped, PoseArray
from nav_msgs.msg import OccupancyGrid, Path
from rclpy.exceptions import InvalidTopicNameException
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rclpy.validate_full_topic_name import validate_full_topic_name
from sensor_msgs.msg import LaserScan, PointCloud2
from visualization_msgs.msg import Marker, MarkerArray

from kompass.algorithms.transforms import TransformError
from kompass.rclpy_ext.executor import MIDDLEWARE_ERRORS
from kompass_console.link.graph.discovery import Graph
from kompass_console.link.on_demand import shapes
from kompass_console.link.on_demand.frames import Frames
from kompass_console.link.on_demand.markers import MarkerBoard
from kompass_console.link.on_demand.raw_topic import RawTopic
from kompass_console.link.on_demand.shapes import Part
from kompass_console.schema.look_models import ExtraInfo, ExtraKind
from kompass_console.schema.plain import plain
from kompass_console.schema.world import Shape, Stamped, WorldModel

MOST_LISTED = 60  # topics
MOST_READ = 16  # of all pages together

_PERIOD = 0.25  # s between two looks at a topic
_REST = 4.0  # times as long as a look takes is waited before the next one
_AGAIN = 1.0  # s between two looks for a frame that is not connected
_MARKERS_WAIT = 50  # messages between two looks: each may add or take away
_MOST_AT_ONCE = 1_000_000  # bytes of messages that wait; of more only the newest are read
_KB, _MB = 1000, 1_000_000


@dataclass(frozen=True, slots=True)
class _Kind:
    """A type that is drawn, by what function, and of what size (bytes) a message may be."""

    key: ExtraKind
    message: type[Any]
    part: Callable[[Any], Part] | None  # None of markers, which add up
    largest: int


# What is made of many objects takes long to be read: of that a message has to be smaller.
_KINDS: dict[str, _Kind] = {
    "nav_msgs/msg/Path": _Kind("path", Path, shapes.path_part, 2 * _MB),
    "geometry_msgs/msg/PoseArray": _Kind("poses", PoseArray, shapes.poses_part, 2 * _MB),
    "visualization_msgs/msg/Marker": _Kind("markers", Marker, None, 2 * _MB),
    "visualization_msgs/msg/MarkerArray": _Kind("markers", MarkerArray, None, 2 * _MB),
    "sensor_msgs/msg/PointCloud2": _Kind("cloud", PointCloud2, shapes.cloud_part, 48 * _MB),
    "sensor_msgs/msg/LaserScan": _Kind("scan", LaserScan, shapes.scan_part, 2 * _MB),
    "nav_msgs/msg/OccupancyGrid": _Kind("grid", OccupancyGrid, shapes.grid_part, 32 * _MB),
    "geometry_msgs/msg/PolygonStamped": _Kind(
        "polygon", PolygonStamped, shapes.polygon_part, 200 * _KB
    ),
}


def can_be_read(topic: str) -> bool:
    """Whether a name on the graph can be subscribed to: on DDS there may be others than ROS's."""
    try:
        validate_full_topic_name(topic)
    except InvalidTopicNameException:
        return False
    return True


def newest(messages: Sequence[bytes], most: int) -> Sequence[bytes]:
    """Of messages, the oldest first, the last ones of so many bytes together; one at least."""
    size = 0
    for count, message in enumerate(reversed(messages)):
        size += len(message)
        if count > 0 and size > most:
            return messages[len(messages) - count :]
    return messages


@dataclass(slots=True)
class _Read:
    """A topic that is read."""

    kind: _Kind
    topic: RawTopic
    board: MarkerBoard | None
    due: float = 0.0
    place_due: float = math.inf
    parts: Sequence[Part] = ()
    received: float | None = None
    problem: str = ""
    note: str = ""
    shape: Stamped[Shape] | None = None
    drawn: int = 0
    missed: int = 0


class Extras:
    """Reads on the one thread that calls `look`; it is told on any other what there is.

    Parameters
    ----------
    node
        As of :class:`RawTopic`.
    world
        Says what pages want to see, and is given what is to be drawn.
    """

    def __init__(self, node: Node, world: WorldModel) -> None:
        self._node = node
        self._world = world
        self._frames = Frames(node, world)
        self._found: dict[str, _Kind] = {}
        self._read: dict[str, _Read] = {}
        self._too_many: frozenset[str] = frozenset()

    def refresh(self, published: Graph, drawn: Collection[str]) -> None:
        """Take in what is published now, without what the scene draws anyway."""
        found = {}
        for name, types in sorted(published.items()):
            kind = next((_KINDS[each] for each in types if each in _KINDS), None)
            if kind is not None and name not in drawn and can_be_read(name):
                found[name] = kind
                if len(found) == MOST_LISTED:
                    break
        self._found = found

    def look(self) -> bool:
        """Read what is due; whether anything is wanted."""
        found, wanted = self._found, sorted(self._world.extras_wanted)
        there = [name for name in wanted if name in found]
        read, self._too_many = there[:MOST_READ], frozenset(there[MOST_READ:])
        changed = False
        for name in [n for n, r in self._read.items() if n not in read or r.kind != found[n]]:
            self._read.pop(name).topic.close()
            changed = True
        if not read:
            self._frames.close()
        else:
            self._frames.look()
        now = time.monotonic()
        for name in read:
            if name not in self._read:
                self._read[name] = self._open(name, found[name])
            each = self._read[name]
            if now >= each.due:
                began = time.monotonic()
                each.due = began + _AGAIN  # whatever goes wrong
                changed |= self._look_at(each, began)
                took = time.monotonic() - began
                each.due = began + took + max(_PERIOD, _REST * took)
        if changed:
            self._world.extras = {
                name: each.shape for name, each in self._read.items() if each.shape is not None
            }
        return bool(read)

    def infos(self) -> list[ExtraInfo]:
        """All topics that could be drawn. Any thread."""
        now, read = time.monotonic(), self._read
        infos = []
        for name, kind in self._found.items():
            each = read.get(name)
            age = None if each is None or each.received is None else max(0.0, now - each.received)
            problem = "" if each is None else each.problem
            if name in self._too_many:
                problem = f"{MOST_READ} further layers are drawn on all pages; switch one off."
            infos.append(
                ExtraInfo(
                    topic=name,
                    kind=kind.key,
                    age=age,
                    problem=problem,
                    note="" if each is None else each.note,
                )
            )
        return infos

    def close(self) -> None:
        """Read nothing any more."""
        for each in self._read.values():
            each.topic.close()
        self._frames.close()

    def _open(self, name: str, kind: _Kind) -> _Read:
        is_board = kind.part is None
        topic = RawTopic(self._node, name, kind.message, _MARKERS_WAIT if is_board else 1)
        return _Read(kind, topic, MarkerBoard() if is_board else None)

    def _look_at(self, each: _Read, now: float) -> bool:
        """Whether there is something else to draw of a topic."""
        each.topic.fit()
        new = False
        waiting = list(each.topic.take())
        chosen = newest(waiting, _MOST_AT_ONCE)
        if waiting:
            each.missed = len(waiting) - len(chosen)
        for raw in chosen:
            each.received = now
            try:
                self._take(each, raw, now)
            except (ValueError, *MIDDLEWARE_ERRORS) as error:
                each.parts, each.note = (), ""
                each.problem = f"Not drawn: {plain(error)}."
                if each.shape is not None:
                    self._draw(each, Shape(), now)
                    return True
                return False
            new = True
        if each.board is not None and (new or each.board.next_end() <= now):
            each.parts = each.board.parts(now)
            new = True
        if new or now >= each.place_due:
            self._place(each, now)
            return True
        return False

    def _take(self, each: _Read, raw: bytes, now: float) -> None:
        if len(raw) > each.kind.largest:
            raise ValueError(
                f"a message has {len(raw) / _MB:.1f} MB, and {each.kind.largest / _MB:g} MB is "
                "the most of this kind"
            )
        message = deserialize_message(raw, each.kind.message)
        if each.board is not None:
            markers = message.markers if isinstance(message, MarkerArray) else [message]
            each.board.take(markers, now)
        elif each.kind.part is not None:
            each.parts = (each.kind.part(message),)

    def _place(self, each: _Read, now: float) -> None:
        """Take the parts to the scene's frame, as far as it is known where they are."""
        placed, problems = [], []
        for part in each.parts:
            try:
                placed.append(shapes.moved(part.shape, self._frames.place(part.frame, part.stamp)))
            except TransformError as error:
                problems.append(str(error))
        each.place_due = now + _AGAIN if problems else math.inf
        each.problem = problems[0] if problems else ""
        notes = [part.note for part in each.parts if part.note]
        if each.missed > 0:
            notes.append("It comes faster than it can be read: some messages are left out.")
        each.note = " ".join(notes)
        self._draw(each, shapes.combined(placed) if placed else Shape(), now)

    def _draw(self, each: _Read, shape: Shape, now: float) -> None:
        each.drawn += 1
        each.shape = Stamped(shape, now, each.drawn)
