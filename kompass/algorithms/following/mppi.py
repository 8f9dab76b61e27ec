"""Model predictive path integral control: thousands of noisy plans, averaged by what they cost.

G. Williams, A. Aldrich, E. Theodorou, "Model Predictive Path Integral Control: From Theory to
Parallel Computation", Journal of Guidance, Control, and Dynamics, 2017; the weighting by
information theory of G. Williams et al., "Information Theoretic MPC for Model-Based Reinforcement
Learning", ICRA 2017.

A plan is a velocity and a turning rate for each step of the horizon. Every cycle the last plan,
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
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from kompass.algorithms.following.command import Command
from kompass.algorithms.following.follower import FollowerParams, NoCommand, PathFollower, Situation
from kompass.algorithms.following.limits import stopping_speed
from kompass.algorithms.following.path_tracker import PathTracker
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, inverse, transform_points, wrap_angle
from kompass.algorithms.mapping.moving import predicted

Singles: TypeAlias = NDArray[np.float32]

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
_FASTER: Singles = np.array([[[1.0]], [[1.1]], [[1.3]]], dtype=np.float32)
# Ways to come to rest that are looked at, and into how many parts each step of them is divided.
_BRAKING, _FINER = 31, 4
_ASIDE = 0.6  # rad; what lies farther to the side at the end of the way is turned to on the spot
# So far a command alone must be free, beyond the drive manager's critical zone [m].
_HELD = 0.07
# So fast it passes obstacles however near [m/s], and faster by 1 m/s for so much room [s]; what
# is faster costs more, per m/s, than it gains in way.
_SLOW, _BESIDE, _HASTE = 0.4, 0.15, 12.0
# Room beyond that of what is slow, for each m/s: the faster, the farther off a plan comes out [s].
_STRAY = 0.06
# Kept from what moves, and liked to be kept beyond that [m]; who drives slower stands [m/s].
_PERSONAL, _SHY, _STANDS = 0.12, 0.5, 0.02
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
        ``max_v``, ``max_omega``, ``acc``, ``decel``, ``omega_acc``, as of every follower.
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
        self._body = footprint
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
        self._noise = self._draw(np.random.default_rng(seed))
        self._fixed = self._plain()
        self._bank = 0
        self._plan: Singles = np.zeros((self._steps, 2), dtype=np.float32)

    def reset(self) -> None:
        super().reset()
        self._plan[:] = 0.0

    def take_over(self, other: PathFollower[Any]) -> None:
        super().take_over(other)
        self._plan[:] = (self._last.vx, self._last.omega)

    def _move(self, *args: Any, **kwargs: Any) -> Command:
        # Turning is one of the plans, under which obstacles are looked at; so it has no phase
        # that goes on by itself, only a name for whoever watches.
        self._phase = "driving"
        command = super()._move(*args, **kwargs)
        creeping = command.vx <= max(self.config.min_speed, 0.05 * self._linear.max_vel)
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

    def _drive(self, situation: Situation) -> tuple[float, float]:
        border = self._half * self.config.resolution
        near = situation.obstacles[(np.abs(situation.obstacles) < border).all(axis=1)]
        near = _standing(near, situation.movers)
        field = _Nearest(self.config.resolution, self._half, near).distance
        origin = np.zeros(1, dtype=np.float32)
        here = self._room(field, origin, origin, origin)[0]
        if (home := self._home(situation, field, float(here))) is not None:
            return home
        plans = self._feasible(self._candidates(situation), situation)
        cost = self._cost(plans, field, float(here), situation)
        least = float(cost.min())
        if least >= _CONTACT:
            self._plan[:] = 0.0
            if situation.speed > _STANDS:
                return self._brake(situation, field)
            raise NoCommand(
                f"No way keeps {self.config.clearance:.2f} m between the robot and the obstacles; "
                f"the nearest is at {max(float(here), 0.0):.2f} m."
            )
        weight = np.exp((least - cost) / self.config.temperature)
        mean: Singles = np.tensordot((weight / weight.sum()).astype(np.float32), plans, axes=1)[
            None
        ]
        best = plans[int(np.argmin(cost))][None]
        # Speeds end at the top, and so their mean lies below it: the same way, driven faster. Two
        # ways round something may lie on either side of the mean.
        means = self._feasible(mean * _FASTER, situation)
        costs = self._cost(means, field, float(here), situation)
        index = int(np.argmin(costs))
        chosen = means[index] if costs[index] < _CONTACT else best[0]
        self._plan = chosen
        return float(chosen[0, 0]), float(chosen[0, 1])

    def _brake(self, situation: Situation, field: _Field) -> tuple[float, float]:
        """As hard as it can, and turned to where most room is left while it comes to rest.

        What lay behind something else is seen late: then the way straight on is not the best one.
        """
        turns = np.linspace(-1.0, 1.0, _BRAKING) * self._angular.max_vel
        wanted = np.zeros((_BRAKING, self._steps, 2), dtype=np.float32)
        wanted[:, :, 1] = turns[:, None]
        plans = self._feasible(wanted, situation)
        # It stands when it has stopped: turning on the spot is looked at anew then.
        v, omega = plans[:, :, 0], plans[:, :, 1] * (plans[:, :, 0] > 0.0)
        # In finer steps than plans have: all of it is over within a few of them.
        v, omega = np.repeat(v, _FINER, axis=1), np.repeat(omega, _FINER, axis=1)
        step = np.float32(self._step_time / _FINER)
        yaw: Singles = np.cumsum(omega, axis=1) * step
        x: Singles = np.cumsum(v * np.cos(yaw), axis=1) * step
        y: Singles = np.cumsum(v * np.sin(yaw), axis=1) * step
        room = self._room(field, x, y, yaw).min(axis=1)
        # Of equally good ones the one that turns least.
        best = int(np.lexsort((np.abs(turns), -np.round(room, 3)))[0])
        return 0.0, float(plans[best, 0, 1])

    def _home(self, situation: Situation, field: _Field, here: float) -> tuple[float, float] | None:
        """The last bit of the way as pure pursuit drives it, if that is free; else None.

        There what a plan still wins by coming nearer is less than what the noise makes of it: the
        mean of all plans creeps, and stands beside the goal.
        """
        tracker, ahead = situation.tracker, self.config.lookahead_distance
        if not situation.homing and tracker.remaining > ahead:
            return None
        here_from = inverse((situation.x, situation.y, situation.yaw))
        ((px, py),) = transform_points(here_from, np.array([tracker.goal]))
        distance, bearing = math.hypot(px, py), math.atan2(py, px)
        if distance > 2.0 * ahead:
            return None  # the path comes back on itself
        if distance <= 0.7 * self.config.goal_tolerance:
            bearing = 0.0  # on the spot: where it lies does not matter any more
        plan = np.zeros((1, self._steps, 2), dtype=np.float32)
        if abs(bearing) > _ASIDE:
            rate = stopping_speed(abs(bearing), 0.5 * self._angular.max_decel, 1.5 * situation.dt)
            rate = max(min(rate, self._angular.max_vel), self.config.min_turn_rate)
            plan[0, 0, 1] = math.copysign(min(rate, abs(bearing) / self._step_time), bearing)
        else:
            curvature = 2.0 * math.sin(bearing) / max(distance, 0.05)
            way = np.arange(1, self._steps + 1) * situation.allowed_speed * self._step_time
            steps = np.diff(np.minimum(way, distance), prepend=0.0) / self._step_time
            plan[0, :, 0] = steps
            plan[0, :, 1] = curvature * steps
        plan = self._feasible(plan, situation)
        if self._cost(plan, field, here, situation)[0] >= _CONTACT:
            return None
        self._plan = plan[0]
        return float(plan[0, 0, 0]), float(plan[0, 0, 1])

    def _draw(self, random: np.random.Generator) -> Singles:
        """Noise (banks, rollouts, steps, 2) in velocity [m/s] and turning rate [rad/s]."""
        params = self.config
        knots = random.standard_normal((_BANKS, params.rollouts, _KNOTS, 2))
        at = np.linspace(0.0, _KNOTS - 1.0, self._steps)
        low = np.minimum(at.astype(np.int64), _KNOTS - 2)
        share = (at - low)[:, None]
        noise = knots[:, :, low] * (1.0 - share) + knots[:, :, low + 1] * share
        noise[..., 0] *= params.speed_noise * self._linear.max_vel
        noise[..., 1] *= params.turn_noise * self._angular.max_vel
        return noise.astype(np.float32)

    def _plain(self) -> Singles:
        """Plans (N, steps, 2) that noise around the last one would rarely meet.

        To stop, to turn, to drive an arc, to step aside, and to step aside and come back.
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
        both = [np.column_stack([share * top * steady, rate]) for share, rate in plans]
        return np.array(both, dtype=np.float32)

    def _candidates(self, situation: Situation) -> Singles:
        """Plans (N, steps, 2) to be looked at, whether the robot could do them or not."""
        at = np.arange(self._steps) + situation.dt / self._step_time
        moved = np.empty_like(self._plan)
        for axis in range(2):
            moved[:, axis] = np.interp(at, np.arange(self._steps), self._plan[:, axis])
        self._bank = (self._bank + 1) % _BANKS
        plans: Singles = moved + self._noise[self._bank]
        plans[0] = moved
        plans[1 : 1 + len(self._fixed)] = self._fixed
        return plans

    def _feasible(self, plans: Singles, situation: Situation) -> Singles:
        """The same plans within the robot's speeds and accelerations, from its velocity on."""
        step = self._step_time
        linear, angular = self._linear, self._angular
        top = np.minimum(linear.max_vel, situation.allowed_speed)
        v = np.clip(plans[:, :, 0], 0.0, top)
        omega = np.clip(plans[:, :, 1], -angular.max_vel, angular.max_vel)
        speed = np.full(len(plans), max(situation.speed, 0.0), dtype=np.float32)
        rate = np.full(len(plans), situation.turn_rate, dtype=np.float32)
        faster, slower = linear.max_acc * step, linear.max_decel * step
        bend = angular.max_acc * step
        for index in range(plans.shape[1]):
            speed = np.clip(v[:, index], speed - slower, speed + faster)
            # Whoever wants to turn tightly slows down first: a wheel that slips turns nothing.
            tightest = self.config.lateral_acceleration / np.maximum(speed, 1e-3)
            wanted = np.clip(omega[:, index], -tightest, tightest)
            rate = np.clip(wanted, rate - bend, rate + bend)
            v[:, index], omega[:, index] = speed, rate
        out: Singles = np.stack([v, omega], axis=2)
        return out

    def _cost(self, plans: Singles, field: _Field, here: float, situation: Situation) -> Floats:
        """What each plan (N, steps, 2) costs (N,); _CONTACT and more for those with a contact."""
        params, step = self.config, self._step_time
        v, omega = plans[:, :, 0], plans[:, :, 1]
        # Where the robot will be when it takes the plan up, which it does not until then.
        begin = np.float32(params.delay * situation.turn_rate)
        ahead = np.float32(params.delay * max(situation.speed, 0.0))
        yaw = begin + np.cumsum(omega, axis=1) * step
        middle = yaw - 0.5 * step * omega
        x = ahead * np.cos(begin / 2) + np.cumsum(v * np.cos(middle), axis=1) * step
        y = ahead * np.sin(begin / 2) + np.cumsum(v * np.sin(middle), axis=1) * step

        room = self._room(field, x, y, yaw) - params.clearance
        nearness = np.clip(1.0 - room / params.obstacle_range, 0.0, 1.0)
        # The faster, the farther off what is planned comes out.
        hasty = np.maximum(v - (_SLOW + np.maximum(room, 0.0) / _BESIDE), 0.0).mean(axis=1)
        # A robot that stands too close already may go wherever it comes no closer.
        travelled = np.cumsum(v, axis=1) * step
        needed = np.minimum(0.0, here - params.clearance + 0.1 * travelled)
        contact = (room < needed + _STRAY * np.maximum(v - _SLOW, 0.0) - _ROUNDING).any(axis=1)
        if len(situation.movers):
            close, meets = self._people(situation, x, y, v)
            nearness = np.maximum(nearness, close)
            contact |= meets
        contact |= self._held(plans, field) < min(0.0, here) - _ROUNDING

        off, along, course = self._along(situation, x, y)
        facing = np.abs(wrap_angle(yaw[:, -1] - course))
        change = np.abs(np.diff(v, axis=1)).mean(axis=1) / self._linear.max_vel
        change += np.abs(np.diff(omega, axis=1)).mean(axis=1) / self._angular.max_vel
        cost: Floats = (
            params.path_weight * off
            + params.progress_weight * along
            + params.heading_weight * facing
            + params.obstacle_weight * (nearness * nearness).mean(axis=1)
            + params.smoothness_weight * change
            + _HASTE * hasty
            + _CONTACT * contact
        )
        return cost

    def _people(
        self, situation: Situation, x: Singles, y: Singles, v: Singles
    ) -> tuple[Singles, NDArray[np.bool_]]:
        """Nearness (N, steps) of what moves, 0 … 1, and which plans (N,) drive into it.

        Whoever stands is walked round, so a plan that stands when somebody comes is a good one.
        """
        movers = situation.movers
        times = self.config.delay + self._step_time * np.arange(1, x.shape[1] + 1)
        at_x, at_y = (each.astype(np.float32) for each in predicted(movers, times))
        nearness = np.zeros_like(x)
        meets = np.zeros(len(x), dtype=bool)
        for index, radius in enumerate(movers[:, 4].tolist()):
            kept = np.float32(radius + self._body.radius + _PERSONAL)
            room = np.hypot(x - at_x[index], y - at_y[index]) - kept
            now = float(np.hypot(*movers[index, :2]) - kept)
            nearness = np.maximum(nearness, np.clip(1.0 - room / _SHY, 0.0, 1.0))
            meets |= ((room < min(0.0, now)) & (v > _STANDS)).any(axis=1)
        return nearness, meets

    def _held(self, plans: Singles, field: _Field) -> Singles:
        """Room left (N,) where each plan's first twist leads within the gate's reach [m].

        What looks at single commands, as the drive manager does, cannot know of the turn that a
        plan has in mind: a command that would lead too close by itself would not be carried out.
        """
        v, omega = plans[:, 0, 0], plans[:, 0, 1]
        fastest = v + np.abs(omega) * np.float32(self._body.radius)
        seconds = np.minimum(np.float32(_HELD) / np.maximum(fastest, 1e-3), 1.0)[:, None]
        seconds = seconds * np.array([0.5, 1.0], dtype=np.float32)
        yaw = seconds * omega[:, None]
        way = seconds * v[:, None]
        out: Singles = self._room(field, way * np.cos(yaw / 2), way * np.sin(yaw / 2), yaw).min(
            axis=1
        )
        return out

    def _room(self, field: _Field, x: Singles, y: Singles, yaw: Singles) -> Singles:
        """Distance between the body at poses of any shape and the nearest obstacle [m]."""
        centres, radius = self._body.discs
        if len(centres) == 1:
            return field.at(x, y) - np.float32(radius)
        cos, sin = np.cos(yaw), np.sin(yaw)
        nearest = np.full(x.shape, np.inf, dtype=np.float32)
        for px, py in centres.astype(np.float32):
            distance = field.at(x + px * cos - py * sin, y + px * sin + py * cos)
            np.minimum(nearest, distance, out=nearest)
        nearest -= np.float32(radius)
        return nearest

    def _along(self, situation: Situation, x: Singles, y: Singles) -> tuple[Floats, Floats, Floats]:
        """Mean distance from the path [m], what is left of its part ahead [m], its course there."""
        path, left, course = self._ahead(situation)
        spacing = self._half * self.config.resolution / _PATH_CELLS
        cells = _Nearest(spacing, _PATH_CELLS, path)
        off = cells.distance.at(x, y).mean(axis=1)
        nearest = cells.index(x[:, -1], y[:, -1])
        # Between two points of the path: by the way along its course.
        dx, dy = x[:, -1] - path[nearest, 0], y[:, -1] - path[nearest, 1]
        cos, sin = np.cos(course[nearest]), np.sin(course[nearest])
        onward = np.clip(dx * cos + dy * sin, -_PATH_SPACING, _PATH_SPACING)
        beside = np.hypot(dx - onward * cos, dy - onward * sin)
        return off, left[nearest] - onward + beside, course[nearest]

    def _ahead(self, situation: Situation) -> tuple[Floats, Floats, Floats]:
        """Points (N, 2) of the path within reach, in the base frame; what is left; its course."""
        tracker = situation.tracker
        here = inverse((situation.x, situation.y, situation.yaw))
        if situation.homing:
            goal = transform_points(here, [tracker.goal])
            return goal, np.zeros(1), np.arctan2(goal[:, 1], goal[:, 0])
        end = min(tracker.progress + self._reach, tracker.length)
        count = max(2, min(_MOST_PATH_POINTS, math.ceil((end - tracker.progress) / _PATH_SPACING)))
        at = np.linspace(tracker.progress, end, count)
        path = transform_points(here, np.array([tracker.point_at(float(s)) for s in at]))
        course = np.array([tracker.heading_at(float(s)) for s in at]) - situation.yaw
        # Where the path comes back on itself, what lies behind the turn is not yet to be reached.
        back = np.abs(np.unwrap(course) - course[0]) > _TURNED_BACK
        until = int(np.argmax(back)) if back.any() else count
        until = max(until, 2)
        return path[:until], at[until - 1] - at[:until], course[:until]


def _standing(points: Floats, movers: Floats) -> Floats:
    """Points (N, 2) that belong to nothing that moves."""
    for x, y, _, _, radius in movers.tolist():
        points = points[np.hypot(points[:, 0] - x, points[:, 1] - y) > radius + _ITS_OWN]
    return points


class _Field:
    """Values on a square grid around the robot, in the base frame.

    Parameters
    ----------
    per_metre
        Cells [1/m].
    half
        Cells from the robot to the border.
    values
        (2 half + 1, 2 half + 1), by row (y) and column (x).
    """

    def __init__(self, per_metre: float, half: int, values: Singles) -> None:
        self._per_metre, self._half, self._n = np.float32(per_metre), np.float32(half), 2 * half + 1
        self._last = np.float32(2 * half - 0.001)
        self._flat = values.ravel()

    def at(self, x: Singles, y: Singles) -> Singles:
        """Interpolated between cells, at places of any shape; beyond the border its values."""
        u, v = x * self._per_metre, y * self._per_metre
        for index in (u, v):
            index += self._half
            np.clip(index, 0.0, self._last, out=index)
        col, row = u.astype(np.int32), v.astype(np.int32)
        u -= col
        v -= row
        i = row * self._n + col
        flat, n = self._flat, self._n
        low, high = flat.take(i), flat.take(i + n)
        low += (flat.take(i + 1) - low) * u
        high += (flat.take(i + n + 1) - high) * u
        high -= low
        high *= v
        low += high
        return low


class _Nearest:
    """The nearest of given points from everywhere on a square grid around the robot.

    Which one it is may be off by what is left of a cell; how far it is, is not.

    Parameters
    ----------
    resolution
        [m]
    half
        Cells from the robot to the border.
    points
        (N, 2) in the base frame [m]; those beyond the border count as the nearest cells on it.
    """

    def __init__(self, resolution: float, half: int, points: Floats) -> None:
        n = 2 * half + 1
        self._resolution, self._half, self._n = resolution, half, n
        if not len(points):
            far = np.full((n, n), n * resolution, dtype=np.float32)
            self.distance = _Field(1.0 / resolution, half, far)
            return
        cell = np.clip(np.rint(points / resolution), -half, half).astype(np.int64) + half
        which = np.full((n, n), -1, dtype=np.int64)
        which[cell[:, 1], cell[:, 0]] = np.arange(len(points))
        row, col = distance_transform_edt(which < 0, return_distances=False, return_indices=True)
        self._which = which[row, col]
        at = (np.arange(n) - half) * resolution
        away = np.hypot(points[self._which, 0] - at[None, :], points[self._which, 1] - at[:, None])
        self.distance = _Field(1.0 / resolution, half, away.astype(np.float32))

    def index(self, x: Singles, y: Singles) -> NDArray[np.int64]:
        """Of the nearest point, at places (M,)."""
        col = np.clip(np.rint(x / self._resolution), -self._half, self._half).astype(np.int64)
        row = np.clip(np.rint(y / self._resolution), -self._half, self._half).astype(np.int64)
        out: NDArray[np.int64] = self._which[row + self._half, col + self._half]
        return out
