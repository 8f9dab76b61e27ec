"""A lidar that repeats itself, told by the robot's own motion."""

import math

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.geometry import Pose2D, wrap_angle

# By so much odometry must say that the robot has moved meanwhile [m, rad]: enough that no
# localizer's wandering at rest counts, and little enough that not much is driven blindly.
MOVED, TURNED = 0.05, 0.1


class FrozenScan:
    """Compares each scan with the one before.

    The same ranges twice, to the last bit, come from no real lidar, for that has noise; but from a
    simulated one without noise whenever the robot stands. So a scan counts as frozen only when the
    robot has moved since it first came. One that saw nothing at all may stay the same in the open.

    Attributes
    ----------
    is_frozen
        Whether the newest scan says nothing of where the robot is now.
    """

    def __init__(self) -> None:
        self.is_frozen = False
        self._ranges = b""
        self._from: Pose2D | None = None

    def heard(self, ranges: NDArray[np.floating], pose: Pose2D | None) -> None:
        """Take in a scan's ranges (N,) [m] and where the robot was, if that is known."""
        same = ranges.tobytes()
        if same != self._ranges or not np.isfinite(ranges).any():
            self._ranges, self._from, self.is_frozen = same, pose, False
            return
        if pose is None:
            return
        if self._from is None:
            self._from = pose
        way = math.hypot(pose[0] - self._from[0], pose[1] - self._from[1])
        turn = abs(wrap_angle(pose[2] - self._from[2]))
        self.is_frozen = self.is_frozen or way >= MOVED or turn >= TURNED
