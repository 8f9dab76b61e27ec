"""What the robot sees around it right now: occupied cells as a translucent film over the map."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import viser

from kompass_console.scene.palette import Rgba, palette
from kompass_console.scene.png import encode_palette
from kompass_console.settings import Theme
from kompass_console.world import Grid, Pose

_LEVELS = 16  # steps of opacity; 4 bits per pixel
_HEIGHT = 0.012  # m above the map, so that the two never flicker through each other
_MAGNIFY = 4


@dataclass(frozen=True, slots=True)
class LocalMapDrawing:
    """Origin corner in the map frame, size in m, and the picture for both themes."""

    origin: Pose
    width: float
    height: float
    images: dict[Theme, bytes]


def convert(grid: Grid) -> LocalMapDrawing:
    """Drawing of a local occupancy grid; unknown and free cells are clear."""
    levels = np.clip(grid.cells, 0, 100).astype(np.uint16) * (_LEVELS - 1) // 100
    factor = max(1, min(_MAGNIFY, 1024 // max(levels.shape)))
    indices = levels.astype(np.uint8).repeat(factor, axis=0).repeat(factor, axis=1)
    themes: tuple[Theme, Theme] = ("light", "dark")
    images: dict[Theme, bytes] = {t: encode_palette(indices, _film(t)) for t in themes}
    width, height = grid.size
    return LocalMapDrawing(grid.origin, width, height, images)


def _film(theme: Theme) -> list[Rgba]:
    r, g, b, alpha = palette(theme).obstacle
    return [(r, g, b, alpha * level // (_LEVELS - 1)) for level in range(_LEVELS)]


class LocalMapNodes:
    """The local map on one page."""

    def __init__(self, scene: viser.SceneApi, parent: str, theme: Theme) -> None:
        self._theme = theme
        self._scene = scene
        self._frame = scene.add_frame(f"{parent}/local_map", show_axes=False)
        self._image: viser.ImageHandle | None = None

    def draw(self, drawing: LocalMapDrawing) -> None:
        half = drawing.origin.yaw / 2.0
        self._frame.position = (drawing.origin.x, drawing.origin.y, _HEIGHT)
        self._frame.wxyz = (math.cos(half), 0.0, 0.0, math.sin(half))
        if self._image is None:
            self._image = self._scene.add_image(
                f"{self._frame.name}/cells",
                np.zeros((1, 1, 4), np.uint8),
                drawing.width,
                drawing.height,
                format="png",
                cast_shadow=False,
                receive_shadow=False,
            )
        self._image.render_width, self._image.render_height = drawing.width, drawing.height
        self._image.position = (drawing.width / 2.0, drawing.height / 2.0, 0.0)
        self._image._data = drawing.images[self._theme]

    def show(self, visible: bool) -> None:
        self._frame.visible = visible
