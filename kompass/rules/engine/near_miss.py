"""When a rule came close to firing and did not: for whoever asks later why nothing happened."""

from kompass.rules.engine.compiled_table import CompiledTable, RulePlan
from kompass.rules.engine.firing import Note, Output
from kompass.rules.engine.predicates import tree_of
from kompass.rules.engine.readings import readings
from kompass.rules.engine.state import EngineState
from kompass.rules.schema.conditions import AllOf, Condition, TreePath
from kompass.rules.schema.describe import describe

QUIET = 10.0  # s between two of the same sort of one rule
ENOUGH = 0.5  # share of the hold after which its end is a near miss


def look_for_miss(
    table: CompiledTable, state: EngineState, plan: RulePlan, at: float, out: list[Output]
) -> None:
    """Look at a rule that is not true (any more), before its state is told so."""
    rule = state.rules[plan.index]
    if plan.hold and rule.since is not None:
        held = at - rule.since
        if ENOUGH * plan.hold <= held < plan.hold:
            report_miss(table, state, plan, at, "hold", out)
    if plan.parts:
        true = 0
        for part in plan.parts:
            if part(state.verdicts) is True:
                true += 1
        close = true == len(plan.parts) - 1
        if close and not rule.close:
            report_miss(table, state, plan, at, "one", out)
        rule.close = close


def report_miss(
    table: CompiledTable,
    state: EngineState,
    plan: RulePlan,
    at: float,
    sort: str,
    out: list[Output],
) -> None:
    """Say that a rule came close, unless the same was said a moment ago."""
    missed = state.rules[plan.index].missed
    last = missed.get(sort)
    if last is not None and at < last + QUIET:
        return
    missed[sort] = at
    note = Note(
        kind="near_miss",
        rule_id=plan.rule.id,
        at=at,
        revision_hash=plan.hash,
        severity=plan.rule.severity,
        text=_text(state, plan, at, sort),
        leaves=readings(table, state, plan, at),
    )
    out.append(note)


def _text(state: EngineState, plan: RulePlan, at: float, sort: str) -> str:
    rule = state.rules[plan.index]
    if sort == "hold":
        assert rule.since is not None
        held = f"{at - rule.since:.3g} of {plan.hold:g} s"
        return f"was true for {held}, then no longer: {_wanting(state, plan)}"
    if sort == "one":
        return f"all but one were true; wanting: {_wanting(state, plan)}"
    if sort == "cooldown":
        return f"became true, but cooled down for {rule.cooldown_end - at:.3g} s more"
    if sort == "once":
        return "became true, but fires once only, and had fired"
    return "became true, but its actions were still running"


def _wanting(state: EngineState, plan: RulePlan) -> str:
    """Return what is not true of all that must be."""
    condition = plan.rule.event.condition
    parts: list[tuple[TreePath, Condition]] = [((), condition)]
    if isinstance(condition, AllOf):
        parts = [((place,), part) for place, part in enumerate(condition.conditions)]
    index = dict(plan.leaves)
    texts = []
    for path, part in parts:
        verdict = tree_of(part, index, path)(state.verdicts)
        if verdict is not True:
            texts.append(describe(part) + ("" if verdict is False else " (unknown)"))
    return ", ".join(texts)
