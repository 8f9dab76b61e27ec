"""Where to look from: framing a map, looking straight down, and centring on the robot."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Bounds = tuple[float, float, float, float]
Vector = npt.NDArray[np.float64]

FIELD_OF_VIEW = math.radians(40.0)  # vertical; narrow enough that far walls keep their size
NOTHING_KNOWN: Bounds = (-3.0, -3.0, 3.0, 3.0)
FOLLOW_DISTANCE = 5.0  # m from the robot at most, when following begins

_PITCH = math.radians(58.0)  # below the horizon
_MARGIN = 0.90  # of half the picture that the map may fill
_NEAREST, _FARTHEST = 1.0, 2000.0
# Straight down has no "up" of its own: a hair south of it, north is at the top of the picture.
_TILT = 1e-3


def framing(bounds: Bounds, aspect: float, *, top: bool) -> tuple[Vector, Vector]:
    """Camera position and look-at point, (3,) each in m, from which all of `bounds` is seen.

    `bounds` is (x0, y0, x1, y1); `aspect` is width over height. The camera looks north, from
    above at an angle, or straight down for `top`.
    """
    x0, y0, x1, y1 = bounds
    centre = np.array([(x0 + x1) / 2.0, (y0 + y1) / 2.0, 0.0])
    corners = np.array([[x, y, 0.0] for x in (x0, x1) for y in (y0, y1)])
    away = offset_direction(top=top)
    distance = _FARTHEST
    # Seen at an angle the near half of the map is the larger one: aim, centre, and aim again.
    for _ in range(4):
        distance = _closest(corners - centre, away, aspect)
        _, along = _seen(corners - centre, away * distance)
        centre[1] += (along.max() + along.min()) / 2.0 * distance * 0.8
    return centre + away * distance, centre


def _closest(corners: Vector, away: Vector, aspect: float) -> float:
    """Least distance (m) in the direction `away` from which all corners (N, 3) are seen."""
    half = math.tan(FIELD_OF_VIEW / 2.0) * _MARGIN
    near, far = _NEAREST, _FARTHEST
    for _ in range(40):
        middle = math.sqrt(near * far)
        across, along = _seen(corners, away * middle)
        if np.all(np.abs(across) <= half * aspect) and np.all(np.abs(along) <= half):
            far = middle
        else:
            near = middle
    return far


def offset_direction(*, top: bool) -> Vector:
    """Unit vector (3,) from the point looked at to the camera."""
    if top:
        return np.array([0.0, -_TILT, math.sqrt(1.0 - _TILT**2)])
    return np.array([0.0, -math.cos(_PITCH), math.sin(_PITCH)])


def _seen(corners: Vector, camera: Vector) -> tuple[Vector, Vector]:
    """Tangents (N,) across and along the picture of points (N, 3), seen from `camera` looking at
    the origin; infinite behind the camera."""
    forward = -camera / np.linalg.norm(camera)
    right = np.array([1.0, 0.0, 0.0])
    up = np.cross(right, forward)
    rays = corners - camera
    depth = rays @ forward
    depth = np.where(depth > 1e-6, depth, np.nan)
    return (
        np.nan_to_num(rays @ right / depth, nan=np.inf),
        np.nan_to_num(rays @ up / depth, nan=np.inf),
    )
