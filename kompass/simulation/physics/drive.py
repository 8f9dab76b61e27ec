"""From velocity commands to wheel speeds, with the limits and the watchdog of a real base."""

from __future__ import annotations

import math

from kompass.simulation.physics.mjcf import WHEEL_RADIUS, WHEEL_SEPARATION

MAX_SPEED = 0.3  # m/s
MAX_TURN_RATE = 1.9  # rad/s
COMMAND_TIMEOUT = 0.5  # s without a command that stop the wheels


class DifferentialDrive:
    """Keeps the last command for ``COMMAND_TIMEOUT`` and no longer."""

    def __init__(self) -> None:
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
        self._command = (
            max(-MAX_SPEED, min(MAX_SPEED, v)),
            max(-MAX_TURN_RATE, min(MAX_TURN_RATE, omega)),
        )
        self._commanded_at = now

    def wheel_speeds(self, now: float) -> tuple[float, float]:
        """(left, right) wheel speeds in rad/s that are wanted at ``now`` (s)."""
        if now - self._commanded_at >= COMMAND_TIMEOUT:
            return 0.0, 0.0
        v, omega = self._command
        difference = omega * WHEEL_SEPARATION / 2
        return (v - difference) / WHEEL_RADIUS, (v + difference) / WHEEL_RADIUS
