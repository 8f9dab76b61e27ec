"""The global planner of a car: curves that its wheels can be steered to, driven ahead and back.

A search over poses joined by short arcs of the tightest turn and straight legs (hybrid A*: D.
Dolgov, S. Thrun, M. Montemerlo, J. Diebel, "Path Planning for Autonomous Vehicles in Unknown
Semi-structured Environments", IJRR 2010), led by what the way over cells costs and ended by the
shortest curves of a car in the open (J. Reeds, L. Shepp, "Optimal paths for a car that goes both
forwards and backwards", Pacific J. Math. 1990), which OMPL computes. Every pose is looked at under
the whole outline.
"""

from __future__ import annotations

import heapq
import itertools
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from ompl import base

from kompass.algorithms.distance_field import TOLERANCE
from kompass.algorithms.following.gears import Leg, legs_of
from kompass.algorithms.following.path_tracker import PathTracker
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, wrap_angle
from kompass.algorithms.grid import Grid
from kompass.algorithms.planning.failure import PlanningFailure
from kompass.algorithms.planning.outline_planner import OutlinePlanner
from kompass.algorithms.planning.planner import Plan

# A metre driven back counts for so many, and a change of direction for so many metres.
_BACK, _CHANGE = 2.0, 0.6
# A change from one curve to another, and a metre of the tightest curve, for so many metres more.
_SWERVE, _BENT = 0.05, 0.05
_HEADINGS = 24  # that poses are told apart by
_ARC = 0.5  # rad of the tightest turn that one leg of the search turns by
_BATCH = 16  # poses that are gone on from together
_MOST = 40_000  # poses that are gone on from in all
_SHOTS = 4  # batches between two tries to end in one curve
_FEW = 0.2  # m between the first looks along one
_ANY = 12  # headings that are tried at a goal that any will do for
_LOOKS = 4  # of them that are looked at closely
# Where no way over cells is known a metre counts for so many.
_UNLIKELY = 5.0
_SHORTCUTS = 0.4  # m between the places of a way that curves are tried between
_LONGEST = 4.0  # m of way that such a curve may take the place of
# To tell where a curve turns back [m].
_TINY = 1e-4
# By so much for each metre on the way a car that stands too close to something must come away.
_LEAVE = 0.1
# A car that is off its path steers to what lies so far ahead on it, and at the end of a leg at
# least so far beyond; so much of its way is looked at [m].
_AIM, _BEYOND, _REACH = 0.35, 0.12, 1.5


@dataclass(frozen=True, eq=False)
class _Arrival:
    """An end of the search: a curve to the goal."""

    poses: Floats
    backward: bool  # at its end


@dataclass(eq=False)
class _Tree:
    """The poses that the search has come to, and how."""

    pose: list[tuple[float, float, float]] = field(default_factory=list)
    before: list[int] = field(default_factory=list)
    cost: list[float] = field(default_factory=list)
    leg: list[int] = field(default_factory=list)  # which one led there

    def add(self, pose: tuple[float, float, float], before: int, cost: float, leg: int) -> int:
        self.pose.append(pose)
        self.before.append(before)
        self.cost.append(cost)
        self.leg.append(leg)
        return len(self.pose) - 1


class CarPlanner(OutlinePlanner):
    """Plans for a robot with steered wheels; see :class:`OutlinePlanner` for what is not told here.

    The yaw of a pose is where the car faces. Where that is against the way to the next pose it
    drives back. No part of a path is bent tighter than ``turning_radius``, and nowhere does it
    turn on the spot.

    Parameters
    ----------
    turning_radius
        Of the tightest turn of the base frame's origin, which is on the axle that is not
        steered [m].

    Raises
    ------
    ValueError
        An argument is out of range.
    """

    def __init__(
        self,
        grid: Grid,
        *,
        footprint: Footprint,
        turning_radius: float,
        clearance: float = 0.1,
        least: float | None = None,
        unknown_is_obstacle: bool = True,
        points_per_meter: float = 10,
        start_slack: float = 0.0,
    ) -> None:
        if not (math.isfinite(turning_radius) and turning_radius > 0):
            raise ValueError(f"turning_radius: {turning_radius} m; give a finite number above 0")
        super().__init__(
            grid,
            footprint=footprint,
            clearance=clearance,
            least=least,
            unknown_is_obstacle=unknown_is_obstacle,
            points_per_meter=points_per_meter,
            start_slack=start_slack,
        )
        self.turning_radius = turning_radius
        self._curves = _Curves(turning_radius)
        step = max(_ARC * turning_radius, 3.0 * grid.resolution)
        self._bin = 0.6 * step
        looks = math.ceil(step / grid.resolution)
        bends = np.array([-1.0, 0.0, 1.0])
        self._bend = np.concatenate([bends, bends])
        self._backward = np.repeat([False, True], len(bends))
        way = step * (np.arange(looks) + 1.0) / looks
        signed = np.where(self._backward, -1.0, 1.0)[:, None] * way
        turn = signed * self._bend[:, None] / turning_radius
        chord = signed * np.sinc(turn / 2.0 / math.pi)
        # Poses (legs, looks, 3) on the way of each, from the origin.
        self._legs = np.stack(
            [chord * np.cos(turn / 2.0), chord * np.sin(turn / 2.0), turn], axis=2
        )
        self._step = step

    def plan(
        self,
        start: ArrayLike,
        goal: tuple[float, float, float | None],
        most: float = math.inf,
    ) -> Plan:
        """The path from ``start`` (x, y, yaw) to ``goal`` (x, y, yaw or None for "any").

        All along it the body keeps what it must from obstacles, except that where it starts closer
        it comes away from there.

        Parameters
        ----------
        most
            What it may cost, by :meth:`cost` [m]: that there is no cheaper one than a path that is
            known is found out much sooner than another path.

        Raises
        ------
        PlanningFailure
            There is none.
        """
        x, y, yaw = (float(value) for value in np.asarray(start, dtype=np.float64))
        _, last = self._ends(start, goal[:2])
        end = (float(goal[0]), float(goal[1]), None if goal[2] is None else float(goal[2]))
        heading = yaw if end[2] is None else end[2]
        if math.hypot(end[0] - x, end[1] - y) < 1e-6 and abs(wrap_angle(heading - yaw)) < 1e-6:
            return self._judged(np.array([[x, y, yaw], [end[0], end[1], heading]]), 0.0)
        to_go = self._outline.costs_to(last, unlikely=_UNLIKELY)
        found = self._searched((x, y, yaw), end, to_go, most)
        if found is None:
            raise PlanningFailure(
                "no_path",
                f"No path from ({x:z.2f}, {y:z.2f}) to ({end[0]:z.2f}, {end[1]:z.2f}) was found "
                f"that the robot fits through and can be steered along: its tightest turn has a "
                f"radius of {self.turning_radius:.2f} m.",
            )
        poses = self._spaced(self._shortened(found))
        return self._judged(poses, float(np.hypot(*np.diff(poses[:, :2], axis=0).T).sum()))

    def blocked(self, poses: ArrayLike, clearance: float = 0.0) -> bool:
        """Whether the body would come nearer than ``clearance`` [m] to an obstacle along poses.

        Parameters
        ----------
        poses
            (N, 3), N ≥ 1; the body faces as they say.
        """
        given = np.atleast_2d(np.asarray(poses, dtype=np.float64))
        return bool(len(self._overlaps(given, clearance)))

    def loses(self, pose: ArrayLike, poses: ArrayLike, radius: float) -> bool:
        """Whether a car that is beside a path, or faces off it, would touch something on its way.

        Steered wheels cannot turn it to where the path leads: it comes back to it by a curve, which
        may lead through something although the path does not. Then only another path helps, which
        begins where the car is.

        Parameters
        ----------
        pose
            (x, y, yaw) of the car.
        poses
            What is left of the path (N, 3), N ≥ 1.
        radius
            Of the tightest turn that its wheels can be steered to [m].
        """
        here = np.asarray(pose, dtype=np.float64)
        driven = [here[None]]
        left = _REACH
        for leg in legs_of(np.atleast_2d(np.asarray(poses, dtype=np.float64))):
            part = _steered_back(driven[-1][-1], leg, radius, left, self.grid.resolution)
            driven.append(part)
            left -= self.grid.resolution * (len(part) - 1)
            if left <= 0.0:
                break
        return bool(len(self._overlaps(np.concatenate(driven), 0.0)))

    def cost(self, poses: ArrayLike) -> float:
        """What a path (N, 3) costs by the measure of the search: its length, or more [m]."""
        given = np.atleast_2d(np.asarray(poses, dtype=np.float64))
        if len(given) < 2:
            return 0.0
        room = self._room(given)
        steps = np.hypot(*np.diff(given[:, :2], axis=0).T)
        back = _backward(given)
        changes = np.count_nonzero(back[1:] != back[:-1])
        dearer = self._outline.dearer(room)
        way = steps * (dearer[:-1] + dearer[1:]) / 2.0 * np.where(back, _BACK, 1.0)
        bent = np.abs(wrap_angle(np.diff(given[:, 2]))).sum() * self.turning_radius
        return float(way.sum() + _CHANGE * changes + _BENT * bent)

    def _dense(self, poses: Floats) -> Floats:
        """Between two poses the body turns as it goes."""
        return _between(poses, self.grid.resolution / 2.0)

    # -- the search ---------------------------------------------------------------------------

    def _searched(
        self,
        start: tuple[float, float, float],
        goal: tuple[float, float, float | None],
        to_go: Floats,
        most: float,
    ) -> Floats | None:
        """Poses (N, 3) close to each other that lead to the goal; None when there are none."""
        tree, ends = _Tree(), dict[int, _Arrival]()
        here = np.array([start])
        room = float(self._room(here)[0])
        best = {self._key(here)[0]: 0.0}
        root = tree.add(start, -1, 0.0, -1)
        order = itertools.count()
        waiting = [(self._left(here, to_go)[0], next(order), root)]
        expanded = 0
        for turn in itertools.count():
            batch = list[int]()
            while waiting and len(batch) < _BATCH:
                about, _, node = waiting[0]
                if about > most:
                    break  # and so does all that is left
                if node in ends:
                    if not batch:
                        return self._traced(tree, node, ends[node])
                    break
                heapq.heappop(waiting)
                batch.append(node)
            if not batch or expanded >= _MOST:
                return None
            expanded += len(batch)
            if turn % _SHOTS == 0:
                left = self._left(np.array([tree.pose[node] for node in batch]), to_go)
                node = batch[int(np.argmin(left))]
                if (shot := self._shot(tree, node, goal, start, room)) is not None:
                    cost, arrival = shot
                    end = tree.add(tuple(arrival.poses[-1]), node, cost, -1)
                    ends[end] = arrival
                    heapq.heappush(waiting, (cost, next(order), end))
            self._go_on(tree, batch, best, to_go, (start, room), waiting, order)
        return None

    def _go_on(
        self,
        tree: _Tree,
        batch: list[int],
        best: dict[int, float],
        to_go: Floats,
        begin: tuple[tuple[float, float, float], float],
        waiting: list[tuple[float, int, int]],
        order: itertools.count[int],
    ) -> None:
        """All legs from a batch of poses, as far as the body fits and nothing cheaper is known."""
        at = np.array([tree.pose[node] for node in batch])
        x, y, yaw = at.T[:, :, None, None]
        legs = self._legs
        cos, sin = np.cos(yaw), np.sin(yaw)
        px = x + cos * legs[..., 0] - sin * legs[..., 1]
        py = y + sin * legs[..., 0] + cos * legs[..., 1]
        poses = np.stack([px, py, yaw + legs[..., 2]], axis=-1)
        n, m, looks, _ = poses.shape
        room = self._room(poses.reshape(-1, 3)).reshape(n, m, looks)
        needed = self._needed(poses.reshape(-1, 3), *begin).reshape(n, m, looks)
        fits = (room >= needed).all(axis=2)
        dearer = self._outline.dearer(room).mean(axis=2)
        price = self._step * (dearer * np.where(self._backward, _BACK, 1.0))
        price += _BENT * self._step * np.abs(self._bend)
        node, leg = np.nonzero(fits)
        if not len(node):
            return
        after = poses[node, leg, -1]
        after[:, 2] = wrap_angle(after[:, 2])
        cost = price[node, leg]
        keys, left = self._key(after), self._left(after, to_go)
        for index, (parent, which) in enumerate(zip(node.tolist(), leg.tolist(), strict=True)):
            parent = batch[parent]
            before = tree.leg[parent]
            total = tree.cost[parent] + float(cost[index])
            if before >= 0:
                if self._backward[before] != self._backward[which]:
                    total += _CHANGE
                total += _SWERVE * abs(self._bend[before] - self._bend[which])
            # Ahead and back are told apart: who comes to a place in reverse must change there.
            key = 2 * keys[index] + int(self._backward[which])
            if best.get(key, math.inf) <= total:
                continue
            best[key] = total
            x, y, yaw = after[index].tolist()
            child = tree.add((x, y, yaw), parent, total, which)
            heapq.heappush(waiting, (total + left[index], next(order), child))

    def _shot(
        self,
        tree: _Tree,
        node: int,
        goal: tuple[float, float, float | None],
        start: tuple[float, float, float],
        room: float,
    ) -> tuple[float, _Arrival] | None:
        """What the goal costs by the cheapest of a few curves from a pose that the body fits."""
        here = tree.pose[node]
        headings = [goal[2]] if goal[2] is not None else _headings(here, goal)
        lengths = [self._curves.length(here, (*goal[:2], yaw)) for yaw in headings]
        shots = []
        for which in np.argsort(lengths, kind="stable")[:_LOOKS].tolist():
            end = (*goal[:2], headings[which])
            # A few looks tell of most curves that they lead through something.
            few = self._curves.some(here, end, _FEW)
            if (self._room(few) < self._needed(few, start, room)).any():
                continue
            poses = self._curves.poses(here, end, self.grid.resolution)
            if (self._room(poses) < self._needed(poses, start, room)).any():
                continue
            back = _backward(poses)
            cost = tree.cost[node] + self.cost(poses)
            if tree.leg[node] >= 0 and self._backward[tree.leg[node]] != back[0]:
                cost += _CHANGE
            shots.append((cost, _Arrival(poses, bool(back[-1]))))
        return min(shots, key=lambda shot: shot[0]) if shots else None

    def _needed(self, poses: Floats, start: tuple[float, float, float], room: float) -> Floats:
        """What room (N,) the body must have at poses (N, 3) on a way from the start [m]."""
        if room >= self._least:
            return np.full(len(poses), self._least - TOLERANCE)
        # Who stands too close already may go wherever he comes no closer.
        gone = np.hypot(poses[:, 0] - start[0], poses[:, 1] - start[1])
        coming = max(room, -self._start_slack) + _LEAVE * gone - 0.005
        return np.minimum(self._least, coming) - TOLERANCE

    def _key(self, poses: Floats) -> list[int]:
        """One number for all poses (N, 3) that are as good as the same."""
        cells = np.floor((poses[:, :2] - self.grid.origin[:2]) / self._bin).astype(np.int64)
        turn = np.rint(poses[:, 2] * (_HEADINGS / math.tau)).astype(np.int64) % _HEADINGS
        keys: list[int] = (
            ((cells[:, 0] + 2**20) * 2**21 + cells[:, 1] + 2**20) * 32 + turn
        ).tolist()
        return keys

    def _left(self, poses: Floats, to_go: Floats) -> list[float]:
        """What is left to the goal (N,) [m]; what leaves the map leads nowhere."""
        grid = self.grid
        cells = grid.world_to_cell(poses[:, :2])
        inside = (cells >= 0).all(axis=1) & (cells < (grid.width, grid.height)).all(axis=1)
        ids = np.where(inside, cells[:, 1] * grid.width + cells[:, 0], 0)
        left: list[float] = np.where(inside, to_go[ids], math.inf).tolist()
        return left

    def _traced(self, tree: _Tree, node: int, end: _Arrival) -> Floats:
        """The poses (N, 3) on the way to an end."""
        parts = [end.poses]
        at = tree.before[node]
        while tree.before[at] >= 0:
            parent = tree.before[at]
            x, y, yaw = tree.pose[parent]
            leg = self._legs[tree.leg[at]]
            cos, sin = math.cos(yaw), math.sin(yaw)
            parts.append(
                np.column_stack(
                    [
                        x + cos * leg[:, 0] - sin * leg[:, 1],
                        y + sin * leg[:, 0] + cos * leg[:, 1],
                        yaw + leg[:, 2],
                    ]
                )
            )
            at = parent
        parts.append(np.array([tree.pose[at]]))
        # What ends where the next begins is told once.
        way: Floats = np.concatenate(parts[::-1])
        moved = np.hypot(*np.diff(way[:, :2], axis=0).T) > 1e-6
        kept: Floats = way[np.concatenate([[True], moved])]
        return kept

    # -- a smoother way -----------------------------------------------------------------------

    def _shortened(self, way: Floats) -> Floats:
        """A way (N, 3) with curves in place of what they are cheaper than."""
        steps = np.hypot(*np.diff(way[:, :2], axis=0).T)
        along = np.concatenate([[0.0], np.cumsum(steps)])
        count = max(2, math.ceil(along[-1] / _SHORTCUTS) + 1)
        places = np.unique(np.searchsorted(along, np.linspace(0.0, along[-1], count) - 1e-9))
        places = np.unique(np.append(places, [0, len(way) - 1]))
        start, room = (float(way[0, 0]), float(way[0, 1]), float(way[0, 2])), self._room(way[:1])
        parts, at = [way[:1]], 0
        while at < len(places) - 1:
            here = tuple(way[places[at]].tolist())
            chosen = way[places[at] : places[at + 1] + 1]
            onward = at + 1
            reach = along[places] <= along[places[at]] + _LONGEST
            for to in range(int(np.flatnonzero(reach)[-1]), at + 1, -1):
                old = way[places[at] : places[to] + 1]
                length = self._curves.length(here, tuple(way[places[to]].tolist()))
                if length > along[places[to]] - along[places[at]] + 1e-6:
                    continue
                new = self._curves.poses(here, tuple(way[places[to]].tolist()), self._bin / 2.0)
                if (
                    self._room(_between(new, self.grid.resolution))
                    < self._needed(_between(new, self.grid.resolution), start, float(room[0]))
                ).any():
                    continue
                if self.cost(new) < self.cost(old) - 1e-3:
                    chosen, onward = new, to
                    break
            parts.append(chosen[1:])
            at = onward
        return np.concatenate(parts)

    def _spaced(self, way: Floats) -> Floats:
        """A way (N, 3) as poses at most ``1 / points_per_meter`` apart, its turning points kept."""
        back = _backward(way)
        cuts = [0, *(np.flatnonzero(back[1:] != back[:-1]) + 1).tolist(), len(way) - 1]
        parts = [way[:1]]
        for first, last in itertools.pairwise(cuts):
            leg = way[first : last + 1]
            steps = np.hypot(*np.diff(leg[:, :2], axis=0).T)
            along = np.concatenate([[0.0], np.cumsum(steps)])
            n = max(1, math.ceil(along[-1] / self._spacing - 1e-9))
            at = np.linspace(0.0, along[-1], n + 1)[1:]
            yaw = np.unwrap(leg[:, 2])
            parts.append(
                np.column_stack(
                    [np.interp(at, along, each) for each in (leg[:, 0], leg[:, 1], yaw)]
                )
            )
        return np.concatenate(parts)


class _Curves:
    """The shortest ways of a car in the open, by OMPL."""

    def __init__(self, radius: float) -> None:
        self._space = base.ReedsSheppStateSpace(radius)
        bounds = base.RealVectorBounds(2)
        bounds.setLow(-1e6)
        bounds.setHigh(1e6)
        self._space.setBounds(bounds)
        self._states = [self._space.allocState() for _ in range(3)]

    def length(self, a: tuple[float, ...], b: tuple[float, ...]) -> float:
        """Of the shortest one [m]."""
        first, last, _ = self._between(a, b)
        return float(self._space.distance(first, last))

    def some(self, a: tuple[float, ...], b: tuple[float, ...], spacing: float) -> Floats:
        """Poses (N, 3) on it, at most ``spacing`` [m] apart."""
        first, last, state = self._between(a, b)
        count = max(1, math.ceil(self._space.distance(first, last) / spacing))
        out = np.empty((count + 1, 3))
        for index in range(count + 1):
            self._space.interpolate(first, last, index / count, state)
            out[index] = state.getX(), state.getY(), state.getYaw()
        return out

    def poses(self, a: tuple[float, ...], b: tuple[float, ...], spacing: float) -> Floats:
        """Poses (N, 3) on it, at most ``spacing`` [m] apart; its turning points are among them."""
        first, last, state = self._between(a, b)
        length = float(self._space.distance(first, last))

        def at(way: float) -> tuple[float, float, float]:
            self._space.interpolate(first, last, min(max(way / length, 0.0), 1.0), state)
            return state.getX(), state.getY(), state.getYaw()

        def is_back(way: float) -> bool:
            x, y, yaw = at(way)
            to_x, to_y, _ = at(way + _TINY)
            return math.cos(yaw) * (to_x - x) + math.sin(yaw) * (to_y - y) < 0.0

        if length < _TINY:
            return np.array([a, b])
        places = np.linspace(0.0, length, max(1, math.ceil(length / spacing)) + 1).tolist()
        out = [at(0.0)]
        for low, high in itertools.pairwise(places):
            before = is_back(low)
            if is_back(high - _TINY) != before:
                begin, end = low, high
                while end - begin > _TINY:
                    middle = (begin + end) / 2.0
                    begin, end = (middle, end) if is_back(middle) == before else (begin, middle)
                out.append(at(end))
            out.append(at(high))
        return np.array(out, dtype=np.float64)

    def _between(self, a: tuple[float, ...], b: tuple[float, ...]) -> list[Any]:
        for state, (x, y, yaw) in zip(self._states, (a, b), strict=False):
            state.setXY(x, y)
            state.setYaw(float(wrap_angle(yaw)))
        return self._states


def _headings(here: tuple[float, float, float], goal: tuple[float, float, Any]) -> list[float]:
    """Those that are tried at a goal which says none, as it lies before the car among them."""
    first = math.atan2(goal[1] - here[1], goal[0] - here[0])
    return [first + index * math.tau / _ANY for index in range(_ANY)]


def _backward(poses: Floats) -> NDArray[np.bool_]:
    """Which steps (N - 1,) between poses (N, 3) are driven back."""
    delta: Floats = np.diff(poses[:, :2], axis=0)
    middle = poses[:-1, 2] + wrap_angle(np.diff(poses[:, 2])) / 2.0
    return delta[:, 0] * np.cos(middle) + delta[:, 1] * np.sin(middle) < 0.0


def _steered_back(here: Floats, leg: Leg, radius: float, most: float, step: float) -> Floats:
    """The poses (N, 3) of a car on a leg that it is off, a step apart, the one it has first.

    It steers to a place ahead on the leg, as pure pursuit does, no tighter than its wheels can.
    """
    tracker, gear = PathTracker(leg.poses), -1.0 if leg.backward else 1.0
    x, y, yaw = here.tolist()
    out = [(x, y, yaw)]
    for _ in range(math.ceil(most / step)):
        tracker.advance(x, y)
        if tracker.remaining < step / 2.0:
            break
        aim = tracker.progress + min(_AIM, max(tracker.remaining, _BEYOND))
        to_x, to_y = tracker.point_at(aim)
        ahead = gear * (math.cos(yaw) * (to_x - x) + math.sin(yaw) * (to_y - y))
        left = gear * (math.cos(yaw) * (to_y - y) - math.sin(yaw) * (to_x - x))
        tightest = 1.0 / radius
        bend = 2.0 * left / max(ahead * ahead + left * left, 1e-6)
        turn = step * min(max(bend, -tightest), tightest)
        x += gear * step * math.cos(yaw + turn / 2.0)
        y += gear * step * math.sin(yaw + turn / 2.0)
        yaw += turn
        out.append((x, y, yaw))
    return np.array(out)


def _between(poses: Floats, spacing: float) -> Floats:
    """Poses (N, 3) with others between them, at most ``spacing`` [m] apart."""
    if len(poses) < 2:
        return poses
    legs = np.diff(poses, axis=0)
    legs[:, 2] = wrap_angle(legs[:, 2])
    lengths = np.hypot(legs[:, 0], legs[:, 1])
    parts = np.maximum(1, np.ceil(lengths / spacing - 1e-9)).astype(int)
    leg = np.repeat(np.arange(len(legs)), parts)
    share = (np.arange(len(leg)) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[leg]
    inner = poses[leg] + legs[leg] * share[:, None]
    return np.concatenate([inner, poses[-1:]])
