"""The path of a car, leg by leg: each is driven ahead or back as a whole."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from kompass.algorithms.geometry import Floats, wrap_angle

# What faces this much off the way to the next pose is meant to be driven back [rad]. Paths of
# others often say of a pose only that it is somewhere, and so much off it is never by chance.
_AGAINST = 2.0 * math.pi / 3.0


@dataclass(frozen=True, eq=False)
class Leg:
    """A part of a path.

    Attributes
    ----------
    poses
        (N, 3): x, y, yaw of the car turned round where it is driven back: along the way.
    backward
        Whether it is driven back.
    """

    poses: Floats
    backward: bool


def legs_of(poses: Floats) -> list[Leg]:
    """The legs of a path (N, 3), N ≥ 1; one begins where the one before it ends."""
    delta = np.diff(poses[:, :2], axis=0)
    moves = np.hypot(delta[:, 0], delta[:, 1]) > 1e-6
    course = np.arctan2(delta[:, 1], delta[:, 0])
    middle = poses[:-1, 2] + wrap_angle(np.diff(poses[:, 2])) / 2.0
    back = np.abs(wrap_angle(course - middle)) > _AGAINST
    steps = np.flatnonzero(moves)
    if not len(steps):
        return [Leg(poses, False)]
    changes = steps[1:][back[steps[1:]] != back[steps[:-1]]]
    cuts = [0, *changes.tolist(), len(poses) - 1]
    legs = []
    for first, last in itertools.pairwise(cuts):
        part = poses[first : last + 1].copy()
        backward = bool(back[steps[np.searchsorted(steps, first)]])
        if backward:
            part[:, 2] = wrap_angle(part[:, 2] + math.pi)
        legs.append(Leg(part, backward))
    return legs
