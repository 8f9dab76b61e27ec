"""Why there is no plan, in a form that can be shown at the pointer."""

from __future__ import annotations

from typing import Literal, TypeAlias, get_args

# In the order of their numbers in kompass_interfaces/srv/CheckGoal; empty when there is a plan.
Reason: TypeAlias = Literal[
    "",
    "no_map",
    "outside_map",
    "occupied",
    "too_close",
    "unreachable",
    "no_pose",
    "start_blocked",
    "no_path",
]
REASONS: tuple[Reason, ...] = get_args(Reason)


def code_of(reason: Reason) -> int:
    """The number of a reason in CheckGoal's answer."""
    return REASONS.index(reason)


class PlanningFailure(Exception):
    """No plan. ``nearest`` is the reachable place closest to the goal, in the world, if any."""

    def __init__(
        self, reason: Reason, message: str, nearest: tuple[float, float] | None = None
    ) -> None:
        super().__init__(message)
        self.reason: Reason = reason
        self.message = message
        self.nearest = nearest
