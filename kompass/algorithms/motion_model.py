"""Which of all twists a robot's wheels can carry out."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from kompass.algorithms.following.limits import Limits

_NO_MOTION = Limits(0.0, 0.0, 0.0)


@dataclass(frozen=True)
class MotionModel:
    """What the kind of drive allows, beside the limits of each axis.

    Attributes
    ----------
    turning_radius
        Of the tightest turn that steered wheels can drive [m]; 0 for a robot that turns on the
        spot.
    aside
        Limits of the motion to the left and to the right; of zero for a robot without one.

    Raises
    ------
    ValueError
        The radius is negative or not finite.
    """

    turning_radius: float = 0.0
    aside: Limits = field(default=_NO_MOTION)

    def __post_init__(self) -> None:
        if not (math.isfinite(self.turning_radius) and self.turning_radius >= 0.0):
            raise ValueError(
                f"turning_radius: {self.turning_radius} m; give a finite number, 0 or more"
            )

    @property
    def is_steered(self) -> bool:
        """Whether it has to drive to turn."""
        return self.turning_radius > 0.0

    @property
    def slides(self) -> bool:
        """Whether it can go sideways."""
        return self.aside.max_vel > 0.0

    def turn(self, vx: float, omega: float) -> float:
        """What is left of a turning rate at a velocity ahead [rad/s]."""
        if not self.is_steered:
            return omega
        most = abs(vx) / self.turning_radius
        return min(max(omega, -most), most)
