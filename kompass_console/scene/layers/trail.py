"""Where the robot has been: a line that fades into the floor."""

from __future__ import annotations

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
_JUMP = 1.0  # m; further than this in one step is a relocalisation, not a drive
_HEIGHT = 0.008


class Trail:
    """The points (x, y) of the last metres driven."""

    def __init__(self) -> None:
        self._points: deque[tuple[float, float]] = deque(maxlen=_LENGTH)

    def add(self, pose: Pose) -> bool:
        """Add a pose; True when the trail has changed."""
        if self._points:
            last_x, last_y = self._points[-1]
            moved = float(np.hypot(pose.x - last_x, pose.y - last_y))
            if moved < _STEP:
                return False
            if moved > _JUMP:
                self._points.clear()
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
