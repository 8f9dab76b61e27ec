"""Where the robot is and how it moves, as one sensor or the truth has it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Matrix3 = NDArray[np.float64]


def _zeros() -> Matrix3:
    return np.zeros((3, 3))


@dataclass(frozen=True)
class BodyMotion:
    """A planar pose with the twist that goes with it.

    Attributes
    ----------
    pose
        (x, y, yaw) in the frame of whoever gives it, metres and radians.
    twist
        (vx, vy, omega) in ``base_link``, m/s and rad/s.
    pose_covariance
        (3, 3) of ``pose``; zeros for the truth.
    twist_covariance
        (3, 3) of ``twist``; zeros for the truth.
    age
        Seconds since it was measured.
    """

    pose: tuple[float, float, float]
    twist: tuple[float, float, float]
    pose_covariance: Matrix3 = field(default_factory=_zeros)
    twist_covariance: Matrix3 = field(default_factory=_zeros)
    age: float = 0.0
