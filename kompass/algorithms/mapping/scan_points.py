"""Obstacle points from a planar scan."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kompass.algorithms.geometry import Floats, transform_points


def scan_to_points(
    ranges: ArrayLike,
    angle_min: float,
    angle_increment: float,
    range_min: float,
    range_max: float,
    sensor_pose: ArrayLike = (0.0, 0.0, 0.0),
) -> Floats:
    """The places (N, 2) in the base frame where rays met something.

    Only real returns count: finite and within ``range_min`` … ``range_max`` [m], the maximum
    itself excluded, which many sensors report for "nothing". ``sensor_pose`` is (x, y, yaw) of
    the sensor in the base frame.
    """
    measured = np.asarray(ranges, dtype=np.float64).ravel()
    real = (measured >= max(range_min, 1e-6)) & (measured < range_max)
    index = np.flatnonzero(real)
    angles = angle_min + angle_increment * index
    r = measured[index]
    return transform_points(sensor_pose, np.stack([r * np.cos(angles), r * np.sin(angles)], axis=1))
