"""Why a goal is refused and how it ended: the same words and numbers wherever they are told."""

from typing import Any, get_args

from kompass_interfaces.action import PlanPath
from kompass_interfaces.srv import CheckGoal

from kompass.algorithms.planning.failure import REASONS, code_of
from kompass.components.planner.goal_progress import GoalOutcome
from kompass_console.schema.models import GoalReason


def constants(kind: Any, prefix: str) -> dict[str, int]:
    """Constants of an interface by name, without the prefix."""
    names = {name for one in type(kind).__mro__ for name in dir(one)} | set(dir(kind))
    return {
        name.removeprefix(prefix): getattr(kind, name) for name in names if name.startswith(prefix)
    }


def test_the_reasons_have_the_numbers_of_the_service() -> None:
    named = {(reason or "ok").upper(): code_of(reason) for reason in REASONS}
    assert constants(CheckGoal.Response, "REASON_") == named


def test_the_outcomes_have_the_numbers_of_the_action() -> None:
    named = {outcome.name: int(outcome) for outcome in GoalOutcome}
    assert constants(PlanPath.Result, "OUTCOME_") == named


def test_the_console_tells_every_reason_of_the_planner() -> None:
    assert get_args(GoalReason)[: len(REASONS)] == REASONS
