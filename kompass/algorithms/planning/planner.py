"""The global planner: a checked, short, smooth path over a known map, or the reason for none."""

from __future__ import annotations

import contextlib
import copy
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kompass.algorithms.distance_field import TOLERANCE, DistanceField
from kompass.algorithms.geometry import Floats
from kompass.algorithms.grid import Grid
from kompass.algorithms.planning.failure import PlanningFailure
from kompass.algorithms.planning.free_space import FreeSpace
from kompass.algorithms.planning.sampling import resolve_planner, search
from kompass.algorithms.planning.shorten import path_length, pull_tight, resample, smooth, spread

# How far a robot that stands too close to something may drive straight to get clear [m].
_ESCAPE = 1.0


@dataclass(frozen=True, eq=False)
class Plan:
    """A path in the map's frame.

    Attributes
    ----------
    poses
        (N, 3) as (x, y, yaw), N ≥ 2, the first one at the start.
    length
        [m]
    min_clearance
        Least distance from an obstacle to where the robot's centre goes [m].
    room
        … to its body [m].
    """

    poses: Floats
    length: float
    min_clearance: float
    room: float


class GlobalPlanner:
    """Plans for a round robot on one map. Building it is the expensive part; keep it per map.

    Parameters
    ----------
    grid
        The map.
    robot_radius
        Of the circle around the robot's footprint [m].
    clearance
        What the path keeps between that circle and every obstacle [m]. A robot that already stands
        closer is led out by the straightest way that comes no closer still.
    unknown_is_obstacle
        Whether unexplored cells are closed to the robot.
    points_per_meter
        Density of the returned poses [1/m].
    planner_id
        An OMPL geometric planner, ``"RRTConnect"`` or ``"ompl.geometric.RRTConnect"``.
    timeout
        For OMPL [s], counted in checks (:data:`sampling.CHECKS_PER_SECOND`). When it runs out a
        search over the grid's cells takes its place.
    seed
        For OMPL; the same input and seed give the same path.
    start_slack
        A robot that stands closer to something than its radius, by so much at most, is led out as
        from within the clearance [m]: cells of what was seen are not exact.

    Raises
    ------
    ValueError
        An argument is out of range, or OMPL has no such planner.
    """

    def __init__(
        self,
        grid: Grid,
        *,
        robot_radius: float,
        clearance: float = 0.1,
        unknown_is_obstacle: bool = True,
        points_per_meter: float = 10,
        planner_id: str = "RRTConnect",
        timeout: float = 1.0,
        seed: int = 1,
        start_slack: float = 0.0,
    ) -> None:
        for name, value, least in (
            ("robot_radius", robot_radius, 0.0),
            ("points_per_meter", points_per_meter, 0.0),
            ("timeout", timeout, 0.0),
        ):
            if not (math.isfinite(value) and value > least):
                raise ValueError(f"{name}: {value}; give a finite number above {least}")
        if not (math.isfinite(clearance) and clearance >= 0):
            raise ValueError(f"clearance: {clearance} m; give 0 or more")
        if not (math.isfinite(start_slack) and start_slack >= 0):
            raise ValueError(f"start_slack: {start_slack} m; give 0 or more")
        self.grid = grid
        self.robot_radius = robot_radius
        self.required = robot_radius + clearance
        self.field = DistanceField(grid, unknown_is_obstacle)
        self._free = self._space()
        self._spacing = 1.0 / points_per_meter
        self._planner = resolve_planner(planner_id)
        self._timeout = timeout
        self._seed = seed
        self._start_slack = start_slack

    def with_clearance(self, clearance: float) -> GlobalPlanner:
        """The same planner with another ``clearance`` [m], for much less than a new one."""
        other = copy.copy(self)
        other.required = self.robot_radius + clearance
        other._free = other._space()
        return other

    def cost(self, poses: ArrayLike) -> float:
        """What a path (N, ≥ 2) costs by the measure of the search: its length [m]."""
        return path_length(np.atleast_2d(np.asarray(poses, dtype=np.float64))[:, :2])

    def check(self, start: ArrayLike, goal: ArrayLike) -> None:
        """Whether a plan from ``start`` (x, y, yaw) to ``goal`` (x, y) exists, without searching.

        Raises
        ------
        PlanningFailure
            It does not; says why, and what the nearest reachable place is.
        """
        self._ends(start, goal)

    def plan(self, start: ArrayLike, goal: tuple[float, float, float | None]) -> Plan:
        """The path from ``start`` (x, y, yaw) to ``goal`` (x, y, yaw or None for "any").

        Every pose and every straight motion between poses keeps the radius and the clearance,
        except that a start inside the clearance is left without coming closer to anything.

        Raises
        ------
        PlanningFailure
            There is none.
        """
        x, y, yaw = (float(value) for value in np.asarray(start, dtype=np.float64))
        first, last = self._ends(start, goal[:2])
        end = np.array([float(goal[0]), float(goal[1])])
        here = np.array([x, y])
        if float(np.hypot(*(end - here))) < 1e-6:
            heading = yaw if goal[2] is None else float(goal[2])
            beside = self.field.at_xy(x, y)
            return Plan(
                np.array([[x, y, yaw], [end[0], end[1], heading]]),
                length=0.0,
                min_clearance=beside,
                room=beside - self.robot_radius,
            )

        origin = here
        clear_start = self.field.at_xy(x, y) >= self.required - TOLERANCE
        if not clear_start:
            origin = self._free.centres(np.array([first]))[0]
        points = self._search(origin, end, first, last)
        points = self._finish(points)
        if not clear_start:
            points = self._leave(here, points)
        return self._to_plan(points, goal[2])

    def blocked(self, poses: ArrayLike, clearance: float = 0.0) -> bool:
        """Whether the body would come nearer than ``clearance`` [m] to an obstacle along poses.

        Parameters
        ----------
        poses
            (N, ≥ 2), N ≥ 1.
        """
        points = np.atleast_2d(np.asarray(poses, dtype=np.float64))[:, :2]
        if len(points) == 1:
            points = np.concatenate([points, points])
        clear = self.field.segments_clear(points[:-1], points[1:], self.robot_radius + clearance)
        return not bool(clear.all())

    def _space(self) -> FreeSpace:
        """Where the robot may be."""
        return FreeSpace(self.field, self.required)

    def _ends(self, start: ArrayLike, goal: ArrayLike) -> tuple[int, int]:
        """The cells through which start and goal enter the graph; raises if there are none."""
        sx, sy = (float(value) for value in np.asarray(start, dtype=np.float64)[:2])
        gx, gy = (float(value) for value in np.asarray(goal, dtype=np.float64)[:2])
        grid, field = self.grid, self.field
        if not (math.isfinite(gx) and math.isfinite(gy) and grid.contains([(gx, gy)])[0]):
            nearest = None
            # Wherever the robot stands: that it may come free is no reason to wait for such a goal.
            with contextlib.suppress(PlanningFailure):
                first = self._start_cell(sx, sy)
                if math.isfinite(gx) and math.isfinite(gy):
                    nearest = self._free.nearest(first, (gx, gy))
            raise PlanningFailure(
                "outside_map", f"The goal ({gx:z.2f}, {gy:z.2f}) is outside the map.", nearest
            )
        first = self._start_cell(sx, sy)
        clearance = field.at_xy(gx, gy)
        if clearance < self.required - TOLERANCE:
            nearest = self._free.nearest(first, (gx, gy))
            raise self._too_close(gx, gy, clearance, nearest)
        last = self._free.entry((gx, gy), 3 * grid.resolution, self.required)
        if last is None or self._free.labels[last] != self._free.labels[first]:
            raise PlanningFailure(
                "unreachable",
                f"No way leads from ({sx:z.2f}, {sy:z.2f}) to the goal ({gx:z.2f}, {gy:z.2f}) for "
                f"a robot that needs {self.required:.2f} m on every side.",
                self._free.nearest(first, (gx, gy)),
            )
        return first, last

    def _start_cell(self, x: float, y: float) -> int:
        if not (math.isfinite(x) and math.isfinite(y) and self.grid.contains([(x, y)])[0]):
            raise PlanningFailure(
                "start_blocked", f"The robot at ({x:z.2f}, {y:z.2f}) is outside the map."
            )
        clearance = self.field.at_xy(x, y)
        if clearance <= max(0.0, self.robot_radius - self._start_slack):
            raise PlanningFailure(
                "start_blocked",
                f"The robot at ({x:z.2f}, {y:z.2f}) is {clearance:.2f} m from an obstacle on the "
                f"map, less than its radius of {self.robot_radius:.2f} m.",
            )
        cell = self._free.entry((x, y), max(_ESCAPE, 3 * self.grid.resolution), self.robot_radius)
        if cell is None:
            raise PlanningFailure(
                "start_blocked",
                f"The robot at ({x:z.2f}, {y:z.2f}) finds no place within {_ESCAPE:.0f} m that has "
                f"{self.required:.2f} m on every side.",
            )
        return cell

    def _too_close(
        self, x: float, y: float, clearance: float, nearest: tuple[float, float]
    ) -> PlanningFailure:
        col, row = (int(value) for value in self.grid.world_to_cell([(x, y)])[0])
        value = int(self.grid.cells[row, col])
        if self.grid.occupied()[row, col]:
            return PlanningFailure(
                "occupied", f"The goal ({x:z.2f}, {y:z.2f}) is inside an obstacle.", nearest
            )
        if value < 0 and self.field.unknown_is_obstacle:
            return PlanningFailure(
                "occupied", f"The goal ({x:z.2f}, {y:z.2f}) is in unexplored space.", nearest
            )
        return PlanningFailure(
            "too_close",
            f"The goal ({x:z.2f}, {y:z.2f}) is {clearance:.2f} m from an obstacle; the robot needs "
            f"{self.required:.2f} m.",
            nearest,
        )

    def _search(self, start: Floats, goal: Floats, first: int, last: int) -> Floats:
        """A tight polyline (N, 2) that is no longer than the shortest one over the grid's cells."""
        field, required = self.field, self.required
        if field.segment_clear(start[0], start[1], goal[0], goal[1], required):
            return np.stack([start, goal])
        best: Floats | None = None
        found = search(
            field,
            required,
            start,
            goal,
            bounds=self._free.bounds(first),
            planner=self._planner,
            timeout=self._timeout,
            seed=self._seed,
        )
        if found is not None and field.segments_clear(found[:-1], found[1:], required).all():
            best = pull_tight(found, field, required)
        # A sampled path may go round the wrong side of something. The grid's shortest path shows
        # it, searched only as far as it could be shorter; it also stands in when sampling fails.
        limit = math.inf if best is None else path_length(best)
        over_cells = self._free.shortest(first, last, limit)
        if over_cells is not None:
            way = np.concatenate([start[None], over_cells[0], goal[None]])
            if field.segments_clear(way[:-1], way[1:], required).all():
                way = pull_tight(way, field, required)
                if best is None or path_length(way) < path_length(best):
                    best = way
        if best is None:
            raise PlanningFailure(
                "no_path",
                f"No path from ({start[0]:z.2f}, {start[1]:z.2f}) to "
                f"({goal[0]:z.2f}, {goal[1]:z.2f}) was found.",
            )
        return best

    def _finish(self, points: Floats) -> Floats:
        """Rounded and equally spaced; where equal steps would cut a corner, nearly equally."""
        band = smooth(points, self.field, self.required, self._spacing)
        clear = self.field.segments_clear(band[:-1], band[1:], self.required)
        if not clear.all():
            band = spread(points, self._spacing)
        even = resample(band, self._spacing)
        clear = self.field.segments_clear(even[:-1], even[1:], self.required)
        return even if clear.all() else spread(band, self._spacing)

    def _leave(self, here: Floats, points: Floats) -> Floats:
        """Prepend the straight way out of the clearance zone, to as late a pose as allowed."""
        away = np.hypot(points[:, 0] - here[0], points[:, 1] - here[1])
        reach = 2.0 * float(away[0]) + 4.0 * self.grid.resolution
        level = min(self.field.at_xy(*here), self.required)
        join = 0
        for index in range(1, len(points)):
            if away[index] > reach:
                break
            if self.field.segment_clear(
                here[0], here[1], points[index, 0], points[index, 1], level
            ):
                join = index
        rest = points[join:]
        return np.concatenate([spread(np.stack([here, rest[0]]), self._spacing), rest[1:]])

    def _to_plan(self, points: Floats, goal_yaw: float | None) -> Plan:
        delta = np.diff(points, axis=0)
        headings = np.arctan2(delta[:, 1], delta[:, 0])
        yaw = np.append(headings, headings[-1] if goal_yaw is None else float(goal_yaw))
        dense = spread(points, self.grid.resolution / 2.0)
        beside = float(self.field.at(dense).min())
        return Plan(
            poses=np.column_stack([points, yaw]),
            length=path_length(points),
            min_clearance=beside,
            room=beside - self.robot_radius,
        )
