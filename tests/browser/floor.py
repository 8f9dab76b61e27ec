"""Between the floor of the map and the pixels of the scene.

The floor is a plane and the camera a pinhole, so eight numbers say where each of its points is
drawn. They are found from what the console itself says of a few pixels.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Point = tuple[float, float]

# In the hexagon, each where a page that opens shows it: one is always far from the robot.
FAR_APART: tuple[Point, Point] = ((0.9, 0.55), (-1.65, 0.55))


class Floor:
    """Projects points of the floor (m, map frame) into the picture (fractions u right, v down)."""

    def __init__(self, floor: list[Point], picture: list[Point]) -> None:
        """From four or more pairs, no three of them on a line."""
        rows: list[list[float]] = []
        for (x, y), (u, v) in zip(floor, picture, strict=True):
            rows.append([x, y, 1, 0, 0, 0, -u * x, -u * y, -u])
            rows.append([0, 0, 0, x, y, 1, -v * x, -v * y, -v])
        _, _, directions = np.linalg.svd(np.array(rows))
        self._matrix: npt.NDArray[np.float64] = directions[-1].reshape(3, 3)

    def project(self, x: float, y: float) -> Point:
        """Where a point of the floor is drawn."""
        u, v, w = self._matrix @ np.array([x, y, 1.0])
        return float(u / w), float(v / w)
