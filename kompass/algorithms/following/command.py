"""What a path follower says in every control cycle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

Phase: TypeAlias = Literal["turning", "driving", "aligning", "arrived"]


@dataclass(frozen=True)
class Command:
    """A twist in the base frame: vx, vy [m/s], omega [rad/s]."""

    vx: float = 0.0
    vy: float = 0.0
    omega: float = 0.0


@dataclass(frozen=True)
class FollowStep:
    """One control cycle of a follower.

    Attributes
    ----------
    command
        What the robot should do now.
    phase
        ``turning`` on the spot towards the path, ``driving`` along it, ``aligning`` on the spot to
        the goal's heading, or ``arrived`` (for good, until a new path is set).
    progress
        Arc length of the path that lies behind the robot [m].
    remaining
        Arc length that lies ahead [m].
    cross_track_error
        Distance from the path, positive left of it [m].
    heading_error
        Heading of the path (of the goal, when aligning) less the robot's [rad].
    """

    command: Command
    phase: Phase
    progress: float
    remaining: float
    cross_track_error: float
    heading_error: float
