"""From a point of the picture to a point of the floor.

Camera conventions are viser's (OpenCV's): the camera looks along its +z, +x is right, +y is down;
`wxyz` rotates camera coordinates into the world, and `fov` is vertical.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]

_FARTHEST = 2000.0  # m; beyond this the floor is a line at the horizon, not a place to drive to


@dataclass(frozen=True, slots=True)
class Camera:
    """Pose and lens of a view: position (3,) in m, unit quaternion (w, x, y, z), vertical field
    of view in rad, width over height."""

    position: tuple[float, float, float]
    wxyz: tuple[float, float, float, float]
    fov: float
    aspect: float


def ray(camera: Camera, u: float, v: float) -> Vector:
    """Unit direction (3,) in the world through the picture point (u right, v down, 0..1)."""
    half_height = math.tan(camera.fov / 2.0)
    direction = np.array(
        [(2.0 * u - 1.0) * half_height * camera.aspect, (2.0 * v - 1.0) * half_height, 1.0]
    )
    world = _rotation(camera.wxyz) @ direction
    return np.asarray(world / np.linalg.norm(world), dtype=np.float64)


def floor_point(camera: Camera, u: float, v: float) -> tuple[float, float] | None:
    """Where the picture point (u, v) meets z = 0, in m, or None at and above the horizon."""
    direction = ray(camera, u, v)
    height = camera.position[2]
    if height * direction[2] >= 0.0:
        return None
    distance = -height / direction[2]
    x = camera.position[0] + distance * direction[0]
    y = camera.position[1] + distance * direction[1]
    if math.hypot(x - camera.position[0], y - camera.position[1]) > _FARTHEST:
        return None
    return float(x), float(y)


def _rotation(wxyz: tuple[float, float, float, float]) -> Vector:
    """Rotation matrix (3, 3) of a quaternion of any length but zero."""
    w, x, y, z = np.asarray(wxyz, dtype=np.float64) / np.linalg.norm(wxyz)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
