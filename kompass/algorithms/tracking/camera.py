"""Where in space a pixel of a camera is, and how far away what it shows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kompass.algorithms.geometry import Floats
from kompass.algorithms.tracking.box import Box

# Of a box's width and height, the middle part whose depth counts: beside it is the background.
_MIDDLE = 0.3


@dataclass(frozen=True)
class Camera:
    """A pinhole camera without distortion; its frame looks along z, x to the right and y down.

    Attributes
    ----------
    width, height
        Of the image [px].
    fx, fy
        Focal lengths [px].
    cx, cy
        Where the optical axis meets the image [px].

    Raises
    ------
    ValueError
        A size or a focal length is not above 0, or a number is not finite.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    def __post_init__(self) -> None:
        for name in ("width", "height", "fx", "fy"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} of the camera is {value}; publish one above 0")
        if not (math.isfinite(self.cx) and math.isfinite(self.cy)):
            raise ValueError(f"cx, cy of the camera are {self.cx}, {self.cy}; publish finite ones")

    def point(self, u: float, v: float, depth: float) -> Floats:
        """The place (3,) of a pixel in the camera's frame [m], ``depth`` [m] along its axis."""
        return np.array([(u - self.cx) * depth / self.fx, (v - self.cy) * depth / self.fy, depth])


def depth_of(box: Box, depths: Floats, nearest: float, farthest: float) -> float | None:
    """Depth of what a box shows [m]; None where nothing in its middle has one in the range.

    Parameters
    ----------
    depths
        (rows, columns) [m] of the image that the box is of; 0 and what is not finite is none.
    nearest, farthest
        Range in which depths are believed [m].
    """
    half_x, half_y = max(0.5, _MIDDLE * box.width / 2.0), max(0.5, _MIDDLE * box.height / 2.0)
    top, bottom = max(0, round(box.y - half_y)), max(0, math.ceil(box.y + half_y))
    left, right = max(0, round(box.x - half_x)), max(0, math.ceil(box.x + half_x))
    middle = depths[top:bottom, left:right]
    believed = (middle > 0.0) & (middle >= nearest) & (middle <= farthest)
    valid = middle[np.isfinite(middle) & believed]
    return float(np.median(valid)) if len(valid) else None
