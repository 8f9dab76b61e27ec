"""Whether a robot that is meant to move gets anywhere.

No ROS and no clock: time is an argument [s].
"""

import math

from kompass.algorithms.geometry import Pose2D, wrap_angle

NEAR = 0.05  # m; who stays within this of a place has not left it
TURNED = 0.2  # rad; on the spot, a turn by this is progress
MOST_TURNED = 2 * math.tau  # rad; who has turned round twice in one place is getting nowhere


class Progress:
    """Remembers where the robot last got somewhere, and when."""

    def __init__(self) -> None:
        self._at: Pose2D | None = None
        self._yaw = self._turned = 0.0  # the last heading, and the whole turn since then [rad]
        self._most = [0.0, 0.0]  # of these turns, to the right and to the left, that were progress
        self._since = 0.0

    def reset(self) -> None:
        """Nothing is wanted of the robot now."""
        self._at = None

    def stalled(self, pose: Pose2D, now: float, *, turning: bool) -> float:
        """For how long it has got nowhere [s].

        Parameters
        ----------
        pose
            Where it is.
        turning
            Whether it is meant to turn on the spot; only then a turn is progress, and only beyond
            those before it: who turns to and fro gets nowhere, nor does who turns for ever.
        """
        if self._at is None or self._left(self._at, pose):
            self._at, self._since = pose, now
            self._turned, self._most = 0.0, [0.0, 0.0]
        else:
            self._turned += float(wrap_angle(pose[2] - self._yaw))
            beyond = not self._most[0] - TURNED < self._turned < self._most[1] + TURNED
            if turning and beyond and abs(self._turned) <= MOST_TURNED:
                self._most[self._turned > 0.0] = self._turned
                self._since = now
        self._yaw = pose[2]
        return now - self._since

    @staticmethod
    def _left(place: Pose2D, pose: Pose2D) -> bool:
        return math.hypot(pose[0] - place[0], pose[1] - place[1]) >= NEAR
