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
_FEW = 24  # motions that are looked at faster one by one


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
        self._lattice = _to_the_edge(_squares_away(lattice), step)
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
        return self._inside(*self._on_lattice(np.asarray(points, dtype=np.float64).reshape(-1, 2)))

    def _on_lattice(self, points: Floats) -> tuple[Floats, Floats]:
        """Columns and rows of the lattice, with fractions, at points (N, 2)."""
        dx = points[:, 0] - self._origin[0]
        dy = points[:, 1] - self._origin[1]
        u = (self._cos * dx + self._sin * dy) * self._per_metre
        v = (self._cos * dy - self._sin * dx) * self._per_metre
        return u, v

    def _inside(self, u: Floats, v: Floats) -> Floats:
        """Distances at columns and rows (overwritten), 0 beyond the lattice."""
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
        return self._at_one(*self._one_on_lattice(x, y))

    def _one_on_lattice(self, x: float, y: float) -> tuple[float, float]:
        dx, dy = x - self._origin[0], y - self._origin[1]
        u = (self._cos * dx + self._sin * dy) * self._per_metre
        return u, (self._cos * dy - self._sin * dx) * self._per_metre

    def _at_one(self, u: float, v: float) -> float:
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
        u, v = self._one_on_lattice(x0, y0)
        last_u, last_v = self._one_on_lattice(x1, y1)
        du, dv = last_u - u, last_v - v
        length = math.hypot(du, dv)
        scale = max(length, 1e-12)
        return self._clear_onward(required, u, v, du / scale, dv / scale, 0.0, length)

    def _clear_onward(
        self, required: float, u: float, v: float, du: float, dv: float, at: float, length: float
    ) -> bool:
        """Whether the rest of a motion is clear, from ``at`` of its length, in lattice steps."""
        while True:
            slack = self._at_one(u + du * at, v + dv * at) - required
            if slack < -TOLERANCE:
                return False
            if at >= length:
                return True
            at = min(length, at + max(slack * self._per_metre, 0.5))

    def segments_clear(
        self, starts: ArrayLike, ends: ArrayLike, required: float
    ) -> NDArray[np.bool_]:
        """:meth:`segment_clear` for many segments at once: (N, 2), (N, 2) -> bool (N,)."""
        u, v = self._on_lattice(np.asarray(starts, dtype=np.float64).reshape(-1, 2))
        du, dv = self._on_lattice(np.asarray(ends, dtype=np.float64).reshape(-1, 2))
        du -= u
        dv -= v
        # In steps of the lattice from here on; what is open is kept together.
        length = np.hypot(du, dv)
        scale = np.maximum(length, 1e-12)
        du /= scale
        dv /= scale
        clear = np.zeros(len(u), dtype=bool)
        number = np.arange(len(u))
        at = np.zeros(len(u))
        while number.size > _FEW:
            slack = self._inside(u + du * at, v + dv * at) - required
            free = slack >= -TOLERANCE
            ends_here = at >= length
            clear[number[free & ends_here]] = True
            going = np.flatnonzero(free & ~ends_here)
            number, length = number[going], length[going]
            u, v, du, dv = u[going], v[going], du[going], dv[going]
            slack = slack[going] * self._per_metre
            np.maximum(slack, 0.5, out=slack)
            slack += at[going]
            at = np.minimum(length, slack)
        for i in range(number.size):
            motion = (float(each[i]) for each in (u, v, du, dv, at, length))
            clear[number[i]] = self._clear_onward(required, *motion)
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


def _squares_away(free: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Squared distance of each place to the nearest that is not free, in steps of the lattice."""
    rows, cols = free.shape
    if free.all():
        return np.full(free.shape, rows**2 + cols**2, dtype=np.int32)
    # The squares are whole numbers: distances made by SciPy itself take half as long again.
    away, across = distance_transform_edt(free, return_distances=False, return_indices=True)
    away -= np.arange(rows, dtype=np.int32)[:, None]
    across -= np.arange(cols, dtype=np.int32)
    away *= away
    across *= across
    away += across
    squares: NDArray[np.int32] = away
    return squares


def _to_the_edge(squares: NDArray[np.int32], step: float) -> NDArray[np.float32]:
    """Distances [m] that never overstate, from squared distances in steps of the lattice."""
    most = int(squares.max())
    # Mostly there are far fewer distances than places.
    few = most < squares.size // 4
    steps_away = np.sqrt(np.arange(most + 1) if few else squares)
    distance = steps_away * step
    np.maximum(steps_away, 1.0, out=steps_away)
    distance -= step * (1.0 + 1.35 / steps_away) / (8.0 * steps_away)
    np.maximum(distance, 0.0, out=distance)
    found = distance.astype(np.float32)
    return found.take(squares) if few else found
