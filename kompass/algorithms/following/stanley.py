"""Stanley: steer by the heading error and the cross-track error at the front axle.

G. M. Hoffmann, C. J. Tomlin, M. Montemerlo, S. Thrun, "Autonomous Automobile Trajectory Tracking
for Off-Road Driving: Controller Design, Experimental Validation and Racing", ACC 2007.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, TypeVar

from kompass.algorithms.following.follower import FollowerParams, PathFollower, Situation
from kompass.algorithms.geometry import wrap_angle


@dataclass(frozen=True, kw_only=True)
class StanleyParams(FollowerParams):
    """The law's own parameters.

    Attributes
    ----------
    heading_gain
        On the heading error.
    cross_track_gain
        k in atan(k e / v) [1/s].
    cross_track_min_linear_vel
        Least v there, which keeps a slow robot from twitching [m/s].
    wheel_base
        From the axle that drives to the (virtual) one that steers [m].
    max_steer
        Of the (virtual) steering angle [rad].
    """

    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {
        **FollowerParams.bounds,
        "cross_track_min_linear_vel": (0.001, 10.0),
        "wheel_base": (0.001, 100.0),
        "max_steer": (0.001, 1.57),
    }

    heading_gain: float = 1.0
    cross_track_gain: float = 1.5
    cross_track_min_linear_vel: float = 0.1
    wheel_base: float = 0.16
    max_steer: float = 1.2


S = TypeVar("S", bound=StanleyParams)


class StanleyLaw(PathFollower[S]):
    """A follower that steers by Stanley's law, whatever else it does."""

    def _curvature(self, situation: Situation) -> float:
        tracker, config = situation.tracker, self.config
        if situation.homing:
            dx, dy = tracker.goal[0] - situation.x, tracker.goal[1] - situation.y
            steer = wrap_angle(math.atan2(dy, dx) - situation.yaw)
        elif self.motion.is_steered:
            steer = self._steer_front_axle(situation)
        else:
            # The published law looks at the path beside the front axle, not the rear one.
            front_x = situation.x + config.wheel_base * math.cos(situation.yaw)
            front_y = situation.y + config.wheel_base * math.sin(situation.yaw)
            at = tracker.progress + config.wheel_base
            path_x, path_y = tracker.point_at(at)
            heading = tracker.heading_at(at)
            error = math.cos(heading) * (front_y - path_y) - math.sin(heading) * (front_x - path_x)
            speed = max(abs(situation.speed), config.cross_track_min_linear_vel)
            steer = config.heading_gain * wrap_angle(heading - situation.yaw) - math.atan(
                config.cross_track_gain * error / speed
            )
        steer = min(max(steer, -config.max_steer), config.max_steer)
        return math.tan(steer) / config.wheel_base

    def _steer_front_axle(self, situation: Situation) -> float:
        """The law for a car, whose path is that of the axle behind, at where the other is to be."""
        tracker, config = situation.tracker, self.config
        length = config.wheel_base
        x, y = tracker.point_at(tracker.progress)
        course = tracker.heading_at(tracker.progress)
        heading = course + math.atan(length * tracker.curvature_at(tracker.progress))
        dx = situation.x + length * math.cos(situation.yaw) - x - length * math.cos(course)
        dy = situation.y + length * math.sin(situation.yaw) - y - length * math.sin(course)
        error = math.cos(heading) * dy - math.sin(heading) * dx
        speed = max(abs(situation.speed), config.cross_track_min_linear_vel)
        return config.heading_gain * wrap_angle(heading - situation.yaw) - math.atan(
            config.cross_track_gain * error / speed
        )


class Stanley(StanleyLaw[StanleyParams]):
    """Stanley's law; a robot without a steered axle drives as if it had one ahead of it.

    One with steered wheels follows with its front axle what that would describe if the other one
    kept to the path, and turned round when it drives back.
    """

    params_class = StanleyParams
