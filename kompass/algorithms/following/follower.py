"""What all path followers share: turn towards the path, drive along it, stop at its end, align."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Generic, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike

from kompass.algorithms.bounded import BoundedParams
from kompass.algorithms.following.command import Command, FollowStep, Phase
from kompass.algorithms.following.gears import Leg, legs_of
from kompass.algorithms.following.limits import Limits, stopping_speed
from kompass.algorithms.following.path_tracker import PathTracker
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, wrap_angle
from kompass.algorithms.motion_model import MotionModel


class NoCommand(Exception):
    """No direction is free of obstacles: the robot must stop, and wait or be freed."""


# Where a leg of a car's path ends, it has come near enough to change direction [m].
_TURNING_POINT = 0.015
# … and so far at least it aims ahead [m].
_BEYOND_END = 0.12
# So slow the wheels may be turned round [m/s], and so much of the speed is driven back with.
_AT_REST, _BACK = 0.03, 0.5


@dataclass(frozen=True, kw_only=True)
class FollowerParams(BoundedParams):
    """Common to all followers; what is not finite or out of its bounds is a ValueError.

    Attributes
    ----------
    lookahead_distance
        Arc ahead of the robot whose end tells which way to face [m].
    goal_tolerance
        Distance from the path's end that counts as there [m].
    heading_tolerance
        Difference from the goal's heading that counts as aligned [rad].
    turn_in_place_angle
        Facing farther than this from the path, the robot turns first [rad].
    turn_done_angle
        … until it faces it this closely [rad].
    lateral_acceleration
        Allowed in curves [m/s²].
    approach_deceleration
        Used to slow down towards the goal, if the robot can [m/s²].
    min_speed
        Least speed while the goal is not reached [m/s].
    min_turn_rate
        Least rate of turning on the spot [rad/s].
    """

    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {
        "lookahead_distance": (0.001, 100.0),
        "goal_tolerance": (0.001, 10.0),
        "heading_tolerance": (0.001, math.pi),
        "turn_in_place_angle": (0.0, math.pi),
        "turn_done_angle": (0.0, math.pi),
        "lateral_acceleration": (0.0, 100.0),
        "approach_deceleration": (0.0, 100.0),
        "min_speed": (0.0, 10.0),
        "min_turn_rate": (0.0, 10.0),
    }

    lookahead_distance: float = 0.35
    goal_tolerance: float = 0.03
    heading_tolerance: float = 0.05
    turn_in_place_angle: float = 1.0
    turn_done_angle: float = 0.15
    lateral_acceleration: float = 0.3
    approach_deceleration: float = 0.3
    min_speed: float = 0.02
    min_turn_rate: float = 0.1

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.turn_done_angle < self.turn_in_place_angle:
            raise ValueError(
                f"turn_done_angle: {self.turn_done_angle} rad; give less than "
                f"turn_in_place_angle, {self.turn_in_place_angle} rad"
            )


@dataclass(frozen=True)
class Situation:
    """What a steering law gets to see.

    Attributes
    ----------
    x, y, yaw
        Pose in the frame of the path [m, m, rad]; of a car that drives back, as it would be
        turned round, and so is all that follows.
    speed, turn_rate
        Current velocity [m/s, rad/s].
    tracker
        The path, and the place on it.
    homing
        Whether only the straight way to the path's end is left.
    off_course
        Whether it faces so far from the way ahead that a robot would turn on the spot.
    allowed_speed
        What the path ahead and its end allow [m/s].
    dt
        Control period [s].
    obstacles
        Points (N, 2) in the base frame [m]; none for a follower that does not need them.
    movers
        (M, 5) in the base frame: x, y [m], velocity over the floor [m/s], radius [m].
    aside
        Current velocity to the left [m/s].
    """

    x: float
    y: float
    yaw: float
    speed: float
    turn_rate: float
    tracker: PathTracker
    homing: bool
    off_course: bool
    allowed_speed: float
    dt: float
    obstacles: Floats
    movers: Floats
    aside: float = 0.0


P = TypeVar("P", bound=FollowerParams)


class PathFollower(ABC, Generic[P]):
    """Follows one path after another; a subclass supplies the steering law.

    Parameters
    ----------
    config
        An instance of the subclass's ``params_class``; the default one when left out.
    max_v
        [m/s]
    max_omega
        [rad/s]
    acc, decel
        [m/s²]
    omega_acc
        Both ways [rad/s²].
    footprint
        The robot's body; only those look at it that need obstacles.
    motion
        What else the wheels can and cannot do; a robot that turns on the spot when left out. One
        with steered wheels drives a path leg by leg, ahead or back as its poses face, and comes to
        rest where one ends: where it does not get to the very end, another path must lead it.
    """

    params_class: ClassVar[type[FollowerParams]]
    # Whether :meth:`step` is to be given the obstacles around the robot.
    needs_obstacles: ClassVar[bool] = False
    # … and what of them moves.
    looks_ahead_in_time: ClassVar[bool] = False

    def __init__(
        self,
        config: P | None = None,
        *,
        max_v: float,
        max_omega: float,
        acc: float,
        decel: float,
        omega_acc: float,
        footprint: Footprint | None = None,
        motion: MotionModel | None = None,
    ) -> None:
        self.config: P = cast(P, self.params_class()) if config is None else config
        self.footprint = footprint
        self._bodies = None if footprint is None else (footprint, Footprint(-footprint.corners))
        self.motion = motion or MotionModel()
        self._linear = Limits(max_v, acc, decel)
        self._angular = Limits(max_omega, omega_acc, omega_acc)
        for name, value in (
            ("max_v", max_v),
            ("max_omega", max_omega),
            ("acc", acc),
            ("decel", decel),
            ("omega_acc", omega_acc),
        ):
            if value <= 0:
                raise ValueError(f"{name}: {value}; give a number above 0")
        self._poses: Floats | None = None
        self._legs: list[Leg] = []  # that are left, the one that is driven first
        self._tracker: PathTracker | None = None
        self._phase: Phase = "driving"
        self._last = Command()

    @property
    def tracker(self) -> PathTracker | None:
        """Progress along the current path, of a car its current leg; None before the first one."""
        return self._tracker

    def set_path(self, poses: ArrayLike) -> None:
        """Follow ``poses`` (N, 3) from now on; the last yaw is the heading to end with.

        The path is joined where it first comes (almost) nearest to the robot, which keeps
        moving meanwhile. Setting the path that is being followed again changes nothing.

        Raises
        ------
        ValueError
            No poses, or one that is not finite.
        """
        given = np.array(poses, dtype=np.float64)
        same = self._poses is not None and np.array_equal(self._poses, given)
        if same and self._phase != "arrived":
            return
        tracker = PathTracker(given)
        if self.motion.is_steered:
            backward = self._drives_back
            self._legs = legs_of(_with_yaw(given))
            tracker = PathTracker(self._legs[0].poses)
            if self._drives_back != backward:
                self._turned_round()
        self._tracker, self._poses = tracker, given
        self._phase = "driving"

    def take_over(self, other: PathFollower[Any]) -> None:
        """Go on where another follower is: same path, same place on it, same velocity."""
        self._poses, self._tracker = other._poses, other._tracker
        self._legs = other._legs
        self._phase, self._last = other._phase, other._last

    def reset(self) -> None:
        """Forget the commanded velocity, after something else has driven or stopped the robot."""
        self._last = Command()

    def step(
        self,
        pose: ArrayLike,
        v: float,
        omega: float,
        dt: float,
        obstacles: ArrayLike = (),
        movers: ArrayLike = (),
        vy: float = 0.0,
    ) -> FollowStep:
        """The command for the next ``dt`` [s].

        Parameters
        ----------
        pose
            (x, y, yaw) of the robot in the frame of the path.
        v, omega
            Its measured velocity ahead [m/s] and turning rate [rad/s].
        dt
            Control period [s].
        obstacles
            Points (N, 2) in the base frame [m], for a follower that needs them.
        movers
            (M, 5) in the base frame, what of that moves: x, y [m], velocity over the floor in x
            and y [m/s], radius [m]; for a follower that looks ahead in time.
        vy
            Measured velocity to the left [m/s].

        Raises
        ------
        ValueError
            An argument is not finite, or ``dt`` is not positive.
        RuntimeError
            No path has been set.
        NoCommand
            Every motion within reach meets an obstacle.
        """
        x, y, yaw = (float(value) for value in np.asarray(pose, dtype=np.float64))
        if not all(map(math.isfinite, (x, y, yaw, v, omega, vy))):
            raise ValueError(
                f"pose, v, omega, vy: {(x, y, yaw, v, omega, vy)}; give finite numbers"
            )
        if not (math.isfinite(dt) and dt > 0):
            raise ValueError(f"dt: {dt} s; give the control period, above 0")
        tracker = self._tracker
        if tracker is None:
            raise RuntimeError("No path to follow: call set_path first.")
        speed, aside, turn_rate = self._velocity(v, vy, omega, dt)
        points = np.asarray(obstacles, dtype=np.float64).reshape(-1, 2)
        moving = np.asarray(movers, dtype=np.float64).reshape(-1, 5)
        if self.motion.is_steered:
            around = _Around(x, y, yaw, speed, 0.0, turn_rate, dt, points, moving)
            return self._step_of_car(around, v)
        tracker.advance(x, y)
        dx, dy = tracker.goal[0] - x, tracker.goal[1] - y
        distance = math.hypot(dx, dy)
        ahead = math.cos(yaw) * dx + math.sin(yaw) * dy
        self._settle_phase(tracker, distance, ahead, speed, dt)

        heading_error = wrap_angle(tracker.heading_at(tracker.progress) - yaw)
        if self._phase == "arrived":
            command = Command()
        elif self._phase == "aligning":
            heading_error = wrap_angle(tracker.goal_yaw - yaw)
            command = self._align(heading_error, speed, aside, turn_rate, dt)
            at_rest = abs(v) <= 0.02 and abs(omega) <= 0.1 and command == Command()
            if at_rest and abs(heading_error) <= self.config.heading_tolerance:
                self._phase = "arrived"
        else:
            around = _Around(x, y, yaw, speed, aside, turn_rate, dt, points, moving)
            command = self._move(around, distance)
        self._last = command
        return self._told(x, y, command, heading_error)

    def _told(self, x: float, y: float, command: Command, heading_error: float) -> FollowStep:
        tracker = self._tracker
        assert tracker is not None
        return FollowStep(
            command=command,
            phase=self._phase,
            progress=tracker.progress,
            remaining=tracker.remaining,
            cross_track_error=tracker.cross_track(x, y),
            heading_error=heading_error,
        )

    def _step_of_car(self, around: _Around, v: float) -> FollowStep:
        """One cycle of a robot with steered wheels, along the leg that it is on."""
        x, y, dt, gear = around.x, around.y, around.dt, -1.0 if self._drives_back else 1.0
        tracker = self._tracker
        assert tracker is not None
        tracker.advance(x, y)
        last = len(self._legs) == 1
        near = 0.3 * self.config.goal_tolerance if last else _TURNING_POINT
        ended = tracker.remaining <= max(near, 0.5 * abs(around.speed) * dt)
        rests = abs(v) <= _AT_REST and abs(around.speed) <= _AT_REST
        if ended and rests and not last:
            del self._legs[0]
            gear, ended = -gear, False
            tracker = self._tracker = PathTracker(self._legs[0].poses)
            tracker.advance(x, y)
            self._turned_round()
        facing = around if gear > 0.0 else around.turned_round()
        heading_error = float(wrap_angle(tracker.heading_at(tracker.progress) - facing.yaw))
        if self._phase == "arrived" or (ended and rests):
            self._phase, command = "arrived", Command()
        elif ended or gear * around.speed < -_AT_REST:
            self._phase = "aligning" if ended and last else "driving"
            slower = self._linear.approach(around.speed, 0.0, dt)
            command = Command(slower, 0.0, self.motion.turn(slower, around.turn_rate))
        else:
            self._phase = "driving"
            distance = math.hypot(tracker.goal[0] - x, tracker.goal[1] - y)
            moved = self._move(facing, distance)
            command = Command(gear * moved.vx, 0.0, moved.omega)
        self._last = command
        return self._told(x, y, command, heading_error)

    @property
    def _body(self) -> Footprint:
        """The body as it lies before the way that is driven."""
        if self._bodies is None:
            raise AssertionError(f"{type(self).__name__} was made without a footprint")
        return self._bodies[self._drives_back]

    @property
    def _drives_back(self) -> bool:
        """Whether the leg that a car is on is driven back."""
        return bool(self._legs) and self._legs[0].backward

    @staticmethod
    def _nearer(lookahead: float, remaining: float) -> float:
        """How far ahead a car aims [m]: hardly beyond the end of a leg, where its curve may end."""
        return min(lookahead, max(remaining, _BEYOND_END))

    def _turned_round(self) -> None:
        """A car drives the other way from now on."""

    def _velocity(self, v: float, vy: float, omega: float, dt: float) -> tuple[float, float, float]:
        """What to accelerate from: speed ahead, to the left, and turning rate."""
        last = self._last
        speed = self._linear.going(last.vx, v, dt)
        aside = self.motion.aside.going(last.vy, vy, dt) if self.motion.slides else 0.0
        return speed, aside, self._angular.going(last.omega, omega, dt)

    def _settle_phase(
        self, tracker: PathTracker, distance: float, ahead: float, speed: float, dt: float
    ) -> None:
        tolerance = self.config.goal_tolerance
        if self._phase == "aligning":
            if distance > tolerance:
                self._phase = "driving"
        elif (
            self._phase != "arrived"
            and tracker.remaining <= tolerance
            and distance <= 0.7 * tolerance
            and ahead <= 0.15 * tolerance + 0.5 * abs(speed) * dt
        ):
            self._phase = "aligning"

    def _move(self, around: _Around, distance: float) -> Command:
        tracker, params, steered = self._tracker, self.config, self.motion.is_steered
        assert tracker is not None
        x, y, yaw, dt = around.x, around.y, around.yaw, around.dt
        speed, aside, turn_rate = around.speed, around.aside, around.turn_rate
        # Past the end of the path or beside it, only the straight way to the goal is left.
        dx, dy = tracker.goal[0] - x, tracker.goal[1] - y
        end = tracker.end_heading
        homing = not steered and (
            tracker.remaining <= params.goal_tolerance
            and math.cos(end) * dx + math.sin(end) * dy <= 0.3 * params.goal_tolerance
        )
        if homing:
            target = tracker.goal
        else:
            target = tracker.point_at(tracker.progress + params.lookahead_distance)
        bearing = wrap_angle(math.atan2(target[1] - y, target[0] - x) - yaw)
        if homing and distance <= 0.7 * params.goal_tolerance:
            bearing = 0.0  # on the spot: where it lies does not matter any more
        limit = params.turn_in_place_angle * (0.5 if homing else 1.0)
        off_course = abs(bearing) > limit and not steered
        if off_course and self._turns_to_path():
            self._phase = "turning"
        elif self._phase == "turning" and abs(bearing) <= params.turn_done_angle:
            self._phase = "driving"
        if self._phase == "turning":
            return self._turn(bearing, speed, aside, turn_rate, dt)

        allowed = self._allowed_speed(tracker, bearing, distance if homing else None, dt)
        if self._drives_back:
            allowed = min(allowed, _BACK * self._linear.max_vel)
        situation = Situation(
            *(x, y, yaw, speed, turn_rate, tracker, homing, off_course, allowed, dt),
            *(around.obstacles, around.movers, aside),
        )
        vx, vy, omega = self._drive(situation)
        vx = self._linear.approach(speed, vx, dt)
        omega = self.motion.turn(vx, self._angular.approach(turn_rate, omega, dt))
        return Command(vx, self.motion.aside.approach(aside, vy, dt), omega)

    def _turns_to_path(self) -> bool:
        """Whether to turn on the spot when the path lies far to the side."""
        return True

    def _allowed_speed(
        self, tracker: PathTracker, bearing: float, straight: float | None, dt: float
    ) -> float:
        """How fast the path ahead, its end and the robot's heading allow it to go [m/s]."""
        params = self.config
        limits = [self._linear.max_vel * max(0.2, math.cos(bearing))]
        if straight is None:
            at = tracker.progress
            curvature = tracker.sharpest(at, min(at + params.lookahead_distance, tracker.length))
            if curvature > 1e-6:
                limits.append(0.9 * self._angular.max_vel / curvature)
                limits.append(math.sqrt(params.lateral_acceleration / curvature))
        decel = min(params.approach_deceleration, self._linear.max_decel)
        left = tracker.remaining if straight is None else straight
        limits.append(stopping_speed(left, decel, 1.5 * dt))
        return max(min(limits), min(params.min_speed, self._linear.max_vel))

    def _turn(
        self, angle: float, speed: float, aside: float, turn_rate: float, dt: float
    ) -> Command:
        """Turn on the spot by ``angle`` [rad], slowing down in time."""
        limit = stopping_speed(abs(angle), 0.5 * self._angular.max_decel, 1.5 * dt)
        rate = min(self._angular.max_vel, max(limit, self.config.min_turn_rate))
        return Command(
            self._linear.approach(speed, 0.0, dt),
            self.motion.aside.approach(aside, 0.0, dt),
            self._angular.approach(turn_rate, math.copysign(rate, angle), dt),
        )

    def _align(
        self, error: float, speed: float, aside: float, turn_rate: float, dt: float
    ) -> Command:
        if abs(error) > 0.5 * self.config.heading_tolerance:
            return self._turn(error, speed, aside, turn_rate, dt)
        return Command(
            self._linear.approach(speed, 0.0, dt),
            self.motion.aside.approach(aside, 0.0, dt),
            self._angular.approach(turn_rate, 0.0, dt),
        )

    def _drive(self, situation: Situation) -> tuple[float, float, float]:
        """The twist (vx, vy, omega) wanted next; the limits of acceleration are applied after."""
        curvature = self._curvature(situation)
        if self.motion.is_steered:
            tightest = 1.0 / self.motion.turning_radius
            curvature = min(max(curvature, -tightest), tightest)
        v = situation.allowed_speed
        # The turning rate wins: rather slower than off the curve.
        if abs(curvature) * v > self._angular.max_vel:
            v = self._angular.max_vel / abs(curvature)
        reached = self._linear.approach(situation.speed, v, situation.dt)
        limit = self._angular.max_vel
        return v, 0.0, min(max(curvature * reached, -limit), limit)

    @abstractmethod
    def _curvature(self, situation: Situation) -> float:
        """The curvature to drive now [1/m], positive to the left."""


@dataclass(frozen=True)
class _Around:
    """Where a robot is, how it moves and what is around it; see :class:`Situation`."""

    x: float
    y: float
    yaw: float
    speed: float
    aside: float
    turn_rate: float
    dt: float
    obstacles: Floats
    movers: Floats

    def turned_round(self) -> _Around:
        """The same as seen by a car that faces the other way, and so drives ahead."""
        movers = self.movers.copy()
        movers[:, :4] *= -1.0
        return replace(
            self,
            yaw=float(wrap_angle(self.yaw + math.pi)),
            speed=-self.speed,
            obstacles=-self.obstacles,
            movers=movers,
        )


def _with_yaw(poses: Floats) -> Floats:
    """Poses (N, 3) that face along a path (N, ≥ 2) without headings."""
    given = np.atleast_2d(poses)
    if given.shape[1] > 2 or len(given) < 2:
        return given[:, :3]
    delta = np.diff(given[:, :2], axis=0)
    yaw = np.arctan2(delta[:, 1], delta[:, 0])
    return np.column_stack([given[:, :2], np.append(yaw, yaw[-1])])
