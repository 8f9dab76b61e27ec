"""What stands where: the map that was given, and beside it what the sensor has seen since.

Each cell holds the log-odds of being occupied (Moravec and Elfes, ICRA 1985; Thrun, Burgard and
Fox, "Probabilistic Robotics", 9.2), added up over scans within bounds, so that what has stood for
an hour is forgotten as fast as what has stood for a second once rays pass through it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.geometry import Floats, Pose2D, transform_points
from kompass.algorithms.grid import FREE, OCCUPIED, Grid
from kompass.algorithms.mapping.scan_points import read_rays

HIT, MISS = 0.85, -0.4  # log-odds of one reading that ends in a cell, or goes through it
# One reading is enough to be in the way, wherever was free before: MOST_FREE + HIT > 0.
MOST_FREE, MOST_OCCUPIED = -0.8, 3.5
MOST_CELLS = 4_000_000  # 100 m x 100 m at 5 cm
_CHUNK = 64  # cells by which the model grows
_EDGE = 0.7  # cells before a reading's end that the ray may have ended in already


class TooFar(ValueError):
    """A place is so far away that the model would not hold all in between."""


@dataclass(frozen=True)
class Change:
    """What one scan has changed.

    Attributes
    ----------
    marked
        Centres (N, 2) of cells in the world that are obstacles now, and were not [m].
    cleared
        How many cells are obstacles no more.
    """

    marked: Floats
    cleared: int


class WorldModel:
    """Marks what rays end at, clears what they pass through, forgets what nobody looks at.

    With a map, the model has the map's cells, and what is outside of it is left out; what the map
    has as an obstacle stays one. Without a map it grows as far as it is asked to, and what was
    never seen is free.

    Parameters
    ----------
    resolution
        Of a model without a map [m].
    reach
        Readings are believed up to here [m].
    memory
        After so many seconds in which no ray came to an obstacle or through it, it is forgotten.

    Raises
    ------
    ValueError
        An argument is not above 0.
    """

    def __init__(
        self, resolution: float = 0.05, *, reach: float = 5.0, memory: float = 120.0
    ) -> None:
        for name, value, unit in (
            ("resolution", resolution, "m"),
            ("reach", reach, "m"),
            ("memory", memory, "s"),
        ):
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name}: {value} {unit}; give a finite number above 0")
        self.reach, self.memory = reach, memory
        self._static: Grid | None = None
        self._origin: Pose2D
        self._resolution: float
        self._odds: NDArray[np.float32]
        self._seen: NDArray[np.float64]
        self._lay_out((0.0, 0.0, 0.0), resolution, (0, 0))

    @property
    def is_empty(self) -> bool:
        """Whether it knows nothing: no map, and no place was ever asked for or seen."""
        return self._odds.size == 0

    @property
    def has_map(self) -> bool:
        """Whether a map was given."""
        return self._static is not None

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, cols = self._odds.shape
        return rows, cols

    @property
    def resolution(self) -> float:
        """Edge of a cell [m]."""
        return self._resolution

    def set_map(self, grid: Grid) -> None:
        """Take a map; what was seen before stays, on the map's cells."""
        known = np.flatnonzero(self._odds.ravel() > 0.0)
        width = self._odds.shape[1]
        places = self._world(np.stack([known % max(1, width), known // max(1, width)], axis=1))
        odds, seen = self._odds.ravel()[known], self._seen.ravel()[known]
        self._static = grid
        self._lay_out(grid.origin, grid.resolution, grid.cells.shape)
        inside = grid.contains(places) if len(places) else np.empty(0, dtype=bool)
        cols, rows = grid.world_to_cell(places[inside]).T
        self._odds[rows, cols] = odds[inside]
        self._seen[rows, cols] = seen[inside]

    def include(self, points: ArrayLike, margin: float) -> None:
        """Have a model without a map reach around world points (N, 2), ``margin`` [m] further.

        Raises
        ------
        TooFar
            When it would have more than MOST_CELLS.
        """
        if self._static is not None:
            return
        cells = self._cells(np.asarray(points, dtype=np.float64).reshape(-1, 2))
        more = math.ceil(margin / self._resolution)
        low, high = cells.min(axis=0) - more, cells.max(axis=0) + more + 1
        height, width = self._odds.shape
        before = np.array([math.ceil(max(0, -value) / _CHUNK) * _CHUNK for value in low])
        if self.is_empty:  # nothing there to grow from
            before = -low
        after = np.array(
            [
                math.ceil(max(0, value - size) / _CHUNK) * _CHUNK
                for value, size in zip(high, (width, height), strict=True)
            ]
        )
        if not (before.any() or after.any()):
            return
        rows, cols = height + before[1] + after[1], width + before[0] + after[0]
        if rows * cols > MOST_CELLS:
            raise TooFar(
                f"a model of {cols * self._resolution:.0f} m x {rows * self._resolution:.0f} m has "
                f"more than {MOST_CELLS} cells of {self._resolution:g} m"
            )
        pad = ((int(before[1]), int(after[1])), (int(before[0]), int(after[0])))
        self._odds = np.pad(self._odds, pad)
        self._seen = np.pad(self._seen, pad)
        x, y, yaw = self._origin
        step = -before * self._resolution
        self._origin = (x + float(step[0]), y + float(step[1]), yaw)

    def see(
        self,
        ranges: ArrayLike,
        angle_min: float,
        angle_increment: float,
        range_min: float,
        range_max: float,
        sensor_pose: Pose2D,
        now: float,
    ) -> Change:
        """Take a scan in.

        +inf and what is not below the maximum range is free as far as the model looks; NaN, 0,
        -inf and what is nearer than the minimum range say nothing. A cell counts as passed through
        only when its own ray and both beside it go on behind it: a ray that grazes a wall tells
        nothing of the wall's other cells.

        Parameters
        ----------
        ranges
            (N,) [m], ray i at ``angle_min + i * angle_increment`` in the sensor's frame.
        angle_min, angle_increment
            [rad], the increment not 0.
        range_min, range_max
            Between them the sensor measures [m].
        sensor_pose
            (x, y, yaw) in the world, when it was measured.
        now
            [s]

        Raises
        ------
        ValueError
            No rays, or an increment of 0.
        TooFar
            When a model without a map would become too large.
        """
        measured = np.asarray(ranges, dtype=np.float64).ravel()
        if measured.size == 0:
            raise ValueError("ranges: there are none; give at least one")
        if angle_increment == 0 or not math.isfinite(angle_increment):
            raise ValueError(f"angle_increment: {angle_increment} rad; give one other than 0")
        farthest = min(range_max, self.reach)
        self.include([sensor_pose[:2]], farthest)
        rays = read_rays(measured, angle_min, angle_increment, range_min, farthest, sensor_pose)
        rows, cols, passed = self._passed(rays.free_to, angle_min, angle_increment, sensor_pose)
        end_cols, end_rows = self._cells(rays.ends).T
        height, width = self._odds.shape
        inside = (end_cols >= 0) & (end_rows >= 0) & (end_cols < width) & (end_rows < height)
        end_cols, end_rows = end_cols[inside], end_rows[inside]

        window = (rows, cols)
        odds = self._odds[window]
        before = odds > 0.0
        hit = np.zeros(odds.shape, dtype=bool)
        hit[end_rows - rows.start, end_cols - cols.start] = True
        passed &= ~hit
        odds[passed] = np.maximum(odds[passed] + MISS, MOST_FREE)
        odds[hit] = np.minimum(odds[hit] + HIT, MOST_OCCUPIED)
        self._seen[window][passed | hit] = now
        after = odds > 0.0
        new_rows, new_cols = np.nonzero(after & ~before)
        marked = np.stack([new_cols + cols.start, new_rows + rows.start], axis=1)
        return Change(self._world(marked), int((before & ~after).sum()))

    def grid(self, now: float, seen_within: float = math.inf) -> Grid:
        """The map with all that was seen on it, as a planner wants it.

        Parameters
        ----------
        now
            [s]
        seen_within
            Without what no ray has come to for longer than that [s].

        Raises
        ------
        ValueError
            The model is empty.
        """
        seen = self.obstacles(now) & (now - self._seen <= seen_within)
        if self._static is None:
            cells = np.full(self._odds.shape, FREE, dtype=np.int8)
        else:
            cells = self._static.cells.copy()
        cells[seen] = OCCUPIED
        return Grid(cells, self._resolution, self._origin)

    def obstacles(self, now: float) -> NDArray[np.bool_]:
        """What was seen, and is not forgotten, bool (H, W) on the cells of :meth:`grid`."""
        old = (self._odds > 0.0) & (now - self._seen > self.memory)
        self._odds[old] = 0.0
        return self._odds > 0.0

    def near(self, place: ArrayLike, reach: float, now: float) -> tuple[Floats, Floats, Floats]:
        """What was seen, and what the map has, within ``reach`` [m] of a place (x, y).

        Returns
        -------
        tuple[Floats, Floats, Floats]
            Centres (N, 2) of what was seen [m], for how long no ray has come there (N,) [s], and
            centres (M, 2) of what is an obstacle on the map; all in the world.
        """
        rows, cols = self._around(place, reach)
        start = np.array([cols.start, rows.start])
        seen = self._odds[rows, cols] > 0.0
        at = np.argwhere(seen)[:, ::-1] + start
        ages = now - self._seen[rows, cols][seen]
        if self._static is None:
            return self._world(at), ages, np.empty((0, 2))
        known = np.argwhere(self._static.occupied()[rows, cols])[:, ::-1] + start
        return self._world(at), ages, self._world(known)

    def forget(self, unseen_for: float, now: float) -> int:
        """Forget what no ray has come to for so long [s]; how many cells that were."""
        old = (self._odds > 0.0) & (now - self._seen > unseen_for)
        self._odds[old] = 0.0
        return int(old.sum())

    def _around(self, place: ArrayLike, reach: float) -> tuple[slice, slice]:
        col, row = self._cells(np.asarray(place, dtype=np.float64).reshape(1, 2))[0]
        more = math.ceil(reach / self._resolution)
        height, width = self._odds.shape
        cols = slice(max(0, min(width, col - more)), max(0, min(width, col + more + 1)))
        return slice(max(0, min(height, row - more)), max(0, min(height, row + more + 1))), cols

    def _passed(
        self, free_to: Floats, angle_min: float, increment: float, pose: Pose2D
    ) -> tuple[slice, slice, NDArray[np.bool_]]:
        """Which cells of a window around the sensor rays have gone through."""
        x, y, yaw = pose
        at_x, at_y = (float(v) for v in self._local(np.array([[x, y]]))[0] / self._resolution)
        height, width = self._odds.shape
        reach = float(np.max(free_to, initial=0.0)) / self._resolution + 1.0
        col, row = max(0, math.floor(at_x - reach)), max(0, math.floor(at_y - reach))
        cols = slice(col, max(col, min(width, math.ceil(at_x + reach) + 1)))
        rows = slice(row, max(row, min(height, math.ceil(at_y + reach) + 1)))
        dx = (np.arange(cols.start, cols.stop) + (0.5 - at_x))[None, :] * self._resolution
        dy = (np.arange(rows.start, rows.stop) + (0.5 - at_y))[:, None] * self._resolution
        away = np.hypot(dx, dy)
        bearing = np.arctan2(dy, dx) - (yaw - self._origin[2] + angle_min)
        step, count = abs(increment), free_to.size
        swept = np.mod(bearing * math.copysign(1.0, increment) + step / 2.0, math.tau)
        ray = (swept / step).astype(np.int64)
        whole_turn = count * step > math.tau - step
        if whole_turn:
            beside = np.minimum(np.roll(free_to, 1), np.roll(free_to, -1))
        else:
            beside = np.minimum(np.append(free_to[1:], 0.0), np.append(0.0, free_to[:-1]))
        # One more, for what no ray looks at.
        least = np.append(np.minimum(free_to, beside), 0.0) - _EDGE * self._resolution
        ray = np.where(ray < count, ray, count - 1 if whole_turn else count)
        passed: NDArray[np.bool_] = away < least[ray]
        return rows, cols, passed

    def _lay_out(self, origin: Pose2D, resolution: float, shape: tuple[int, ...]) -> None:
        self._origin, self._resolution = origin, resolution
        self._odds = np.zeros(shape, dtype=np.float32)
        self._seen = np.zeros(shape, dtype=np.float64)

    def _local(self, points: Floats) -> Floats:
        x, y, yaw = self._origin
        return transform_points((0.0, 0.0, -yaw), points - (x, y))

    def _cells(self, points: Floats) -> NDArray[np.int64]:
        found: NDArray[np.int64] = np.floor(self._local(points) / self._resolution).astype(np.int64)
        return found

    def _world(self, cells: ArrayLike) -> Floats:
        centres = (np.asarray(cells, dtype=np.float64).reshape(-1, 2) + 0.5) * self._resolution
        return transform_points(self._origin, centres)


def pose_at(stamp: float, before: tuple[float, Pose2D], after: tuple[float, Pose2D]) -> Pose2D:
    """Where the robot was at ``stamp`` [s], between two poses with theirs.

    Outside of the two, the nearer one.
    """
    (t0, first), (t1, last) = before, after
    share = 1.0 if t1 <= t0 else min(1.0, max(0.0, (stamp - t0) / (t1 - t0)))
    turn = math.remainder(last[2] - first[2], math.tau)
    return (
        first[0] + share * (last[0] - first[0]),
        first[1] + share * (last[1] - first[1]),
        math.remainder(first[2] + share * turn, math.tau),
    )
