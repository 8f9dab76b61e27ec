"""Motions of one speed for a while, as tests of a base drive them, and the room that they need.

No ROS and no clock: time is an argument [s].
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Pose2D, compose, inverse, transform_points
from kompass.algorithms.safety.velocity_limiter import VelocityLimits
from kompass.components.drive.command_queue import Twist2D

LONGEST_LEG = 60.0  # s
LONGEST_LEGS = 300.0  # s, of all that are looked at together
MOST_LEGS = 40  # to look at more holds up the wheels
LATE = 0.3  # s that a base may go on after a leg, before it brakes
STRIDE = 0.03  # m or rad between two poses that are looked at
MOST_POSES = 2000


@dataclass
class Leg:
    """One twist for a while.

    Parameters
    ----------
    twist
        (vx, vy, omega) [m/s, m/s, rad/s].
    seconds
        How long.
    """

    twist: Twist2D
    seconds: float
    done: float = 0.0  # s
    _began: float | None = None

    def step(self, _pose: Pose2D, now: float) -> Twist2D | None:
        """The twist for this moment; None when the time is over."""
        self._began = now if self._began is None else self._began
        self.done = now - self._began
        return self.twist if self.done < self.seconds else None

    def overdue(self, _now: float) -> bool:
        """Never: it ends by the clock, whatever the base makes of it."""
        return False


def read_legs(legs: Sequence[Sequence[float]], limits: VelocityLimits) -> list[Leg]:
    """Legs of rows (vx, vy, omega, seconds).

    Raises
    ------
    ValueError
        There are too many, or a row is no leg, faster than the robot may be, or takes too long;
        names it and the remedy.
    """
    if len(legs) > MOST_LEGS:
        raise ValueError(f"there are {len(legs)} legs; give at most {MOST_LEGS}")
    read = []
    axes = {"vx": limits.vx, "vy": limits.vy, "omega": limits.omega}
    for number, row in enumerate(legs, start=1):
        if len(row) != 4 or not all(math.isfinite(value) for value in row):
            raise ValueError(f"leg {number} is {list(row)}; give (vx, vy, omega, seconds)")
        for (name, axis), value in zip(axes.items(), row[:3], strict=True):
            if abs(value) > axis.max_vel:
                raise ValueError(
                    f"leg {number}: {name} = {value:g} is beyond the robot's {axis.max_vel:g}"
                )
        if not 0.0 < row[3] <= LONGEST_LEG:
            raise ValueError(
                f"leg {number}: seconds = {row[3]:g}; give more than 0 and at most {LONGEST_LEG:g}"
            )
        read.append(Leg((row[0], row[1], row[2]), row[3]))
    if not read:
        raise ValueError("there are no legs; give at least one")
    total = sum(leg.seconds for leg in read)
    if total > LONGEST_LEGS:
        raise ValueError(f"the legs take {total:g} s; at most {LONGEST_LEGS:g} are possible")
    return read


def swept(legs: Sequence[Leg], limits: VelocityLimits) -> NDArray[np.float64]:
    """Poses (N, 3) that the legs lead through one after the other, the ways to rest included.

    They begin at (0, 0, 0): in the frame of the robot where it stands.
    """
    start: NDArray[np.float64] = np.zeros(3)
    found = [start[None]]
    for leg in legs:
        vx, vy, omega = leg.twist
        brakes = max(
            math.hypot(vx, vy) / limits.vx.max_decel,
            abs(omega) / limits.omega.max_decel if omega else 0.0,
        )
        # What is driven while it brakes is half as far as at the full speed.
        whole = leg.seconds + LATE + brakes / 2.0
        count = math.ceil(whole * max(math.hypot(vx, vy), abs(omega)) / STRIDE) + 1
        times = np.linspace(0.0, whole, min(max(2, count), MOST_POSES))
        along = _along(leg.twist, times)
        poses = np.array([compose(start, pose) for pose in along])
        found.append(poses)
        # The next one sets out from where a base comes to rest that is late by nothing.
        start = compose(start, _along(leg.twist, np.array([leg.seconds]))[0])
    return np.concatenate(found)


def _along(twist: Twist2D, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Poses (N, 3) after so long at a twist."""
    vx, vy, omega = twist
    turned = omega * times
    if abs(omega) < 1e-9:
        return np.column_stack([vx * times, vy * times, turned])
    sin, cos = np.sin(turned) / omega, (1.0 - np.cos(turned)) / omega
    return np.column_stack([vx * sin - vy * cos, vx * cos + vy * sin, turned])


def least_gap(
    poses: NDArray[np.float64], points: NDArray[np.float64], footprint: Footprint, enough: float
) -> float:
    """The least distance of the body at poses (N, 3) to points (M, 2) [m]; infinite without points.

    Beyond ``enough`` [m] it may be told smaller than it is, by the circle around the body.
    """
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        return math.inf
    gaps: NDArray[np.float64] = np.asarray(cKDTree(points).query(poses[:, :2])[0])
    gaps = gaps - footprint.radius
    if not footprint.is_round:
        for index in np.flatnonzero(gaps < enough):
            seen = transform_points(inverse(poses[index]), points)
            near = seen[np.hypot(seen[:, 0], seen[:, 1]) < footprint.radius + enough]
            gaps[index] = footprint.distance(near).min() if len(near) else enough
    return float(gaps.min())
