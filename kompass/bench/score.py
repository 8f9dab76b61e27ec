"""BARN's metric: what a drive is worth, from its time and the length of BARN's own way."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kompass.simulation.physics.robot_model import RobotModel

NEAR = 1.0  # m from the goal: there, as BARN has it
THERE = 0.10  # m from the goal: there, as we have it
SET_OUT = 0.1  # m from the start, from where on the time counts
SLOWEST_START = 100.0  # s that a robot of 2 m/s may take
_TOP = 2.0  # m/s, of the robot that this time is for
_STEP = 0.02  # m between two poses whose gap is looked at
_CHUNK = 500  # poses looked at in one piece


def time_limit(top_speed: float) -> float:
    """Seconds that a drive may take: BARN's 100 s for 2 m/s, longer for a slower robot."""
    return SLOWEST_START * _TOP / top_speed


def score(length: float, top_speed: float, time: float | None) -> float:
    """What a drive is worth since 2023, 0 … 0.5.

    The optimal time over that taken, where less than twice the optimal time counts as twice, and
    more than eight times as eight times.

    Parameters
    ----------
    length
        Of BARN's way [m].
    top_speed
        Of the robot [m/s].
    time
        Taken [s]; None when it did not arrive, touched something, or was too late.
    """
    if time is None:
        return 0.0
    optimal = length / top_speed
    return optimal / min(max(time, 2.0 * optimal), 8.0 * optimal)


def arrival(
    times: Sequence[float], poses: NDArray[np.float64], goal: tuple[float, float]
) -> float | None:
    """Seconds from setting out until the goal was near; None when it never was.

    Parameters
    ----------
    times
        [s], (N,).
    poses
        (N, ≥ 2), the first one at the start.
    """
    if not len(poses):
        return None
    near = np.flatnonzero(np.hypot(*(poses[:, :2] - goal).T) <= NEAR)
    moved = np.flatnonzero(np.hypot(*(poses[:, :2] - poses[0, :2]).T) >= SET_OUT)
    if not len(near):
        return None
    return float(times[near[0]] - times[moved[0]]) if len(moved) else 0.0


def least_gap(
    robot: RobotModel, poses: NDArray[np.float64], obstacles: NDArray[np.float64]
) -> tuple[float, tuple[float, float]]:
    """The least distance from the body to an obstacle on a way, and where the robot was [m].

    Parameters
    ----------
    poses
        (N, 3), N ≥ 1; between them the robot went straight, turning evenly.
    obstacles
        (M, 3): x, y, radius, M ≥ 1.
    """
    dense = _dense(poses)
    best, at = np.inf, (0.0, 0.0)
    for first in range(0, len(dense), _CHUNK):
        part = dense[first : first + _CHUNK]
        gaps = robot.gap(part, obstacles[:, :2]) - obstacles[:, 2]
        index = int(np.argmin(gaps.min(axis=1)))
        if gaps[index].min() < best:
            best, at = float(gaps[index].min()), (float(part[index, 0]), float(part[index, 1]))
    return best, at


def _dense(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    whole = np.column_stack([poses[:, :2], np.unwrap(poses[:, 2])])
    steps = np.hypot(*np.diff(whole[:, :2], axis=0).T)
    moved = np.concatenate([[True], steps > 1e-3])  # what stands needs no second look
    whole = whole[moved]
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(whole[:, :2], axis=0).T))])
    at = np.linspace(0.0, way[-1], max(1, int(np.ceil(way[-1] / _STEP))) + 1)
    return np.column_stack([np.interp(at, way, whole[:, column]) for column in range(3)])
