"""Follow a target whose place is measured: keep a distance, and a bearing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from kompass.algorithms.following.limits import stopping_speed
from kompass.algorithms.geometry import Pose2D, wrap_angle
from kompass.algorithms.tracking.kalman import MovingPoint
from kompass.algorithms.tracking.vision_follower import (
    UNSEEN,
    Quest,
    VisionFollower,
    VisionParams,
)

# A place this far from where the target should be is that of something else, for as long as it was
# seen a moment ago [m].
_JUMP = 1.0
# Slower than this, a target stands [m/s].
_STANDS = 0.1


@dataclass(frozen=True, kw_only=True)
class VisionRGBDParams(VisionParams):
    """The law's own parameters.

    Attributes
    ----------
    target_distance
        From the robot's middle to the target, to be kept [m]; None: that at which it is first seen.
    target_orientation
        Bearing at which the target is kept [rad]; 0: straight ahead, positive to the left.
    distance_tolerance
        Error of the distance that is none [m].
    angle_tolerance
        Error of the bearing that is none [rad].
    rotation_gain
        Turning rate for an error of the bearing [rad/s per rad].
    speed_gain
        Speed for an error of the distance [m/s per m], beside that of the target.
    min_depth, max_depth
        Range in which depths are believed [m].
    depth_conversion_factor
        Of the whole numbers of a depth image [m].
    place_deviation
        Standard deviation of a measured place [m].
    target_acceleration
        … of the target's acceleration [m/s²].
    """

    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {
        **VisionParams.bounds,
        "target_distance": (0.05, 100.0),
        "target_orientation": (-math.pi, math.pi),
        "distance_tolerance": (0.0, 10.0),
        "angle_tolerance": (0.0, math.pi),
        "depth_conversion_factor": (1e-6, 1e3),
        "place_deviation": (1e-3, 10.0),
        "target_acceleration": (1e-3, 100.0),
    }

    target_distance: float | None = None
    target_orientation: float = 0.0
    distance_tolerance: float = 0.05
    angle_tolerance: float = 0.1
    rotation_gain: float = 1.5
    speed_gain: float = 1.0
    min_depth: float = 0.0
    max_depth: float = 1000.0
    depth_conversion_factor: float = 1e-3
    place_deviation: float = 0.05
    target_acceleration: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.min_depth < self.max_depth:
            raise ValueError(f"min_depth: {self.min_depth} m; give less than max_depth")


class VisionRGBDFollower(VisionFollower[VisionRGBDParams]):
    """Keeps a distance from a target, and faces it.

    Places and poses are in one frame, which does not move with the robot. It never comes nearer to
    a target at rest than the distance that is kept.
    """

    params_class = VisionRGBDParams

    def begin(self, quest: Quest, now: float) -> None:
        super().begin(quest, now)
        self._target: MovingPoint | None = None
        self._kept = self.params.target_distance

    def see(self, place: tuple[float, float], now: float) -> None:
        """The target is at ``place`` (x, y) [m], measured at ``now`` [s]."""
        if self._target is None or now - self._seen > UNSEEN:
            self._target = MovingPoint(
                place,
                now,
                deviation=self.params.place_deviation,
                acceleration=self.params.target_acceleration,
            )
        elif math.dist(self._target.at(now)[0], place) > _JUMP:
            return
        else:
            self._target.measure(place, now)
        self._is_seen(now)

    def _follow(self, pose: Pose2D, now: float, dt: float) -> tuple[float, float, float, float]:
        params = self.params
        assert self._target is not None
        (x, y), (vx, vy) = self._target.at(now)
        dx, dy = x - pose[0], y - pose[1]
        distance, course = math.hypot(dx, dy), math.atan2(dy, dx)
        if self._kept is None:
            self._kept = max(distance, params.bounds["target_distance"][0])
        bearing = wrap_angle(course - pose[2])
        away = distance - self._kept
        side = wrap_angle(bearing - params.target_orientation)
        runs = vx * math.cos(course) + vy * math.sin(course)
        runs = runs if abs(runs) > _STANDS else 0.0
        v = runs
        if abs(away) > params.distance_tolerance:
            v += params.speed_gain * away
        # As fast as it still stops in time, behind a target that goes on as it does.
        decel = 0.5 * self._linear.max_decel
        v = min(v, runs + stopping_speed(max(0.0, away), decel, 1.5 * dt))
        v *= max(0.0, math.cos(bearing))
        omega = 0.0
        if abs(side) > params.angle_tolerance:
            rate = min(params.rotation_gain * abs(side), self._turning_rate(side, dt))
            omega = math.copysign(rate, side)
        return v, omega, away, side
