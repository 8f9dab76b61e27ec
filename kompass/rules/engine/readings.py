"""Leaves with the values that account for their verdicts, as they are shown."""

from collections.abc import Sequence
from typing import Any

from kompass.rules.engine.compiled_table import (
    LEAST_COUNTED,
    CompiledTable,
    LeafPlan,
    RulePlan,
)
from kompass.rules.engine.firing import LeafVerdict
from kompass.rules.engine.state import EngineState
from kompass.rules.schema.conditions import Absent, Rate, TreePath
from kompass.rules.schema.values import MISSING

_SHOWN = 16  # elements of a list, beyond which it is summed up
_SHOWN_TEXT = 200


def readings(
    table: CompiledTable, state: EngineState, plan: RulePlan, at: float
) -> tuple[LeafVerdict, ...]:
    """Return each leaf of a rule's condition as it is in the state."""
    return tuple(
        leaf_verdict(table, state, path, table.leaves[leaf], state.verdicts[leaf], at)
        for path, leaf in plan.leaves
    )


def leaf_verdict(
    table: CompiledTable,
    state: EngineState,
    path: TreePath,
    leaf: LeafPlan,
    verdict: bool | None,
    at: float,
) -> LeafVerdict:
    """Return a leaf with its verdict, and the value and age at ``at`` that account for it."""
    received = state.received[leaf.topic]
    age = None if received is None else at - received
    return LeafVerdict(path, leaf.text, _value(table, state, leaf, at), age, verdict)


def _value(
    table: CompiledTable, state: EngineState, leaf: LeafPlan, at: float
) -> bool | int | float | str | None:
    condition = leaf.condition
    if isinstance(condition, Absent):
        last = state.seen[leaf.probe] if leaf.probe >= 0 else state.received[leaf.topic]
        begun = last if last is not None else state.begun[leaf.timer]
        return None if begun is None else at - begun
    if isinstance(condition, Rate):
        return _rate(condition, state.times[leaf.topic], at)
    return shown(state.values[leaf.probe])


def _rate(condition: Rate, times: Sequence[float], at: float) -> float | None:
    if not times:
        return None
    within = sum(at < t + condition.window for t in times)
    if within == len(times) >= LEAST_COUNTED and at > times[0]:
        # No more are remembered: there may have been more in the window before them.
        return within / (at - times[0])
    # The whole window counts, also where nothing came: three at once are no thousands a second.
    return within / condition.window


def shown(value: Any) -> bool | int | float | str | None:
    """Return a scalar as it is, and a text for anything else; None for a missing value."""
    if value is MISSING:
        return None
    if isinstance(value, (bool, int, float)):
        return value
    if isinstance(value, list) and len(value) > _SHOWN:
        return f"{len(value)} items"
    text = value if isinstance(value, str) else repr(value) if isinstance(value, list) else ""
    if not text and not isinstance(value, str):
        return type(value).__name__
    return text if len(text) <= _SHOWN_TEXT else text[: _SHOWN_TEXT - 1] + "…"
