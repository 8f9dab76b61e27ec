"""Why a rule fires, or why it does not."""

import math
from typing import Literal, NamedTuple

from kompass.rules.engine.compiled_table import CompiledTable, LeafPlan, RulePlan
from kompass.rules.engine.firing import LeafVerdict
from kompass.rules.engine.readings import leaf_verdict
from kompass.rules.engine.schedule import due, rate_of
from kompass.rules.engine.state import (
    ARMED,
    WAITS_FOR_FALSE,
    Counters,
    EngineState,
    RuleState,
    counters,
)
from kompass.rules.schema.conditions import TreePath, timeout_of
from kompass.rules.schema.values import Verdict


class Gate(NamedTuple):
    """One thing that keeps a rule from firing.

    ``left`` are the seconds until it opens by itself; None if it takes something else.
    """

    kind: Literal[
        "disabled",
        "rate_latched",
        "once",
        "unknown",
        "false",
        "hold",
        "not_armed",
        "cooldown",
        "busy",
    ]
    text: str
    left: float | None = None


class Explanation(NamedTuple):
    """A rule at one moment.

    Attributes
    ----------
    verdict
        Of the whole condition.
    leaves, clear_leaves
        Each leaf of the condition, and of the condition that re-arms it.
    gates
        All that keeps it from firing, what matters most first; empty if it fires with the next
        message that calls for it.
    text
        One sentence.
    """

    rule_id: str
    at: float
    revision_hash: str
    verdict: Verdict
    leaves: tuple[LeafVerdict, ...]
    clear_leaves: tuple[LeafVerdict, ...]
    gates: tuple[Gate, ...]
    counters: Counters
    text: str


def explain(table: CompiledTable, state: EngineState, rule_id: str, now: float) -> Explanation:
    """Explain a rule at ``now`` (monotonic seconds), without changing the state.

    Raises
    ------
    KeyError
        If the table has no such rule.
    """
    plan = table.by_id[rule_id]
    now = max(now, state.now)
    verdicts = {
        index: verdict_at(table, state, table.leaves[index], now)
        for _, index in (*plan.leaves, *plan.clear_leaves)
    }
    verdict = plan.evaluate(verdicts)
    gates = tuple(_gates(plan, state.rules[plan.index], verdict, now))
    return Explanation(
        rule_id=rule_id,
        at=now,
        revision_hash=plan.hash,
        verdict=verdict,
        leaves=_shown(table, state, plan.leaves, verdicts, now),
        clear_leaves=_shown(table, state, plan.clear_leaves, verdicts, now),
        gates=gates,
        counters=counters(table, state, rule_id),
        text="; ".join(gate.text for gate in gates) or _READY[plan.trigger],
    )


_READY = {
    "level": "the condition is true: it fires with the next message",
    "edge": "the condition is true: it fires when it is next evaluated",
    "change": "the condition is true: it fires when a value changes",
}


def verdict_of(table: CompiledTable, state: EngineState, plan: RulePlan, now: float) -> Verdict:
    """Return the verdict of a rule's condition at a moment after the last step."""
    now = max(now, state.now)
    return plan.evaluate(
        {index: verdict_at(table, state, table.leaves[index], now) for _, index in plan.leaves}
    )


def verdict_at(table: CompiledTable, state: EngineState, leaf: LeafPlan, now: float) -> Verdict:
    """Return the verdict of a leaf at a moment after the last step."""
    verdict = state.verdicts[leaf.index]
    if leaf.timer >= 0:
        timer = table.timers[leaf.timer]
        if timer.kind == "absent":
            when = due(timer, state)
            return True if when is not None and when <= now else verdict
        begun = state.begun[leaf.timer]
        if begun is None or now < begun + timer.seconds:
            return None
        return rate_of(timer, state, now)
    received, timeout = state.received[leaf.topic], timeout_of(leaf.condition)
    if received is not None and timeout is not None:
        return None if now >= math.nextafter(received + timeout, math.inf) else verdict
    return verdict


def _shown(
    table: CompiledTable,
    state: EngineState,
    leaves: tuple[tuple[TreePath, int], ...],
    verdicts: dict[int, Verdict],
    now: float,
) -> tuple[LeafVerdict, ...]:
    return tuple(
        leaf_verdict(table, state, path, table.leaves[index], verdicts[index], now)
        for path, index in leaves
    )


def _gates(plan: RulePlan, rule: RuleState, verdict: Verdict, now: float) -> list[Gate]:
    event = plan.rule.event
    gates = []
    if not plan.rule.enabled:
        gates.append(Gate("disabled", "it is switched off"))
    if rule.latched_at is not None:
        gates.append(Gate("rate_latched", "it fired too often and waits to be reset"))
    if event.once and rule.fired:
        gates.append(Gate("once", "it fires once only, and has fired"))
    if verdict is None:
        gates.append(Gate("unknown", "a value is missing or too old to tell"))
    elif verdict is False:
        gates.append(Gate("false", "the condition is false"))
    elif plan.hold and (left := _hold_left(plan, rule, now)) > 0:
        gates.append(Gate("hold", f"it must stay true for {left:.3g} s more", left))
    if rule.armed != ARMED and (plan.trigger == "edge" or plan.clear):
        gates.append(Gate("not_armed", _REARM[bool(plan.clear and rule.armed != WAITS_FOR_FALSE)]))
    if now < rule.cooldown_end:
        left = rule.cooldown_end - now
        gates.append(Gate("cooldown", f"it cools down for {left:.3g} s more", left))
    if rule.runs and event.mode.kind != "restart" and len(rule.runs) >= _room(plan):
        gates.append(Gate("busy", f"its actions are running ({len(rule.runs)})"))
    return gates


_REARM = {
    False: "it fires on becoming true, and was not false since it last did",
    True: "it has fired, and its clear condition was not true since",
}


def _hold_left(plan: RulePlan, rule: RuleState, now: float) -> float:
    return plan.hold if rule.since is None else rule.since + plan.hold - now


def _room(plan: RulePlan) -> int:
    mode = plan.rule.event.mode
    return mode.size if mode.kind == "parallel" else 1
