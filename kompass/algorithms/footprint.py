"""The outline of the robot's body on the floor."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from kompass.algorithms.geometry import Floats

# Corners at most this much farther than the sides make a circle of a polygon (share).
_ROUND = 0.03
# Discs along a body's shorter side, and at most along the longer one: more would cover it more
# closely, but each is looked up at every place of every plan.
_TILES = 3
_MOST_TILES = 8


@dataclass(frozen=True, eq=False)
class Footprint:
    """A convex polygon around the base frame's origin.

    Parameters
    ----------
    corners
        (N, 2), N ≥ 3, anticlockwise, in the base frame [m].

    Raises
    ------
    ValueError
        Fewer than three corners, one that is not finite, corners that are not convex and
        anticlockwise, or an origin that is not inside.
    """

    corners: Floats

    def __post_init__(self) -> None:
        corners = np.array(self.corners, dtype=np.float64)
        if corners.ndim != 2 or corners.shape[1:] != (2,) or len(corners) < 3:
            raise ValueError(f"corners: shape {corners.shape}; give at least three (x, y)")
        if not np.isfinite(corners).all():
            raise ValueError(f"corners: {corners.tolist()}; give finite numbers")
        side = np.roll(corners, -1, axis=0) - corners
        after = np.roll(side, -1, axis=0)
        turns = side[:, 0] * after[:, 1] - side[:, 1] * after[:, 0]
        if (turns <= 0.0).any():
            raise ValueError(
                f"corners: {corners.tolist()} are not convex; give a convex polygon, anticlockwise"
            )
        if (corners[:, 0] * side[:, 1] - corners[:, 1] * side[:, 0] <= 0.0).any():
            raise ValueError(
                f"corners: {corners.tolist()}; the base frame's origin must lie inside"
            )
        corners.setflags(write=False)
        object.__setattr__(self, "corners", corners)

    @classmethod
    def circle(cls, radius: float) -> Footprint:
        """A body that is round [m]: a polygon of 24 corners with that circumscribed circle."""
        if not (math.isfinite(radius) and radius > 0):
            raise ValueError(f"radius: {radius} m; give a finite number above 0")
        angles = np.linspace(0.0, math.tau, 24, endpoint=False)
        return cls(radius * np.stack([np.cos(angles), np.sin(angles)], axis=1))

    @cached_property
    def radius(self) -> float:
        """Of the smallest circle around the origin that holds the body [m]."""
        return float(np.hypot(self.corners[:, 0], self.corners[:, 1]).max())

    @cached_property
    def inscribed_radius(self) -> float:
        """Of the largest circle around the origin that the body holds [m]."""
        side = np.roll(self.corners, -1, axis=0) - self.corners
        cross = self.corners[:, 0] * side[:, 1] - self.corners[:, 1] * side[:, 0]
        return float((cross / np.hypot(side[:, 0], side[:, 1])).min())

    @property
    def is_round(self) -> bool:
        """Whether the circle around it is the body, all but a few percent."""
        return self.radius <= self.inscribed_radius * (1.0 + _ROUND)

    @cached_property
    def discs(self) -> tuple[Floats, float]:
        """Centres (N, 2) and the radius [m] of equal discs that cover the body's outline.

        One for a body that is all but round. Else the box around it is cut into tiles, three
        along its shorter side, and those at its border have a disc each, which sticks out by a
        fifth of a tile. What touches the body from outside touches a disc.
        """
        if self.is_round:
            return np.zeros((1, 2)), self.radius
        low, high = self.corners.min(axis=0), self.corners.max(axis=0)
        size = high - low
        count = np.minimum(np.ceil(_TILES * size / size.min() - 1e-9), _MOST_TILES).astype(int)
        tile = size / count
        column, row = (index.ravel() for index in np.indices(tuple(count)))
        border = (column == 0) | (row == 0) | (column == count[0] - 1) | (row == count[1] - 1)
        centres = low + tile * (np.column_stack([column, row])[border] + 0.5)
        return centres, float(np.hypot(*tile)) / 2.0

    def distance(self, points: ArrayLike) -> Floats:
        """How far points (N, 2) in the base frame are from the body [m]; negative inside. (N,)."""
        given = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        start = self.corners
        side = np.roll(start, -1, axis=0) - start
        length = np.hypot(side[:, 0], side[:, 1])
        unit = side / length[:, None]
        away = given[:, None, :] - start[None]
        t = np.clip((away * unit).sum(axis=2), 0.0, length)
        gap = away - t[:, :, None] * unit
        nearest = np.hypot(gap[:, :, 0], gap[:, :, 1]).min(axis=1)
        left_of = unit[:, 0] * away[:, :, 1] - unit[:, 1] * away[:, :, 0]
        inside = (left_of >= 0.0).all(axis=1)
        out: Floats = np.where(inside, -nearest, nearest)
        return out
