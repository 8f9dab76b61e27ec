"""The planned path: one line in the accent colour."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import viser

from kompass_console.scene.layers.palette import Rgb
from kompass_console.scene.layers.shapes import Vertices, open_segments

_HEIGHT = 0.03  # m above the floor
_MOST_POINTS = 600  # a path is redrawn whole; more points than this cannot be told apart


def path_segments(points: npt.NDArray[np.float64]) -> Vertices:
    """Segments (N, 2, 3) of a path (M, 2); none when it has fewer than two points."""
    if len(points) < 2:
        return np.zeros((0, 2, 3), np.float32)
    if len(points) > _MOST_POINTS:
        points = points[np.linspace(0, len(points) - 1, _MOST_POINTS).astype(int)]
    return open_segments(points, _HEIGHT)


class PathNodes:
    """A path on one page; also used for the preview of a goal."""

    def __init__(
        self, scene: viser.SceneApi, name: str, colour: Rgb, *, thickness: float = 4.0
    ) -> None:
        self._scene = scene
        self._name = name
        self._colour = colour
        self._thickness = thickness
        self._visible = True
        self._line: viser.LineSegmentsHandle | None = None

    def draw(self, segments: Vertices) -> None:
        if len(segments) == 0:
            if self._line is not None:
                self._line.visible = False
                self._line.points = np.zeros((0, 2, 3), np.float32)
            return
        if self._line is None:
            self._line = self._scene.add_line_segments(
                self._name,
                segments,
                self._colour,
                thickness=self._thickness,
                thickness_units="screen",
            )
        self._line.points = segments
        self._line.visible = self._visible

    def show(self, visible: bool) -> None:
        self._visible = visible
        if self._line is not None:
            self._line.visible = visible and len(self._line.points) > 0
