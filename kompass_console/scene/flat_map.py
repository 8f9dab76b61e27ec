"""The scene for a page that draws it flat, by itself: what has changed, as numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from kompass_console.scene.drawings import Drawings
from kompass_console.scene.layers.local_map import LocalMapDrawing
from kompass_console.scene.layers.map import MapDrawing
from kompass_console.scene.layers.robot import outline
from kompass_console.scene.layers.shapes import Vertices
from kompass_console.schema.map_models import (
    FlatAreas,
    FlatExtra,
    FlatGoal,
    FlatMapInfo,
    FlatNews,
    FlatPoint,
    FlatText,
)
from kompass_console.schema.models import View
from kompass_console.schema.world import GoalMark, HindranceMark, Shape, Stamped

_LAYERS = ("map", "local_map", "path", "scan", "trail", "footprint", "goal", "hindrance")
_MOST_POINTS = 2000  # of a further topic; a weak tablet draws them one by one
_MOST_LINES = 2000


class FlatMap:
    """One page's flat map: remembers what it was told, and tells the rest.

    Drawings are never changed once they are made, so that another object is another drawing; and
    whoever asks seldom is told the newest.

    Parameters
    ----------
    find_view
        The page's view; None where it has none (any more).
    """

    def __init__(self, drawings: Drawings, find_view: Callable[[], View | None]) -> None:
        self._drawings = drawings
        self._find_view = find_view
        self._told: dict[str, Any] = dict.fromkeys(_LAYERS)
        self._told_extras: dict[str, Stamped[Shape]] = {}

    @property
    def extras(self) -> list[str]:
        """Further topics that are shown."""
        view = self._find_view()
        return [] if view is None else view.extras

    def news(self) -> FlatNews:
        """What has changed since the last time; everything there is, the first time."""
        news: dict[str, Any] = {}
        for layer in _LAYERS:
            drawing = getattr(self._drawings, layer)
            if drawing is self._told[layer]:
                continue
            self._told[layer] = drawing
            news[layer] = None if drawing is None else _IN_NUMBERS[layer](drawing)
        extras = self._new_extras()
        if extras:
            news["extras"] = extras
        return FlatNews(**news)

    def _new_extras(self) -> dict[str, FlatExtra | None]:
        shown = {t: d for t in self.extras if (d := self._drawings.extras.get(t)) is not None}
        told, self._told_extras = self._told_extras, shown
        gone: dict[str, FlatExtra | None] = {topic: None for topic in told if topic not in shown}
        return gone | {
            topic: _extra(drawing.value)
            for topic, drawing in shown.items()
            if drawing is not told.get(topic)
        }


def _map(drawing: MapDrawing) -> FlatMapInfo:
    x, y, yaw = drawing.origin
    height, width = drawing.classes.shape
    return FlatMapInfo(
        version=drawing.version,
        x=x,
        y=y,
        yaw=yaw,
        resolution=drawing.resolution,
        width=width,
        height=height,
        bounds=drawing.bounds,
    )


def _local_map(drawing: LocalMapDrawing) -> FlatAreas:
    x, y, yaw = drawing.origin
    return FlatAreas(x=x, y=y, yaw=yaw, areas=_numbers(drawing.areas[:, [1, 0, 3, 2]]))


def _line(segments: Vertices) -> list[float]:
    """Points of a line that is drawn as segments (N, 2, 3); a segment without length is none."""
    if len(segments) == 0:
        return []
    points = np.concatenate([segments[:1, 0, :2], segments[:, 1, :2]])
    moves = np.concatenate([[True], (points[1:] != points[:-1]).any(axis=1)])
    return _numbers(points[moves])


def _points(vertices: Vertices) -> list[float]:
    return _numbers(vertices[:, :2])


def _footprint(footprint: npt.NDArray[np.float64]) -> list[float]:
    return _numbers(outline(footprint), digits=3)


def _goal(mark: GoalMark) -> FlatGoal:
    return FlatGoal(x=mark.x, y=mark.y, yaw=mark.yaw)


def _hindrance(mark: HindranceMark) -> FlatPoint:
    return FlatPoint(x=mark.x, y=mark.y)


def _extra(shape: Shape) -> FlatExtra:
    step = max(1, -(-len(shape.points) // _MOST_POINTS))
    return FlatExtra(
        points=_numbers(shape.points[::step, :2]),
        lines=_numbers(shape.segments[:_MOST_LINES, :, :2]),
        areas=_numbers(shape.areas[:, :, :2]),
        texts=[FlatText(x=each.at[0], y=each.at[1], text=each.text) for each in shape.labels],
    )


def _numbers(points: npt.NDArray[np.floating], digits: int = 2) -> list[float]:
    return np.asarray(points, np.float64).round(digits).ravel().tolist()


_IN_NUMBERS: dict[str, Callable[[Any], object]] = {
    "map": _map,
    "local_map": _local_map,
    "path": _line,
    "scan": _points,
    "trail": _line,
    "footprint": _footprint,
    "goal": _goal,
    "hindrance": _hindrance,
}
