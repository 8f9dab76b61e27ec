"""Walls that can be put up beside the robot, wherever it is, while it drives."""

from __future__ import annotations

import math
from dataclasses import dataclass

_BOX_GAP = 0.05  # m between the shell and each wall of the box
# Far enough that a slow robot comes to rest before the wall, near enough to be in its way.
ACROSS_GAP = 0.15
_THICKNESS = 0.02
# Far enough to be gone round by who sees it, and lower than the plane of any lidar here.
_LOW_GAP, _LOW_DEPTH, _LOW_HEIGHT = 0.5, 0.2, 0.1


@dataclass(frozen=True)
class Barrier:
    """An upright wall.

    Attributes
    ----------
    name
        Of its body in the physics.
    away
        From the robot's axis to its near face, metres.
    direction
        In which it stands from the robot, radians anticlockwise from ahead.
    length
        Metres.
    """

    name: str
    away: float
    direction: float
    length: float
    thickness: float = _THICKNESS
    height: float = 0.5

    def place(self, pose: tuple[float, float, float]) -> tuple[float, float, float]:
        """Where it stands (x, y, yaw of its normal) when put up beside a robot at ``pose``."""
        x, y, yaw = pose
        away = self.away + self.thickness / 2
        turned = yaw + self.direction
        return x + away * math.cos(turned), y + away * math.sin(turned), turned


class Barriers:
    """The walls for one robot.

    Parameters
    ----------
    radius
        Of the circle around its shell [m].

    Attributes
    ----------
    box
        Four walls close around it.
    across
        One in its way.
    low
        A low box in its way, for robots that can see it.
    """

    def __init__(self, radius: float) -> None:
        side = 2 * (radius + _BOX_GAP + _THICKNESS)
        self.box = tuple(
            Barrier(f"barrier_{name}", radius + _BOX_GAP, index * math.pi / 2, side)
            for index, name in enumerate(("ahead", "left", "behind", "right"))
        )
        self.across = (Barrier("barrier_across", radius + ACROSS_GAP, 0.0, 0.3 + 2 * radius),)

        self.low = (Barrier("barrier_low", radius + _LOW_GAP, 0.0, 0.3, _LOW_DEPTH, _LOW_HEIGHT),)

    @property
    def all(self) -> tuple[Barrier, ...]:
        """All that may ever stand, whatever the robot sees with."""
        return (*self.box, *self.across)
