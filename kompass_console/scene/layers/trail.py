"""Where the robot has been: a line that fades into the floor."""

from __future__ import annotations

import math
from collections import deque

import numpy as np
import numpy.typing as npt
import viser

from kompass_console.scene.layers.palette import palette
from kompass_console.scene.layers.shapes import Vertices, open_segments
from kompass_console.schema.models import Theme
from kompass_console.schema.world import Pose

_STEP = 0.05  # m between two points
_LENGTH = 240  # points: the last 12 m
# Further than so many metres, and so many in each second, from one pose to the next is no drive: it
# was told, or has found, that it is elsewhere.
_JUMP = 0.2
_FASTEST = 3.0
_HEIGHT = 0.008


class Trail:
    """The points (x, y) of the last metres driven."""

    def __init__(self) -> None:
        self._points: deque[tuple[float, float]] = deque(maxlen=_LENGTH)
        self._seen: tuple[Pose, float] | None = None

    def add(self, pose: Pose, at: float) -> bool:
        """Add a pose that was heard at a time [s]; True when the trail has changed."""
        before, self._seen = self._seen, (pose, at)
        if before is not None and _between(before[0], pose) > _JUMP + _FASTEST * (at - before[1]):
            self._points.clear()
        elif self._points and math.dist(self._points[-1], (pose.x, pose.y)) < _STEP:
            return False
        self._points.append((pose.x, pose.y))
        return True

    def segments(self) -> Vertices:
        """Segments (_LENGTH - 1, 2, 3), oldest first; a shorter trail begins with empty ones, so
        that its colours never have to change."""
        if len(self._points) < 2:
            return np.zeros((0, 2, 3), np.float32)
        points = np.array(self._points)
        padding = np.repeat(points[:1], _LENGTH - len(points), axis=0)
        return open_segments(np.concatenate([padding, points]), _HEIGHT)


def _between(one: Pose, other: Pose) -> float:
    return math.hypot(one.x - other.x, one.y - other.y)


def fading(theme: Theme) -> npt.NDArray[np.uint8]:
    """Colours (_LENGTH - 1, 2, 3) of a trail's segments: from the floor's to the trail's own."""
    colours = palette(theme)
    floor, trail = np.array(colours.free[:3], float), np.array(colours.trail, float)
    share = np.linspace(0.0, 1.0, _LENGTH)[:, None]
    blend = floor + share * (trail - floor)
    # viser takes colours per vertex as linear light, and uniform ones as sRGB.
    light = 255.0 * (blend / 255.0) ** 2.2
    return np.stack([light[:-1], light[1:]], axis=1).astype(np.uint8)


class TrailNodes:
    """The trail on one page."""

    def __init__(self, scene: viser.SceneApi, parent: str, theme: Theme) -> None:
        self._scene = scene
        self._name = f"{parent}/trail"
        self._theme = theme
        self._visible = True
        self._line: viser.LineSegmentsHandle | None = None

    def draw(self, segments: Vertices) -> None:
        if len(segments) == 0:
            return
        if self._line is None:
            self._line = self._scene.add_line_segments(
                self._name,
                segments,
                fading(self._theme),
                thickness=3.0,
                thickness_units="screen",
                visible=self._visible,
            )
        self._line.points = segments

    def show(self, visible: bool) -> None:
        self._visible = visible
        if self._line is not None:
            self._line.visible = visible
