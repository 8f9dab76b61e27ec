"""What was seen around the robot before, kept as log odds while it moves on."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.geometry import Floats, Pose2D
from kompass.algorithms.grid import FREE, OCCUPIED

# A cell is told occupied above the one, free below the other, and unknown between them.
OCCUPIED_ABOVE, FREE_BELOW = 0.65, 0.35
# Log odds are kept as whole numbers of these parts.
_PARTS = 256
# What is known for sure is taken back as fast as this, whatever was seen how often.
MOST_FREE, MOST_OCCUPIED = np.int16(-2.0 * _PARTS), np.int16(3.5 * _PARTS)
_POINT = 12  # bits behind the point of a place on a grid
# How far the robot goes before the cells are moved [cells].
_STRIDE = 16
_BAND = 64  # rows that are looked up at a time


def _log_odds(probability: float) -> np.int16:
    return np.int16(round(_PARTS * math.log(probability / (1.0 - probability))))


@dataclass(frozen=True)
class SensorModel:
    """How far a sensor is to be believed.

    Attributes
    ----------
    p_prior
        Probability that a cell is occupied of which nothing is known.
    p_occupied
        That one is in which a ray ends.
    p_empty
        That one is through which a ray passes.

    Raises
    ------
    ValueError
        They are not in this order: 0 < p_empty < p_prior < p_occupied < 1.
    """

    p_prior: float = 0.6
    p_occupied: float = 0.9
    p_empty: float = 0.1

    def __post_init__(self) -> None:
        if not 0.0 < self.p_empty < self.p_prior < self.p_occupied < 1.0:
            raise ValueError(
                f"p_empty = {self.p_empty:g}, p_prior = {self.p_prior:g}, "
                f"p_occupied = {self.p_occupied:g}; each must be larger than the one before it, "
                "and all between 0 and 1"
            )


class OccupancyMemory:
    """An occupancy grid that goes with the robot and does not forget what is out of sight.

    Each cell adds up the log odds of all that was seen of it (S. Thrun, W. Burgard, D. Fox,
    "Probabilistic Robotics", MIT Press 2005, section 9.2). The cells lie along the axes of the
    world, so that nothing blurs when the robot turns; what is farther away than the robot can turn
    towards is dropped.

    Parameters
    ----------
    rows, cols
        Of the maps of single scans that it takes, and of those that it makes.
    resolution
        [m]
    model
        See :class:`SensorModel`.
    """

    def __init__(self, rows: int, cols: int, resolution: float, model: SensorModel) -> None:
        self._rows, self._cols, self._resolution = rows, cols, resolution
        self._prior = _log_odds(model.p_prior)
        self._hit = _log_odds(model.p_occupied) - self._prior
        self._miss = _log_odds(model.p_empty) - self._prior
        self._free_below, self._occupied_above = _log_odds(FREE_BELOW), _log_odds(OCCUPIED_ABOVE)
        self._side = math.ceil(math.hypot(rows, cols)) + 2 + 2 * _STRIDE
        self._odds = np.full((self._side, self._side), self._prior, dtype=np.int16)
        # What cells lose by a scan; with an edge of zeros, for those who look beside its map.
        self._edge = max(rows, cols) // 2 + 3
        self._loss = np.zeros((rows + 2 * self._edge, cols + 2 * self._edge), dtype=np.int16)
        self._corner: NDArray[np.int64] | None = None  # of the grid, in cells of the world (x, y)
        # Middles of a map's cells in the robot's frame, in cells.
        self._x = np.arange(cols, dtype=np.float64) + (0.5 - cols / 2)
        self._y = np.arange(rows, dtype=np.float64) + (0.5 - rows / 2)

    def take(self, cells: NDArray[np.int8], pose: Pose2D) -> None:
        """Add the map of one scan.

        Parameters
        ----------
        cells
            (rows, cols), -1, 0 and 100, in the robot's frame, which is in its middle.
        pose
            (x, y, yaw) of the robot in the world, when it was made.
        """
        corner = self._follow(pose)
        # Each cell of the memory looks up the one of the scan's map in which its middle lies: no
        # cell is left out between two, whatever the angle. What is a single cell might be, so
        # obstacles go the other way.
        hit = self._indices(cells == OCCUPIED, pose, corner)
        before = self._odds[hit]
        edge = self._edge
        scan = self._loss[edge : edge + self._rows, edge : edge + self._cols]
        np.multiply(cells == FREE, self._miss, out=scan)
        cos, sin = math.cos(pose[2]), math.sin(pose[2])
        window, dx, dy = self._around(pose, corner)
        loss = self._loss.ravel()
        for band, which in _places(
            cos * dx + (self._cols / 2 + edge),
            sin * dy,
            -sin * dx + (self._rows / 2 + edge),
            cos * dy,
            self._loss.shape[1],
        ):
            part = loss.take(which, mode="wrap")
            part += window[band]
            np.maximum(part, MOST_FREE, out=window[band])
        self._odds[hit] = np.minimum(before + self._hit, MOST_OCCUPIED)

    def cells(self, pose: Pose2D) -> NDArray[np.int8]:
        """What is known around a robot that is at a pose (x, y, yaw) now, (rows, cols)."""
        corner = self._follow(pose)
        x, y, yaw = pose
        cos, sin = math.cos(yaw), math.sin(yaw)
        from_x, from_y = x / self._resolution - corner[0], y / self._resolution - corner[1]
        known = np.subtract((self._odds < self._free_below).view(np.int8), np.int8(1)).ravel()
        found = np.empty((self._rows, self._cols), dtype=np.int8)
        for band, which in _places(
            cos * self._x + from_x,
            -sin * self._y,
            sin * self._x + from_y,
            cos * self._y,
            self._side,
        ):
            known.take(which, mode="wrap", out=found[band])
        # Obstacles go the other way here, too: between two middles none is lost.
        window, dx, dy = self._around(pose, corner)
        rows, cols = divmod(np.flatnonzero(window > self._occupied_above), window.shape[1])
        dx, dy = dx[cols], dy[rows]
        cols = np.floor(cos * dx + sin * dy + self._cols / 2).astype(np.int64)
        rows = np.floor(cos * dy - sin * dx + self._rows / 2).astype(np.int64)
        inside = (cols >= 0) & (rows >= 0) & (cols < self._cols) & (rows < self._rows)
        found[rows[inside], cols[inside]] = OCCUPIED
        return found

    def forget(self) -> None:
        """Know nothing, as at first."""
        self._odds.fill(self._prior)

    def _around(
        self, pose: Pose2D, corner: NDArray[np.int64]
    ) -> tuple[NDArray[np.int16], Floats, Floats]:
        """The part of the memory in which a map at a pose lies, a view.

        With it, where its columns and rows have their middles, in cells from the robot.
        """
        x, y, yaw = pose
        cos, sin = abs(math.cos(yaw)), abs(math.sin(yaw))
        along = np.arange(self._side)
        dx = along + (corner[0] + 0.5 - x / self._resolution)
        dy = along + (corner[1] + 0.5 - y / self._resolution)
        near_x = _within(dx, (self._cols * cos + self._rows * sin) / 2)
        near_y = _within(dy, (self._cols * sin + self._rows * cos) / 2)
        return self._odds[near_y, near_x], dx[near_x], dy[near_y]

    def _indices(
        self, chosen: NDArray[np.bool_], pose: Pose2D, corner: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Rows and columns of the memory in which the chosen cells of a scan's map lie."""
        x, y, yaw = pose
        rows, cols = divmod(np.flatnonzero(chosen), self._cols)
        ahead, left = self._x[cols], self._y[rows]
        at_x = x / self._resolution - corner[0] + math.cos(yaw) * ahead - math.sin(yaw) * left
        at_y = y / self._resolution - corner[1] + math.sin(yaw) * ahead + math.cos(yaw) * left
        return np.floor(at_y).astype(np.int64), np.floor(at_x).astype(np.int64)

    def _follow(self, pose: Pose2D) -> NDArray[np.int64]:
        """Have the robot near the middle; the corner of the grid, in cells of the world."""
        here = np.floor(np.array(pose[:2]) / self._resolution).astype(np.int64)
        wanted = here - self._side // 2
        if self._corner is None:
            self._corner = wanted
        step = wanted - self._corner
        if np.abs(step).max() > _STRIDE:
            before, self._odds = self._odds, np.full_like(self._odds, self._prior)
            if np.abs(step).max() < self._side:
                (from_x, to_x), (from_y, to_y) = (_overlap(int(by), self._side) for by in step)
                self._odds[to_y, to_x] = before[from_y, from_x]
            self._corner = wanted
        return self._corner


def _places(
    col_x: Floats, col_y: Floats, row_x: Floats, row_y: Floats, width: int
) -> Iterator[tuple[slice, NDArray[np.intp]]]:
    """Places in a grid, row by row, of columns ``col_x + col_y`` and rows ``row_x + row_y``.

    The terms that depend on x, and those on y, are columns and rows of what is yielded, in bands
    of some rows: large arrays that live for a moment cost more than what is done with them. Whole
    numbers with a point in them take a third of the time of broken ones. None of them lies
    outside, so they are looked up in the way that looks for that least (``wrap``).
    """
    terms = [(each * (1 << _POINT)).astype(np.int32) for each in (col_x, col_y, row_x, row_y)]
    for first in range(0, len(col_y), _BAND):
        band = slice(first, first + _BAND)
        cols = terms[0] + terms[1][band, None]
        rows = terms[2] + terms[3][band, None]
        cols >>= _POINT
        rows >>= _POINT
        which = np.multiply(rows, width, dtype=np.intp)
        which += cols
        yield band, which


def _within(values: Floats, reach: float) -> slice:
    """The part of a rising row whose values are within ``reach`` of 0, and one more at each end."""
    first, last = np.searchsorted(values, [-reach, reach])
    return slice(max(0, int(first) - 1), int(last) + 1)


def _overlap(step: int, size: int) -> tuple[slice, slice]:
    """Which part of a row stays, and where, when its first place moves by ``step``."""
    kept = slice(max(0, step), min(size, size + step))
    return kept, slice(kept.start - step, kept.stop - step)
