"""A world: a floor, the wall around it, what stands on it, and where the robot starts."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kompass.simulation.worlds.shapes import Box, Points, Shape

# The robot's body has a radius of 0.10 m; a start closer than this would begin in contact.
START_CLEARANCE = 0.15


@dataclass(frozen=True)
class World:
    """A place to drive in, as data. Lengths in metres, angles in radians, frame ``map``.

    Attributes
    ----------
    name
        What ``--sim NAME`` calls it.
    title
        One line for people.
    floor
        Corners (x, y) of the floor, anticlockwise: the inner faces of the outer wall.
    start
        The robot's first pose (x, y, yaw).
    obstacles
        What stands on the floor.
    wall_thickness
        Of the outer wall, built outside the floor.
    wall_height
        Of the outer wall.
    doorways
        Where a door can close, each as the closed door; open ones, and so not in the map.
    """

    name: str
    title: str
    floor: tuple[tuple[float, float], ...]
    start: tuple[float, float, float]
    obstacles: tuple[Shape, ...]
    wall_thickness: float = 0.10
    wall_height: float = 0.5
    doorways: tuple[Box, ...] = ()

    def __post_init__(self) -> None:
        if len(self.floor) < 3:
            raise ValueError(
                f"world {self.name!r}: floor has {len(self.floor)} corners; give at least 3"
            )
        if _area(self.floor) <= 0.0:
            raise ValueError(
                f"world {self.name!r}: floor runs clockwise (signed area "
                f"{_area(self.floor):.3f} m²); list its corners anticlockwise"
            )
        names = [shape.name for shape in (*self.solids, *self.doorways)]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(
                    f"world {self.name!r}: two shapes are called {name!r}; rename one of them"
                )
        start = np.array([self.start[:2]])
        if not self.on_floor(start)[0]:
            raise ValueError(f"world {self.name!r}: start {self.start} is off the floor; move it")
        for shape in self.solids:
            clearance = float(shape.distance(start)[0])
            if clearance < START_CLEARANCE:
                raise ValueError(
                    f"world {self.name!r}: start {self.start} is {clearance:.3f} m from "
                    f"{shape.name!r}; keep it {START_CLEARANCE} m away"
                )

    @cached_property
    def walls(self) -> tuple[Box, ...]:
        """The outer wall, one box along each side of the floor.

        At an outward corner both boxes run on until their outer faces meet, so no gap is left;
        at an inward corner they already overlap outside the floor.
        """
        corners = self.floor
        count = len(corners)
        walls = []
        for index in range(count):
            before, start, end, after = (corners[(index + k) % count] for k in (-1, 0, 1, 2))
            direction = _direction(start, end)
            length = math.dist(start, end)
            at_start = self._overrun(_direction(before, start), direction)
            at_end = self._overrun(direction, _direction(end, after))
            along = (length + at_end - at_start) / 2
            out = self.wall_thickness / 2
            walls.append(
                Box(
                    name=f"wall_{index}",
                    # The outside of an anticlockwise side lies on its right: (sin, -cos).
                    center=(
                        start[0] + along * math.cos(direction) + out * math.sin(direction),
                        start[1] + along * math.sin(direction) - out * math.cos(direction),
                    ),
                    size=(length + at_start + at_end, self.wall_thickness),
                    yaw=direction,
                    height=self.wall_height,
                )
            )
        return tuple(walls)

    @property
    def solids(self) -> tuple[Shape, ...]:
        """Everything the robot can touch: walls, then obstacles."""
        return (*self.walls, *self.obstacles)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """(min x, min y, max x, max y) of the floor with its outer wall."""
        reach = self.wall_thickness
        xs, ys = zip(*self.floor, strict=True)
        return min(xs) - reach, min(ys) - reach, max(xs) + reach, max(ys) + reach

    def on_floor(self, points: Points) -> NDArray[np.bool_]:
        """Which world ``points`` (N, 2) lie inside the outer wall. Shape (N,).

        Counts the sides that a ray towards +x crosses (Shimrat, CACM 1962).
        """
        x, y = points[:, 0], points[:, 1]
        inside = np.zeros(len(points), dtype=np.bool_)
        for (x0, y0), (x1, y1) in itertools.pairwise((*self.floor, self.floor[0])):
            if y0 == y1:
                continue
            crosses = (y0 > y) != (y1 > y)
            inside ^= crosses & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
        return inside

    def distance(self, points: Points) -> NDArray[np.float64]:
        """Distance of world ``points`` (N, 2) to the nearest solid [m]; negative inside it."""
        nearest = np.full(len(points), np.inf)
        for shape in self.solids:
            np.minimum(nearest, shape.distance(points), out=nearest)
        return nearest

    def _overrun(self, arriving: float, leaving: float) -> float:
        turn = math.remainder(leaving - arriving, math.tau)
        return self.wall_thickness * math.tan(turn / 2) if turn > 0.0 else 0.0


def _direction(start: tuple[float, float], end: tuple[float, float]) -> float:
    return math.atan2(end[1] - start[1], end[0] - start[0])


def _area(corners: tuple[tuple[float, float], ...]) -> float:
    """Signed area by the shoelace formula, m²; positive when anticlockwise."""
    sides = itertools.pairwise((*corners, corners[0]))
    return sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in sides) / 2
