"""What the robot sees around it right now: a translucent film over the occupied cells.

A mesh, not a picture: a translucent picture over the map's would be sorted against it by distance,
and hide it from half of all directions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import viser

from kompass.algorithms.grid import OCCUPIED_FROM, Grid
from kompass.algorithms.rectangles import rectangles
from kompass_console.scene.layers.cells import tops
from kompass_console.scene.layers.map import WALL_HEIGHT
from kompass_console.scene.layers.palette import palette
from kompass_console.scene.layers.shapes import Faces, Vertices, placed
from kompass_console.schema.models import Theme
from kompass_console.schema.world import Pose

_HEIGHT = WALL_HEIGHT + 0.006  # m; just above the walls, so that the two never flicker
_OPACITY = 0.6
_MOST_AREAS = 2000


@dataclass(frozen=True, slots=True)
class LocalMapDrawing:
    """The film in the map frame. Its place is in the vertices and not in the node's pose: a browser
    applies poses a frame or more before it has rebuilt a mesh, and the film would lag its place.

    `areas` (N, 4) are the same as (y0, x0, y1, x1) in m of a grid at `origin`.
    """

    vertices: Vertices
    faces: Faces
    origin: tuple[float, float, float]
    areas: npt.NDArray[np.floating]


def local_map_drawing(grid: Grid) -> LocalMapDrawing:
    """Drawing of a local occupancy grid."""
    areas = rectangles(grid.cells >= OCCUPIED_FROM)[:_MOST_AREAS] * grid.resolution
    vertices, faces = tops(areas, _HEIGHT)
    return LocalMapDrawing(placed(vertices, Pose(*grid.origin)), faces, grid.origin, areas)


class LocalMapNodes:
    """The local map on one page."""

    def __init__(self, scene: viser.SceneApi, parent: str, theme: Theme) -> None:
        self._visible = True
        # A mesh has to have something in it; this is out of sight until there is a local map.
        self._film = scene.add_mesh_simple(
            f"{parent}/local_map",
            np.zeros((3, 3), np.float32),
            np.array([[0, 1, 2]], np.uint32),
            color=palette(theme).obstacle,
            opacity=_OPACITY,
            flat_shading=True,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )

    def draw(self, drawing: LocalMapDrawing) -> None:
        if len(drawing.faces) == 0:
            self._film.visible = False
            return
        self._film.vertices = drawing.vertices
        self._film.faces = drawing.faces
        self._film.visible = self._visible

    def show(self, visible: bool) -> None:
        self._visible = visible
        self._film.visible = visible and len(self._film.faces) > 1
