"""How far a commanded motion may go before the robot's body would meet something."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from kompass.algorithms.following.limits import stopping_distance
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats
from kompass.algorithms.safety.sweep import time_to_contact


class StopZone:
    """Slows and stops a robot before obstacles that lie in the way of its motion.

    A round robot's circle is swept along the arc that the commanded twist describes. What counts is
    the length of that arc up to the first contact: with braking distance b, motion is blocked
    when it is at most ``b + critical_distance``, free from ``b + slowdown_distance`` on, and
    scaled linearly between. Obstacles beside the way do not matter, however near; neither does
    anything to a robot that turns on the spot, since a circle then sweeps only itself. Points
    that the motion moves away from are never in the way, so a robot that has come too close to
    something can always leave it.

    Of any other body the outline itself is swept, turning on the spot included. What counts is the
    way of its farthest corner up to the first contact. It is let go as fast as it can still stop
    ``critical_distance`` before that, and slower in proportion from ``slowdown_distance`` on: a
    long body that has to turn between two obstacles always has something near one of its corners.

    Parameters
    ----------
    robot_radius
        Of the circle around the body [m].
    critical_distance
        What is left between body and obstacle after braking [m].
    slowdown_distance
        Where slowing begins [m].
    max_decel
        Of the robot, for its braking distance [m/s²].
    reaction_time
        From a reading to the moment the brakes act [s].
    footprint
        The body, where it is not round.
    max_turn_decel
        Of the robot's turning [rad/s²]; only the turning of a body that is not round needs room.

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
        footprint: Footprint | None = None,
        max_turn_decel: float = 3.0,
    ) -> None:
        for name, value in (
            ("robot_radius", robot_radius),
            ("max_decel", max_decel),
            ("max_turn_decel", max_turn_decel),
        ):
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
        self.max_turn_decel = max_turn_decel
        self._body = None if footprint is None or footprint.is_round else footprint

    @property
    def turning_is_free(self) -> bool:
        """Whether the body sweeps nothing but itself when it turns on the spot."""
        return self._body is None

    def way(self, points_in_base: ArrayLike, direction: float) -> float:
        """How far the body can go straight, ``direction`` [rad] from its x axis, to a contact [m].

        Infinite where there is none.
        """
        points = np.asarray(points_in_base, dtype=np.float64).reshape(-1, 2)
        points = points[np.isfinite(points).all(axis=1)]
        if points.size == 0:
            return math.inf
        ux, uy = math.cos(direction), math.sin(direction)
        if self._body is not None:
            return float(time_to_contact(self._body, points, ux, uy, 0.0).min())
        return float(self._travel(points, ux, uy, 0.0).min())

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
        if self._body is not None:
            return self._factor_of_outline(self._body, points_in_base, v, vy, omega)
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

    def _factor_of_outline(
        self, body: Footprint, points_in_base: ArrayLike, v: float, vy: float, omega: float
    ) -> float:
        speed, rate = math.hypot(v, vy), abs(omega)
        fastest = speed + rate * self.robot_radius
        if fastest < 1e-9:
            return 1.0
        points = np.asarray(points_in_base, dtype=np.float64).reshape(-1, 2)
        # Driving and turning end together, for the twist keeps its curve while it fades.
        fade = max(speed / self.max_decel, rate / self.max_turn_decel)
        reach = self.robot_radius + self.slowdown_distance
        reach += fastest * (self.reaction_time + fade / 2.0)
        near = points[points[:, 0] ** 2 + points[:, 1] ** 2 <= reach * reach]
        if near.size == 0:
            return 1.0
        travel = fastest * float(time_to_contact(body, near, v, vy, omega).min())
        room = travel - self.critical_distance
        if room <= 0.0:
            return 0.0
        # At a share f of the twist it needs fastest * (f * reaction + f² * fade / 2) to stop.
        linear, square = fastest * self.reaction_time, fastest * fade
        stops = 2.0 * room / (linear + math.sqrt(linear * linear + 2.0 * square * room))
        return min(1.0, stops, room / (self.slowdown_distance - self.critical_distance))

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
