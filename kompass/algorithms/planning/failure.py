"""Why there is no plan, in a form that can be shown at the pointer."""

from __future__ import annotations

from enum import IntEnum


class Reason(IntEnum):
    """The codes of kompass_interfaces/srv/CheckGoal."""

    OK = 0
    NO_MAP = 1
    OUTSIDE_MAP = 2
    OCCUPIED = 3
    TOO_CLOSE = 4
    UNREACHABLE = 5
    NO_POSE = 6
    START_BLOCKED = 7
    NO_PATH = 8


class PlanningFailure(Exception):
    """No plan. ``nearest`` is the reachable place closest to the goal, in the world, if any."""

    def __init__(
        self, reason: Reason, message: str, nearest: tuple[float, float] | None = None
    ) -> None:
        super().__init__(message)
        self.reason = reason
        self.message = message
        self.nearest = nearest
