"""Markers of a topic (visualization_msgs), as RViz keeps them: by namespace and number."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from visualization_msgs.msg import Marker

from kompass_console.link.graph.convert import seconds
from kompass_console.link.on_demand.shapes import (
    MOST_LABELS,
    MOST_POINTS,
    MOST_SEGMENTS,
    Part,
    Points,
    joined,
    moved,
    pose_matrix,
    vertices,
)
from kompass_console.schema.plain import plain
from kompass_console.schema.world import Shape, ShapeLabel

MOST_MARKERS = 1000  # of one topic

_LONGEST_LABEL = 60  # characters
_ROUND = 16  # strokes of a circle
_HEAD = 0.25  # of an arrow's length


class _Kept(NamedTuple):
    part: Part
    until: float  # s, monotonic; inf without an end


class MarkerBoard:
    """The markers that are there; knows no clock: time (s, monotonic) is an argument."""

    def __init__(self) -> None:
        self._kept: dict[tuple[str, int], _Kept] = {}
        self._too_many = False

    def take(self, markers: Sequence[Any], now: float) -> None:
        """Add, change and remove, in the order in which it is said."""
        for marker in markers:
            key = (str(marker.ns), int(marker.id))
            if marker.action == Marker.DELETEALL:
                self._kept.clear()
                self._too_many = False
            elif marker.action == Marker.DELETE:
                self._kept.pop(key, None)
            elif key not in self._kept and len(self._kept) >= MOST_MARKERS:
                self._too_many = True
            else:
                self._add(key, marker, now)

    def next_end(self) -> float:
        """When the next one ends by itself (s, monotonic); inf when none does."""
        return min((kept.until for kept in self._kept.values()), default=math.inf)

    def parts(self, now: float) -> list[Part]:
        """What is to be drawn, bounded; those whose time is over are forgotten."""
        for key in [key for key, kept in self._kept.items() if kept.until <= now]:
            del self._kept[key]
        parts, points, segments, labels = [], MOST_POINTS, MOST_SEGMENTS, MOST_LABELS
        cut = False
        not_drawn = Counter(kept.part.note for kept in self._kept.values() if kept.part.note)
        for kept in self._kept.values():
            shape = kept.part.shape
            points -= len(shape.points)
            segments -= len(shape.segments)
            labels -= len(shape.labels)
            if min(points, segments, labels) < 0:
                cut = True
                break
            parts.append(kept.part._replace(note=""))
        notes = [f"{count} {why}" for why, count in not_drawn.items()]
        if self._too_many:
            notes.append(f"more than {MOST_MARKERS} markers")
        if cut:
            notes.append(f"all after the first {len(parts)}, which are many lines and points")
        note = f"Not drawn: {', '.join(notes)}." if notes else ""
        return [*parts, Part("", 0.0, Shape(), note)]

    def _add(self, key: tuple[str, int], marker: Any, now: float) -> None:
        shape, note = Shape(), ""
        try:
            shape = marker_shape(marker)
        except ValueError as error:
            note = str(error)
        lifetime = seconds(marker.lifetime)
        frame, stamp = str(marker.header.frame_id), seconds(marker.header.stamp)
        until = now + lifetime if lifetime > 0.0 else math.inf
        self._kept.pop(key, None)
        self._kept[key] = _Kept(Part(frame, stamp, shape, note), until)


def marker_shape(marker: Any) -> Shape:
    """What is drawn of a marker, in the frame of its header: solids by their edges.

    Raises
    ------
    ValueError
        When it cannot be drawn; the message says of what kind it is, as of several.
    """
    draw = _KINDS.get(int(marker.type))
    if draw is None:
        raise ValueError("that show a file" if marker.type == 10 else "of an unknown kind")
    scale = (marker.scale.x, marker.scale.y, marker.scale.z)
    if not all(map(math.isfinite, scale)):
        raise ValueError("of a size that is not finite")
    if marker.color.a == 0.0 and not marker.colors:
        return Shape()  # as RViz: it is there, and not seen
    try:
        matrix = pose_matrix(marker.pose)
    except ValueError as error:
        raise ValueError("at a place that is not finite") from error
    return moved(draw(marker, np.array(scale)), matrix)


def _arrow(marker: Any, scale: npt.NDArray[np.float64]) -> Shape:
    if len(marker.points) >= 2:
        start, tip = vertices(marker.points[:2])
    else:
        start, tip = np.zeros(3, np.float32), np.array([scale[0], 0.0, 0.0], np.float32)
    along = tip - start
    aside = (
        np.cross(along, [0.0, 0.0, 1.0])
        if abs(along[2]) < np.abs(along).max()
        else along[[2, 0, 1]]
    )
    barbs = [tip - _HEAD * along + side * _HEAD * 0.5 * aside for side in (1.0, -1.0)]
    lines = np.array([[start, tip], [barbs[0], tip], [barbs[1], tip]], np.float32)
    return _lines(marker, lines)


def _box(marker: Any, scale: npt.NDArray[np.float64]) -> Shape:
    corners = np.array(
        [
            [x, y, z]
            for z in (-0.5, 0.5)
            for x, y in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
        ]
    )
    edges = [(i, (i + 1) % 4) for i in range(4)]
    edges += [(i + 4, j + 4) for i, j in edges] + [(i, i + 4) for i in range(4)]
    return _lines(marker, (corners * scale)[np.array(edges)])


def _sphere(marker: Any, scale: npt.NDArray[np.float64]) -> Shape:
    flat = _circle()
    rings = [
        joined((flat[:, order] * scale).astype(np.float32))
        for order in ([0, 1, 2], [2, 0, 1], [1, 2, 0])
    ]
    return _lines(marker, np.concatenate(rings))


def _cylinder(marker: Any, scale: npt.NDArray[np.float64]) -> Shape:
    flat = _circle()
    low, high = ((flat + np.array([0.0, 0.0, z])) * scale for z in (-0.5, 0.5))
    upright = np.stack([low, high], axis=1)[:: _ROUND // 4]
    return _lines(marker, np.concatenate([joined(low), joined(high), upright]))


def _strip(marker: Any, _scale: object) -> Shape:
    points = vertices(marker.points[: MOST_SEGMENTS + 1])
    return _lines(marker, joined(points), 1)


def _list(marker: Any, _scale: object) -> Shape:
    points = vertices(marker.points[: 2 * MOST_SEGMENTS])
    return _lines(marker, points[: len(points) // 2 * 2].reshape(-1, 2, 3), 2)


def _triangles(marker: Any, _scale: object) -> Shape:
    points = vertices(marker.points[:MOST_SEGMENTS])
    corners = points[: len(points) // 3 * 3].reshape(-1, 3, 3)
    edges = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2, 3)
    return _lines(marker, edges, 1)


def _dots(marker: Any, _scale: object) -> Shape:
    points = vertices(marker.points[:MOST_POINTS])
    return Shape(points=points, point_colours=_colours(marker, len(points), 1))


def _text(marker: Any, _scale: object) -> Shape:
    text = plain(marker.text, _LONGEST_LABEL)
    return Shape(labels=(ShapeLabel(text, (0.0, 0.0, 0.0)),) if text else ())


_KINDS: dict[int, Callable[[Any, Any], Shape]] = {
    Marker.ARROW: _arrow,
    Marker.CUBE: _box,
    Marker.SPHERE: _sphere,
    Marker.CYLINDER: _cylinder,
    Marker.LINE_STRIP: _strip,
    Marker.LINE_LIST: _list,
    Marker.CUBE_LIST: _dots,
    Marker.SPHERE_LIST: _dots,
    Marker.POINTS: _dots,
    Marker.TEXT_VIEW_FACING: _text,
    Marker.TRIANGLE_LIST: _triangles,
}


def _lines(marker: Any, segments: npt.NDArray[np.floating], step: int = 0) -> Shape:
    """`step` is how many of the marker's colours lie between two segments; 0: it has one."""
    lines = segments[:MOST_SEGMENTS].astype(np.float32)
    return Shape(segments=lines, segment_colours=_colours(marker, len(lines), step))


def _colours(marker: Any, count: int, step: int) -> npt.NDArray[np.uint8]:
    """Colours (count, 3) of points or lines: each its own where the marker has some."""
    if step > 0 and len(marker.colors) >= count * step > 0:
        given = [_rgb(each) for each in marker.colors[: count * step : step]]
    else:
        given = [_rgb(marker.color)] * count
    return np.array(given, np.uint8).reshape(-1, 3)


def _rgb(colour: Any) -> tuple[int, int, int]:
    r, g, b = (
        round(255 * min(max(each, 0.0), 1.0)) if math.isfinite(each) else 0
        for each in (colour.r, colour.g, colour.b)
    )
    return r, g, b


def _circle() -> Points:
    """A closed circle (N, 3) of diameter 1 around z."""
    angles = np.linspace(0.0, math.tau, _ROUND + 1)
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(_ROUND + 1)]) / 2
    return ring.astype(np.float32)
