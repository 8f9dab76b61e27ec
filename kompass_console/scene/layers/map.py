"""The map: quiet floor tiles, and low walls where it is occupied."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import viser
from PIL import Image

from kompass.algorithms.geometry import transform_points
from kompass.algorithms.grid import OCCUPIED_FROM, Grid
from kompass.algorithms.rectangles import rectangles
from kompass_console.scene.layers.palette import palette
from kompass_console.schema.models import Theme

_UNKNOWN, _HATCH, _FREE, _OCCUPIED = 0, 1, 2, 3

_TILE = 1024  # px; the smallest texture limit still met on tablets is 4096
_SHARP = 2048  # px; small maps are magnified up to this, or their cells blur into each other
_LONGEST = 16_383  # px of a side of a WebP
_HATCH_PITCH = 12  # px between the hatching lines of unknown space

WALL_HEIGHT = 0.08  # m; low, so that a point on a wall's top is near the point on the floor
_MOST_WALLS = 30_000  # boxes; a map with more keeps its floor only

_Bytes = npt.NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Tile:
    """A piece of the floor: centre (x, y) in the grid's frame and size, m; classes (h, w)."""

    x: float
    y: float
    width: float
    height: float
    classes: _Bytes


@dataclass(frozen=True, slots=True)
class MapDrawing:
    """A map ready to be drawn. `bounds` (x0, y0, x1, y1) holds what is known, in the map frame.

    `classes` (rows, columns) has every cell once, and `version` tells one map from the next.
    `walls` (N, 4) cover the occupied cells as (row, column, end row, end column); those of one size
    stand together, south before north: what is alike is near, and packs well on its way to a page.
    """

    version: int
    origin: tuple[float, float, float]
    resolution: float
    classes: _Bytes
    tiles: tuple[Tile, ...]
    walls: npt.NDArray[np.int64]
    bounds: tuple[float, float, float, float]
    images: dict[Theme, tuple[bytes, ...]]


def map_drawing(grid: Grid, version: int = 0) -> MapDrawing:
    """Drawing of a map, its tiles encoded for both themes."""
    classes = classify(grid.cells)
    height, width = classes.shape
    factor = max(1, min(8, _SHARP // max(height, width)))
    tiles = []
    step = max(1, _TILE // factor)
    for row in range(0, height, step):
        for column in range(0, width, step):
            part = classes[row : row + step, column : column + step]
            h, w = part.shape
            magnified = part.repeat(factor, axis=0).repeat(factor, axis=1)
            tiles.append(
                Tile(
                    x=(column + w / 2.0) * grid.resolution,
                    y=(row + h / 2.0) * grid.resolution,
                    width=w * grid.resolution,
                    height=h * grid.resolution,
                    classes=_hatched(magnified, row * factor, column * factor),
                )
            )
    walls = _walls(classes == _OCCUPIED)
    if len(walls) > _MOST_WALLS:
        walls = walls[:0]
    images = {theme: tuple(_encoded(t.classes, theme) for t in tiles) for theme in _THEMES}
    return MapDrawing(
        version,
        grid.origin,
        grid.resolution,
        classes,
        tuple(tiles),
        walls,
        known_bounds(grid, classes),
        images,
    )


_THEMES: tuple[Theme, Theme] = ("light", "dark")


def classify(cells: npt.NDArray[np.int8]) -> _Bytes:
    """Class of every cell: unknown, free or occupied (what is in between counts as free)."""
    classes = np.full(cells.shape, _FREE, dtype=np.uint8)
    classes[cells < 0] = _UNKNOWN
    classes[cells >= OCCUPIED_FROM] = _OCCUPIED
    return classes


def _walls(occupied: npt.NDArray[np.bool_]) -> npt.NDArray[np.int64]:
    """See `MapDrawing.walls`. Along the rows or along the columns, whichever has fewer."""
    along_rows = np.count_nonzero(occupied[:, 1:] != occupied[:, :-1])
    along_columns = np.count_nonzero(occupied[1:] != occupied[:-1])
    if along_rows <= along_columns:
        walls = rectangles(occupied)
    else:
        walls = rectangles(occupied.T)[:, [1, 0, 3, 2]]
    row, column, end_row, end_column = walls.T
    return walls[np.lexsort((column, row, end_row - row, end_column - column))]


def known_bounds(grid: Grid, classes: _Bytes) -> tuple[float, float, float, float]:
    """Box (x0, y0, x1, y1) in the map frame around the known cells (the whole grid if none)."""
    known = classes != _UNKNOWN
    rows, columns = np.nonzero(known.any(axis=1))[0], np.nonzero(known.any(axis=0))[0]
    height, width = classes.shape
    r0, r1 = (int(rows[0]), int(rows[-1]) + 1) if rows.size else (0, height)
    c0, c1 = (int(columns[0]), int(columns[-1]) + 1) if columns.size else (0, width)
    corners = np.array([(column, row) for row in (r0, r1) for column in (c0, c1)], np.float64)
    seen = transform_points(grid.origin, corners * grid.resolution)
    (x0, y0), (x1, y1) = seen.min(axis=0), seen.max(axis=0)
    return float(x0), float(y0), float(x1), float(y1)


def _hatched(classes: _Bytes, row: int, column: int) -> _Bytes:
    """Unknown space gets thin diagonal lines that run on across tiles."""
    rows = np.arange(row, row + classes.shape[0])[:, None]
    columns = np.arange(column, column + classes.shape[1])[None, :]
    lines = (rows + columns) % _HATCH_PITCH < 1
    return np.where(lines & (classes == _UNKNOWN), np.uint8(_HATCH), classes)


def whole_picture(drawing: MapDrawing, theme: Theme) -> bytes:
    """WebP, or PNG of a very long map, in one piece, a pixel for each cell, north up."""
    return _encoded(drawing.classes[::-1], theme)


def _encoded(classes: _Bytes, theme: Theme) -> bytes:
    """WebP, without loss, of the few colours of a theme: at the size of a building two thirds of
    the best PNG's bytes in half of its time."""
    colours = palette(theme)
    colour = np.array(
        [colours.unknown, colours.unknown_line, colours.free, colours.occupied], np.uint8
    )
    encoded = io.BytesIO()
    picture = Image.fromarray(colour[classes])
    if max(classes.shape) > _LONGEST:
        picture.save(encoded, "PNG")
    else:
        picture.save(encoded, "WEBP", lossless=True, method=4, quality=60)
    return encoded.getvalue()


# A box of 1 m without a bottom, standing on the floor. Its faces share their corners, for shading
# is flat: a weak tablet's time goes by corners.
_CORNERS = np.array(
    [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], np.float32
)
_FACES = np.array(
    [(4, 5, 6), (4, 6, 7)]
    + [f for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)) for f in ((a, b, b + 4), (a, b + 4, a + 4))],
    np.uint32,
)


def _linear(colour: tuple[int, int, int]) -> tuple[int, int, int]:
    """The shares of light that an sRGB colour stands for (IEC 61966-2-1), of 255: viser takes the
    colours of meshes as sRGB, and those of batched ones as light."""
    share = np.array(colour) / 255.0
    light = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    red, green, blue = np.rint(light * 255.0).astype(int).tolist()
    return red, green, blue


class MapNodes:
    """The map on one page."""

    def __init__(self, scene: viser.SceneApi, parent: str, theme: Theme) -> None:
        self._scene = scene
        self._theme = theme
        self._root = f"{parent}/map"
        self._frame = scene.add_frame(self._root, show_axes=False)
        self._tiles: list[viser.ImageHandle] = []
        self._walls: viser.BatchedMeshHandle | None = None

    def draw(self, drawing: MapDrawing) -> None:
        x, y, yaw = drawing.origin
        self._frame.position = (x, y, 0.0)
        half = yaw / 2.0
        self._frame.wxyz = (math.cos(half), 0.0, 0.0, math.sin(half))
        for surplus in self._tiles[len(drawing.tiles) :]:
            surplus.remove()
        del self._tiles[len(drawing.tiles) :]
        images = drawing.images[self._theme]
        for i, (tile, image) in enumerate(zip(drawing.tiles, images, strict=True)):
            if i == len(self._tiles):
                self._tiles.append(
                    self._scene.add_image(
                        f"{self._root}/tile{i}",
                        np.zeros((1, 1, 4), np.uint8),
                        tile.width,
                        tile.height,
                        format="png",
                        cast_shadow=False,
                        receive_shadow=False,
                    )
                )
            handle = self._tiles[i]
            handle.render_width, handle.render_height = tile.width, tile.height
            handle.position = (tile.x, tile.y, 0.0)
            handle._data = image
        self._draw_walls(drawing)

    def _draw_walls(self, drawing: MapDrawing) -> None:
        walls = drawing.walls
        if len(walls) == 0:
            if self._walls is not None:
                self._walls.remove()
                self._walls = None
            return
        # In cells: whole numbers have few digits, and the node's scale makes metres of them.
        row, column, end_row, end_column = walls.T
        corners = np.stack([column, row, np.zeros_like(row)], axis=1)
        sizes = np.stack([end_column - column, end_row - row, np.ones_like(row)], axis=1)
        upright = np.tile([1.0, 0.0, 0.0, 0.0], (len(walls), 1))
        # One for each: a browser gives a colour that all share to the boxes of the first map only.
        colours = np.tile(np.array(_linear(palette(self._theme).wall), np.uint8), (len(walls), 1))
        scale = (drawing.resolution, drawing.resolution, WALL_HEIGHT)
        if self._walls is None:
            self._walls = self._scene.add_batched_meshes_simple(
                f"{self._root}/walls",
                _CORNERS,
                _FACES,
                batched_wxyzs=upright,
                batched_positions=corners,
                batched_scales=sizes,
                batched_colors=colours,
                scale=scale,
                lod="off",
                flat_shading=True,
                cast_shadow=False,
                receive_shadow=False,
            )
            return
        # A node that is made anew is missing from a few frames; one that is changed is not.
        self._walls.batched_wxyzs = upright
        self._walls.batched_positions = corners
        self._walls.batched_scales = sizes
        self._walls.batched_colors = colours
        self._walls.scale = scale

    def show(self, visible: bool) -> None:
        self._frame.visible = visible
