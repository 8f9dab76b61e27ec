"""A goal that is being considered, on the page that considers it: where, and by which way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import viser

from kompass_console.scene.layers.goal import GoalNodes
from kompass_console.scene.layers.palette import palette
from kompass_console.scene.layers.path import PathNodes, path_segments
from kompass_console.schema.models import Theme
from kompass_console.schema.world import GoalMark


@dataclass(frozen=True, slots=True)
class Preview:
    """A goal and the path (N, 2) to it in the map frame, m; the path is empty when there is
    none."""

    mark: GoalMark
    path: npt.NDArray[np.float64]


class PreviewNodes:
    """The preview on one page."""

    def __init__(self, scene: viser.SceneApi, parent: str, theme: Theme) -> None:
        colour = palette(theme).preview
        self._path = PathNodes(scene, f"{parent}/preview_path", colour, thickness=3.0)
        self._goal = GoalNodes(scene, f"{parent}/preview_goal", colour)

    def draw(self, preview: Preview | None) -> None:
        self._goal.draw(None if preview is None else preview.mark)
        self._path.draw(path_segments(np.zeros((0, 2)) if preview is None else preview.path))
