"""Short motions without a path: so far ahead, so far back, so far round. Measured by odometry.

No ROS and no clock: time is an argument [s].
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.following.limits import stopping_speed
from kompass.algorithms.geometry import Pose2D, wrap_angle
from kompass.components.drive.command_queue import Twist2D

BRAKING_SHARE = 0.5  # of the robot's deceleration, to come to rest gently
SLOWEST = 0.2  # of the manoeuvre's speed, until it is there
DELAY = 0.15  # s from a measurement to its effect
PATIENCE = 3.0  # s beyond twice the time that the motion takes
GAP = math.radians(6.0)  # between two rays; what is narrower hides nothing that matters nearby
FAR = 2.0  # m of free way, beyond which more is no better


@dataclass
class Manoeuvre:
    """One motion along one axis.

    Parameters
    ----------
    amount
        How far; negative is backwards, or to the right [m or rad].
    speed
        At most; above 0 [m/s or rad/s].
    decel
        Of the robot along that axis [m/s² or rad/s²].
    turns
        Rotation instead of translation.
    """

    amount: float
    speed: float
    decel: float
    turns: bool
    done: float = 0.0  # signed as ``amount``
    _last: Pose2D | None = None
    _began: float | None = field(default=None)

    def step(self, pose: Pose2D, now: float) -> Twist2D | None:
        """The twist (vx, vy, omega) for this moment; None when the motion is complete."""
        if self._began is None:
            self._began = now
        if self._last is not None:
            self.done += self._moved(self._last, pose)
        self._last = pose
        left = (self.amount - self.done) * math.copysign(1.0, self.amount)
        if left <= 0:
            return None
        rate = stopping_speed(left, BRAKING_SHARE * self.decel, DELAY)
        rate = math.copysign(min(self.speed, max(rate, SLOWEST * self.speed)), self.amount)
        return (0.0, 0.0, rate) if self.turns else (rate, 0.0, 0.0)

    def overdue(self, now: float) -> bool:
        """Whether it takes longer than any reason could explain but a blocked wheel."""
        expected = abs(self.amount) / self.speed
        return self._began is not None and now - self._began > 2 * expected + PATIENCE

    def _moved(self, before: Pose2D, after: Pose2D) -> float:
        if self.turns:
            return float(wrap_angle(after[2] - before[2]))
        # Along the robot's own axis, so that slipping sideways does not count.
        dx, dy = after[0] - before[0], after[1] - before[1]
        return math.cos(before[2]) * dx + math.sin(before[2]) * dy


def free_way(points: NDArray[np.float64], radius: float, direction: float = 0.0) -> float:
    """How far a round robot can go straight before it touches something [m].

    Parameters
    ----------
    points
        Obstacles (N, 2) in the robot's frame [m].
    radius
        Of the circle around the footprint [m].
    direction
        0 is ahead, π is back [rad].
    """
    ahead = points[:, 0] * math.cos(direction) + points[:, 1] * math.sin(direction)
    aside = points[:, 1] * math.cos(direction) - points[:, 0] * math.sin(direction)
    meets = (ahead > 0) & (np.abs(aside) < radius)
    if not meets.any():
        return math.inf
    reach = ahead[meets] - np.sqrt(radius**2 - aside[meets] ** 2)
    return max(0.0, float(reach.min()))


def looked_at(
    ranges: NDArray[np.float64], bearings: NDArray[np.float64], direction: float, width: float
) -> bool:
    """Whether a scan has measured all of a sector: no gap in it is wider than ``GAP``.

    Parameters
    ----------
    ranges
        (N,) [m]; what is NaN, 0 or negative says nothing.
    bearings
        Of the rays (N,), from the robot [rad].
    direction, width
        Middle of the sector, and how far it reaches to either side [rad].
    """
    valid = bearings[ranges > 0.0]
    off = np.remainder(valid - direction + math.pi, math.tau) - math.pi
    reached = np.concatenate([[-width], np.sort(off[np.abs(off) <= width]), [width]])
    return bool(np.diff(reached).max() <= GAP)


def widest_turn(points: NDArray[np.float64], radius: float, most: float) -> tuple[float, float]:
    """The turn after which the way ahead is free the farthest, and how far [rad], [m].

    Of ways that are free for ``FAR`` or more the smallest turn is taken.

    Parameters
    ----------
    points, radius
        As of :func:`free_way`.
    most
        Turns up to this angle either way are looked at [rad].
    """
    steps = max(1, math.ceil(most / math.radians(10)))
    turns = sorted(np.linspace(-most, most, 2 * steps + 1), key=abs)
    ways = [min(FAR, free_way(points, radius, float(turn))) for turn in turns]
    best = int(np.argmax(ways))
    return float(turns[best]), ways[best]


def open_turn(
    points: NDArray[np.float64], radius: float, most: float, needed: float
) -> float | None:
    """The smallest turn after which there is a free way ahead [rad].

    Parameters
    ----------
    most
        Turns up to this angle either way are looked at [rad].
    needed
        Free way wanted after the turn [m].

    Returns
    -------
    float | None
        Positive to the left; None when no such turn opens a way.
    """
    steps = max(1, math.ceil(most / math.radians(5)))
    for size in np.linspace(most / steps, most, steps):
        ways = {turn: free_way(points, radius, turn) for turn in (float(size), -float(size))}
        turn = max(ways, key=lambda angle: ways[angle])
        if ways[turn] >= needed:
            return turn
    return None
