"""What the robot is put together from, as far as a part may be exchanged for another."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kompass.simulation.physics.motion import BodyMotion


class NoReading(Exception):
    """A sensor says nothing this time; whoever publishes it publishes nothing."""


class RangeFinder(Protocol):
    """Measures distances all around."""

    @property
    def age(self) -> float:
        """Seconds since the scan that was handed out last was measured."""

    def scan(self) -> NDArray[np.float32]:
        """Measure once.

        Returns
        -------
        NDArray[np.float32]
            Ranges [m] from straight ahead anticlockwise.

        Raises
        ------
        NoReading
            When there is none this time.
        """


class PoseSource(Protocol):
    """Tells where the robot is in the map."""

    def update(self, truth: BodyMotion) -> None:
        """Take in the true motion."""

    def read(self) -> BodyMotion:
        """The newest reading.

        Raises
        ------
        NoReading
            When there is none this time.
        """

    def relocate(self, pose: tuple[float, float, float]) -> None:
        """Believe that the robot is at a pose (x, y, yaw) of the map now, true or not.

        Raises
        ------
        NoReading
            When there is nothing that could be corrected.
        """


class Odometer(Protocol):
    """Tells how far the wheels have rolled."""

    def update(
        self, left_angle: float, right_angle: float, dt: float, rear_angle: float = 0.0
    ) -> None:
        """Take in the wheel angles (radians), ``dt`` seconds after the last ones.

        Of three omni wheels there is a third one.
        """

    def read(self) -> BodyMotion:
        """The newest reading.

        Raises
        ------
        NoReading
            When there is none this time.
        """


class PowerSource(Protocol):
    """Tells how full it is."""

    @property
    def charge(self) -> float:
        """From 0 to 1."""

    @property
    def charging(self) -> bool:
        """Whether it fills."""

    def step(self, at: tuple[float, float], seconds: float) -> None:
        """Let time pass; ``at`` is where the robot is then [m]."""


class WheelDrive(Protocol):
    """Turns commands into speeds of the wheels."""

    def command(self, v: float, omega: float, now: float, vy: float = 0.0) -> None:
        """Drive with ``v``, ``vy`` (m/s) and ``omega`` (rad/s) from ``now`` (s) on."""

    def wheel_speeds(self, now: float) -> tuple[float, ...]:
        """(left, right) in rad/s, and what else the robot has motors for."""
