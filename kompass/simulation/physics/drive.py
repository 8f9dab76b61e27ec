"""From velocity commands to wheel speeds, with the limits and the watchdog of a real base."""

from __future__ import annotations

import math

from kompass.simulation.physics.robot_model import TURTLEBOT3, RobotModel

COMMAND_TIMEOUT = 0.5  # s without a command that stop the wheels


class DifferentialDrive:
    """Keeps the last command for ``COMMAND_TIMEOUT`` and no longer."""

    def __init__(self, robot: RobotModel = TURTLEBOT3) -> None:
        self._robot = robot
        self._command = (0.0, 0.0)
        self._commanded_at = -math.inf

    def command(self, v: float, omega: float, now: float) -> None:
        """Drive with ``v`` (m/s, forward) and ``omega`` (rad/s, anticlockwise) from ``now`` (s).

        Values beyond the base's limits are cut to them.

        Raises
        ------
        ValueError
            One of them is not finite; the robot keeps its last command until it
            runs out.
        """
        for name, value in (("v", v), ("omega", omega)):
            if not math.isfinite(value):
                raise ValueError(f"command {name} is {value!r}; send a finite number")
        fastest, quickest = self._robot.max_speed, self._robot.max_turn_rate
        self._command = (
            max(-fastest, min(fastest, v)),
            max(-quickest, min(quickest, omega)),
        )
        self._commanded_at = now

    def wheel_speeds(self, now: float) -> tuple[float, float]:
        """(left, right) wheel speeds in rad/s that are wanted at ``now`` (s)."""
        if now - self._commanded_at >= COMMAND_TIMEOUT:
            return 0.0, 0.0
        v, omega = self._command
        radius = self._robot.wheel_radius
        difference = omega * self._robot.wheel_separation / 2
        return (v - difference) / radius, (v + difference) / radius
