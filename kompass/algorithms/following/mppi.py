"""Model predictive path integral control: thousands of noisy plans, averaged by what they cost.

G. Williams, A. Aldrich, E. Theodorou, "Model Predictive Path Integral Control: From Theory to
Parallel Computation", Journal of Guidance, Control, and Dynamics, 2017; the weighting by
information theory of G. Williams et al., "Information Theoretic MPC for Model-Based Reinforcement
Learning", ICRA 2017.

A plan is a velocity and a turning rate for each step of the horizon, and one to the side for a
robot that slides; steered wheels turn no tighter than they can. Every cycle the last plan,
moved on by one period, is disturbed by noise that is smooth in time, made feasible for the
robot's accelerations, driven in the mind, and judged: distance from obstacles under the true
footprint, and how far along the path it comes. The mean of all plans, weighted by
exp(-cost / temperature), is the next one. What is carried out must itself be free of contact: where
the mean of two ways round something leads through it, the best single plan is taken.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.following.command import Command
from kompass.algorithms.following.follower import FollowerParams, NoCommand, PathFollower, Situation
from kompass.algorithms.following.limits import stopping_speed
from kompass.algorithms.following.path_tracker import PathTracker
from kompass.algorithms.following.point_field import PointField, Singles
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, inverse, transform_points, wrap_angle
from kompass.algorithms.mapping.moving import predicted

# Of all plans together: more than any robot has time for.
MOST_PLACES = 2_000_000
# Along one side of the grid around the robot.
MOST_CELLS = 2000
# Banks of noise that are used in turn; drawing it anew would take longer than all the rest.
_BANKS = 16
# Noise is drawn at this many knots and interpolated: plans that shake are no plans.
_KNOTS = 5
# A contact costs more than anything that a plan without one could.
_CONTACT = 1e4
# The path ahead is looked at on a grid of this many cells from the robot to its border.
_PATH_CELLS = 40
_MOST_PATH_POINTS = 80
_PATH_SPACING = 0.05  # m between two points of it, if they are not too many
_TURNED_BACK = 2.0  # rad
# How much faster than the mean of all plans is looked at, too (3, 1, 1).
_FASTER: Singles = np.array([1.0, 1.1, 1.3], dtype=np.float32)
# Ways to come to rest that are looked at, and into how many parts each step of them is divided.
_BRAKING, _FINER = 31, 4
_ASIDE = 0.6  # rad; what lies farther to the side at the end of the way is turned to on the spot
# So far a command alone must be free, beyond the drive manager's critical zone [m].
_HELD = 0.07
_HELD_FOR: Singles = np.array([[0.5], [1.0]], dtype=np.float32)
# So fast it passes obstacles however near [m/s], and faster by 1 m/s for so much room [s]; what
# is faster costs more, per m/s, than it gains in way.
_SLOW, _BESIDE, _HASTE = 0.4, 0.15, 12.0
# Room beyond that of what is slow, for each m/s: the faster, the farther off a plan comes out [s].
_STRAY = 0.06
# Kept from what moves, and liked to be kept beyond that [m]; who drives slower stands [m/s].
_PERSONAL, _SHY, _STANDS = 0.12, 0.5, 0.02
# How much farther than rollouts obstacles are looked for [m].
_FARTHER = 0.3
# What comes no farther than this leads nowhere; so many directions on the spot are looked at, and
# so much free way [m] makes one of them open.
_SOMEWHERE, _DIRECTIONS, _OPEN_AHEAD = 0.05, 48, 0.3
# Within this of it points are taken as those of what moves [m].
_ITS_OWN = 0.15
# Of single precision [m].
_ROUNDING = 1e-5


@dataclass(frozen=True, kw_only=True)
class MPPIParams(FollowerParams):
    """What is sampled and how it is judged.

    Attributes
    ----------
    prediction_time
        How far the plans look ahead [s].
    time_step
        Of a plan [s].
    least_reach
        A robot too slow to come this far in that time looks ahead for longer, with longer
        steps [m].
    rollouts
        Plans tried in each cycle.
    temperature
        Difference of cost that makes a plan e times less likely.
    speed_noise
        Standard deviation of velocities tried, as a share of the largest.
    turn_noise
        The same of turning rates.
    delay
        From a command to the motion [s].
    clearance
        What plans keep between the body and obstacles [m].
    resolution
        Of the grid around the robot [m].
    path_weight
        On the mean distance from the path, per metre.
    progress_weight
        On the part of the path ahead that is not covered, per metre.
    heading_weight
        On facing another way than the path does where the plan ends, per radian.
    obstacle_weight
        On nearness to obstacles, 0 from ``obstacle_range`` on, 1 at the clearance.
    obstacle_range
        Beyond the clearance [m].
    smoothness_weight
        On the change of velocities from step to step, as a share of the largest.
    """

    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {
        **FollowerParams.bounds,
        "prediction_time": (0.2, 10.0),
        "time_step": (0.02, 1.0),
        "least_reach": (0.1, 20.0),
        "rollouts": (64, 20000),
        "temperature": (0.001, 100.0),
        "speed_noise": (0.001, 2.0),
        "turn_noise": (0.001, 2.0),
        "delay": (0.0, 1.0),
        "clearance": (0.0, 10.0),
        "resolution": (0.005, 1.0),
        "obstacle_range": (0.001, 10.0),
    }

    turn_in_place_angle: float = math.pi
    lateral_acceleration: float = 2.5
    prediction_time: float = 2.0
    time_step: float = 0.1
    least_reach: float = 1.0
    rollouts: int = 1000
    temperature: float = 0.15
    speed_noise: float = 0.3
    turn_noise: float = 0.35
    delay: float = 0.1
    clearance: float = 0.03
    resolution: float = 0.04
    path_weight: float = 5.0
    progress_weight: float = 3.0
    heading_weight: float = 0.3
    obstacle_weight: float = 4.0
    obstacle_range: float = 0.25
    smoothness_weight: float = 0.3

    def __post_init__(self) -> None:
        super().__post_init__()
        places = self.rollouts * self.prediction_time / self.time_step
        if places > MOST_PLACES:
            raise ValueError(
                f"rollouts × prediction_time / time_step: {places:.0f} places looked at, more "
                f"than {MOST_PLACES}; give fewer rollouts or a longer step"
            )
        if self.prediction_time < 4 * self.time_step:
            raise ValueError(
                f"prediction_time: {self.prediction_time} s; give at least four times "
                f"time_step, {self.time_step} s"
            )


class MPPI(PathFollower[MPPIParams]):
    """Follows a path round what stands beside or on it, with the whole of its dynamics in mind.

    The same inputs give the same commands: the noise is drawn from ``seed`` once.

    Parameters
    ----------
    config
        See :class:`MPPIParams`.
    footprint
        The robot's body.
    seed
        Of the noise.
    limits
        ``max_v``, ``max_omega``, ``acc``, ``decel``, ``omega_acc``, ``motion``, as of every
        follower.
    """

    params_class = MPPIParams
    needs_obstacles = True
    looks_ahead_in_time = True

    def __init__(
        self,
        config: MPPIParams | None = None,
        *,
        footprint: Footprint,
        seed: int = 1,
        **limits: Any,
    ) -> None:
        super().__init__(config, footprint=footprint, **limits)
        params = self.config
        self._steps = max(4, round(params.prediction_time / params.time_step))
        # A slow robot looks ahead for longer, or it would see nothing of a way round.
        reach = max(self._linear.max_vel * params.prediction_time, params.least_reach)
        self._reach = reach
        self._step_time = reach / self._linear.max_vel / self._steps
        reach += footprint.radius
        margin = params.clearance + params.obstacle_range
        self._half = math.ceil((reach + margin) / params.resolution)
        if 2 * self._half > MOST_CELLS:
            raise ValueError(
                f"resolution: {params.resolution} m is too fine for a grid that holds "
                f"plans of {self._reach:g} m; give a coarser one, or a shorter prediction_time"
            )
        # Where a body is seen to be free without its outline being looked at: so far from the
        # middle to an obstacle it has all the room that a plan could be asked for.
        fastest = max(self._linear.max_vel - _SLOW, 0.0)
        counts = max(params.obstacle_range, _BESIDE * fastest, _STRAY * fastest)
        self._free = np.float32(footprint.radius + params.clearance + counts)
        self._noise = self._draw(np.random.default_rng(seed))
        self._fixed = self._plain()
        self._bank = 0
        self._plan: Singles = np.zeros((self._axes, self._steps), dtype=np.float32)

    @property
    def _axes(self) -> int:
        """Of a plan: ahead, turning, and to the side where the robot slides."""
        return 3 if self.motion.slides else 2

    def reset(self) -> None:
        super().reset()
        self._plan[:] = 0.0

    def take_over(self, other: PathFollower[Any]) -> None:
        super().take_over(other)
        back = -1.0 if self._drives_back else 1.0
        axes = [[back * self._last.vx], [self._last.omega], [self._last.vy]]
        self._plan[:] = axes[: self._axes]

    def _turned_round(self) -> None:
        self._plan[:] = 0.0

    def _move(self, *args: Any, **kwargs: Any) -> Command:
        # Turning is one of the plans, under which obstacles are looked at; so it has no phase
        # that goes on by itself, only a name for whoever watches.
        self._phase = "driving"
        command = super()._move(*args, **kwargs)
        creeping = math.hypot(command.vx, command.vy) <= max(
            self.config.min_speed, 0.05 * self._linear.max_vel
        )
        if creeping and abs(command.omega) >= self.config.min_turn_rate:
            self._phase = "turning"
        return command

    def _curvature(self, situation: Situation) -> float:
        raise AssertionError("MPPI chooses velocities, not a curvature")

    def _allowed_speed(
        self, tracker: PathTracker, bearing: float, straight: float | None, dt: float
    ) -> float:
        # Curves and heading are in the plans; only the end of the path may lie beyond them.
        decel = min(self.config.approach_deceleration, self._linear.max_decel)
        left = tracker.remaining if straight is None else straight
        limit = min(self._linear.max_vel, stopping_speed(left, decel, 1.5 * dt))
        return max(limit, min(self.config.min_speed, self._linear.max_vel))

    def _drive(self, situation: Situation) -> tuple[float, float, float]:
        rollouts = self._roll_out(self._candidates(situation), situation)
        seen = self._look(rollouts, situation)
        if (home := self._home(seen, situation)) is not None:
            return home
        cost = self._cost(rollouts, seen, situation)
        least = float(cost.min())
        if least >= _CONTACT:
            self._plan[:] = 0.0
            if situation.speed > _STANDS:
                return self._brake(seen, situation)
            raise self._enclosed(seen)
        if situation.speed <= _STANDS and not len(situation.movers):
            # To stand is a plan too, and so is to turn here and there: a robot that can do nothing
            # else is to say so.
            furthest = float(rollouts.speed.sum(axis=0)[cost < _CONTACT].max())
            if furthest * self._step_time < _SOMEWHERE and not self._open_beside(seen):
                self._plan[:] = 0.0
                raise self._enclosed(seen)
        weight = np.exp((least - cost) / self.config.temperature)
        mean = rollouts.plans @ (weight / weight.sum()).astype(np.float32)
        # Speeds end at the top, and so their mean lies below it: the same way, driven faster. Two
        # ways round something may lie on either side of the mean.
        means = self._roll_out(mean[:, :, None] * _FASTER, situation)
        costs = self._cost(means, seen, situation)
        index = int(np.argmin(costs))
        if costs[index] < _CONTACT:
            return self._take_up(means.plans[:, :, index])
        return self._take_up(rollouts.plans[:, :, int(np.argmin(cost))])

    def _enclosed(self, seen: _Seen) -> NoCommand:
        return NoCommand(
            f"No way keeps {self.config.clearance:.2f} m between the robot and the obstacles; "
            f"the nearest is at {max(seen.here, 0.0):.2f} m."
        )

    def _open_beside(self, seen: _Seen) -> bool:
        """Whether there is a direction that it could turn to on the spot and drive on in."""
        if self.motion.is_steered:
            return False
        yaw = np.linspace(-math.pi, math.pi, _DIRECTIONS, endpoint=False, dtype=np.float32)
        way = np.linspace(0.0, _OPEN_AHEAD, 7, dtype=np.float32)[1:, None]
        room = self._room(seen.obstacles, way * np.cos(yaw), way * np.sin(yaw), yaw + 0.0 * way)
        needed = np.minimum(self.config.clearance, seen.here + 0.1 * way) - _ROUNDING
        return bool((room >= needed).all(axis=0).any())

    def _take_up(self, plan: Singles) -> tuple[float, float, float]:
        """Go on from this plan (axes, steps), by its first velocities."""
        self._plan = plan.copy()
        return float(plan[0, 0]), float(plan[2, 0]) if len(plan) > 2 else 0.0, float(plan[1, 0])

    def _look(self, rollouts: _Rollouts, situation: Situation) -> _Seen:
        """What stands and where the path goes, as far as the rollouts come."""
        params, border = self.config, self._half * self.config.resolution
        around = np.array(
            [
                [min(float(each.min()), 0.0), max(float(each.max()), 0.0)]
                for each in (rollouts.x, rollouts.y)
            ]
        ).clip(-border, border)
        # The mean of plans, driven faster, may come a little farther than any of them.
        (low, high) = around.T + np.array([[-1.0], [1.0]]) * (float(self._free) + _FARTHER)
        near = (situation.obstacles > low) & (situation.obstacles < high)
        standing = _standing(situation.obstacles[near.all(axis=1)], situation.movers)
        obstacles = PointField(standing, tuple(low), tuple(high), params.resolution)
        origin = np.zeros(1, dtype=np.float32)
        here = float(self._room(obstacles, origin, origin, origin)[0])

        path, left, course = self._ahead(situation, obstacles)
        within = np.clip(path, -border, border)
        low, high = (
            np.minimum(around[:, 0], within.min(axis=0)),
            np.maximum(around[:, 1], within.max(axis=0)),
        )
        ahead = PointField(path, tuple(low), tuple(high), border / _PATH_CELLS)
        return _Seen(obstacles, here, ahead, path, left, course)

    def _brake(self, seen: _Seen, situation: Situation) -> tuple[float, float, float]:
        """As hard as it can, and turned to where most room is left while it comes to rest.

        What lay behind something else is seen late: then the way straight on is not the best one.
        """
        turns = np.linspace(-1.0, 1.0, _BRAKING) * self._angular.max_vel
        wanted = np.zeros((self._axes, self._steps, _BRAKING), dtype=np.float32)
        wanted[1] = turns
        plans = self._feasible(wanted, situation)
        v, omega = plans[:2]
        # It stands when it has stopped: turning on the spot is looked at anew then.
        omega = omega * (v > 0.0)
        # In finer steps than plans have: all of it is over within a few of them.
        v, omega = np.repeat(v, _FINER, axis=0), np.repeat(omega, _FINER, axis=0)
        step = np.float32(self._step_time / _FINER)
        yaw: Singles = np.cumsum(omega, axis=0) * step
        x: Singles = np.cumsum(v * np.cos(yaw), axis=0) * step
        y: Singles = np.cumsum(v * np.sin(yaw), axis=0) * step
        room = self._room(seen.obstacles, x, y, yaw).min(axis=0)
        # Of equally good ones the one that turns least.
        best = int(np.lexsort((np.abs(turns), -np.round(room, 3)))[0])
        return 0.0, 0.0, float(plans[1, 0, best])

    def _home(self, seen: _Seen, situation: Situation) -> tuple[float, float, float] | None:
        """The last bit of the way as pure pursuit drives it, if that is free; else None.

        There what a plan still wins by coming nearer is less than what the noise makes of it: the
        mean of all plans creeps, and stands beside the goal.
        """
        tracker, ahead = situation.tracker, self.config.lookahead_distance
        if not situation.homing and tracker.remaining > ahead:
            return None
        here_from = inverse((situation.x, situation.y, situation.yaw))
        aim, left = tracker.goal, math.inf
        if self.motion.is_steered:
            # It comes to rest at the end of the path, and faces along it: what it steers to lies
            # beyond.
            left = tracker.remaining
            aim = tracker.point_at(tracker.progress + self._nearer(ahead, left))
        ((px, py),) = transform_points(here_from, np.array([aim]))
        distance, bearing = math.hypot(px, py), math.atan2(py, px)
        if distance > 2.0 * ahead:
            return None  # the path comes back on itself
        if distance <= 0.7 * self.config.goal_tolerance:
            bearing = 0.0  # on the spot: where it lies does not matter any more
        plan = np.zeros((self._axes, self._steps, 1), dtype=np.float32)
        if abs(bearing) > _ASIDE and self.motion.is_steered:
            return None
        if abs(bearing) > _ASIDE:
            rate = stopping_speed(abs(bearing), 0.5 * self._angular.max_decel, 1.5 * situation.dt)
            rate = max(min(rate, self._angular.max_vel), self.config.min_turn_rate)
            plan[1, 0] = math.copysign(min(rate, abs(bearing) / self._step_time), bearing)
        else:
            curvature = 2.0 * math.sin(bearing) / max(distance, 0.05)
            way = np.arange(1, self._steps + 1) * situation.allowed_speed * self._step_time
            way = np.minimum(way, min(distance, left))
            steps = np.diff(way, prepend=0.0) / self._step_time
            plan[0, :, 0] = steps
            plan[1, :, 0] = curvature * steps
        straight = self._roll_out(plan, situation)
        if self._cost(straight, seen, situation)[0] >= _CONTACT:
            return None
        return self._take_up(straight.plans[:, :, 0])

    def _draw(self, random: np.random.Generator) -> Singles:
        """Noise (banks, axes, steps, rollouts) in velocities [m/s] and turning rate [rad/s]."""
        params, shape = self.config, (_BANKS, self.config.rollouts, _KNOTS, self._axes)
        knots = random.standard_normal(shape).transpose(0, 3, 2, 1)
        at = np.linspace(0.0, _KNOTS - 1.0, self._steps)
        low = np.minimum(at.astype(np.int64), _KNOTS - 2)
        share = (at - low)[:, None]
        noise = knots[:, :, low] * (1.0 - share) + knots[:, :, low + 1] * share
        noise[:, 0] *= params.speed_noise * self._linear.max_vel
        noise[:, 1] *= params.turn_noise * self._angular.max_vel
        noise[:, 2:] *= params.speed_noise * self.motion.aside.max_vel
        return np.ascontiguousarray(noise, dtype=np.float32)

    def _plain(self) -> Singles:
        """Plans (axes, steps, N) that noise around the last one would rarely meet.

        To stop, to turn, to drive an arc, to step aside, and to step aside and come back; for a
        robot that slides, to do so, with and without a way ahead.
        """
        top, turn = self._linear.max_vel, self._angular.max_vel
        time = np.arange(self._steps) / self._steps
        steady = np.ones(self._steps)
        aside = np.where(time < 0.5, 1.0, -1.0)
        back = np.where((time < 0.25) | (time >= 0.75), 1.0, -1.0)
        horizon = self._steps * self._step_time
        plans = [(0.0, 0.0 * steady), (0.0, turn * steady), (0.0, -turn * steady)]
        plans += [
            (share, bend * turn * steady)
            for share in (0.15, 0.4, 1.0)
            for bend in (-1.0, -0.5, -0.2, 0.0, 0.2, 0.5, 1.0)
        ]
        plans += [
            (share, rate)
            for share in (0.5, 1.0)
            for heading in (-1.1, -0.7, -0.35, 0.35, 0.7, 1.1)
            for rate in (2.0 * heading / horizon * aside, 4.0 * heading / horizon * back)
        ]
        if not self.motion.slides:
            both = [[share * top * steady, rate] for share, rate in plans]
            return np.ascontiguousarray(np.transpose(both, (1, 2, 0)), dtype=np.float32)
        still, side = 0.0 * steady, self.motion.aside.max_vel
        all_of_it = [[share * top * steady, rate + still, still] for share, rate in plans]
        all_of_it += [
            [share * top * steady, still, slide * side * along]
            for share in (0.0, 0.3, 0.7)
            for slide in (-1.0, -0.3, 0.3, 1.0)
            for along in (steady, aside, back)
        ]
        return np.ascontiguousarray(np.transpose(all_of_it, (1, 2, 0)), dtype=np.float32)

    def _candidates(self, situation: Situation) -> Singles:
        """Plans (axes, steps, N) to be looked at, whether the robot could do them or not."""
        at = np.arange(self._steps) + situation.dt / self._step_time
        moved = np.array([np.interp(at, np.arange(self._steps), axis) for axis in self._plan])
        self._bank = (self._bank + 1) % _BANKS
        plans: Singles = self._noise[self._bank] + moved[:, :, None].astype(np.float32)
        plans[:, :, 0] = moved
        plans[:, :, 1 : 1 + self._fixed.shape[2]] = self._fixed
        return plans

    def _feasible(self, plans: Singles, situation: Situation) -> Singles:
        """Make plans (axes, steps, N) keep to the robot's speeds, accelerations and wheels."""
        step = self._step_time
        linear, angular = self._linear, self._angular
        top = min(linear.max_vel, situation.allowed_speed)
        np.clip(plans[0], 0.0, np.float32(top), out=plans[0])
        speed = np.full(plans.shape[2], max(situation.speed, 0.0), dtype=np.float32)
        rate = np.full_like(speed, situation.turn_rate)
        faster, slower, bend, slip, slowest, fastest = (
            np.float32(each)
            for each in (
                linear.max_acc * step,
                linear.max_decel * step,
                angular.max_acc * step,
                self.config.lateral_acceleration,
                1e-3,
                angular.max_vel,
            )
        )
        least, most = np.empty_like(speed), np.empty_like(speed)
        tightest = np.float32(self.motion.turning_radius)
        for v, omega in zip(*plans[:2], strict=True):
            np.maximum(v, np.subtract(speed, slower, out=least), out=v)
            speed = np.minimum(v, np.add(speed, faster, out=most), out=v)
            # Whoever wants to turn tightly slows down first: a wheel that slips turns nothing.
            np.divide(slip, np.maximum(speed, slowest, out=most), out=most)
            np.minimum(most, fastest, out=most)
            np.minimum(omega, most, out=omega)
            np.maximum(omega, np.negative(most, out=most), out=omega)
            np.maximum(omega, np.subtract(rate, bend, out=least), out=omega)
            rate = np.minimum(omega, np.add(rate, bend, out=most), out=omega)
            if tightest:
                # Who brakes in a curve keeps the curve, however fast its turning fades with it.
                np.divide(v, tightest, out=most)
                np.minimum(omega, most, out=omega)
                np.maximum(omega, np.negative(most, out=most), out=omega)
        if len(plans) > 2:
            self._slide(plans, situation, top)
        return plans

    def _slide(self, plans: Singles, situation: Situation, top: float) -> None:
        """Make the motion to the side of plans (3, steps, N) keep to its limits."""
        limits, step = self.motion.aside, self._step_time
        np.clip(plans[2], -limits.max_vel, limits.max_vel, out=plans[2])
        aside = np.full(plans.shape[2], situation.aside, dtype=np.float32)
        change = np.float32(min(limits.max_acc, limits.max_decel) * step)
        # All ways together it is no faster than it may be ahead.
        most = np.sqrt(np.maximum(np.float32(top * top) - plans[0] * plans[0], 0.0))
        for vy, fastest in zip(plans[2], most, strict=True):
            np.clip(vy, -fastest, fastest, out=vy)
            np.clip(vy, aside - change, aside + change, out=vy)
            aside = vy

    def _roll_out(self, plans: Singles, situation: Situation) -> _Rollouts:
        """Where plans (axes, steps, N), which become feasible, lead."""
        v, omega, *sideways = self._feasible(plans, situation)
        step = np.float32(self._step_time)
        x, y, yaw = (np.empty((len(v) + len(_HELD_FOR), v.shape[1]), np.float32) for _ in range(3))
        steps = len(v)
        # Where the robot will be when it takes the plan up, which it does not until then.
        begin = np.float32(self.config.delay * situation.turn_rate)
        ahead = np.float32(self.config.delay * max(situation.speed, 0.0))
        np.multiply(omega, step, out=yaw[:steps])
        middle = yaw[:steps] * np.float32(-0.5)
        way = v * step
        yaw[0] += begin
        for index in range(1, steps):
            yaw[index] += yaw[index - 1]
        middle += yaw[:steps]
        if sideways:
            across = sideways[0] * step
            cos, sin = np.cos(middle), np.sin(middle)
            np.subtract(cos * way, sin * across, out=x[:steps])
            np.add(sin * way, cos * across, out=y[:steps])
            y[0] += np.float32(self.config.delay * situation.aside)
        else:
            np.multiply(np.cos(middle), way, out=x[:steps])
            np.multiply(np.sin(middle, out=middle), way, out=y[:steps])
        x[0] += ahead * np.cos(begin / 2)
        y[0] += ahead * np.sin(begin / 2)
        for index in range(1, steps):
            x[index] += x[index - 1]
            y[index] += y[index - 1]

        # What looks at single commands, as the drive manager does, cannot know of the turn that a
        # plan has in mind: one that would lead too close by itself would not be carried out.
        speed = np.hypot(v[0], sideways[0][0]) if sideways else v[0]
        fastest = speed + np.abs(omega[0]) * np.float32(self._body.radius)
        seconds = np.minimum(np.float32(_HELD) / np.maximum(fastest, 1e-3), 1.0) * _HELD_FOR
        np.multiply(seconds, omega[0], out=yaw[steps:])
        middle = yaw[steps:] * np.float32(0.5)
        if sideways:
            way, across = seconds * v[0], seconds * sideways[0][0]
            cos, sin = np.cos(middle), np.sin(middle)
            np.subtract(cos * way, sin * across, out=x[steps:])
            np.add(sin * way, cos * across, out=y[steps:])
            return _Rollouts(plans, x, y, yaw)
        seconds *= v[0]
        np.multiply(seconds, np.cos(middle), out=x[steps:])
        np.multiply(seconds, np.sin(middle), out=y[steps:])
        return _Rollouts(plans, x, y, yaw)

    def _cost(self, rollouts: _Rollouts, seen: _Seen, situation: Situation) -> Floats:
        """What each rollout costs (N,); _CONTACT and more for those with a contact."""
        params, steps = self.config, self._steps
        needed = self._needed(rollouts, seen)
        away = seen.obstacles.at(rollouts.x, rollouts.y)
        cost = np.full(rollouts.count, _CONTACT)
        # By the largest circle that the body holds: most of what touches something does so there.
        surely = self._body.inscribed_radius - params.resolution
        alive = np.flatnonzero((away >= needed + np.float32(surely)).all(axis=0))
        rollouts, needed, away = rollouts.only(alive), needed.take(alive, 1), away.take(alive, 1)
        room = self._room(seen.obstacles, rollouts.x, rollouts.y, rollouts.yaw, away)
        free = np.flatnonzero((room >= needed).all(axis=0))
        alive, rollouts, room = alive.take(free), rollouts.only(free), room[:steps].take(free, 1)
        if not len(alive):
            return cost
        omega, v = rollouts.plans[1], rollouts.speed
        room -= np.float32(params.clearance)
        nearness = np.clip(1.0 - room / np.float32(params.obstacle_range), 0.0, 1.0)
        # The faster, the farther off what is planned comes out.
        hasty = np.maximum(v - (_SLOW + np.maximum(room, 0.0) / np.float32(_BESIDE)), 0.0)
        x, y = rollouts.x[:steps], rollouts.y[:steps]
        meets = np.zeros(len(alive), dtype=bool)
        if len(situation.movers):
            close, meets = self._people(situation, x, y, v)
            nearness = np.maximum(nearness, close)
        off, along, course = seen.along(x, y)
        facing = np.abs(wrap_angle(rollouts.yaw[steps - 1] - course))
        change = np.abs(np.diff(rollouts.plans[0], axis=0)).mean(axis=0) / self._linear.max_vel
        change += np.abs(np.diff(omega, axis=0)).mean(axis=0) / self._angular.max_vel
        for vy in rollouts.plans[2:]:
            change += np.abs(np.diff(vy, axis=0)).mean(axis=0) / self._linear.max_vel
        cost[alive] = (
            params.path_weight * off
            + params.progress_weight * along
            + params.heading_weight * facing
            + params.obstacle_weight * (nearness * nearness).mean(axis=0)
            + params.smoothness_weight * change
            + _HASTE * hasty.mean(axis=0)
            + _CONTACT * meets
        )
        return cost

    def _needed(self, rollouts: _Rollouts, seen: _Seen) -> Singles:
        """Room (steps + 2, N) that rollouts must have where they lead [m]."""
        params, steps = self.config, self._steps
        v = rollouts.speed
        needed = np.empty_like(rollouts.x)
        stray = np.subtract(v, np.float32(_SLOW), out=needed[:steps])
        np.maximum(stray, np.float32(0.0), out=stray)
        stray *= np.float32(_STRAY)
        needed[:steps] += np.float32(params.clearance - _ROUNDING)
        lacking = seen.here - params.clearance
        if lacking < 0.0:
            # A robot that stands too close already may go wherever it comes no closer.
            travelled = np.cumsum(v, axis=0) * np.float32(0.1 * self._step_time)
            needed[:steps] += np.minimum(0.0, np.float32(lacking) + travelled)
        needed[steps:] = min(0.0, seen.here) - _ROUNDING
        return needed

    def _people(
        self, situation: Situation, x: Singles, y: Singles, v: Singles
    ) -> tuple[Singles, NDArray[np.bool_]]:
        """Nearness (steps, N) of what moves, 0 … 1, and which plans (N,) drive into it.

        Whoever stands is walked round, so a plan that stands when somebody comes is a good one.
        """
        movers = situation.movers
        times: Floats = self.config.delay + self._step_time * np.arange(1.0, len(x) + 1.0)
        at_x, at_y = (each.astype(np.float32)[:, :, None] for each in predicted(movers, times))
        nearness = np.zeros_like(x)
        meets = np.zeros(x.shape[1], dtype=bool)
        for index, radius in enumerate(movers[:, 4].tolist()):
            kept = np.float32(radius + self._body.radius + _PERSONAL)
            room = np.hypot(x - at_x[index], y - at_y[index]) - kept
            now = float(np.hypot(*movers[index, :2]) - kept)
            nearness = np.maximum(nearness, np.clip(1.0 - room / _SHY, 0.0, 1.0))
            meets |= ((room < min(0.0, now)) & (v > _STANDS)).any(axis=0)
        return nearness, meets

    def _room(
        self,
        field: PointField,
        x: Singles,
        y: Singles,
        yaw: Singles,
        away: Singles | None = None,
    ) -> Singles:
        """Distance between the body at poses of any shape and the nearest obstacle [m].

        Where that is more than counts, of the circle around the body: the outline is looked at
        only near something. ``away`` is the distance from the body's middle, if it is known.
        """
        away = field.at(x, y) if away is None else away
        room: Singles = away - np.float32(self._body.radius)
        centres, radius = self._body.discs
        if len(centres) > 1:
            near = np.flatnonzero(away < self._free)
            x, y, yaw = (each.ravel().take(near) for each in (x, y, yaw))
            discs = field.least(x, y, np.cos(yaw), np.sin(yaw), centres.astype(np.float32))
            room.ravel()[near] = discs - np.float32(radius)
        return room

    def _ahead(self, situation: Situation, obstacles: PointField) -> tuple[Floats, Floats, Floats]:
        """Points (N, 2) of the path within reach, in the base frame; what is left; its course."""
        tracker = situation.tracker
        here = inverse((situation.x, situation.y, situation.yaw))
        if situation.homing:
            goal = transform_points(here, [tracker.goal])
            return goal, np.zeros(1), np.arctan2(goal[:, 1], goal[:, 0])
        # Beyond its end the path goes straight on where that is free. Plans are to come as far as
        # they can; were they to stop there, a slow one would be as good as one that is there
        # sooner. What makes the robot stop at the goal is the speed that it is allowed.
        beyond = tracker.progress + self._reach - tracker.length
        if beyond > 0.0:
            beyond = self._straight_on(beyond, situation, obstacles)
        end = min(tracker.progress + self._reach, tracker.length + max(beyond, 0.0))
        count = max(2, min(_MOST_PATH_POINTS, math.ceil((end - tracker.progress) / _PATH_SPACING)))
        at = np.linspace(tracker.progress, end, count)
        path = transform_points(here, tracker.points_at(at))
        course = tracker.headings_at(at) - situation.yaw
        # Where the path comes back on itself, what lies behind the turn is not yet to be reached.
        back = np.abs(np.unwrap(course) - course[0]) > _TURNED_BACK
        until = int(np.argmax(back)) if back.any() else count
        until = max(until, 2)
        return path[:until], at[until - 1] - at[:until], course[:until]

    def _straight_on(self, most: float, situation: Situation, obstacles: PointField) -> float:
        """How far the body could go on straight from the path's end with room to spare [m]."""
        tracker = situation.tracker
        here = inverse((situation.x, situation.y, situation.yaw))
        further = np.linspace(0.0, most, max(2, math.ceil(most / (2.0 * _PATH_SPACING))))
        places = transform_points(here, tracker.points_at(tracker.length + further))
        x, y = places.astype(np.float32).T
        yaw = np.full_like(x, tracker.end_heading - situation.yaw)
        room = self._room(obstacles, x, y, yaw)
        narrow = room < self.config.clearance + 0.5 * self.config.obstacle_range
        return float(further[max(int(np.argmax(narrow)) - 1, 0)] if narrow.any() else most)


def _standing(points: Floats, movers: Floats) -> Floats:
    """Points (N, 2) that belong to nothing that moves."""
    for x, y, _, _, radius in movers.tolist():
        points = points[np.hypot(points[:, 0] - x, points[:, 1] - y) > radius + _ITS_OWN]
    return points


@dataclass(frozen=True, eq=False)
class _Rollouts:
    """Plans and where they lead, in the base frame.

    Attributes
    ----------
    plans
        (axes, steps, N): velocities ahead, turning rates, and velocities to the left, if any.
    x, y, yaw
        (steps + 2, N): after each step [m, m, rad], and last where the first twist alone leads
        within the drive manager's reach.
    """

    plans: Singles
    x: Singles
    y: Singles
    yaw: Singles

    @property
    def count(self) -> int:
        return len(self.x[0])

    @property
    def speed(self) -> Singles:
        """(steps, N), whichever way [m/s]."""
        out: Singles = self.plans[0]
        return out if len(self.plans) == 2 else np.hypot(out, self.plans[2])

    def only(self, which: NDArray[np.int64]) -> _Rollouts:
        """Some of them, by their numbers."""
        if len(which) == self.count:
            return self
        return _Rollouts(
            self.plans.take(which, 2), *(each.take(which, 1) for each in (self.x, self.y, self.yaw))
        )


@dataclass(frozen=True, eq=False)
class _Seen:
    """What one cycle's plans are judged by, in the base frame.

    Attributes
    ----------
    obstacles
        Distance from them.
    here
        What room the robot has now [m].
    ahead
        Distance from the path ahead, which is
    path
        its points (M, 2),
    left
        how much of it comes after each (M,) [m],
    course
        and its direction there (M,) [rad].
    """

    obstacles: PointField
    here: float
    ahead: PointField
    path: Floats
    left: Floats
    course: Floats

    def along(self, x: Singles, y: Singles) -> tuple[Singles, Floats, Floats]:
        """Of places (steps, N): mean distance from the path [m], what is left of it, its course."""
        off: Singles = self.ahead.at(x, y).mean(axis=0)
        nearest = self.ahead.index(x[-1], y[-1])
        course = self.course[nearest]
        # Between two points of the path: by the way along its course.
        dx, dy = x[-1] - self.path[nearest, 0], y[-1] - self.path[nearest, 1]
        cos, sin = np.cos(course), np.sin(course)
        onward = np.clip(dx * cos + dy * sin, -_PATH_SPACING, _PATH_SPACING)
        beside = np.hypot(dx - onward * cos, dy - onward * sin)
        return off, self.left[nearest] - onward + beside, course
