"""The dynamic window approach: of the velocities within reach, the one whose near future is best.

D. Fox, W. Burgard, S. Thrun, "The Dynamic Window Approach to Collision Avoidance", IEEE Robotics
and Automation Magazine, 1997.

All rollouts are one array, and so is what they are judged by: two distance fields on one small
grid around the robot, one of the obstacles and one of the path ahead. A collision check and a
distance to the path are then look-ups.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from kompass.algorithms.following.follower import FollowerParams, NoCommand, PathFollower, Situation
from kompass.algorithms.following.limits import stopping_distance, stopping_speed
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, inverse, transform_points, wrap_angle

# What must be free beyond the braking distance of a velocity for it to be admissible [m].
_BEYOND_BRAKING = 0.1
# Of all rollouts together: 300 times the usual, and more than any robot has time for.
MOST_PLACES = 2_000_000
# Along one side of the grid around the robot.
MOST_CELLS = 2000
# How much free way makes a direction worth turning to [m].
_OPEN_AHEAD = 0.3

_Reals: TypeAlias = NDArray[np.floating[Any]]


@dataclass(frozen=True, kw_only=True)
class DWAParams(FollowerParams):
    """What is sampled and how it is judged.

    Attributes
    ----------
    prediction_time
        How far the rollouts look ahead [s].
    time_step
        Between two looked-at places of a rollout [s].
    linear_samples
        Velocities tried.
    angular_samples
        Turning rates tried for each.
    clearance
        What rollouts keep between the body and obstacles [m].
    resolution
        Of the grid around the robot [m].
    path_weight
        On the mean distance from the path, per metre.
    goal_weight
        On the distance left to the point ahead on the path, per metre.
    obstacle_weight
        On nearness to obstacles, 0 from ``obstacle_range`` on, 1 at contact.
    obstacle_range
        [m]
    smoothness_weight
        On the change of command, as a share of the largest velocities.
    """

    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {
        **FollowerParams.bounds,
        "prediction_time": (0.05, 10.0),
        "time_step": (0.01, 1.0),
        "linear_samples": (2, 100),
        "angular_samples": (2, 200),
        "clearance": (0.0, 10.0),
        "resolution": (0.005, 1.0),
        "obstacle_range": (0.001, 10.0),
    }

    prediction_time: float = 1.6
    time_step: float = 0.1
    linear_samples: int = 12
    angular_samples: int = 31
    clearance: float = 0.02
    resolution: float = 0.04
    path_weight: float = 3.0
    goal_weight: float = 3.0
    obstacle_weight: float = 0.1
    obstacle_range: float = 0.3
    smoothness_weight: float = 0.05

    def __post_init__(self) -> None:
        super().__post_init__()
        places = self.linear_samples * self.angular_samples * self.prediction_time / self.time_step
        if places > MOST_PLACES:
            raise ValueError(
                f"linear_samples × angular_samples × prediction_time / time_step: {places:.0f} "
                f"places looked at, more than {MOST_PLACES}; give fewer samples or a longer step"
            )


class DWA(PathFollower[DWAParams]):
    """Follows a path and goes round what stands beside or partly on it.

    It looks a second or two ahead and has no memory: before something that fills the way to both
    sides alike it stops without touching, and a new path from the planner is what helps.

    Parameters
    ----------
    config
        See :class:`DWAParams`.
    footprint
        The robot's body.
    limits
        ``max_v``, ``max_omega``, ``acc``, ``decel``, ``omega_acc``, ``motion``, as of every
        follower.
    """

    params_class = DWAParams
    needs_obstacles = True

    def __init__(
        self, config: DWAParams | None = None, *, footprint: Footprint, **limits: Any
    ) -> None:
        super().__init__(config, footprint=footprint, **limits)
        if self.motion.is_steered:
            raise ValueError(
                f"turning_radius: {self.motion.turning_radius:g} m; DWA turns on the spot to get "
                "round things: take MPPI for a robot with steered wheels"
            )
        self.robot_radius = footprint.radius
        steps = max(2, round(self.config.prediction_time / self.config.time_step))
        self._times = self.config.time_step * np.arange(1, steps + 1, dtype=np.float64)
        reach = self._linear.max_vel * self.config.prediction_time + self.robot_radius
        self._half = math.ceil((reach + self.config.obstacle_range + 0.2) / self.config.resolution)
        if 2 * self._half > MOST_CELLS:
            raise ValueError(
                f"resolution: {self.config.resolution} m is too fine for a grid that holds "
                f"max_v × prediction_time = {self._linear.max_vel:g} m/s × "
                f"{self.config.prediction_time:g} s; give a coarser one, or a shorter time"
            )

        cells = np.arange(-self._half, self._half + 1, dtype=np.float64)
        self._nodes = cells * self.config.resolution  # x of columns, y of rows

        self._gives_way = False

    def reset(self) -> None:
        super().reset()
        self._gives_way = False

    def _turns_to_path(self) -> bool:
        # What it has just turned away from, to get round something, it is not to turn back to.
        return not self._gives_way

    def _curvature(self, situation: Situation) -> float:
        raise AssertionError("DWA chooses velocities, not a curvature")

    def _drive(self, situation: Situation) -> tuple[float, float, float]:
        config = self.config
        v, omega = self._window(situation)
        shape = (len(omega) * len(v), len(self._times))
        # Exact positions on the arc of a constant twist; sinc keeps straight ones finite. What
        # depends on the turning rate alone is worked out once for all velocities.
        # Places are float32: there are thousands of them, and half as much memory is half the time.
        half_turn = 0.5 * omega[:, None] * self._times
        sinc = np.sinc(half_turn / math.pi).astype(np.float32)
        along = (v[:, None] * self._times)[None].astype(np.float32)
        chord = along * sinc[:, None]
        x = (chord * np.cos(half_turn).astype(np.float32)[:, None]).reshape(shape)
        y = (chord * np.sin(half_turn).astype(np.float32)[:, None]).reshape(shape)

        obstacles, path = self._fields(situation)
        if self._body.is_round:
            distance, from_path = self._look_up((obstacles, path), x, y)
        else:
            (from_path,) = self._look_up((path,), x, y)
            yaw = np.repeat((2.0 * half_turn).astype(np.float32), len(v), axis=0)
            distance = self._beside(obstacles, x, y, yaw)
        travelled = np.broadcast_to(along, (len(omega), *along.shape[1:])).reshape(shape)
        v, omega = np.tile(v, len(omega)), np.repeat(omega, len(v))
        # As in the original, what counts is that the robot can stop before it hits something: a
        # rollout is checked as far as its braking distance and a little, not to its end.
        braking = stopping_distance(1.0, self._linear.max_decel, 0.0) * v * v + v * situation.dt
        counts = travelled <= (braking + _BEYOND_BRAKING).astype(np.float32)[:, None]
        counts[:, 0] = True
        admissible = self._admissible(obstacles, distance, travelled, counts)
        self._gives_way = not admissible.any() or (self._gives_way and situation.off_course)
        if not admissible.any():
            return 0.0, 0.0, self._turn_to_open(obstacles, situation)
        nearest = np.where(counts, distance, np.inf).min(axis=1)
        aim = self._aim(situation)
        left = np.hypot(x[:, -1] - aim[0], y[:, -1] - aim[1])
        nearness = np.clip(1.0 - (nearest - self.robot_radius) / config.obstacle_range, 0.0, 1.0)
        change = np.abs(v - situation.speed) / self._linear.max_vel + np.abs(
            omega - situation.turn_rate
        ) / (2.0 * self._angular.max_vel)
        cost = (
            config.path_weight * from_path.mean(axis=1)
            + config.goal_weight * left
            + config.obstacle_weight * nearness
            + config.smoothness_weight * change
        )
        best = int(np.argmin(np.where(admissible, cost, np.inf)))
        return float(v[best]), 0.0, float(omega[best])

    def _admissible(
        self, obstacles: _Reals, distance: _Reals, travelled: _Reals, counts: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """Which rollouts (N, T) keep their distance; for a robot too close, which ones leave."""
        required = self.robot_radius + self.config.clearance
        origin = np.zeros(1)
        here = float(self._beside(obstacles, origin, origin, origin)[0])
        if here >= required:
            keeps: NDArray[np.bool_] = np.all((distance >= required) | ~counts, axis=1)
            return keeps
        outward = distance >= np.minimum(here + 0.3 * travelled, required)
        leaves: NDArray[np.bool_] = np.all(outward | ~counts, axis=1)
        return leaves

    def _turn_to_open(self, obstacles: _Reals, situation: Situation) -> float:
        """The turning rate towards the open direction that is nearest to the way to the aim."""
        aim = self._aim(situation)
        directions = np.linspace(-math.pi, math.pi, 48, endpoint=False)
        # The first place is that of the slowest rollout: what is open must be so for that one, too,
        # or the robot would turn here and there between two judgements.
        first = max(self.config.min_speed * float(self._times[0]), 0.001)
        ahead = np.append(first, np.linspace(0.05, _OPEN_AHEAD, 6))
        yaw = np.broadcast_to(directions[:, None], (len(directions), len(ahead)))
        distance = self._beside(obstacles, np.cos(yaw) * ahead, np.sin(yaw) * ahead, yaw)
        counts = np.ones(distance.shape, dtype=bool)
        travelled = np.broadcast_to(ahead, distance.shape)
        is_open = self._admissible(obstacles, distance, travelled, counts)
        if not is_open.any():
            raise NoCommand(
                f"No direction keeps {self.robot_radius + self.config.clearance:.2f} m from the "
                f"obstacles; the nearest is at {float(obstacles[self._half, self._half]):.2f} m."
            )
        wanted = math.atan2(aim[1], aim[0])
        # What was turned towards so far stays cheaper, or two equal ways would be dithered between.
        off = np.abs(wrap_angle(directions - wanted)) + 0.5 * (
            directions * situation.turn_rate < 0.0
        )
        turn = float(directions[is_open][int(np.argmin(off[is_open]))])
        rate = stopping_speed(abs(turn), 0.5 * self._angular.max_decel, 1.5 * situation.dt)
        rate = min(self._angular.max_vel, max(rate, self.config.min_turn_rate))
        return math.copysign(rate, turn)

    def _beside(self, obstacles: _Reals, x: _Reals, y: _Reals, yaw: _Reals) -> _Reals:
        """Distance of obstacles from the body at poses of any shape, and its radius on top [m].

        So much that of a round body it is the distance from its centre.
        """
        if self._body.is_round:
            (distance,) = self._look_up((obstacles,), x, y)
            return distance
        centres, radius = self._body.discs
        cos, sin = np.cos(yaw), np.sin(yaw)
        nearest = np.full(x.shape, np.inf, dtype=np.float32)
        for px, py in centres.tolist():
            (away,) = self._look_up((obstacles,), x + px * cos - py * sin, y + px * sin + py * cos)
            np.minimum(nearest, away, out=nearest)
        return nearest + (self.robot_radius - radius)

    def _look_up(self, fields: Sequence[_Reals], x: _Reals, y: _Reals) -> list[_Reals]:
        """Each field's values at base-frame places of any shape, interpolated between cells."""
        last = 2 * self._half - 1
        per_metre = np.float32(1.0 / self.config.resolution)
        u = np.clip(x * per_metre + np.float32(self._half), 0.0, last + 1.0)
        v = np.clip(y * per_metre + np.float32(self._half), 0.0, last + 1.0)
        col = np.minimum(np.floor(u), np.float32(last))
        row = np.minimum(np.floor(v), np.float32(last))
        u -= col
        v -= row
        stride = 2 * self._half + 1
        i = row.astype(np.int64)
        i *= stride
        i += col.astype(np.int64)
        out = []
        for values in fields:
            flat = values.ravel()
            # The same places in parts of the field that begin later: no index is added up anew.
            a, b, c, d = (flat[by:].take(i) for by in (0, 1, stride, stride + 1))
            b -= a
            b *= u
            a += b
            d -= c
            d *= u
            c += d
            c -= a
            c *= v
            a += c
            out.append(a)
        return out

    def _window(self, situation: Situation) -> tuple[Floats, Floats]:
        """The velocities (V,) and turning rates (W,) that can be reached in one period."""
        config = self.config
        low, high = self._linear.reachable(situation.speed, situation.dt)
        high = max(min(high, situation.allowed_speed), low, 0.0)
        # Standing still leads nowhere, and is what follows when nothing else is admissible.
        low = min(max(low, config.min_speed), high)
        left, right = self._angular.reachable(situation.turn_rate, situation.dt)
        v = np.linspace(low, high, config.linear_samples)
        omega = np.linspace(left, right, config.angular_samples)
        if left < 0.0 < right:
            omega = np.append(omega, 0.0)
        return v, omega

    def _aim(self, situation: Situation) -> tuple[float, float]:
        """Where the robot should be after the prediction time, in the base frame."""
        tracker = situation.tracker
        if situation.homing:
            target = tracker.goal
        else:
            reach = situation.allowed_speed * self.config.prediction_time
            target = tracker.point_at(tracker.progress + max(reach, 0.1))
        x, y = transform_points(inverse((situation.x, situation.y, situation.yaw)), [target])[0]
        return float(x), float(y)

    def _fields(self, situation: Situation) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Distances from obstacles and from the path ahead [m], (n, n) around the robot."""
        config = self.config
        tracker = situation.tracker
        window = self._half * config.resolution * 1.5
        along = np.arange(tracker.progress, tracker.progress + window, config.resolution / 2.0)
        path = tracker.points_at(along)
        path = transform_points(inverse((situation.x, situation.y, situation.yaw)), path)
        return self._distances(situation.obstacles), self._distances(path)

    def _distances(self, points: Floats) -> NDArray[np.float32]:
        """Distances [m] of the grid's nodes (n, n) from points (N, 2) in the base frame.

        Each node looks at one point only, but at where that is and not at the middle of its cell:
        between obstacles, a robot has no room to give away to rounding.
        """
        resolution, n = self.config.resolution, 2 * self._half + 1
        near = points[(np.abs(points) < self._half * resolution).all(axis=1)]
        if not len(near):
            return np.full((n, n), n * resolution, dtype=np.float32)
        # Of several in one cell the nearest to the robot counts, which is written last.
        near = near[np.argsort(-(near[:, 0] ** 2 + near[:, 1] ** 2), kind="stable")]
        col, row = (np.rint(near / resolution).astype(np.int64) + self._half).T
        empty = np.ones((n, n), dtype=bool)
        empty[row, col] = False
        points_of = np.zeros((2, n, n))
        points_of[:, row, col] = near.T
        row, col = distance_transform_edt(empty, return_distances=False, return_indices=True)
        x, y = points_of[:, row, col]
        away: Floats = np.hypot(x - self._nodes, y - self._nodes[:, None])
        return away.astype(np.float32)
