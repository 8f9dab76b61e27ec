"""How fast an axis may go and change, and how fast it may be so that it stops in time."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """Of one axis of motion, magnitudes: [m/s, m/s²], or [rad/s, rad/s²] for rotation.

    Raises
    ------
    ValueError
        A limit is negative or not finite.
    """

    max_vel: float
    max_acc: float
    max_decel: float

    def __post_init__(self) -> None:
        for name in ("max_vel", "max_acc", "max_decel"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0):
                raise ValueError(f"{name}: {value}; give a finite number, 0 or more")

    def reachable(self, velocity: float, dt: float) -> tuple[float, float]:
        """The lowest and highest velocity that can follow ``velocity`` after ``dt`` [s].

        Away from zero the axis accelerates, towards zero it decelerates; a step through zero
        spends the time that is left of it accelerating. A velocity above the limit may only fall.
        """
        speed = abs(velocity)
        fastest = max(min(self.max_vel, speed + self.max_acc * dt), speed - self.max_decel * dt)
        if self.max_decel > 0 and speed < self.max_decel * dt:
            slowest = -min(self.max_vel, self.max_acc * (dt - speed / self.max_decel))
        else:
            slowest = speed - self.max_decel * dt
        return (slowest, fastest) if velocity >= 0 else (-fastest, -slowest)

    def going(self, commanded: float, measured: float, dt: float) -> float:
        """What to accelerate from: the last command, unless the robot plainly did not follow it.

        Measurements lag and are noisy; but after a stop or a slowdown they are right.
        """
        obeys = abs(measured - commanded) <= max(0.3 * self.max_vel, 3.0 * self.max_acc * dt)
        return commanded if obeys else measured

    def approach(self, velocity: float, target: float, dt: float) -> float:
        """The velocity closest to ``target`` that can follow ``velocity`` after ``dt`` [s]."""
        low, high = self.reachable(velocity, dt)
        return min(max(target, low), high)


def stopping_speed(distance: float, decel: float, delay: float) -> float:
    """The speed from which the axis still stops within ``distance`` ≥ 0.

    It goes on for ``delay`` [s] at that speed, then brakes with ``decel``: the positive root of
    v · delay + v² / (2 decel) = distance.
    """
    if distance <= 0.0 or decel <= 0.0:
        return 0.0
    lost = decel * delay
    return math.sqrt(lost * lost + 2.0 * decel * distance) - lost


def stopping_distance(speed: float, decel: float, delay: float) -> float:
    """How far the axis still goes from ``speed`` ≥ 0: ``delay`` [s] unbraked, then braking."""
    return speed * delay + (speed * speed / (2.0 * decel) if decel > 0.0 else 0.0)
