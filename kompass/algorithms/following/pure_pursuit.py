"""Pure pursuit: drive the arc that leads to a point some way ahead on the path.

R. C. Coulter, "Implementation of the Pure Pursuit Path Tracking Algorithm", CMU-RI-TR-92-01, 1992.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from kompass.algorithms.following.follower import FollowerParams, PathFollower, Situation
from kompass.algorithms.geometry import wrap_angle


@dataclass(frozen=True, kw_only=True)
class PurePursuitParams(FollowerParams):
    """``lookahead_distance`` is the least; from a speed on it grows by ``lookahead_gain`` [s]."""

    lookahead_gain: float = 0.8


class PurePursuit(PathFollower[PurePursuitParams]):
    """Pure pursuit for a robot that can turn on the spot.

    The point ahead is found by arc length, not by intersecting a circle with the path, so it
    exists always and never lies on another part of the path. Near the goal it runs on beyond the
    end along the last direction, which keeps the arc gentle where the distance gets short.
    """

    params_class = PurePursuitParams

    def _curvature(self, situation: Situation) -> float:
        tracker, config = situation.tracker, self.config
        lookahead = max(config.lookahead_distance, config.lookahead_gain * abs(situation.speed))
        if self.motion.is_steered:
            lookahead = self._nearer(lookahead, tracker.remaining)
        if situation.homing:
            x, y = tracker.goal
        else:
            x, y = tracker.point_at(tracker.progress + lookahead)
        dx, dy = x - situation.x, y - situation.y
        distance = max(math.hypot(dx, dy), 0.05)
        angle = wrap_angle(math.atan2(dy, dx) - situation.yaw)
        return 2.0 * math.sin(angle) / distance
