"""How far it is to the nearest of some points, everywhere on a grid around the robot."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from kompass.algorithms.geometry import Floats

Singles: TypeAlias = NDArray[np.float32]


class PointField:
    """Distances [m] in single precision, interpolated between the nodes of a grid.

    Each node looks at one point only, the one in the nearest cell that has any, but at where that
    is and not at the middle of its cell.

    Parameters
    ----------
    points
        (N, 2) in the base frame [m]; those beyond the border count as in the nearest cell on it.
    low, high
        Least and largest x and y of the grid [m].
    resolution
        [m]
    """

    def __init__(
        self,
        points: Floats,
        low: tuple[float, float],
        high: tuple[float, float],
        resolution: float,
    ) -> None:
        first = np.floor(np.array(low) / resolution)
        columns, rows = (np.ceil(np.array(high) / resolution) - first).astype(int) + 1
        # A row and a column more than there are squares between nodes.
        self._columns, self._rows = max(int(columns), 2), max(int(rows), 2)
        self._per_metre = np.float32(1.0 / resolution)
        self._first_x, self._first_y = (np.float32(each) for each in first)
        shape = (self._rows, self._columns)
        if len(points):
            last = (self._columns - 1, self._rows - 1)
            nodes = np.clip(np.rint(points / resolution) - first, 0, last).astype(np.int64)
            which = np.full(shape, -1, dtype=np.int64)
            which[nodes[:, 1], nodes[:, 0]] = np.arange(len(points))
            row, column = distance_transform_edt(
                which < 0, return_distances=False, return_indices=True
            )
            row *= self._columns
            row += column
            self._which = which.ravel().take(row)
            along, across = points.astype(np.float32).T
            dx = along.take(self._which)
            dy = across.take(self._which)
            dx -= ((np.arange(self._columns) + first[0]) * resolution).astype(np.float32)
            dy -= ((np.arange(self._rows) + first[1]) * resolution).astype(np.float32)[:, None]
            dx *= dx
            dy *= dy
            dx += dy
            values = np.sqrt(dx, out=dx)
        else:
            self._which = np.zeros(shape, dtype=np.int64)
            values = np.full(shape, sum(shape) * resolution, dtype=np.float32)
        # The four nodes around a square, each found by the number of its first one.
        flat = values.ravel()
        self._corners = (flat, flat[1:], flat[self._columns :], flat[self._columns + 1 :])

    def at(self, x: Singles, y: Singles) -> Singles:
        """At places of any shape; beyond the border its values."""
        u, v = self._in_cells(x, y)
        out = np.empty_like(u)
        self._interpolate(u, v, out, _Spare(u.shape))
        return out

    def least(
        self, x: Singles, y: Singles, cos: Singles, sin: Singles, centres: Singles
    ) -> Singles:
        """The least one (M,) at ``centres`` (N, 2) of a body, at poses (M,).

        A body that sticks out over the border is looked at where it just does not.
        """
        reach = float(np.hypot(centres[:, 0], centres[:, 1]).max())
        u, v = self._in_cells(x, y, reach)
        least = np.full_like(u, np.inf)
        out, at_u, at_v, spare = (*(np.empty_like(u) for _ in range(3)), _Spare(u.shape))
        cos, sin = cos * self._per_metre, sin * self._per_metre
        # What centres of one row have in common is worked out once.
        for across in np.unique(centres[:, 1]):
            row_u, row_v = u - across * sin, v + across * cos
            for along in centres[centres[:, 1] == across, 0]:
                np.multiply(cos, along, out=at_u)
                np.multiply(sin, along, out=at_v)
                at_u += row_u
                at_v += row_v
                self._interpolate(at_u, at_v, out, spare)
                np.minimum(least, out, out=least)
        return least

    def index(self, x: Singles, y: Singles) -> NDArray[np.int64]:
        """Which of the points is the nearest, at places (M,), but for what is left of a cell."""
        u, v = self._in_cells(x, y)
        out: NDArray[np.int64] = self._which[
            np.rint(v).astype(np.int64), np.rint(u).astype(np.int64)
        ]
        return out

    def _in_cells(self, x: Singles, y: Singles, reach: float = 0.0) -> tuple[Singles, Singles]:
        """Places as columns and rows; those less than ``reach`` within the border are moved in."""
        u, v = x * self._per_metre, y * self._per_metre
        u -= self._first_x
        v -= self._first_y
        kept = np.float32(reach) * self._per_metre
        for each, count in ((u, self._columns), (v, self._rows)):
            last = np.float32(count - 1.001)
            np.maximum(each, np.minimum(kept, last / 2), out=each)
            np.minimum(each, np.maximum(last - kept, last / 2), out=each)
        return u, v

    def _interpolate(self, u: Singles, v: Singles, out: Singles, spare: _Spare) -> None:
        """Write the values at columns and rows to ``out``; u and v are used up."""
        column, row, index = spare.first, spare.second, spare.index
        np.floor(u, out=column)
        np.floor(v, out=row)
        u -= column
        v -= row
        row *= np.float32(self._columns)
        row += column
        np.copyto(index, row, casting="unsafe")
        right, upper = column, row
        here, beside, above, across = self._corners
        here.take(index, out=out, mode="clip")
        beside.take(index, out=right, mode="clip")
        right -= out
        right *= u
        out += right
        above.take(index, out=upper, mode="clip")
        across.take(index, out=right, mode="clip")
        right -= upper
        right *= u
        upper += right
        upper -= out
        upper *= v
        out += upper


class _Spare:
    """Room for what lies between places and values."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.first: Singles = np.empty(shape, dtype=np.float32)
        self.second: Singles = np.empty(shape, dtype=np.float32)
        self.index = np.empty(shape, dtype=np.intp)
