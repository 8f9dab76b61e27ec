"""Poses in the plane: composition, inversion, and the quaternions ROS wants for a yaw."""

from __future__ import annotations

import math
from typing import TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = NDArray[np.float64]
Pose2D: TypeAlias = tuple[float, float, float]  # x, y, yaw [m, m, rad]


@overload
def wrap_angle(a: float) -> float: ...
@overload
def wrap_angle(a: Floats) -> Floats: ...
def wrap_angle(a: float | Floats) -> float | Floats:
    """The same angle in [-π, π), for a number or an array [rad]."""
    return (a + math.pi) % (2.0 * math.pi) - math.pi


def compose(pose_a: ArrayLike, pose_b: ArrayLike) -> Floats:
    """Pose b, given in the frame of pose a, in the frame that a is given in. Returns (3,)."""
    ax, ay, a_yaw = (float(value) for value in np.asarray(pose_a, dtype=np.float64))
    bx, by, b_yaw = (float(value) for value in np.asarray(pose_b, dtype=np.float64))
    c, s = math.cos(a_yaw), math.sin(a_yaw)
    return np.array([ax + c * bx - s * by, ay + s * bx + c * by, wrap_angle(a_yaw + b_yaw)])


def inverse(pose: ArrayLike) -> Floats:
    """The pose of the outer frame as seen from ``pose``. Returns (3,)."""
    x, y, yaw = (float(value) for value in np.asarray(pose, dtype=np.float64))
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([-c * x - s * y, s * x - c * y, wrap_angle(-yaw)])


def transform_points(pose: ArrayLike, pts: ArrayLike) -> Floats:
    """Points (N, 2) given in the frame of ``pose``, in the frame that ``pose`` is given in."""
    x, y, yaw = (float(value) for value in np.asarray(pose, dtype=np.float64))
    points = np.asarray(pts, dtype=np.float64).reshape(-1, 2)
    c, s = math.cos(yaw), math.sin(yaw)
    out = np.empty_like(points)
    out[:, 0] = x + c * points[:, 0] - s * points[:, 1]
    out[:, 1] = y + s * points[:, 0] + c * points[:, 1]
    return out


def yaw_from_quaternion(x: float, y: float, z: float, w: float) -> float:
    """Yaw of a rotation [rad]; roll and pitch are dropped. The quaternion need not be unit."""
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def quaternion_from_yaw(yaw: float) -> tuple[float, float, float, float]:
    """The unit quaternion (x, y, z, w) of a rotation about the vertical [rad]."""
    return (0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0))
