"""From velocity commands to wheel speeds, with the limits and the watchdog of a real base."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np

from kompass.simulation.physics.robot_model import (
    TURTLEBOT3,
    OmniWheels,
    RobotModel,
    Steering,
)

COMMAND_TIMEOUT = 0.5  # s without a command that stop the wheels
_ROLLS = 1e-3  # m/s below which the wheels keep their angle: there is no curve to be driven


class _Drive(ABC):
    """Keeps the last command for ``COMMAND_TIMEOUT`` and no longer."""

    def __init__(self, robot: RobotModel = TURTLEBOT3) -> None:
        self._robot = robot
        self._command = (0.0, 0.0, 0.0)
        self._commanded_at = -math.inf

    def command(self, v: float, omega: float, now: float, vy: float = 0.0) -> None:
        """Drive with ``v``, ``vy`` (m/s, ahead, to the left) and ``omega`` (rad/s, anticlockwise).

        From ``now`` (s) on. Values beyond the base's limits are cut to them.

        Raises
        ------
        ValueError
            One of them is not finite; the robot keeps its last command until it
            runs out.
        """
        for name, value in (("v", v), ("omega", omega), ("vy", vy)):
            if not math.isfinite(value):
                raise ValueError(f"command {name} is {value!r}; send a finite number")
        fastest, quickest = self._robot.max_speed, self._robot.max_turn_rate
        aside = 0.0 if self._robot.omni is None else self._robot.omni.max_side_speed
        self._command = (
            max(-fastest, min(fastest, v)),
            max(-aside, min(aside, vy)),
            max(-quickest, min(quickest, omega)),
        )
        self._commanded_at = now

    def wheel_speeds(self, now: float) -> tuple[float, ...]:
        """What is wanted of each motor at ``now`` (s): (left, right, …) wheel speeds [rad/s].

        Of a steered robot also the angles of the (left, right) wheel ahead [rad].
        """
        timed_out = now - self._commanded_at >= COMMAND_TIMEOUT
        return self._wheels(*((0.0, 0.0, 0.0) if timed_out else self._command), now)

    @abstractmethod
    def _wheels(self, v: float, vy: float, omega: float, now: float) -> tuple[float, ...]:
        """The motors' speeds and angles for a twist."""


class DifferentialDrive(_Drive):
    """Two wheels, turned by their difference."""

    def _wheels(self, v: float, vy: float, omega: float, now: float) -> tuple[float, ...]:
        radius = self._robot.wheel_radius
        difference = omega * self._robot.wheel_separation / 2
        return (v - difference) / radius, (v + difference) / radius


class SteeredDrive(_Drive):
    """Two driven wheels behind, two steered ones ahead: it turns only while it drives.

    The speed counts, and of the turning what the wheels can be steered to. As on a real car the
    servos take their time, and an electronic differential drives the wheels along the curve that
    they have.
    """

    def __init__(self, robot: RobotModel, steering: Steering) -> None:
        super().__init__(robot)
        self._steering = steering
        self._angle = 0.0
        self._turned_at = -math.inf

    def _wheels(self, v: float, vy: float, omega: float, now: float) -> tuple[float, ...]:
        steering, robot = self._steering, self._robot
        if abs(v) >= _ROLLS:
            wanted = math.atan(steering.wheel_base * omega / v)
            wanted = max(-steering.most, min(steering.most, wanted))
            most = steering.rate * min(now - self._turned_at, COMMAND_TIMEOUT)
            self._angle += max(-most, min(most, wanted - self._angle))
        self._turned_at = now
        curvature = math.tan(self._angle) / steering.wheel_base
        half = robot.wheel_separation / 2
        return (
            v * (1.0 - curvature * half) / robot.wheel_radius,
            v * (1.0 + curvature * half) / robot.wheel_radius,
            math.atan(steering.wheel_base * curvature / (1.0 - curvature * half)),
            math.atan(steering.wheel_base * curvature / (1.0 + curvature * half)),
        )


class OmniDrive(_Drive):
    """Three wheels that each drive across the line from the middle to it."""

    def __init__(self, robot: RobotModel, wheels: OmniWheels) -> None:
        super().__init__(robot)
        self._from_twist = rolling(robot, wheels)

    def _wheels(self, v: float, vy: float, omega: float, now: float) -> tuple[float, ...]:
        left, right, behind = (self._from_twist @ (v, vy, omega)).tolist()
        return left, right, behind


def rolling(
    robot: RobotModel, wheels: OmniWheels
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """The matrix (3, 3) from a twist (vx, vy, omega) to the speeds of three omni wheels [rad/s]."""
    directions = np.array(wheels.directions)
    away = np.full(3, wheels.away)
    return np.column_stack([-np.sin(directions), np.cos(directions), away]) / robot.wheel_radius


def drive_of(robot: RobotModel) -> _Drive:
    """The drive of one of the embedded robots."""
    if robot.steering is not None:
        return SteeredDrive(robot, robot.steering)
    if robot.omni is not None:
        return OmniDrive(robot, robot.omni)
    return DifferentialDrive(robot)
