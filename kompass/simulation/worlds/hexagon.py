"""The hexagon with nine pillars that every TurtleBot3 user has driven in."""

from __future__ import annotations

import math

from kompass.simulation.worlds.shapes import Cylinder
from kompass.simulation.worlds.world import World

INNER_WIDTH = 4.8  # between opposite walls, m
PILLAR_SPACING = 1.1
PILLAR_RADIUS = 0.15

_corner_radius = INNER_WIDTH / math.sqrt(3.0)

HEXAGON = World(
    name="hexagon",
    title="Hexagonal room with nine pillars",
    floor=tuple(
        (
            _corner_radius * math.cos(math.radians(60 * k)),
            _corner_radius * math.sin(math.radians(60 * k)),
        )
        for k in range(6)
    ),
    start=(-2.0, -0.5, 0.0),
    obstacles=tuple(
        Cylinder(
            name=f"pillar_{3 * row + column}",
            center=((column - 1) * PILLAR_SPACING, (row - 1) * PILLAR_SPACING),
            radius=PILLAR_RADIUS,
        )
        for row in range(3)
        for column in range(3)
    ),
)
