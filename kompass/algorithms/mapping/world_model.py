"""What stands where: the map that was given, and beside it what the sensor has seen since.

Each cell holds the log-odds of being occupied (Moravec and Elfes, ICRA 1985; Thrun, Burgard and
Fox, "Probabilistic Robotics", 9.2), added up over scans within bounds, so that what has stood for
an hour is forgotten as fast as what has stood for a second once rays pass through it.
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.geometry import Floats, Pose2D, inverse, transform_points
from kompass.algorithms.grid import FREE, OCCUPIED, OCCUPIED_FROM, Grid
from kompass.algorithms.mapping.cloud_view import CloudView
from kompass.algorithms.mapping.scan_points import read_rays

HIT, MISS = 0.85, -0.4  # log-odds of one reading that ends in a cell, or goes through it
# One reading is enough to be in the way, wherever was free before: MOST_FREE + HIT > 0.
MOST_FREE, MOST_OCCUPIED = -0.8, 3.5
MOST_CELLS = 4_000_000  # 100 m x 100 m at 5 cm
_CHUNK = 64  # cells by which the model grows
_EDGE = 0.7  # cells before a reading's end that the ray may have ended in already


class TooFar(ValueError):
    """A place is so far away that the model would not hold all in between."""


class _Layer:
    """What one source has seen: log-odds of its cells, when it looked there, and how high it saw.

    Heights are those of clouds; a planar scan, whose ray clears all of a cell, has none.
    """

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.odds: NDArray[np.float32] = np.zeros(shape, dtype=np.float32)
        self.seen: NDArray[np.float64] = np.zeros(shape, dtype=np.float64)
        self.bottoms: NDArray[np.float32] | None = None
        self.tops: NDArray[np.float32] | None = None

    def with_heights(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Lowest and highest of what was seen in each cell."""
        if self.bottoms is None or self.tops is None:
            self.bottoms, self.tops = np.zeros_like(self.odds), np.zeros_like(self.odds)
        return self.bottoms, self.tops

    def move(self, before: NDArray[np.int64], after: NDArray[np.int64]) -> None:
        """Make room for so many (columns, rows) before and after those that there are."""
        pad = ((int(before[1]), int(after[1])), (int(before[0]), int(after[0])))
        self.odds, self.seen = np.pad(self.odds, pad), np.pad(self.seen, pad)
        if self.bottoms is not None and self.tops is not None:
            self.bottoms, self.tops = np.pad(self.bottoms, pad), np.pad(self.tops, pad)


@dataclass(frozen=True)
class Change:
    """What one scan, or one cloud, has changed.

    Attributes
    ----------
    marked
        Centres (N, 2) of cells in the world that are obstacles now, and were none of its source's
        before [m].
    cleared
        How many cells are obstacles of its source no more.
    """

    marked: Floats
    cleared: int


class WorldModel:
    """Marks what rays end at, clears what they pass through, forgets what nobody looks at.

    With a map, the model has the map's cells, and what is outside of it is left out; what the map
    has as an obstacle stays one. Without a map it grows as far as it is asked to, and what was
    never seen is free.

    Sources that do not see the same things have a layer each, and an obstacle in one of them is
    one: a lidar that looks over a low box does not clear what a camera has seen of it.

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
        self._shape: tuple[int, int]
        self._layers: dict[Hashable, _Layer]
        self._lay_out((0.0, 0.0, 0.0), resolution, (0, 0))

    @property
    def is_empty(self) -> bool:
        """Whether it knows nothing: no map, and no place was ever asked for or seen."""
        return 0 in self._shape

    @property
    def has_map(self) -> bool:
        """Whether a map was given."""
        return self._static is not None

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self._shape

    @property
    def resolution(self) -> float:
        """Edge of a cell [m]."""
        return self._resolution

    def set_map(self, grid: Grid) -> None:
        """Take a map; what was seen before stays, on the map's cells."""
        before = {key: (layer, *self._known(layer)) for key, layer in self._layers.items()}
        self._static = grid
        rows, cols = grid.cells.shape
        self._lay_out(grid.origin, grid.resolution, (rows, cols))
        for key, (old, known, places) in before.items():
            inside = grid.contains(places) if len(places) else np.empty(0, dtype=bool)
            to_cols, to_rows = grid.world_to_cell(places[inside]).T
            from_ = tuple(index[inside] for index in known)
            layer = self._layer(key)
            layer.odds[to_rows, to_cols] = old.odds[from_]
            layer.seen[to_rows, to_cols] = old.seen[from_]
            if old.bottoms is not None and old.tops is not None:
                bottoms, tops = layer.with_heights()
                bottoms[to_rows, to_cols] = old.bottoms[from_]
                tops[to_rows, to_cols] = old.tops[from_]

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
        height, width = self._shape
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
        self._shape = int(rows), int(cols)
        for layer in self._layers.values():
            layer.move(before, after)
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
        source: Hashable = None,
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
        source
            Of which layer it is; scanners that look in one plane may share theirs.

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
        end_rows, end_cols, _ = self._inside(rays.ends)

        window = (rows, cols)
        layer = self._layer(source)
        odds = layer.odds[window]
        before = odds > 0.0
        hit = np.zeros(odds.shape, dtype=bool)
        hit[end_rows - rows.start, end_cols - cols.start] = True
        passed &= ~hit
        odds[passed] = np.maximum(odds[passed] + MISS, MOST_FREE)
        odds[hit] = np.minimum(odds[hit] + HIT, MOST_OCCUPIED)
        layer.seen[window][passed | hit] = now
        after = odds > 0.0
        new_rows, new_cols = np.nonzero(after & ~before)
        marked = np.stack([new_cols + cols.start, new_rows + rows.start], axis=1)
        return Change(self._world(marked), int((before & ~after).sum()))

    def look(self, view: CloudView, robot_pose: Pose2D, now: float, source: Hashable) -> Change:
        """Take a cloud in.

        An obstacle of its layer counts as looked through when a line of sight goes on behind it at
        a height at which it was seen; what is out of the cloud's sight stays as it was.

        Parameters
        ----------
        view
            In the robot's frame.
        robot_pose
            (x, y, yaw) in the world, when it was made.
        now
            [s]
        source
            Of which layer it is.

        Raises
        ------
        TooFar
            When a model without a map would become too large.
        """
        self.include([robot_pose[:2]], self.reach)
        layer = self._layer(source)
        bottoms, tops = layer.with_heights()
        (old_rows, old_cols), places = self._known(layer)
        seen_from = transform_points(inverse(robot_pose), places)
        through = view.sees_through(
            seen_from,
            bottoms[old_rows, old_cols].astype(np.float64),
            tops[old_rows, old_cols].astype(np.float64),
        )
        points, near = view.points, np.hypot(*view.points.T) < self.reach
        rows, cols, kept = self._inside(transform_points(robot_pose, points[near]))
        hit = np.zeros(self._shape, dtype=bool)
        hit[rows, cols] = True
        through &= ~hit[old_rows, old_cols]
        gone_rows, gone_cols = old_rows[through], old_cols[through]
        layer.odds[gone_rows, gone_cols] += np.float32(MISS)
        cleared = layer.odds[gone_rows, gone_cols] <= 0.0
        # What is seen anew has the heights that it is seen at now.
        new = hit & (layer.odds <= 0.0)
        bottoms[new], tops[new] = np.inf, -np.inf
        np.minimum.at(bottoms, (rows, cols), view.bottoms[near][kept].astype(np.float32))
        np.maximum.at(tops, (rows, cols), view.tops[near][kept].astype(np.float32))
        layer.odds[hit] = np.minimum(np.maximum(layer.odds[hit], 0.0) + HIT, MOST_OCCUPIED)
        layer.seen[hit] = layer.seen[gone_rows, gone_cols] = now
        new_rows, new_cols = np.nonzero(new)
        marked = self._world(np.stack([new_cols, new_rows], axis=1))
        return Change(marked, int(cleared.sum()))

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
        whole = (slice(0, self._shape[0]), slice(0, self._shape[1]))
        return self._piece(*whole, self.obstacles(now, seen_within))

    def grid_around(self, place: ArrayLike, reach: float, now: float) -> Grid:
        """What of :meth:`grid` is within ``reach`` [m] of a place (x, y) along each axis of the
        model, for what so much takes; what lies outside of the model is left out.

        Raises
        ------
        ValueError
            None of it is.
        """
        rows, cols = self._around(place, reach)
        seen = np.zeros((rows.stop - rows.start, cols.stop - cols.start), dtype=bool)
        for layer in self._layers.values():
            fresh = now - layer.seen[rows, cols] <= self.memory
            seen |= (layer.odds[rows, cols] > 0.0) & fresh
        return self._piece(rows, cols, seen)

    def obstacles(self, now: float, seen_within: float = math.inf) -> NDArray[np.bool_]:
        """What was seen, and is not forgotten, bool (H, W) on the cells of :meth:`grid`; without
        what no ray has come to for longer than ``seen_within`` [s]."""
        found = np.zeros(self._shape, dtype=bool)
        for layer in self._layers.values():
            layer.odds[(layer.odds > 0.0) & (now - layer.seen > self.memory)] = 0.0
            found |= (layer.odds > 0.0) & (now - layer.seen <= seen_within)
        return found

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
        # Of layers that have the same obstacle, the one counts that was looked at last.
        newest = np.full((rows.stop - rows.start, cols.stop - cols.start), -np.inf)
        for layer in self._layers.values():
            looked = np.where(layer.odds[rows, cols] > 0.0, layer.seen[rows, cols], -np.inf)
            np.maximum(newest, looked, out=newest)
        seen = newest > -np.inf
        at = np.argwhere(seen)[:, ::-1] + start
        ages = now - newest[seen]
        if self._static is None:
            return self._world(at), ages, np.empty((0, 2))
        known = np.argwhere(self._static.cells[rows, cols] >= OCCUPIED_FROM)[:, ::-1] + start
        return self._world(at), ages, self._world(known)

    def forget(self, unseen_for: float, now: float) -> int:
        """Forget what no ray has come to for so long [s]; how many cells that were."""
        gone = np.zeros(self._shape, dtype=bool)
        for layer in self._layers.values():
            old = (layer.odds > 0.0) & (now - layer.seen > unseen_for)
            layer.odds[old] = 0.0
            gone |= old
        return int(gone.sum())

    def _piece(self, rows: slice, cols: slice, seen: NDArray[np.bool_]) -> Grid:
        """A piece of the map with what was seen there."""
        if self._static is None:
            cells = np.full(seen.shape, FREE, dtype=np.int8)
        else:
            cells = self._static.cells[rows, cols].copy()
        cells[seen] = OCCUPIED
        corner = self._resolution * np.array([[cols.start, rows.start]], dtype=np.float64)
        x, y = transform_points(self._origin, corner)[0]
        return Grid(cells, self._resolution, (float(x), float(y), self._origin[2]))

    def _around(self, place: ArrayLike, reach: float) -> tuple[slice, slice]:
        col, row = self._cells(np.asarray(place, dtype=np.float64).reshape(1, 2))[0]
        more = math.ceil(reach / self._resolution)
        height, width = self._shape
        cols = slice(max(0, min(width, col - more)), max(0, min(width, col + more + 1)))
        return slice(max(0, min(height, row - more)), max(0, min(height, row + more + 1))), cols

    def _passed(
        self, free_to: Floats, angle_min: float, increment: float, pose: Pose2D
    ) -> tuple[slice, slice, NDArray[np.bool_]]:
        """Which cells of a window around the sensor rays have gone through."""
        x, y, yaw = pose
        at_x, at_y = (float(v) for v in self._local(np.array([[x, y]]))[0] / self._resolution)
        height, width = self._shape
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

    def _lay_out(self, origin: Pose2D, resolution: float, shape: tuple[int, int]) -> None:
        self._origin, self._resolution, self._shape = origin, resolution, shape
        self._layers = {}

    def _layer(self, source: Hashable) -> _Layer:
        layer = self._layers.get(source)
        if layer is None:
            layer = self._layers[source] = _Layer(self._shape)
        return layer

    def _known(self, layer: _Layer) -> tuple[tuple[NDArray[np.intp], NDArray[np.intp]], Floats]:
        """Rows and columns of a layer's obstacles, and where they are in the world (N, 2)."""
        rows, cols = np.nonzero(layer.odds > 0.0)
        return (rows, cols), self._world(np.stack([cols, rows], axis=1))

    def _inside(
        self, points: Floats
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
        """Which of world points (N, 2) are on the model's cells, with their rows and columns."""
        cols, rows = self._cells(points).T
        height, width = self._shape
        inside = (cols >= 0) & (rows >= 0) & (cols < width) & (rows < height)
        return rows[inside], cols[inside], inside

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
