"""What is being considered, on the page that considers it: a goal and its way, or a place of the
robot and the scan as it would lie then."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
import viser

from kompass_console.scene.layers.cross import CrossNodes
from kompass_console.scene.layers.goal import GoalNodes
from kompass_console.scene.layers.palette import palette
from kompass_console.scene.layers.path import PathNodes, path_segments
from kompass_console.scene.layers.scan import ScanNodes
from kompass_console.scene.layers.shapes import Vertices
from kompass_console.schema.models import Theme
from kompass_console.schema.world import GoalMark

_POINT = 0.025  # m; larger than those of the scan itself, which lie about it


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
        self._refused = CrossNodes(scene, f"{parent}/preview_refused", colours.alert)
        self._scan = ScanNodes(scene, f"{parent}/preview_scan", colour, _POINT)

    def draw(self, preview: Preview | None) -> None:
        self._goal.draw(None if preview is None else preview.mark)
        self._path.draw(path_segments(np.zeros((0, 2)) if preview is None else preview.path))
        seen = preview is not None and len(preview.scan) > 0
        self._scan.show(seen)
        if preview is not None and seen:
            self._scan.draw(preview.scan)
        self._refused.draw(None if preview is None else preview.refused)
