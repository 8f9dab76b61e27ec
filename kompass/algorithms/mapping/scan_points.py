"""What the rays of a planar scan say."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.geometry import Floats, Pose2D, transform_points
from kompass.algorithms.transforms import Matrix

NEAREST = 1e-6  # m; a range of 0 is none
MOST_TILTED = 20.0  # degrees out of the level that a planar scanner may be mounted with


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


@dataclass(frozen=True)
class PlacedScan:
    """A planar scan and where its scanner is on the robot; read as :func:`read_rays` says.

    Attributes
    ----------
    ranges, angle_min, angle_increment, range_min, range_max
        As measured, anticlockwise seen from above, also by a scanner that hangs upside down.
    sensor
        (x, y, yaw) in the robot's frame.
    height
        Of its plane above the origin of that frame [m].
    """

    ranges: Floats
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    sensor: Pose2D
    height: float

    @classmethod
    def of(
        cls,
        ranges: ArrayLike,
        angle_min: float,
        angle_increment: float,
        range_min: float,
        range_max: float,
        mounted: Matrix,
    ) -> Self:
        """Place a scan on the robot.

        Parameters
        ----------
        mounted
            Matrix (4, 4) that takes points of the scanner's frame to the robot's.

        Raises
        ------
        ValueError
            The scanner does not look around in a level plane.
        """
        upright = float(mounted[2, 2])
        tilt = math.degrees(math.acos(min(1.0, abs(upright))))
        if tilt > MOST_TILTED:
            raise ValueError(
                f"its scanner is mounted {tilt:.0f} degrees out of the level, and what it sees is "
                f"taken to be in one plane; mount it within {MOST_TILTED:g} degrees, or have its "
                "points sent as a PointCloud2"
            )
        turns = 1.0 if upright > 0.0 else -1.0
        return cls(
            np.asarray(ranges, dtype=np.float64),
            turns * angle_min,
            turns * angle_increment,
            range_min,
            range_max,
            (
                float(mounted[0, 3]),
                float(mounted[1, 3]),
                float(np.arctan2(mounted[1, 0], mounted[0, 0])),
            ),
            float(mounted[2, 3]),
        )

    @property
    def rays(self) -> tuple[Floats, float, float, float, float]:
        """Ranges, angle_min, angle_increment, range_min and range_max."""
        return (
            self.ranges,
            self.angle_min,
            self.angle_increment,
            self.range_min,
            self.range_max,
        )

    @cached_property
    def fault(self) -> str:
        """Why it says nothing of what is around the robot; see :func:`scan_fault`."""
        return scan_fault(*self.rays)

    @cached_property
    def points(self) -> Floats:
        """Where rays met something, (M, 2) in the robot's frame [m].

        -inf, which is something nearer than the sensor can measure (REP 117), counts as met at
        ``range_min``.

        Raises
        ------
        ValueError
            It says nothing of what is around the robot.
        """
        if self.fault:
            raise ValueError(self.fault)
        nearest = max(self.range_min, NEAREST)
        near = np.where(np.isneginf(self.ranges), nearest, self.ranges)
        return read_rays(near, *self.rays[1:], self.sensor).ends
