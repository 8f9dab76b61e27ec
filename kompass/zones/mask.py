"""Masks: images of where the robot must not be, or is slower, as Nav2's costmap filters read them.

A mask is one of the recipe's, and stays what its files were when it was made, whatever becomes of
them: a program that is started again keeps to the same floor as all others. People draw zones.
"""

from __future__ import annotations

import math
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, PrivateAttr, model_validator
from scipy.ndimage import label

from kompass.algorithms.geometry import Floats
from kompass.algorithms.grid import OCCUPIED, Grid
from kompass.algorithms.map_file import MapFileError, load_mask
from kompass.rules.schema.model import Model
from kompass.settings import Settings
from kompass.zones.outline import outlines
from kompass.zones.zone import FASTEST, SLOWEST

MOST_CELLS = 25_000_000  # of a mask; 5,000 × 5,000
STEP = 0.05  # m/s between two speeds that are drawn apart
SPACING = 0.05  # m between two points of an edge at most
GENTLE = 0.5  # share of the braking that the robot can do, before what slows it

Kind = Literal["keep_out", "speed_percent", "speed"]
_NAV2: dict[object, Kind] = {0: "keep_out", 1: "speed_percent", 2: "speed"}


def _kind(given: object) -> object:
    """Nav2's number of a kind of filter is taken, too."""
    # True is the number 1, but says nothing of a kind.
    is_number = isinstance(given, int) and not isinstance(given, bool)
    return _NAV2.get(given, given) if is_number else given


class Mask(Settings):
    """An image that lies on the map: a YAML file with a PGM or PNG, as for a map.

    Raises
    ------
    ValueError
        When the file cannot be read, or says what cannot be done.
    """

    file: str = Field(min_length=1, description="the YAML file")
    kind: Annotated[Kind, BeforeValidator(_kind)] = Field(
        default="keep_out",
        description="what it is: cells of 100 are kept out of; or `base + multiplier · cell` is "
        "the most speed there, in m/s or in % of the robot's; Nav2's 0, 2 and 1 are taken, too",
    )
    base: float = Field(default=0.0, ge=-1e4, le=1e4, description="of speeds")
    multiplier: float = Field(default=1.0, ge=-1e4, le=1e4, description="of speeds")
    name: str = Field(default="", max_length=60, description="for people; the file's unless given")
    _grid: Grid | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _is_readable(self) -> Self:
        if self.kind == "keep_out" and (self.base, self.multiplier) != (0.0, 1.0):
            raise ValueError(
                f"base = {self.base:g}, multiplier = {self.multiplier:g} are of speeds; leave them "
                "out of a keep-out mask"
            )
        self._grid = self._read()
        self.in_force(FASTEST)
        return self

    @property
    def title(self) -> str:
        """Its name, for people."""
        return self.name or Path(self.file).stem

    def in_force(self, top_speed: float) -> MaskInForce:
        """What it forbids a robot of a top speed [m/s]; raises as the making of a mask."""
        grid = self._grid
        assert grid is not None
        if self.kind == "keep_out":
            return MaskInForce(self.title, grid, _barred(self.file, grid))
        speeds = self._speeds(grid, top_speed)
        return MaskInForce(self.title, grid, np.isfinite(speeds), speeds, top_speed)

    def _read(self) -> Grid:
        path = Path(self.file).expanduser().absolute()
        try:
            grid = _read(path, path.stat().st_mtime_ns)
        except OSError as error:
            raise ValueError(f"file = {self.file!r} cannot be read: {error.strerror}") from None
        except MapFileError as error:
            raise ValueError(f"file = {self.file!r}: {error}") from None
        if grid.cells.size > MOST_CELLS:
            raise ValueError(
                f"file = {self.file!r} has {grid.cells.size} cells; at most {MOST_CELLS} are read"
            )
        return grid

    def _speeds(self, grid: Grid, top_speed: float) -> Floats:
        """The most speed in each cell (H, W) [m/s]; infinite where nothing is said."""
        said = grid.cells > 0
        values = self.base + self.multiplier * grid.cells[said].astype(np.float64)
        if self.kind == "speed_percent":
            bad = ~((values > 0.0) & (values <= 100.0))
            unit, bounds = "%", "more than 0 and at most 100 %"
            speeds = np.maximum(values / 100.0 * top_speed, SLOWEST)
        else:
            bad = ~((values >= SLOWEST) & (values <= FASTEST))
            unit, bounds, speeds = "m/s", f"from {SLOWEST:g} to {FASTEST:g} m/s", values
        if bad.any():
            row, col = (int(n) for n in np.argwhere(said)[int(np.argmax(bad))])
            raise ValueError(
                f"file = {self.file!r}: the cell in column {col}, row {row} from below comes to "
                f"{values[int(np.argmax(bad))]:g} {unit}; speeds are {bounds}: change base, "
                "multiplier or the image"
            )
        found = np.full(grid.cells.shape, math.inf)
        found[said] = speeds
        return found


@lru_cache(maxsize=16)
def _read(path: Path, _changed: int) -> Grid:
    return load_mask(path)


def _barred(file: str, grid: Grid) -> NDArray[np.bool_]:
    between = (grid.cells > 0) & (grid.cells < OCCUPIED)
    if between.any():
        row, col = (int(n) for n in np.argwhere(between)[0])
        raise ValueError(
            f"file = {file!r}: the cell in column {col}, row {row} from below has the value "
            f"{grid.cells[row, col]}; a keep-out mask is of 0 and 100 only, for no way is made "
            "dearer than another here: draw it in black and white, or give it 'mode: trinary'"
        )
    return np.asarray(grid.cells == OCCUPIED)


class MaskMark(Model):
    """A patch of a mask, for who draws it.

    Attributes
    ----------
    speed
        The most there (m/s); None where it is kept out of.
    corners
        Of a polygon in the map's frame (m), as of :func:`kompass.zones.outline.outlines`.
    """

    name: str
    speed: float | None
    corners: tuple[tuple[float, float], ...]


class MasksNow(Model):
    """The masks that are in force, as patches."""

    masks: tuple[MaskMark, ...] = ()


class MaskInForce:
    """What a mask forbids.

    Parameters
    ----------
    name
        For people.
    grid
        Where it lies.
    cells
        Which of its cells (H, W) say something: where no part of the robot enters, or is slower.
    speeds
        The most speed in each cell (H, W) [m/s]; None of a keep-out mask.
    top_speed
        Of the robot [m/s]; limits beyond it do not matter.
    """

    def __init__(
        self,
        name: str,
        grid: Grid,
        cells: NDArray[np.bool_],
        speeds: Floats | None = None,
        top_speed: float = FASTEST,
    ) -> None:
        self.name, self.grid, self.cells = name, grid, cells
        self.kind: Literal["keep_out", "speed"] = "keep_out" if speeds is None else "speed"
        self._speeds, self._top_speed = speeds, top_speed
        self._covered: tuple[tuple[Any, ...], NDArray[np.bool_]] | None = None

    def inside(self, x: float, y: float) -> bool:
        """Whether a point of the world is in one of its cells."""
        col, row = (int(n) for n in self.grid.world_to_cell([(x, y)])[0])
        on = 0 <= col < self.grid.width and 0 <= row < self.grid.height
        return on and bool(self.cells[row, col])

    def distance(self, x: float, y: float, reach: float) -> float:
        """From a point to the nearest of its cells [m]; 0 inside, infinite beyond ``reach``."""
        if self.inside(x, y):
            return 0.0
        _, _, away = self._near(x, y, reach, self.cells)
        return float(away.min()) if len(away) else math.inf

    def edges(self, x: float, y: float, reach: float) -> Floats:
        """Points (N, 2) of the world on the edges of its cells, up to ``reach`` [m] away.

        A patch of cells that the robot's middle is in has none: what is left then is to leave it.
        """
        cells = self._edge
        if self.inside(x, y):
            col, row = (int(n) for n in self.grid.world_to_cell([(x, y)])[0])
            cells = cells & (self._patches != self._patches[row, col])
        rows, cols, _ = self._near(x, y, reach, cells)
        size = self.grid.resolution
        parts = np.linspace(0.0, size, math.ceil(size / SPACING) + 1)
        sides = np.concatenate(
            [
                *(np.column_stack([parts, np.full(len(parts), at)]) for at in (0.0, size)),
                *(np.column_stack([np.full(len(parts), at), parts]) for at in (0.0, size)),
            ]
        )
        corners = np.column_stack([cols, rows]) * size
        points = (corners[:, None, :] + sides[None]).reshape(-1, 2)
        # In units of cells, whose middles are half a cell further.
        world = self.grid.cell_to_world(points / size - 0.5)
        return world[np.hypot(world[:, 0] - x, world[:, 1] - y) <= reach]

    def limit(self, x: float, y: float, radius: float, decel: float) -> float:
        """The most speed [m/s] with which the robot is slow enough where its body comes in.

        Parameters
        ----------
        radius
            Of the circle around its body [m].
        decel
            How it brakes at most [m/s²].
        """
        assert self._speeds is not None
        gentle = 2.0 * GENTLE * decel
        rows, cols, away = self._near(x, y, radius + self._top_speed**2 / gentle, self.cells)
        if not len(away):
            return math.inf
        room = np.maximum(0.0, away - radius)
        return float(np.sqrt(self._speeds[rows, cols] ** 2 + gentle * room).min())

    def lies_on(self, grid: Grid) -> bool:
        """Whether it has a place in common with a map."""
        middles = np.indices((9, 9)).reshape(2, -1).T / 8.0
        return any(
            bool(
                there.contains(here.cell_to_world(middles * (here.width, here.height) - 0.5)).any()
            )
            for here, there in ((self.grid, grid), (grid, self.grid))
        )

    def covered(self, grid: Grid) -> NDArray[np.bool_]:
        """Which cells (H, W) of another grid it covers or touches."""
        geometry = (grid.cells.shape, grid.resolution, grid.origin)
        if self._covered is None or self._covered[0] != geometry:
            self._covered = geometry, self._cover(grid)
        return self._covered[1]

    def _cover(self, grid: Grid) -> NDArray[np.bool_]:
        here = self.grid
        same = (here.resolution, here.origin) == (grid.resolution, grid.origin)
        found = np.zeros(grid.cells.shape, dtype=bool)
        if same:
            height = min(len(found), len(self.cells))
            width = min(grid.width, here.width)
            found[:height, :width] = self.cells[:height, :width]
            return found
        # What has its middle in a cell of the mask, which may have millions of them.
        rows, cols = np.indices(found.shape).reshape(2, -1)
        at = here.world_to_cell(grid.cell_to_world(np.column_stack([cols, rows])))
        known = ((at >= 0) & (at < (here.width, here.height))).all(axis=1)
        found[rows[known], cols[known]] = self.cells[at[known, 1], at[known, 0]]
        # And what an edge leads through: so many points of it that no cell is passed over.
        parts = np.linspace(-0.5, 0.5, math.ceil(2.0 * here.resolution / grid.resolution) + 1)
        rows, cols = np.nonzero(self._edge)
        for right in parts:
            for up in parts:
                points = here.cell_to_world(np.column_stack([cols + right, rows + up]))
                on = grid.world_to_cell(points[grid.contains(points)])
                found[on[:, 1], on[:, 0]] = True
        return found

    def marks(self) -> list[MaskMark]:
        """Its patches; those of speeds in steps, each told as the slowest in it."""
        if self._speeds is None:
            return self._marks(self.cells, None)
        steps = np.floor(self._speeds[self.cells] / STEP)
        found = np.full(self.cells.shape, -1.0)
        found[self.cells] = steps
        return [
            mark
            for step in np.unique(steps)
            for mark in self._marks(
                found == step, round(float(self._speeds[found == step].min()), 3)
            )
        ]

    def _marks(self, cells: NDArray[np.bool_], speed: float | None) -> list[MaskMark]:
        made = []
        for polygon in outlines(cells):
            corners = np.round(self.grid.cell_to_world(polygon - 0.5), 3).tolist()
            made.append(
                MaskMark(name=self.name, speed=speed, corners=tuple((x, y) for x, y in corners))
            )
        return made

    def _near(
        self, x: float, y: float, reach: float, of: NDArray[np.bool_]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats]:
        """Rows, columns and distances (N,) [m] of some cells up to ``reach`` [m] from a point."""
        size = self.grid.resolution
        at = self.grid.to_grid_frame([(x, y)])[0]
        low = np.clip(np.floor((at - reach) / size).astype(int), 0, None)
        high = np.floor((at + reach) / size).astype(int) + 1
        rows, cols = np.nonzero(of[low[1] : max(high[1], 0), low[0] : max(high[0], 0)])
        rows, cols = rows + low[1], cols + low[0]
        away = np.hypot(
            np.maximum(np.abs((cols + 0.5) * size - at[0]) - size / 2.0, 0.0),
            np.maximum(np.abs((rows + 0.5) * size - at[1]) - size / 2.0, 0.0),
        )
        near = away <= reach
        return rows[near], cols[near], away[near]

    @cached_property
    def _edge(self) -> NDArray[np.bool_]:
        """Cells (H, W) next to one that is none of its."""
        around = np.pad(self.cells, 1)
        within = around[:-2, 1:-1] & around[2:, 1:-1] & around[1:-1, :-2] & around[1:-1, 2:]
        return np.asarray(self.cells & ~within)

    @cached_property
    def _patches(self) -> NDArray[np.int32]:
        """Number of the patch that each cell (H, W) is in; corners connect."""
        return np.asarray(label(self.cells, structure=np.ones((3, 3)))[0], dtype=np.int32)
