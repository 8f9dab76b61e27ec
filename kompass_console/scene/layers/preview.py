"""What is being considered, on the page that considers it: a goal and its way, or a place of the
robot and the scan as it would lie then."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
import viser

from kompass_console.scene.layers.goal import GoalNodes
from kompass_console.scene.layers.map import WALL_HEIGHT
from kompass_console.scene.layers.palette import palette
from kompass_console.scene.layers.path import PathNodes, path_segments
from kompass_console.scene.layers.scan import ScanNodes
from kompass_console.scene.layers.shapes import Vertices, open_segments
from kompass_console.schema.models import Theme
from kompass_console.schema.world import GoalMark

_POINT = 0.025  # m; larger than those of the scan itself, which lie about it
_CROSS = 0.13  # m from its middle, in both directions
# Above the walls: a goal is refused inside of one more often than anywhere else.
_CROSS_HEIGHT = WALL_HEIGHT + 0.02


@dataclass(frozen=True, slots=True)
class Preview:
    """A goal or place, the path (N, 2) to it and the scan (N, 3) from it in the map frame, m;
    both are empty when there is none.

    `refused` is the place that was asked for, where the robot cannot be; the goal is the nearest
    one then, if there is any.
    """

    mark: GoalMark | None
    path: npt.NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    scan: Vertices = field(default_factory=lambda: np.zeros((0, 3), np.float32))
    refused: tuple[float, float] | None = None


class PreviewNodes:
    """The preview on one page."""

    def __init__(self, scene: viser.SceneApi, parent: str, theme: Theme) -> None:
        colours = palette(theme)
        colour = colours.preview
        self._path = PathNodes(scene, f"{parent}/preview_path", colour, thickness=3.0)
        self._goal = GoalNodes(scene, f"{parent}/preview_goal", colour)
        self._refused = scene.add_line_segments(
            f"{parent}/preview_refused",
            _cross(),
            colours.alert,
            thickness=5.0,
            thickness_units="screen",
            visible=False,
        )
        self._scan = ScanNodes(scene, f"{parent}/preview_scan", colour, _POINT)

    def draw(self, preview: Preview | None) -> None:
        self._goal.draw(None if preview is None else preview.mark)
        self._path.draw(path_segments(np.zeros((0, 2)) if preview is None else preview.path))
        seen = preview is not None and len(preview.scan) > 0
        self._scan.show(seen)
        if preview is not None and seen:
            self._scan.draw(preview.scan)
        refused = None if preview is None else preview.refused
        if refused is not None:
            self._refused.position = (*refused, 0.0)
        self._refused.visible = refused is not None


def _cross() -> Vertices:
    """Two lines that cross in the origin: what the ring of a goal cannot be taken for."""
    diagonal = np.array([[-_CROSS, -_CROSS], [_CROSS, _CROSS]])
    lines = [open_segments(line, _CROSS_HEIGHT) for line in (diagonal, diagonal * [1.0, -1.0])]
    return np.concatenate(lines)
