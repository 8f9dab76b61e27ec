"""What the rays of a planar scan say."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.geometry import Floats, transform_points

NEAREST = 1e-6  # m; a range of 0 is none


def scan_fault(
    ranges: ArrayLike,
    angle_min: float,
    angle_increment: float,
    range_min: float,
    range_max: float,
) -> str:
    """Why a scan says nothing of what is around the robot, in a clause; empty when it does.

    A scan of which no ray is a measurement is not one that met nothing: that says +inf, or the
    maximum (REP 117).
    """
    measured = np.asarray(ranges)
    if measured.ndim != 1 or measured.size == 0:
        return "ranges is empty; a scan has at least one ray"
    given = {"angle_min": angle_min, "range_min": range_min, "range_max": range_max}
    for name, value in given.items():
        if math.isnan(value) or (math.isinf(value) and name != "range_max"):
            return f"{name} = {value} is no number to measure by; have its driver give a finite one"
    if angle_increment == 0 or not math.isfinite(angle_increment):
        return f"angle_increment = {angle_increment}; have its driver give one other than 0"
    nearest = max(range_min, NEAREST)
    if range_max <= nearest:
        return f"range_max = {range_max:g} is not above range_min = {range_min:g}: it measures none"
    if not ((measured >= nearest) | np.isneginf(measured)).any():
        return (
            "ranges has no measurement: each is NaN, 0 or below range_min; look whether the sensor "
            "is covered, or broken"
        )
    return ""


class Rays(NamedTuple):
    """A scan, ray by ray.

    Attributes
    ----------
    returned
        Indices (M,) of the rays that met something.
    ranges
        How far those went, (M,) [m].
    ends
        Where those met it, (M, 2) [m], in the frame that the sensor's pose is given in.
    free_to
        How far each ray (N,) shows free space [m]; 0 where it says nothing.
    """

    returned: NDArray[np.intp]
    ranges: Floats
    ends: Floats
    free_to: Floats


def read_rays(
    ranges: ArrayLike,
    angle_min: float,
    angle_increment: float,
    range_min: float,
    range_max: float,
    sensor_pose: ArrayLike,
) -> Rays:
    """Tell rays that met something from those that did not, and both from those that failed.

    +inf and what is not below the maximum is free up to the maximum, which many sensors report for
    "nothing"; NaN, 0, -inf and what is nearer than the minimum range say nothing (REP 117).

    Parameters
    ----------
    ranges
        (N,) [m], ray i at ``angle_min + i * angle_increment`` in the sensor's frame.
    angle_min, angle_increment
        [rad]
    range_min, range_max
        Between them the sensor measures, or is believed [m].
    sensor_pose
        (x, y, yaw) of the sensor, in the frame that is asked for.
    """
    measured = np.asarray(ranges, dtype=np.float64).ravel()
    met = (measured >= max(range_min, NEAREST)) & (measured < range_max)
    index = np.flatnonzero(met)
    r, angle = measured[index], angle_min + angle_increment * index
    ends = transform_points(sensor_pose, np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1))
    free = met | (measured >= range_max)
    return Rays(index, r, ends, np.where(free, np.minimum(measured, range_max), 0.0))


def scan_to_points(
    ranges: ArrayLike,
    angle_min: float,
    angle_increment: float,
    range_min: float,
    range_max: float,
    sensor_pose: ArrayLike = (0.0, 0.0, 0.0),
) -> Floats:
    """The places (M, 2) where rays met something; parameters as of :func:`read_rays`.

    -inf, which is something nearer than the sensor can measure (REP 117), counts as met at
    ``range_min``.

    Raises
    ------
    ValueError
        The scan says nothing of what is around the robot; see :func:`scan_fault`.
    """
    fault = scan_fault(ranges, angle_min, angle_increment, range_min, range_max)
    if fault:
        raise ValueError(fault)
    measured = np.asarray(ranges, dtype=np.float64)
    near = np.where(np.isneginf(measured), max(range_min, NEAREST), measured)
    return read_rays(near, angle_min, angle_increment, range_min, range_max, sensor_pose).ends
