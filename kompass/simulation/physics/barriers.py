"""Walls that can be put up beside the robot, wherever it is, while it drives."""

from __future__ import annotations

import math
from dataclasses import dataclass

BODY_RADIUS = 0.10  # m, of the robot's shell
_BOX_GAP = 0.05  # m between the shell and each wall of the box
# Far enough that a robot at full speed comes to rest before the wall, near enough to be in its way.
_ACROSS_GAP = 0.15
_THICKNESS = 0.02


@dataclass(frozen=True)
class Barrier:
    """An upright wall.

    Attributes
    ----------
    name
        Of its body in the physics.
    gap
        Between it and the robot's shell, metres.
    direction
        In which it stands from the robot, radians anticlockwise from ahead.
    length
        Metres.
    """

    name: str
    gap: float
    direction: float
    length: float
    thickness: float = _THICKNESS
    height: float = 0.5

    def place(self, pose: tuple[float, float, float]) -> tuple[float, float, float]:
        """Where it stands (x, y, yaw of its normal) when put up beside a robot at ``pose``."""
        x, y, yaw = pose
        away = BODY_RADIUS + self.gap + self.thickness / 2
        turned = yaw + self.direction
        return x + away * math.cos(turned), y + away * math.sin(turned), turned


_BOX_SIDE = 2 * (BODY_RADIUS + _BOX_GAP + _THICKNESS)
BOX = tuple(
    Barrier(f"barrier_{name}", _BOX_GAP, index * math.pi / 2, _BOX_SIDE)
    for index, name in enumerate(("ahead", "left", "behind", "right"))
)
ACROSS = (Barrier("barrier_across", _ACROSS_GAP, 0.0, 0.5),)
BARRIERS = (*BOX, *ACROSS)
