"""Is it one source that says where the robot is? Two that contradict each other make it jump."""

from __future__ import annotations

import math
from collections import deque

from kompass.algorithms.geometry import Pose2D, wrap_angle

FASTEST, QUICKEST = 5.0, 5.0  # m/s and rad/s that any robot may do meanwhile
TURNED = 1.0  # rad beyond that, for it to be a jump
TIMES, WITHIN = 3, 2.0  # so many in so many seconds: one is a localiser that has found itself


class PoseJumps:
    """Counts jumps of a pose. Time is an argument [s]."""

    def __init__(self) -> None:
        self._last: tuple[Pose2D, float] | None = None
        self._jumps: deque[tuple[float, float]] = deque()  # when, and how far [m]

    def heard(self, pose: Pose2D, now: float, farther: float) -> None:
        """Take in where the robot is said to be.

        Parameters
        ----------
        pose
            (x, y, yaw), finite [m, m, rad].
        farther
            Beyond what any robot may drive meanwhile, for it to be a jump [m].
        """
        if self._last is not None:
            before, then = self._last
            passed = now - then
            away = math.dist(before[:2], pose[:2])
            turned = abs(float(wrap_angle(pose[2] - before[2])))
            if away > farther + FASTEST * passed or turned > TURNED + QUICKEST * passed:
                self._jumps.append((now, away))
        self._last = pose, now
        while self._jumps and now - self._jumps[0][0] > WITHIN:
            self._jumps.popleft()

    @property
    def told(self) -> str:
        """What is wrong with it, in a clause; empty when nothing is."""
        if len(self._jumps) < TIMES:
            return ""
        farthest = max(away for _, away in self._jumps)
        return (
            f"it jumps to and fro, {farthest:.1f} m, more often than {TIMES - 1} times in "
            f"{WITHIN:g} s; look whether two programs publish it"
        )
