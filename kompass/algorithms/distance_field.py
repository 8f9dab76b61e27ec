"""How far every place on a map is from the nearest obstacle.

With this array a collision check is a look-up, a clearance is a look-up, and a straight motion is
checked by stepping along it as far as the clearance allows (sphere tracing), so that open space
costs a handful of look-ups however fine the grid.

The exact Euclidean distance transform of the obstacle *cells' centres* would overstate distances
by up to 0.7 cells. It is therefore taken on a lattice of half the cell size on which every
obstacle cell marks its centre, corners and edge midpoints: from any lattice point the nearest
point of a square cell is again a lattice point, so distances to cells' edges are exact there.
Between lattice points they are interpolated bilinearly, after a small reduction that covers how
much interpolation of a convex function can overstate: h² / (8 d) at lattice step h, and more
right beside a corner, where the distance is a cone's.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import distance_transform_edt

from kompass.algorithms.geometry import Floats
from kompass.algorithms.grid import Grid

# A motion that passes within this of its allowed clearance passes: it absorbs float32 rounding.
TOLERANCE = 1e-5


class DistanceField:
    """Distance from any world point to the nearest obstacle cell's edge [m].

    Never overstates (it understates by less than a third of a cell, in notches), and is 0 inside
    obstacles and outside the map. With ``unknown_is_obstacle`` unexplored cells, and what lies
    beyond the map's border, count as obstacles; without it they do not, and a map with no
    obstacle at all is as far from one everywhere as the map is wide.
    """

    def __init__(self, grid: Grid, unknown_is_obstacle: bool = True) -> None:
        self.grid = grid
        self.unknown_is_obstacle = unknown_is_obstacle
        occupied = grid.occupied(unknown_is_obstacle=unknown_is_obstacle)
        rows, cols = occupied.shape
        lattice = np.ones((2 * rows + 1, 2 * cols + 1), dtype=bool)
        free = ~occupied
        for dy in range(3):
            for dx in range(3):
                lattice[dy : dy + 2 * rows : 2, dx : dx + 2 * cols : 2] &= free
        if unknown_is_obstacle:
            lattice[[0, -1], :] = False
            lattice[:, [0, -1]] = False

        step = grid.resolution / 2.0
        if lattice.all():
            distance = np.full(lattice.shape, step * math.hypot(*lattice.shape))
        else:
            distance = distance_transform_edt(lattice) * step
        steps_away = np.maximum(distance / step, 1.0)
        distance -= step * (1.0 + 1.35 / steps_away) / (8.0 * steps_away)
        np.maximum(distance, 0.0, out=distance)
        self._lattice: NDArray[np.float32] = np.ascontiguousarray(distance, dtype=np.float32)
        self._flat = self._lattice.ravel()
        # Indexing a memoryview gives a Python float in a quarter of the time NumPy takes.
        self._view: memoryview[float] = memoryview(self._flat)  # type: ignore[arg-type]
        self._stride = lattice.shape[1]
        self._per_metre = 1.0 / step
        self._last_col = lattice.shape[1] - 2
        self._last_row = lattice.shape[0] - 2
        x, y, yaw = grid.origin
        self._origin = (x, y)
        self._cos, self._sin = math.cos(yaw), math.sin(yaw)
        self._step = step

    @property
    def lattice(self) -> NDArray[np.float32]:
        """Distances at half-cell steps, (2 H + 1, 2 W + 1); cell [r, c] is at [2r + 1, 2c + 1]."""
        return self._lattice

    def at(self, points: ArrayLike) -> Floats:
        """Distances (N,) at world points (N, 2)."""
        pts = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        dx = pts[:, 0] - self._origin[0]
        dy = pts[:, 1] - self._origin[1]
        u = (self._cos * dx + self._sin * dy) * self._per_metre
        v = (self._cos * dy - self._sin * dx) * self._per_metre
        # Points that are no numbers compare as false, and are outside as well.
        if len(u) and (
            min(u.min(), v.min()) >= 0 and u.max() <= self._last_col and v.max() <= self._last_row
        ):
            return self._between(u, v)
        inside = (u >= 0) & (v >= 0) & (u <= self._last_col + 1) & (v <= self._last_row + 1)
        found = self._between(np.where(inside, u, 0.0), np.where(inside, v, 0.0))
        found *= inside
        return found

    def _between(self, u: Floats, v: Floats) -> Floats:
        """Between four values of the lattice each, at columns and rows within it (overwritten)."""
        col = np.minimum(u.astype(np.int64), self._last_col)
        row = np.minimum(v.astype(np.int64), self._last_row)
        u -= col
        v -= row
        i = row * self._stride
        i += col
        low: Floats = self._flat.take(i) * (1.0 - u)
        i += 1
        low += self._flat.take(i) * u
        i += self._stride
        high: Floats = self._flat.take(i) * u
        i -= 1
        high += self._flat.take(i) * (1.0 - u)
        high -= low
        high *= v
        high += low
        return high

    def at_xy(self, x: float, y: float) -> float:
        """The distance at one world point, without the overhead of arrays."""
        dx, dy = x - self._origin[0], y - self._origin[1]
        u = (self._cos * dx + self._sin * dy) * self._per_metre
        v = (self._cos * dy - self._sin * dx) * self._per_metre
        if not (0.0 <= u <= self._last_col + 1 and 0.0 <= v <= self._last_row + 1):
            return 0.0
        col, row = min(int(u), self._last_col), min(int(v), self._last_row)
        u -= col
        v -= row
        view = self._view
        i = row * self._stride + col
        j = i + self._stride
        low: float = view[i] + (view[i + 1] - view[i]) * u
        high: float = view[j] + (view[j + 1] - view[j]) * u
        distance: float = low + (high - low) * v
        return distance

    def segment_clear(self, x0: float, y0: float, x1: float, y1: float, required: float) -> bool:
        """Whether the straight motion keeps at least ``required`` [m] from every obstacle.

        Distance changes no faster than position, so from a point with distance d the next
        ``d - required`` metres need no look-up; the step never falls under a quarter cell.
        """
        dx, dy = x1 - x0, y1 - y0
        length = math.hypot(dx, dy)
        shortest = self._step / 2.0
        at = 0.0
        while True:
            share = at / length if length > 0.0 else 0.0
            slack = self.at_xy(x0 + share * dx, y0 + share * dy) - required
            if slack < -TOLERANCE:
                return False
            if at >= length:
                return True
            at = min(length, at + max(slack, shortest))

    def segments_clear(
        self, starts: ArrayLike, ends: ArrayLike, required: float
    ) -> NDArray[np.bool_]:
        """:meth:`segment_clear` for many segments at once: (N, 2), (N, 2) -> bool (N,)."""
        a = np.asarray(starts, dtype=np.float64).reshape(-1, 2)
        delta = np.asarray(ends, dtype=np.float64).reshape(-1, 2) - a
        length = np.hypot(delta[:, 0], delta[:, 1])
        direction = delta / np.maximum(length, 1e-12)[:, None]
        clear = np.ones(len(a), dtype=bool)
        at = np.zeros(len(a))
        open_ = np.arange(len(a))
        shortest = self._step / 2.0
        while open_.size:
            slack = self.at(a[open_] + direction[open_] * at[open_, None]) - required
            hit = slack < -TOLERANCE
            clear[open_[hit]] = False
            going = ~hit & (at[open_] < length[open_])
            open_, slack = open_[going], slack[going]
            at[open_] = np.minimum(length[open_], at[open_] + np.maximum(slack, shortest))
        return clear

    def gradient(self, points: ArrayLike) -> Floats:
        """The directions (N, 2) in which distance grows, in the world (central differences)."""
        pts = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        h = self._step
        n = len(pts)
        offsets = np.array([[h, 0.0], [-h, 0.0], [0.0, h], [0.0, -h]])
        probes = (pts[None] + offsets[:, None]).reshape(-1, 2)
        values = self.at(probes)
        out = np.empty((n, 2))
        out[:, 0] = (values[:n] - values[n : 2 * n]) / (2 * h)
        out[:, 1] = (values[2 * n : 3 * n] - values[3 * n :]) / (2 * h)
        return out
