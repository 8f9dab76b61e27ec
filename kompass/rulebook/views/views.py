"""Rules, their state and why they fire, for those who watch."""

import math
from collections.abc import Collection
from typing import NamedTuple

from kompass.rulebook.schema.explanation import ExplanationView, GateView
from kompass.rulebook.schema.journal import FiringRecord
from kompass.rulebook.schema.report import Effect, Finding
from kompass.rulebook.schema.status import LeafReading, RuleState, RuleStatus
from kompass.rulebook.schema.table_view import Merge, TableView
from kompass.rulebook.views.recipe_code import has_code
from kompass.rulebook.views.wording import describe_action, seconds
from kompass.rules.engine.compiled_table import CompiledTable, RulePlan
from kompass.rules.engine.explain import Explanation, Gate, explain
from kompass.rules.engine.firing import LeafVerdict
from kompass.rules.engine.migration import MigrationReport
from kompass.rules.engine.state import EngineState
from kompass.rules.schema.conditions import CallableCondition, leaves, timeout_of, topic_of
from kompass.rules.schema.describe import describe
from kompass.rules.schema.table import Rule, Table, rule_hash


class Extras(NamedTuple):
    """What the shell knows of a rule and the engine does not.

    Attributes
    ----------
    outranked
        How often a more severe rule had the component that it wanted.
    last_ok
        Whether the last run that ended went well; None when none has.
    broken
        Why it cannot work, e.g. that its topic has another type than the rule says; empty if
        nothing is known against it.
    """

    outranked: int = 0
    last_ok: bool | None = None
    broken: str = ""


NO_EXTRAS = Extras()


def leaf_reading(leaf: LeafVerdict) -> LeafReading:
    """Return a leaf as it is shown; an infinite value becomes a text, for JSON has none."""
    value = leaf.value
    if isinstance(value, float) and not math.isfinite(value):
        value = str(value)
    return LeafReading(
        path=leaf.path, text=leaf.text, value=value, age=leaf.age, verdict=leaf.verdict
    )


def rule_status(
    compiled: CompiledTable,
    state: EngineState,
    rule_id: str,
    now: float,
    wall_offset: float,
    *,
    extras: Extras = NO_EXTRAS,
) -> RuleStatus:
    """Return how a rule is doing.

    Parameters
    ----------
    now
        Monotonic seconds.
    wall_offset
        Seconds since the epoch minus monotonic seconds.

    Raises
    ------
    KeyError
        If the table has no such rule.
    """
    plan = compiled.by_id[rule_id]
    found = explain(compiled, state, rule_id, now)
    name, text, left = _state(plan, state, found, extras)
    if plan.rule.shadow and name not in ("broken", "disabled"):
        name, text = "shadow", f"does not act; {text}"
    numbers = found.counters
    return RuleStatus(
        rule_id=rule_id,
        state=name,
        text=text,
        left=left,
        verdict=found.verdict,
        leaves=tuple(map(leaf_reading, found.leaves)),
        evaluated=numbers.evaluated,
        true=numbers.true,
        fired=numbers.fired,
        dropped=numbers.dropped,
        failed=numbers.failed,
        outranked=extras.outranked,
        last_fired=None if numbers.last_fired is None else numbers.last_fired + wall_offset,
        last_ok=extras.last_ok,
        error=extras.broken or numbers.error,
    )


def _state(
    plan: RulePlan, state: EngineState, found: Explanation, extras: Extras
) -> tuple[RuleState, str, float | None]:
    """Return what the table of rules shows: of all that holds a rule back, what matters most."""
    gates = {gate.kind: gate for gate in found.gates}
    running = state.rules[plan.index].runs
    if extras.broken:
        return "broken", extras.broken, None
    if "disabled" in gates:
        return "disabled", "switched off", None
    if "rate_latched" in gates:
        return "latched", "fired too often; stays off until it is reset", None
    if running:
        since = max(found.at - min(running.values()), 0.0)
        number = "" if len(running) == 1 else f"{len(running)} runs, the oldest "
        return "running", f"its actions run, {number}for {seconds(since)}", None
    if "once" in gates:
        return "used up", "has fired once; will not fire again until it is reset", None
    if "cooldown" in gates:
        left = gates["cooldown"].left
        return "cooling", f"cools down for {seconds(left or 0.0)} more", left
    if "unknown" in gates:
        return "unknown", unknown_text(plan, found.leaves), None
    if "not_armed" in gates:
        return "waiting", gates["not_armed"].text, None
    if "hold" in gates:
        return "holding", *_holding(plan, gates["hold"])
    text = "the condition is false" if "false" in gates else found.text
    return "ready", text, None


def _holding(plan: RulePlan, gate: Gate) -> tuple[str, float | None]:
    left = gate.left or 0.0
    return f"holding {plan.hold - left:.1f}/{plan.hold:g} s", left


def unknown_text(plan: RulePlan, readings: Collection[LeafVerdict]) -> str:
    """Return what is missing for a verdict: ``scan silent for 3 s``."""
    leaf_of = dict(leaves(plan.rule.event.condition))
    found: dict[str, str] = {}
    for reading in readings:
        if reading.verdict is not None:
            continue
        leaf = leaf_of[reading.path]
        what = leaf.name if isinstance(leaf, CallableCondition) else topic_of(leaf)
        timeout = timeout_of(leaf)
        if reading.age is None:
            found.setdefault(what, f"nothing received on {what} yet")
        elif timeout is not None and reading.age > timeout:
            found.setdefault(what, f"{what} silent for {seconds(reading.age)}")
        elif leaf.kind == "rate":
            found.setdefault(what, f"{what} not watched for {leaf.window:g} s yet")
        else:
            found.setdefault(what, f"no usable value: {reading.text}")
    return "; ".join(found.values())


def explanation_view(
    compiled: CompiledTable,
    state: EngineState,
    rule_id: str,
    now: float,
    wall_offset: float,
    *,
    revision: int,
    extras: Extras = NO_EXTRAS,
    near_misses: tuple[FiringRecord, ...] = (),
) -> ExplanationView:
    """Explain a rule now; the arguments as of :func:`rule_status`.

    Raises
    ------
    KeyError
        If the table has no such rule.
    """
    plan = compiled.by_id[rule_id]
    found = explain(compiled, state, rule_id, now)
    gates = [_gate(plan, found, gate) for gate in found.gates]
    if plan.rule.shadow:
        gates.insert(0, GateView(kind="shadow", text="it is in shadow: it would not act"))
    if extras.broken:
        gates.insert(0, GateView(kind="broken", text=extras.broken))
    return ExplanationView(
        rule_id=rule_id,
        time=found.at + wall_offset,
        text="; ".join(gate.text for gate in gates) or found.text,
        condition=describe(plan.rule.event.condition),
        rule=plan.rule,
        revision=revision,
        status=rule_status(compiled, state, rule_id, now, wall_offset, extras=extras),
        leaves=tuple(map(leaf_reading, found.leaves)),
        clear_leaves=tuple(map(leaf_reading, found.clear_leaves)),
        gates=tuple(gates),
        near_misses=near_misses,
    )


def why_not(compiled: CompiledTable, state: EngineState, rule_id: str, now: float) -> str:
    """Return in one line what keeps a rule from firing; empty if nothing does.

    Raises
    ------
    KeyError
        If the table has no such rule.
    """
    plan = compiled.by_id[rule_id]
    found = explain(compiled, state, rule_id, now)
    return "; ".join(_gate(plan, found, gate).text for gate in found.gates)


def _gate(plan: RulePlan, found: Explanation, gate: Gate) -> GateView:
    text = gate.text
    if gate.kind == "unknown":
        text = f"unknown: {unknown_text(plan, found.leaves)}"
    elif gate.kind == "cooldown" and gate.left is not None:
        text = f"it cools down for {seconds(gate.left)} more"
    elif gate.kind == "hold" and gate.left is not None:
        held = plan.hold - gate.left
        text = f"it has been true for {held:.1f} of {plan.hold:g} s"
    elif gate.kind == "false":
        wrong = [leaf.text for leaf in found.leaves if leaf.verdict is False]
        text = f"false: {', '.join(wrong)}" if wrong else text
    return GateView(kind=gate.kind, text=text, left=gate.left)


def firing_view(
    firing: FiringRecord,
    rule: Rule,
    *,
    current: Rule | None,
    near_misses: tuple[FiringRecord, ...] = (),
) -> ExplanationView:
    """Explain a firing (or a near miss, or a note) of the past.

    Parameters
    ----------
    rule
        As it was then: of the revision that fired.
    current
        As it is now; None if it was removed since.
    """
    return ExplanationView(
        rule_id=firing.rule_id,
        time=firing.time,
        text=firing_text(firing),
        condition=describe(rule.event.condition),
        rule=rule,
        revision=firing.revision,
        leaves=firing.leaves,
        firing=firing,
        near_misses=near_misses,
        changed_since=current is None or rule_hash(current) != firing.rule_hash,
    )


def firing_text(firing: FiringRecord) -> str:
    """Return an entry of the journal in one sentence."""
    if firing.kind in ("note", "near miss", "outranked"):
        return firing.text
    because = " and ".join(_read(leaf) for leaf in firing.leaves if leaf.verdict) or "by time alone"
    would = "would have fired (shadow)" if firing.kind == "shadow" else "fired"
    if firing.kind == "shadow":
        end = ""
    elif firing.ok is None:
        end = "; its actions run"
    else:
        end = "; its actions went well" if firing.ok else f"; its actions failed: {firing.error}"
    return f"{would}: {because}{end}"


def _read(leaf: LeafReading) -> str:
    if leaf.value is None or isinstance(leaf.value, bool):
        return leaf.text
    value = f"{leaf.value:.4g}" if isinstance(leaf.value, float) else str(leaf.value)
    return f"{leaf.text} (was {value})"


def table_view(
    table: Table,
    *,
    revision: int,
    active: int,
    confirmed: int,
    robot: str,
    probation_left: float = 0.0,
    notice: str = "",
    findings: tuple[Finding, ...] = (),
    merge: Merge | None = None,
    safe_mode: bool = False,
) -> TableView:
    """Return a table with its texts; the arguments as the fields of :class:`TableView`."""
    return TableView(
        revision=revision,
        active=active,
        confirmed=confirmed,
        probation_left=probation_left,
        notice=notice,
        robot=robot,
        table=table,
        conditions={rule.id: describe(rule.event.condition) for rule in table.rules},
        actions={rule.id: tuple(map(describe_action, rule.actions)) for rule in table.rules},
        hashes={rule.id: rule_hash(rule) for rule in table.rules},
        findings=findings,
        from_recipe=tuple(rule.id for rule in table.rules if has_code(rule)),
        merge=merge,
        safe_mode=safe_mode,
    )


def effect_of(report: MigrationReport) -> Effect:
    """Return what became of the rules, for people: rules with several runs are named once."""
    return Effect(
        carried=report.carried,
        reset=report.reset,
        removed=report.removed,
        added=report.added,
        running=tuple(dict.fromkeys(rule_id for rule_id, _ in report.running)),
    )
