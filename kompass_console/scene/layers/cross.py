"""A cross above the floor: where the robot cannot be, or what is in its way."""

from __future__ import annotations

import numpy as np
import viser

from kompass_console.scene.layers.map import WALL_HEIGHT
from kompass_console.scene.layers.palette import Rgb
from kompass_console.scene.layers.shapes import Vertices, open_segments

_REACH = 0.13  # m from its middle, in both directions
# Above the walls: a goal is refused inside of one more often than anywhere else.
_HEIGHT = WALL_HEIGHT + 0.02


class CrossNodes:
    """A cross on one page."""

    def __init__(self, scene: viser.SceneApi, name: str, colour: Rgb) -> None:
        self._visible, self._is_placed = True, False
        self._lines = scene.add_line_segments(
            name, _cross(), colour, thickness=5.0, thickness_units="screen", visible=False
        )

    def draw(self, place: tuple[float, float] | None) -> None:
        """Put it on a place (x, y), m, or take it away."""
        self._is_placed = place is not None
        if place is not None:
            self._lines.position = (*place, 0.0)
        self._lines.visible = self._visible and self._is_placed

    def show(self, visible: bool) -> None:
        self._visible = visible
        self._lines.visible = visible and self._is_placed


def _cross() -> Vertices:
    """Two lines that cross in the origin: what the ring of a goal cannot be taken for."""
    diagonal = np.array([[-_REACH, -_REACH], [_REACH, _REACH]])
    lines = [open_segments(line, _HEIGHT) for line in (diagonal, diagonal * [1.0, -1.0])]
    return np.concatenate(lines)
