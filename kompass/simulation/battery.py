"""The embedded robot's battery: it empties with time and way, and fills where the robot began."""

from __future__ import annotations

import math

CAPACITY = 19.98  # Wh, as a TurtleBot3's
_IDLE, _PER_METRE = 6.0, 40.0  # W; J/m
_CHARGER = 60.0  # W
_DOCK = 0.25  # m from where it began, within which a robot that stands is charged
_FULL, _EMPTY = 12.6, 10.5  # V
_AT_FIRST = 0.8


def voltage(charge: float) -> float:
    """What a battery shows that is so full (0 to 1) [V]."""
    return _EMPTY + (_FULL - _EMPTY) * charge


class Battery:
    """A charge that depends on what the robot does and on nothing else.

    Parameters
    ----------
    dock
        (x, y) of where it is charged [m].

    Attributes
    ----------
    charge
        From 0 to 1.
    charging
        Whether it fills.
    """

    def __init__(self, dock: tuple[float, float]) -> None:
        self._dock, self._before = dock, dock
        self.charge, self.charging = _AT_FIRST, False

    def step(self, at: tuple[float, float], seconds: float) -> None:
        """Let time pass; ``at`` is where the robot is then [m]."""
        way, self._before = math.dist(at, self._before), at
        self.charging = math.dist(at, self._dock) <= _DOCK and way < 1e-3 * seconds
        spent = _IDLE * seconds + _PER_METRE * way
        gained = _CHARGER * seconds if self.charging else 0.0
        self.charge = min(1.0, max(0.0, self.charge + (gained - spent) / (3600.0 * CAPACITY)))
