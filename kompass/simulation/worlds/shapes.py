"""The solid shapes a world is made of, all standing upright on the floor.

Each shape knows its signed distance in the plane, which is all that the map needs, and its
dimensions, which is all that the physics needs. One geometry serves both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


def _require_positive(shape: str, name: str, field: str, value: float) -> None:
    if not (math.isfinite(value) and value > 0.0):
        raise ValueError(
            f"{shape} {name!r}: {field} is {value!r}; give a finite length above 0 (metres)"
        )


@dataclass(frozen=True)
class Box:
    """An upright box.

    Attributes
    ----------
    name
        Unique within its world.
    center
        (x, y) of its middle in the world frame, metres.
    size
        (length, width) along its own x and y axes, metres.
    yaw
        Direction of its own x axis in the world frame, radians.
    height
        Metres above the floor.
    """

    name: str
    center: tuple[float, float]
    size: tuple[float, float]
    yaw: float = 0.0
    height: float = 0.5

    def __post_init__(self) -> None:
        _require_positive("box", self.name, "size[0]", self.size[0])
        _require_positive("box", self.name, "size[1]", self.size[1])
        _require_positive("box", self.name, "height", self.height)

    @property
    def reach(self) -> float:
        """How far its corners are from its middle [m]."""
        return math.hypot(*self.size) / 2

    def distance(self, points: Points) -> NDArray[np.float64]:
        """Signed distance in metres of world ``points`` (N, 2); negative inside. Shape (N,)."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        dx = points[:, 0] - self.center[0]
        dy = points[:, 1] - self.center[1]
        outside_x = np.abs(cos * dx + sin * dy) - self.size[0] / 2
        outside_y = np.abs(cos * dy - sin * dx) - self.size[1] / 2
        outside = np.hypot(np.maximum(outside_x, 0.0), np.maximum(outside_y, 0.0))
        inside = np.minimum(np.maximum(outside_x, outside_y), 0.0)
        return np.asarray(outside + inside, dtype=np.float64)


@dataclass(frozen=True)
class Cylinder:
    """An upright cylinder.

    Attributes
    ----------
    name
        Unique within its world.
    center
        (x, y) of its axis in the world frame, metres.
    radius
        Metres.
    height
        Metres above the floor.
    """

    name: str
    center: tuple[float, float]
    radius: float
    height: float = 0.5

    def __post_init__(self) -> None:
        _require_positive("cylinder", self.name, "radius", self.radius)
        _require_positive("cylinder", self.name, "height", self.height)

    @property
    def reach(self) -> float:
        """How far its side is from its axis [m]."""
        return self.radius

    def distance(self, points: Points) -> NDArray[np.float64]:
        """Signed distance in metres of world ``points`` (N, 2); negative inside. Shape (N,)."""
        offset = np.hypot(points[:, 0] - self.center[0], points[:, 1] - self.center[1])
        return np.asarray(offset - self.radius, dtype=np.float64)


Shape = Box | Cylinder
