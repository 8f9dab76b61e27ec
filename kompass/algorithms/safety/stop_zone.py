"""How far a commanded motion may go before the robot's body would meet something."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from kompass.algorithms.following.limits import stopping_distance
from kompass.algorithms.geometry import Floats


class StopZone:
    """Slows and stops a round robot before obstacles that lie in the way of its motion.

    The robot's circle is swept along the arc that the commanded twist describes. What counts is
    the length of that arc up to the first contact: with braking distance b, motion is blocked
    when it is at most ``b + critical_distance``, free from ``b + slowdown_distance`` on, and
    scaled linearly between. Obstacles beside the way do not matter, however near; neither does
    anything to a robot that turns on the spot, since a circle then sweeps only itself. Points
    that the motion moves away from are never in the way, so a robot that has come too close to
    something can always leave it.

    Parameters
    ----------
    robot_radius
        [m]
    critical_distance
        What is left between body and obstacle after braking [m].
    slowdown_distance
        Where slowing begins [m].
    max_decel
        Of the robot, for its braking distance [m/s²].
    reaction_time
        From a reading to the moment the brakes act [s].

    Raises
    ------
    ValueError
        An argument is out of range.
    """

    def __init__(
        self,
        robot_radius: float,
        critical_distance: float = 0.05,
        slowdown_distance: float = 0.2,
        *,
        max_decel: float = 2.5,
        reaction_time: float = 0.1,
    ) -> None:
        for name, value in (("robot_radius", robot_radius), ("max_decel", max_decel)):
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name}: {value}; give a finite number above 0")
        for name, value in (
            ("critical_distance", critical_distance),
            ("reaction_time", reaction_time),
        ):
            if not (math.isfinite(value) and value >= 0):
                raise ValueError(f"{name}: {value}; give a finite number, 0 or more")
        if not slowdown_distance > critical_distance:
            raise ValueError(
                f"slowdown_distance: {slowdown_distance} m; give more than critical_distance, "
                f"{critical_distance} m"
            )
        self.robot_radius = robot_radius
        self.critical_distance = critical_distance
        self.slowdown_distance = slowdown_distance
        self.max_decel = max_decel
        self.reaction_time = reaction_time

    def factor(self, points_in_base: ArrayLike, v: float, vy: float, omega: float) -> float:
        """The share 0 … 1 of the commanded twist that is safe.

        Parameters
        ----------
        points_in_base
            Obstacles (N, 2) in the base frame [m].
        v
            Commanded velocity ahead [m/s].
        vy
            To the left [m/s].
        omega
            Turning left [rad/s].

        Raises
        ------
        ValueError
            The command is not finite.
        """
        if not (math.isfinite(v) and math.isfinite(vy) and math.isfinite(omega)):
            raise ValueError(f"command: ({v}, {vy}, {omega}); give finite velocities")
        speed = math.hypot(v, vy)
        if speed < 1e-9:
            return 1.0
        points = np.asarray(points_in_base, dtype=np.float64).reshape(-1, 2)
        braking = stopping_distance(speed, self.max_decel, self.reaction_time)
        beyond = braking + self.slowdown_distance
        # Only what the circle can touch on the way matters; this also drops NaN.
        reach = beyond + self.robot_radius
        near = points[points[:, 0] ** 2 + points[:, 1] ** 2 <= reach * reach]
        if near.size == 0:
            return 1.0
        travel = float(self._travel(near, v / speed, vy / speed, omega / speed).min())
        ramp = self.slowdown_distance - self.critical_distance
        return min(1.0, max(0.0, (travel - braking - self.critical_distance) / ramp))

    def _travel(self, points: Floats, ux: float, uy: float, curvature: float) -> Floats:
        """Arc length (N,) until the circle, setting out along (ux, uy), touches each point."""
        ahead = points[:, 0] * ux + points[:, 1] * uy
        left = points[:, 1] * ux - points[:, 0] * uy
        radius = self.robot_radius
        travel = np.full(len(points), math.inf)
        touching = ahead**2 + left**2 <= radius * radius
        travel[touching & (ahead > 0)] = 0.0
        apart = ~touching
        if abs(curvature) < 1e-6:
            meets = apart & (ahead > 0) & (np.abs(left) < radius)
            travel[meets] = ahead[meets] - np.sqrt(radius**2 - left[meets] ** 2)
            return travel
        # Mirror right turns, so that the centre of turning is at (0, turn) with the robot going
        # round it counter-clockwise from the angle -π/2.
        turn = 1.0 / abs(curvature)
        side = left * math.copysign(1.0, curvature)
        away = np.hypot(ahead, side - turn)
        with np.errstate(divide="ignore", invalid="ignore"):
            cosine = (turn * turn + away * away - radius * radius) / (2.0 * turn * away)
        meets = apart & (np.abs(cosine) < 1.0)
        angle = np.arctan2(ahead[meets], turn - side[meets])
        travel[meets] = turn * np.mod(angle - np.arccos(cosine[meets]), 2.0 * math.pi)
        return travel
