"""What the zones of a map forbid: where no way leads, what is in the way, and how fast it goes."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.geometry import Floats
from kompass.algorithms.grid import OCCUPIED, Grid
from kompass.zones.zone import Zone

SPACING = 0.05  # m between two points of an edge
CREEP = 0.2  # m/s, inside a keep-out zone: somebody gets the robot out of it
_GENTLE = 0.5  # share of the braking that the robot can do, before a speed zone


class Polygon:
    """The outline of a zone.

    Parameters
    ----------
    corners
        (N, 2) in the map's frame [m].
    """

    def __init__(self, corners: ArrayLike) -> None:
        self._from = np.asarray(corners, dtype=np.float64).reshape(-1, 2)
        self._to = np.roll(self._from, -1, axis=0)
        self.low, self.high = self._from.min(axis=0), self._from.max(axis=0)

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Which of the points (N, 2) are inside, by how often a ray to the right meets an edge."""
        pts = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        inside = np.zeros(len(pts), dtype=bool)
        for (x0, y0), (x1, y1) in zip(self._from, self._to, strict=True):
            if y0 == y1:
                continue
            meets = (pts[:, 1] < y0) != (pts[:, 1] < y1)
            at = x0 + (pts[:, 1] - y0) / (y1 - y0) * (x1 - x0)
            inside ^= meets & (pts[:, 0] < at)
        return inside

    def distance(self, x: float, y: float) -> float:
        """From a point to the polygon [m]; 0 inside."""
        if self.contains([(x, y)])[0]:
            return 0.0
        along = self._to - self._from
        share = ((x, y) - self._from) * along
        at = np.clip(share.sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)[:, None]
        return float(np.hypot(*(self._from + at * along - (x, y)).T).min())

    def outline(self, spacing: float = SPACING) -> Floats:
        """Points (N, 2) on all edges, at most ``spacing`` [m] from one to the next."""
        made = []
        for start, end in zip(self._from, self._to, strict=True):
            steps = math.ceil(math.hypot(*(end - start)) / spacing)
            made.append(start + np.arange(steps)[:, None] / steps * (end - start))
        return np.concatenate(made)


@dataclass(frozen=True)
class SpeedLimit:
    """How fast the robot may be [m/s], and the zone that says so."""

    speed: float
    zone: Zone


class ZonesInForce:
    """The zones of one map.

    Parameters
    ----------
    zones
        In force.
    """

    def __init__(self, zones: Iterable[Zone] = ()) -> None:
        shapes = [(zone, Polygon(zone.corners)) for zone in zones]
        self._barred = [(zone, shape) for zone, shape in shapes if zone.kind == "keep_out"]
        self._slow = [(zone, shape) for zone, shape in shapes if zone.kind == "speed"]
        self._outlines = [shape.outline() for _, shape in self._barred]

    def __bool__(self) -> bool:
        return bool(self._barred or self._slow)

    def barred(self, x: float, y: float, near: float = 0.0) -> Zone | None:
        """The keep-out zone at a point, or the nearest of those less than ``near`` [m] away."""
        found = [(shape.distance(x, y), n) for n, (_, shape) in enumerate(self._barred)]
        away, n = min(found, default=(math.inf, 0))
        return self._barred[n][0] if away == 0.0 or away < near else None

    def in_the_way(self, x: float, y: float, reach: float) -> Floats:
        """Points (N, 2) on the edges of keep-out zones, up to ``reach`` [m] from the robot.

        A zone that the robot's middle is in has none: what is left then is to leave it.
        """
        near = [
            points[np.hypot(*(points - (x, y)).T) <= reach]
            for (_, shape), points in zip(self._barred, self._outlines, strict=True)
            if not shape.contains([(x, y)])[0]
        ]
        return np.concatenate(near) if near else np.empty((0, 2))

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
        limits = [
            SpeedLimit(CREEP, zone) for zone, shape in self._barred if shape.contains([(x, y)])[0]
        ]
        for zone, shape in self._slow:
            assert zone.speed is not None  # of every speed zone
            away = max(0.0, shape.distance(x, y) - radius)
            limits.append(SpeedLimit(math.sqrt(zone.speed**2 + 2.0 * _GENTLE * decel * away), zone))
        return min(limits, key=lambda limit: limit.speed, default=None)

    def occupy(self, grid: Grid) -> Grid:
        """The grid with every cell that a keep-out zone covers or touches occupied."""
        if not self._barred:
            return grid
        cells = grid.cells.copy()
        for (_, shape), points in zip(self._barred, self._outlines, strict=True):
            x = (shape.low[0], shape.high[0], shape.high[0], shape.low[0])
            y = (shape.low[1], shape.low[1], shape.high[1], shape.high[1])
            box = grid.world_to_cell(np.column_stack([x, y]))
            low = np.maximum(box.min(axis=0), 0)
            high = np.minimum(box.max(axis=0) + 1, (grid.width, grid.height))
            if (low >= high).any():
                continue
            cols, rows = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
            middles = grid.cell_to_world(np.column_stack([cols.ravel(), rows.ravel()]))
            inside = shape.contains(middles)
            cells[rows.ravel()[inside], cols.ravel()[inside]] = OCCUPIED
            fine = points if grid.resolution >= SPACING else shape.outline(grid.resolution)
            touched = grid.world_to_cell(fine[grid.contains(fine)])
            cells[touched[:, 1], touched[:, 0]] = OCCUPIED
        return Grid(cells, grid.resolution, grid.origin)
