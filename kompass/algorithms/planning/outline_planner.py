"""The global planner of a body that is not round, which passes where its circle would not fit.

A way over cells by what it costs (its length, and the room that is missed), straightened by the
same measure, rounded by an elastic band that obstacles push at any part of the body, and at last
looked at pose by pose under the whole outline. Where that shows an overlap, the place is made dear
and the search begins anew: what is returned overlaps with nothing.
"""

from __future__ import annotations

import copy
import math

import numpy as np
from numpy.typing import ArrayLike

from kompass.algorithms.distance_field import TOLERANCE
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, wrap_angle
from kompass.algorithms.grid import Grid
from kompass.algorithms.planning.failure import PlanningFailure
from kompass.algorithms.planning.free_space import FreeSpace
from kompass.algorithms.planning.outline_space import OutlineSpace
from kompass.algorithms.planning.planner import GlobalPlanner, Plan
from kompass.algorithms.planning.shorten import path_length, resample, spread

_TRIES = 6  # searches, each round what the one before had overlooked
_CANDIDATES = 40  # places along a way between which straight connections are tried
_LONGEST = 4.0  # m of such a connection
_LOOK = 0.15  # m between two looks along one
_SWEEPS = 30  # of the elastic band
_SPACING = 0.1  # m between its nodes
_TURN = 0.15  # rad between two looks at a body that turns
# By so much for each metre on the way a robot that stands too close to something must come away.
_LEAVE = 0.1


class OutlinePlanner(GlobalPlanner):
    """Plans for a body with corners; see :class:`GlobalPlanner` for what is not told here.

    A robot that is led along the path faces along it. At corners of the path it turns on the
    spot, which is looked at, too; to face along the first leg is up to whoever follows.

    Parameters
    ----------
    footprint
        The body.
    clearance
        What the path keeps between body and obstacles [m] wherever no way round is several times
        as long.
    least
        … and what it keeps in any case [m]; ``clearance`` when left out.
    """

    def __init__(
        self,
        grid: Grid,
        *,
        footprint: Footprint,
        clearance: float = 0.1,
        least: float | None = None,
        unknown_is_obstacle: bool = True,
        points_per_meter: float = 10,
        start_slack: float = 0.0,
    ) -> None:
        self._body = footprint
        self._least = clearance if least is None else min(least, clearance)
        self._clearance = clearance
        super().__init__(
            grid,
            robot_radius=footprint.inscribed_radius,
            clearance=self._least,
            unknown_is_obstacle=unknown_is_obstacle,
            points_per_meter=points_per_meter,
            start_slack=start_slack,
        )

    def _space(self) -> FreeSpace:
        self._outline = OutlineSpace(self.field, self._body, self._least, self._clearance)
        return self._outline

    def plan(self, start: ArrayLike, goal: tuple[float, float, float | None]) -> Plan:
        """The path from ``start`` (x, y, yaw) to ``goal`` (x, y, yaw or None for "any").

        All along it the body keeps what it must from obstacles, turning included, except that
        where it starts closer it comes away from there.

        Raises
        ------
        PlanningFailure
            There is none.
        """
        x, y, yaw = (float(value) for value in np.asarray(start, dtype=np.float64))
        first, last = self._ends(start, goal[:2])
        here, end = np.array([x, y]), np.array([float(goal[0]), float(goal[1])])
        if float(np.hypot(*(end - here))) < 1e-6:
            heading = yaw if goal[2] is None else float(goal[2])
            poses = np.array([[x, y, yaw], [end[0], end[1], heading]])
            return self._judged(poses, 0.0)
        space = self._outline.copied()  # the search changes it
        for _ in range(_TRIES):
            found = space.shortest(first, last)
            if found is None:
                break
            way = np.concatenate([here[None], found[0], end[None]])
            way = self._straightened(way)
            bad: Floats = np.empty((0, 2))
            for points in (self._rounded(way), way):
                even = resample(points, self._spacing)
                for path in (even, spread(points, self._spacing)):
                    poses = _facing(path, goal[2])
                    bad = self._overlaps(poses)
                    if not len(bad):
                        return self._judged(poses, path_length(path))
            space.avoid(bad, 2 * self.grid.resolution)
        raise PlanningFailure(
            "no_path",
            f"No path from ({x:z.2f}, {y:z.2f}) to ({end[0]:z.2f}, {end[1]:z.2f}) was found that "
            "the robot fits through.",
        )

    def with_clearance(self, clearance: float) -> OutlinePlanner:
        """The same planner with another ``clearance`` [m], which is kept in any case."""
        other = copy.copy(self)
        other._clearance = other._least = clearance
        other.required = other.robot_radius + clearance
        other._free = other._space()
        return other

    def blocked(self, poses: ArrayLike, clearance: float = 0.0) -> bool:
        """Whether the body would come nearer than ``clearance`` [m] to an obstacle along poses.

        Parameters
        ----------
        poses
            (N, ≥ 2), N ≥ 1; the body faces along them.
        """
        points = np.atleast_2d(np.asarray(poses, dtype=np.float64))[:, :2]
        if len(points) == 1:
            return bool(self.field.at(points)[0] < self.robot_radius + clearance - TOLERANCE)
        return bool(len(self._overlaps(_facing(points, None), clearance)))

    def cost(self, poses: ArrayLike) -> float:
        """What a path (N, ≥ 2) costs by the measure of the search: its length, or more [m]."""
        points = np.atleast_2d(np.asarray(poses, dtype=np.float64))[:, :2]
        if len(points) < 2:
            return 0.0
        facing = _facing(points, None)
        steps = np.hypot(*np.diff(points, axis=0).T)
        dearer = self._outline.dearer(self._room(facing))
        return float((steps * (dearer[:-1] + dearer[1:]) / 2.0).sum())

    def _dense(self, poses: Floats) -> Floats:
        """Poses close to each other on the way over some."""
        return _dense(poses, self.grid.resolution / 2.0)

    def _room(self, poses: Floats) -> Floats:
        """Distance (N,) between body and obstacles at poses (N, 3) [m], at most too small."""
        middle = self.field.at(poses[:, :2])
        # In the open its circle says enough.
        out = middle - self._body.radius
        near = out < self._outline.ample
        out[near] = np.minimum(
            self._beside(poses[near])[0].min(axis=1) - self._body.discs[1],
            middle[near] - self._body.inscribed_radius,
        )
        return out

    def _beside(self, poses: Floats) -> tuple[Floats, Floats]:
        """The discs of the body at poses (N, 3): distances (N, K) and places (N, K, 2) [m]."""
        centres, _ = self._body.discs
        cos, sin = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
        x = poses[:, 0, None] + cos * centres[:, 0] - sin * centres[:, 1]
        y = poses[:, 1, None] + sin * centres[:, 0] + cos * centres[:, 1]
        places = np.stack([x, y], axis=2)
        return self.field.at(places.reshape(-1, 2)).reshape(x.shape), places

    def _overlaps(self, poses: Floats, least: float | None = None) -> Floats:
        """Places (N, 2) on the way over poses where the body keeps less than it must."""
        least = self._least if least is None else least
        dense = self._dense(poses)
        room = self._room(dense)
        # Who stands too close already may go wherever he comes no closer.
        gone = np.hypot(*(dense[:, :2] - dense[0, :2]).T)
        needed = np.minimum(least, max(room[0], -self._start_slack) + _LEAVE * gone - 0.005)
        if room[0] >= least:
            needed = np.full(len(dense), least)
        return dense[room < needed - TOLERANCE, :2]

    def _judged(self, poses: Floats, length: float) -> Plan:
        dense = self._dense(poses)
        return Plan(
            poses=poses,
            length=length,
            min_clearance=float(self.field.at(dense[:, :2]).min()),
            room=float(self._room(dense).min()),
        )

    def _straightened(self, way: Floats) -> Floats:
        """The cheapest chain of straight legs between places of a way (N, 2)."""
        length = path_length(way)
        spacing = max(length / _CANDIDATES, self.grid.resolution)
        places = resample(way, spacing)
        n = len(places)
        i, j = np.triu_indices(n, k=1)
        near = np.hypot(*(places[j] - places[i]).T) <= max(_LONGEST, 2.0 * spacing)
        i, j = i[near], j[near]
        legs = places[j] - places[i]
        lengths = np.hypot(legs[:, 0], legs[:, 1])
        counts = np.maximum(2, np.ceil(lengths / _LOOK).astype(int) + 1)
        leg = np.repeat(np.arange(len(i)), counts)
        nth = np.arange(len(leg)) - np.repeat(np.cumsum(counts) - counts, counts)
        share = nth / (counts[leg] - 1)
        at = places[i][leg] + legs[leg] * share[:, None]
        room = self._room(np.column_stack([at, np.arctan2(legs[:, 1], legs[:, 0])[leg]]))
        dearer = self._outline.dearer(room)
        # What is too narrow is not forbidden: the way itself may be, until it is rounded.
        dearer = dearer + 100.0 * np.clip(self._least - room, 0.0, 1.0)
        starts = np.cumsum(counts) - counts
        price = lengths * np.add.reduceat(dearer, starts) / counts
        cost = np.full(n, math.inf)
        cost[0] = 0.0
        before = np.zeros(n, dtype=np.int64)
        table = np.full((n, n), math.inf)
        table[i, j] = price
        for k in range(1, n):
            through = cost[:k] + table[:k, k]
            before[k] = int(np.argmin(through))
            cost[k] = through[before[k]]
        chain = [n - 1]
        while chain[-1]:
            chain.append(int(before[chain[-1]]))
        return places[chain[::-1]]

    def _rounded(self, way: Floats) -> Floats:
        """An elastic band from a way (N, 2), which obstacles push at any part of the body."""
        band = resample(way, _SPACING)
        n = len(band)
        if n < 3:
            return way
        radius = self._body.discs[1]
        wanted = self._clearance + 0.05
        for _ in range(_SWEEPS):
            ahead = band[2:] - band[:-2]
            yaw = np.arctan2(ahead[:, 1], ahead[:, 0])
            middle = band[1:-1]
            move = 0.5 * ((band[:-2] + band[2:]) / 2.0 - middle)
            near = np.flatnonzero(self.field.at(middle) < self._body.radius + wanted)
            if near.size:
                at, places = self._beside(np.column_stack([middle[near], yaw[near]]))
                worst = np.argmin(at, axis=1)
                rows = np.arange(len(near))
                lack = np.clip(wanted - (at[rows, worst] - radius), 0.0, 0.1)
                push = self.field.gradient(places[rows, worst]) * lack[:, None]
                # Across the way only: along it a push moves nothing but the nodes.
                across = np.column_stack([-np.sin(yaw[near]), np.cos(yaw[near])])
                move[near] += 0.4 * (push * across).sum(axis=1)[:, None] * across
            band[1:-1] = middle + move
        return band


def _facing(points: Floats, last: float | None) -> Floats:
    """Poses (N, 3) that face along their way, the last one as it is to."""
    delta = np.diff(points, axis=0)
    headings = np.arctan2(delta[:, 1], delta[:, 0])
    yaw = np.append(headings, headings[-1] if last is None else float(last))
    return np.column_stack([points, yaw])


def _dense(poses: Floats, spacing: float) -> Floats:
    """Poses on a way: along its legs, facing along them, and turning where two of them meet."""
    legs = np.diff(poses[:, :2], axis=0)
    lengths = np.hypot(legs[:, 0], legs[:, 1])
    headings = poses[:-1, 2]
    parts = np.maximum(1, np.ceil(lengths / spacing - 1e-9)).astype(int)
    turns = np.asarray(wrap_angle(poses[1:, 2] - headings))
    looks = np.ceil(np.abs(turns) / _TURN).astype(int)
    count = parts + looks + 1
    leg = np.repeat(np.arange(len(legs)), count)
    nth = np.arange(len(leg)) - np.repeat(np.cumsum(count) - count, count)
    share = np.minimum(nth / parts[leg], 1.0)
    turned = np.clip((nth - parts[leg]) / np.maximum(looks[leg], 1), 0.0, 1.0)
    out = np.empty((len(leg), 3))
    out[:, :2] = poses[leg, :2] + legs[leg] * share[:, None]
    out[:, 2] = headings[leg] + turns[leg] * turned
    return out
