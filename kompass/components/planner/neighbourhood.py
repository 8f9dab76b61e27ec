"""Which part of a path lies around the robot, and what becomes of the rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kompass.algorithms.geometry import Floats, Pose2D


@dataclass(frozen=True)
class Neighbourhood:
    """A path (N, 3), cut where it leaves a circle around the robot for the first time.

    Attributes
    ----------
    near
        From the robot on, up to there; (K, 3).
    rest
        What comes after it; (N - K, 3).
    visits
        Where the rest comes back into the circle: a piece of at least one pose for each time.
    """

    near: Floats
    rest: Floats
    visits: list[Floats]


def cut(path: Floats, pose: Pose2D, radius: float) -> Neighbourhood:
    """Cut the path (N, 3) that is still ahead of a robot at ``pose``.

    Parameters
    ----------
    radius
        Of the circle [m].
    """
    inside = np.hypot(path[:, 0] - pose[0], path[:, 1] - pose[1]) <= radius
    outside = np.flatnonzero(~inside)
    first = int(outside[0]) if len(outside) else len(path)
    rest = path[first:]
    back = np.flatnonzero(inside[first:])
    runs = np.split(back, np.flatnonzero(np.diff(back) > 1) + 1) if len(back) else []
    return Neighbourhood(path[:first], rest, [rest[run] for run in runs])
