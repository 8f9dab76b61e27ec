"""One goal from its acceptance to its end: arrived, refused, blocked, stuck, stopped.

No ROS and no clock: time is an argument [s], so every way to end is tested without waiting.
"""

import enum
import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.geometry import Pose2D, wrap_angle

FREE_HEADING = math.pi  # rad; a tolerance from here on asks for no heading


class GoalOutcome(enum.IntEnum):
    """How a goal ended; the numbers are those of PlanPath's result."""

    ARRIVED = 0
    REFUSED = 1
    BLOCKED = 2
    STOPPED = 3
    PREEMPTED = 4
    CANCELED = 5
    STUCK = 6
    ERROR = 7


@dataclass(frozen=True)
class Tolerance:
    """How near is there: distance [m], heading [rad]."""

    distance: float
    heading: float

    @property
    def heading_matters(self) -> bool:
        """Whether the goal's heading is asked for."""
        return 0 < self.heading < FREE_HEADING


@dataclass
class GoalProgress:
    """Follows the robot on its way to a goal.

    Parameters
    ----------
    goal
        (x, y, yaw) in the world's frame [m, m, rad].
    tolerance
        How near is there.
    patience
        Time without a plan, or without progress, before giving up [s].
    """

    goal: Pose2D
    tolerance: Tolerance
    patience: float
    path: NDArray[np.float64] | None = None
    route: NDArray[np.float64] | None = None  # the last path that there was
    under_way: bool = False  # there has been a path, so the robot may have moved
    _no_plan_since: float | None = None
    _best: float = math.inf
    _best_at: float = field(default=-math.inf)
    _least_off: float = math.inf  # from where the path leads, since it came nearer last [rad]
    _inside_since: float | None = None
    _was_helped: bool = False
    _is_hindered: bool = False
    _hindered_at: list[tuple[float, float]] = field(default_factory=list)

    SETTLE = 2.0  # s inside the tolerance after which a robot that still creeps has arrived
    PROGRESS = 0.05  # m (or rad/10) that count as progress
    TURNED = 0.2  # rad by which it must face the way ahead better than ever, to have got somewhere
    AHEAD = 0.35  # m along the path, to where it has to face
    HINDERED = 0.1  # share of the patience that is used up when something hinders the robot
    SAME_PLACE = 0.5  # m
    LOOKED_AT = 50.0  # m ahead; further away nobody looks for what hinders it
    ROUNDS = 3  # times that something may hinder it at one place although it was helped

    def planned(self, path: NDArray[np.float64], now: float) -> None:
        """A path of poses (N, 3) was found."""
        self.path, self.route, self.under_way = path, path, True
        self._no_plan_since = None
        self._best, self._best_at = math.inf, now

    def replanned(self, path: NDArray[np.float64], pose: Pose2D) -> None:
        """A better path (N, 3) was found, on the way at ``pose``: it is no progress by itself."""
        before = self.distance_left(pose)
        self.path = self.route = path
        self._best += self.distance_left(pose) - before

    def unplanned(self, now: float) -> bool:
        """No path was found; True when patience is over."""
        self.path = None
        if self._no_plan_since is None:
            self._no_plan_since = now
        return now - self._no_plan_since >= self.patience

    def pause(self, seconds: float) -> None:
        """The robot was being helped for so long: that is no time in which it tried in vain."""
        self._was_helped = True
        self._best_at += seconds
        if self._no_plan_since is not None:
            self._no_plan_since += seconds

    def patience_used(self, pose: Pose2D, now: float) -> float:
        """The share of patience that is used up, from 0 to 1.

        1, too, where the robot was helped, and got somewhere, and is hindered at the same place
        again and again: else it would try for ever.
        """
        since = self._best_at if self.path is not None else self._no_plan_since
        waited = 0.0 if since is None or since == -math.inf else now - since
        used = min(1.0, max(0.0, waited / self.patience))
        was, self._is_hindered = self._is_hindered, used >= self.HINDERED
        if self._is_hindered and not was:
            self._hindered_at.append(pose[:2])
        near = [at for at in self._hindered_at if math.dist(at, pose[:2]) <= self.SAME_PLACE]
        if self._is_hindered and self._was_helped and len(near) > self.ROUNDS:
            return 1.0
        return used

    @property
    def is_hindered(self) -> bool:
        """Whether something hindered the robot when its patience was last looked at."""
        return self._is_hindered

    def errors(self, pose: Pose2D) -> tuple[float, float]:
        """Distance [m] and heading error [rad] between a pose and the goal."""
        distance = math.hypot(self.goal[0] - pose[0], self.goal[1] - pose[1])
        return distance, abs(float(wrap_angle(self.goal[2] - pose[2])))

    def ahead(self, pose: Pose2D) -> NDArray[np.float64]:
        """What is left of the last path (M, 3) from the place nearest to ``pose``.

        Without one, the straight line to the goal, as far as anybody looks.
        """
        route = self.route
        if route is None:
            distance = self.errors(pose)[0]
            far = min(distance, self.LOOKED_AT)
            start, goal = np.array(pose), np.array(self.goal)
            end = start + (goal - start) * (far / distance if distance > far else 1.0)
            return np.linspace(start, end, max(2, math.ceil(10 * far)))
        away = np.hypot(route[:, 0] - pose[0], route[:, 1] - pose[1])
        return route[int(np.argmin(away)) :]

    def distance_left(self, pose: Pose2D) -> float:
        """Length of the path still ahead [m]; the straight distance while there is none."""
        if self.path is None or len(self.path) < 2:
            return self.errors(pose)[0]
        points = self.path[:, :2]
        steps = np.hypot(*np.diff(points, axis=0).T)
        ahead = np.append(np.cumsum(steps[::-1])[::-1], 0.0)
        away = np.hypot(points[:, 0] - pose[0], points[:, 1] - pose[1])
        # Of points equally near, as where a path crosses itself, the later one is not assumed.
        return float(ahead[int(np.argmin(away))])

    def arrived(self, pose: Pose2D, standing: bool, now: float) -> bool:
        """Whether the robot is there, and has come to rest or had the time to."""
        distance, heading = self.errors(pose)
        inside = distance <= self.tolerance.distance and (
            not self.tolerance.heading_matters or heading <= self.tolerance.heading
        )
        if not inside:
            self._inside_since = None
            return False
        if self._inside_since is None:
            self._inside_since = now
        return standing or now - self._inside_since >= self.SETTLE

    def stuck(self, pose: Pose2D, now: float) -> bool:
        """Whether nothing has come nearer for longer than patience.

        To turn towards the path is to come nearer; to turn to and fro is not.
        """
        distance, heading = self.errors(pose)
        left = self.distance_left(pose) + distance / 10
        if self.tolerance.heading_matters and distance < 2 * self.tolerance.distance:
            left += heading / 10
        if left < self._best - self.PROGRESS:
            self._best, self._best_at, self._least_off = left, now, self._off_path(pose)
        elif (off := self._off_path(pose)) < self._least_off - self.TURNED:
            self._best_at, self._least_off = now, off
        return self.path is not None and now - self._best_at >= self.patience

    def _off_path(self, pose: Pose2D) -> float:
        """How far it faces from where the path leads [rad]; 0 where there is nothing ahead."""
        if self.path is None:
            return 0.0
        offset = self.path[:, :2] - pose[:2]
        away = np.hypot(offset[:, 0], offset[:, 1])
        nearest = int(np.argmin(away))
        farther = np.flatnonzero(away[nearest:] >= self.AHEAD)
        dx, dy = offset[nearest + int(farther[0])] if len(farther) else offset[-1]
        if math.hypot(dx, dy) < self.tolerance.distance:
            return 0.0
        return abs(float(wrap_angle(math.atan2(dy, dx) - pose[2])))

    def strayed(self, pose: Pose2D, limit: float) -> bool:
        """Whether the robot is farther from its path than ``limit`` [m]."""
        if self.path is None:
            return False
        away = np.hypot(self.path[:, 0] - pose[0], self.path[:, 1] - pose[1])
        return float(away.min()) > limit
