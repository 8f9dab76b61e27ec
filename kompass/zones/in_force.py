"""What the zones of a map forbid: where no way leads, what is in the way, and how fast it goes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.geometry import Floats
from kompass.algorithms.grid import OCCUPIED, Grid
from kompass.zones.mask import GENTLE, SPACING, MaskInForce
from kompass.zones.zone import Zone

CREEP = 0.2  # m/s, inside a keep-out zone: somebody gets the robot out of it


class Outlines:
    """The outlines of several zones, looked at together: a robot asks many times a second.

    Parameters
    ----------
    polygons
        Corners (N, 2) of each, in the map's frame [m].
    """

    def __init__(self, polygons: Sequence[ArrayLike]) -> None:
        corners = [np.asarray(each, dtype=np.float64).reshape(-1, 2) for each in polygons]
        self._from = np.concatenate([*corners, np.empty((0, 2))])
        self._to = np.concatenate(
            [*(np.roll(each, -1, axis=0) for each in corners), np.empty((0, 2))]
        )
        self._first = np.cumsum([0, *(len(each) for each in corners)])[:-1]
        self._of = np.repeat(np.arange(len(corners)), [len(each) for each in corners])

    def __len__(self) -> int:
        return len(self._first)

    def inside(self, x: float, y: float) -> NDArray[np.bool_]:
        """Which polygons (P,) a point is in, by how often a ray to the right meets an edge."""
        (x0, y0), (x1, y1) = self._from.T, self._to.T
        meets = (y < y0) != (y < y1)
        with np.errstate(divide="ignore", invalid="ignore"):
            meets &= x < x0 + (y - y0) / (y1 - y0) * (x1 - x0)
        return np.asarray(np.bincount(self._of[meets], minlength=len(self)) % 2 == 1)

    def distance(self, x: float, y: float) -> Floats:
        """From a point to each polygon (P,) [m]; 0 inside."""
        if not len(self):
            return np.empty(0)
        along = self._to - self._from
        at = (((x, y) - self._from) * along).sum(axis=1) / (along**2).sum(axis=1)
        nearest = self._from + np.clip(at, 0.0, 1.0)[:, None] * along
        away = np.minimum.reduceat(np.hypot(*(nearest - (x, y)).T), self._first)
        return np.where(self.inside(x, y), 0.0, away)

    def near(self, x: float, y: float, reach: float, of: NDArray[np.bool_]) -> Floats:
        """Points (N, 2) on the edges of some of the polygons (P,), up to ``reach`` [m] away.

        From one to the next it is at most ``SPACING``.
        """
        mine = of[self._of]
        start, along = self._from[mine], self._to[mine] - self._from[mine]
        length = np.hypot(*along.T)
        unit = along / length[:, None]
        middle = (((x, y) - start) * unit).sum(axis=1)
        aside = np.hypot(*(start + middle[:, None] * unit - (x, y)).T)
        half = np.sqrt(np.maximum(0.0, reach**2 - aside**2))
        low, high = np.maximum(0.0, middle - half), np.minimum(length, middle + half)
        made = [
            begin + np.linspace(a, b, math.ceil((b - a) / SPACING) + 1)[:, None] * way
            for begin, way, a, b, off in zip(start, unit, low, high, aside, strict=True)
            if off <= reach and a <= b
        ]
        return np.concatenate(made) if made else np.empty((0, 2))


def covered(polygon: ArrayLike, grid: Grid) -> NDArray[np.bool_]:
    """Which cells (H, W) of a grid a polygon (N, 2) covers or touches."""
    corners = np.asarray(polygon, dtype=np.float64).reshape(-1, 2)
    cells = np.zeros(grid.cells.shape, dtype=bool)
    box = grid.world_to_cell(corners)  # the grid's frame turns, and keeps straight lines
    low = np.maximum(box.min(axis=0), 0)
    high = np.minimum(box.max(axis=0) + 1, (grid.width, grid.height))
    if (low >= high).any():
        return cells
    cols, rows = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
    middles = grid.cell_to_world(np.column_stack([cols.ravel(), rows.ravel()]))
    inside = np.zeros(len(middles), dtype=bool)
    ends = np.roll(corners, -1, axis=0)
    for (x0, y0), (x1, y1) in zip(corners, ends, strict=True):
        if y0 == y1:
            continue
        meets = (middles[:, 1] < y0) != (middles[:, 1] < y1)
        inside ^= meets & (middles[:, 0] < x0 + (middles[:, 1] - y0) / (y1 - y0) * (x1 - x0))
    cells[rows.ravel()[inside], cols.ravel()[inside]] = True
    step = grid.resolution / 2.0
    for start, end in zip(corners, ends, strict=True):
        steps = math.ceil(math.hypot(*(end - start)) / step)
        points = start + np.linspace(0.0, 1.0, steps + 1)[:, None] * (end - start)
        touched = grid.world_to_cell(points[grid.contains(points)])
        cells[touched[:, 1], touched[:, 0]] = True
    return cells


@dataclass(frozen=True)
class SpeedLimit:
    """How fast the robot may be [m/s], and the zone or mask that says so."""

    speed: float
    zone: Zone | MaskInForce


class ZonesInForce:
    """The zones of one map, and the masks that lie on it.

    Parameters
    ----------
    zones
        In force.
    masks
        Of the recipe.
    """

    def __init__(self, zones: Iterable[Zone] = (), masks: Iterable[MaskInForce] = ()) -> None:
        given, laid = tuple(zones), tuple(masks)
        self._masks = [mask for mask in laid if mask.kind == "keep_out"]
        self._slow_masks = [mask for mask in laid if mask.kind == "speed"]
        barred = [zone for zone in given if zone.kind == "keep_out"]
        self._all_barred: list[Zone | MaskInForce] = [*barred, *self._masks]
        self._barred = barred
        self._slow = [zone for zone in given if zone.kind == "speed"]
        self._barred_outlines = Outlines([zone.corners for zone in self._barred])
        self._slow_outlines = Outlines([zone.corners for zone in self._slow])

    def __bool__(self) -> bool:
        return bool(self._barred or self._slow or self._masks or self._slow_masks)

    @property
    def barred_names(self) -> list[str]:
        """Of the keep-out zones and masks."""
        return [zone.name for zone in self._all_barred]

    def barred(self, x: float, y: float, near: float = 0.0) -> Zone | MaskInForce | None:
        """The keep-out zone at a point, or the nearest of those less than ``near`` [m] away."""
        away = [
            *self._barred_outlines.distance(x, y).tolist(),
            *(mask.distance(x, y, near) for mask in self._masks),
        ]
        if not away:
            return None
        nearest = int(np.argmin(away))
        found = self._all_barred[nearest]
        return found if away[nearest] == 0.0 or away[nearest] < near else None

    def in_the_way(self, x: float, y: float, reach: float) -> Floats:
        """Points (N, 2) on the edges of keep-out zones, up to ``reach`` [m] from the robot.

        A zone that the robot's middle is in has none: what is left then is to leave it.
        """
        outlines = self._barred_outlines
        edges = outlines.near(x, y, reach, ~outlines.inside(x, y))
        return np.concatenate([edges, *(mask.edges(x, y, reach) for mask in self._masks)])

    def limit(self, x: float, y: float, radius: float, decel: float) -> SpeedLimit | None:
        """How fast the robot may be, so that it is slow enough where a zone begins.

        Parameters
        ----------
        x, y
            Where its middle is [m].
        radius
            Of the circle around its body [m].
        decel
            How it brakes at most [m/s²]; half of that is counted on.
        """
        inside = np.flatnonzero(self._barred_outlines.inside(x, y))
        limits = [SpeedLimit(CREEP, self._barred[n]) for n in inside]
        for zone, away in zip(self._slow, self._slow_outlines.distance(x, y), strict=True):
            assert zone.speed is not None  # of every speed zone
            room = max(0.0, float(away) - radius)
            limits.append(SpeedLimit(math.sqrt(zone.speed**2 + 2.0 * GENTLE * decel * room), zone))
        limits += [SpeedLimit(CREEP, mask) for mask in self._masks if mask.inside(x, y)]
        limits += [
            SpeedLimit(speed, mask)
            for mask in self._slow_masks
            if math.isfinite(speed := mask.limit(x, y, radius, decel))
        ]
        return min(limits, key=lambda limit: limit.speed, default=None)

    def off(self, grid: Grid) -> str:
        """Which mask does not lie on a map, in a sentence; empty when all do."""
        for mask in (*self._masks, *self._slow_masks):
            if not mask.lies_on(grid):
                x, y, _ = mask.grid.origin
                return (
                    f"The mask {mask.name!r} does not lie on the map: its origin is "
                    f"({x:g}, {y:g}) m; give it one that suits the map, or leave it out."
                )
        return ""

    def occupy(self, grid: Grid) -> Grid:
        """The grid with every cell that a keep-out zone covers or touches occupied."""
        if not (self._barred or self._masks):
            return grid
        cells = grid.cells.copy()
        for zone in self._barred:
            cells[covered(zone.corners, grid)] = OCCUPIED
        for mask in self._masks:
            cells[mask.covered(grid)] = OCCUPIED
        return Grid(cells, grid.resolution, grid.origin)
