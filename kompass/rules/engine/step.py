"""The rule engine: a pure function of a table, a state, what happened, and the time.

Time is an argument, in monotonic seconds. Whatever became due before the present input is handled
first, in order and at its own moment. Ticks are therefore wake-ups and nothing more: leaving them
out, or sending more of them, changes no firing and no time of one.
"""

from collections.abc import Collection
from heapq import heappop, heappush
from typing import Any

from kompass.rules.engine.compiled_table import (
    CompiledTable,
    LeafPlan,
    ProbePlan,
    RulePlan,
    TimerPlan,
    TopicPlan,
)
from kompass.rules.engine.firing import Input, Output, RunEnded, Sample
from kompass.rules.engine.near_miss import look_for_miss
from kompass.rules.engine.runs import finish, next_in_queue, trigger
from kompass.rules.engine.schedule import due, enough, rate_of, start
from kompass.rules.engine.state import (
    ARMED,
    HOLD,
    LEAF,
    LOOK,
    WAITS_FOR_FALSE,
    EngineState,
    RuleState,
    evaluated,
)
from kompass.rules.schema.conditions import Changed
from kompass.rules.schema.values import MISSING, kind_of, same

_SCALARS = frozenset({float, int, bool, str})


def initial_state(table: CompiledTable, now: float, used: Collection[str] = ()) -> EngineState:
    """Return the state of a table that has seen nothing.

    Parameters
    ----------
    now
        Monotonic seconds, from which silence is counted.
    used
        Ids of rules with ``once`` that have fired before since the stack was started; others, and
        those that the table does not have, make no difference.
    """
    state = EngineState(table, now)
    for rule_id in used:
        known = table.by_id.get(rule_id)
        if known is not None and known.rule.event.once:
            state.rules[known.index].fired = 1
    for timer in table.timers:
        if timer.kind == "absent":
            state.begun[timer.index] = now
            if timer.from_start:
                for leaf in timer.leaves:
                    state.verdicts[leaf] = False
        start(timer, state, now)
    for plan in table.rules:
        if plan.rule.enabled:
            state.enlist(plan, plan.topics)
            settle(state, plan, plan.evaluate(state.verdicts))
    return state


def step(
    table: CompiledTable, state: EngineState, event: Input, now: float
) -> tuple[EngineState, list[Output]]:
    """Take one input and return what fires.

    Parameters
    ----------
    table
        The rules.
    state
        From :func:`initial_state`, :func:`kompass.rules.engine.migration.migrate_state` or an
        earlier step of the same table. It is changed in place and returned; copy it first to
        keep it.
    event
        A message, the passing of time, or the end of a run.
    now
        Monotonic seconds; a time before that of the last step counts as that.

    Returns
    -------
    EngineState, list of Firing or Note
        In the order in which they are due; at one moment in the order of the table.
    """
    out: list[Output] = []
    now = max(now, state.now)
    schedule = state.schedule
    if schedule and schedule[0][0] <= now:
        _catch_up(table, state, now, out)
    state.now = now
    if type(event) is Sample:
        plan = table.by_topic.get(event.topic)
        if plan is not None:
            _sample(table, state, plan, event.message, now, out)
    elif type(event) is RunEnded:
        rule = table.by_id.get(event.rule_id)
        if rule is not None:
            finish(table, state, rule, event, now, out)
    return state, out


def _catch_up(table: CompiledTable, state: EngineState, now: float, out: list[Output]) -> None:
    schedule = state.schedule
    while schedule and schedule[0][0] <= now:
        at = state.now = max(schedule[0][0], state.now)
        # Leaves that change at the same moment change together: nobody sees half of it.
        touched: set[int] = set()
        while schedule and schedule[0][0] <= at and schedule[0][1] <= LOOK:
            _, phase, index = heappop(schedule)
            if phase == LOOK:
                touched.add(index)
            else:
                _expire(table, state, table.timers[index], at, touched)
        for index in sorted(touched):
            _look(table, state, table.rules[index], at, None, out)
        while schedule and schedule[0][0] <= at and schedule[0][1] > LOOK:
            _, phase, index = heappop(schedule)
            plan = table.rules[index]
            if phase == HOLD:
                _held(table, state, plan, at, out)
            else:
                next_in_queue(table, state, plan, at, out)


def _expire(
    table: CompiledTable, state: EngineState, timer: TimerPlan, at: float, touched: set[int]
) -> None:
    when = due(timer, state)
    if when is not None and when > at:
        heappush(state.schedule, (when, LEAF, timer.index))
        return
    if timer.kind == "rate":
        _set(state, table.leaves[timer.leaves[0]], rate_of(timer, state, at), touched)
        start(timer, state, at)
        return
    state.idle[timer.topic].append(timer.index)
    if timer.kind == "stale" and when is not None:
        state.fresh[timer.topic] = False
        for index in timer.leaves:
            _set(state, table.leaves[index], None, touched)
    elif timer.kind == "absent" and when is not None:
        _set(state, table.leaves[timer.leaves[0]], True, touched)


def _set(state: EngineState, leaf: LeafPlan, verdict: bool | None, touched: set[int]) -> None:
    if state.verdicts[leaf.index] is not verdict:
        state.verdicts[leaf.index] = verdict
        touched.update(leaf.rules)


def _sample(
    table: CompiledTable,
    state: EngineState,
    plan: TopicPlan,
    message: Any,
    now: float,
    out: list[Output],
) -> None:
    topic = plan.index
    state.counts[topic] += 1
    state.received[topic] = now
    state.messages[topic] = message
    if plan.history:
        state.times[topic].append(now)
    touched = set(state.live[topic])
    pulses: list[int] = []
    values = state.values
    anew = not state.fresh[topic]
    for probe in plan.probes:
        value = probe.read(message)
        index = probe.index
        old = values[index]
        if anew or type(value) is not type(old) or value != old or type(value) not in _SCALARS:
            values[index] = value
            _new_value(table, state, probe, old, value, anew, touched, pulses)
        if probe.watched and kind_of(value) != "none":
            state.seen[index] = now
            pulses.extend(probe.receipts)
    if anew:
        state.fresh[topic] = True
        _rest(table, state, plan, touched)
    if state.idle[topic]:
        _resume(table, state, topic, now, touched)
    if plan.always:
        touched.update(plan.always)
    if pulses:
        _pulse(table, state, plan, pulses, touched, now, out)
    elif touched:
        for index in sorted(touched) if len(touched) > 1 else touched:
            _look(table, state, table.rules[index], now, plan, out)


def _new_value(
    table: CompiledTable,
    state: EngineState,
    probe: ProbePlan,
    old: Any,
    value: Any,
    anew: bool,
    touched: set[int],
    pulses: list[int],
) -> None:
    verdicts = state.verdicts
    leaves = table.leaves
    for index in probe.compares if anew else probe.candidates.candidates(old, value):
        leaf = leaves[index]
        verdict = leaf.predicate(value)
        if verdicts[index] is not verdict:
            verdicts[index] = verdict
            touched.update(leaf.rules)
    if probe.changes and kind_of(value) != "none":
        for index in probe.changes:
            if _moved(leaves[index], state.references[index], value):
                if state.references[index] is not MISSING:
                    pulses.append(index)
                state.references[index] = value


def _moved(leaf: LeafPlan, reference: Any, value: Any) -> bool:
    condition = leaf.condition
    assert isinstance(condition, Changed)
    if condition.deadband and kind_of(value) == kind_of(reference) == "number":
        return bool(abs(value - reference) > condition.deadband)
    return not same(value, reference)


def _rest(table: CompiledTable, state: EngineState, plan: TopicPlan, touched: set[int]) -> None:
    """Give the leaves that are true for one message only their verdict between messages."""
    for probe in plan.probes:
        for index in probe.changes:
            known = state.references[index] is not MISSING
            _set(state, table.leaves[index], False if known else None, touched)
        for index in probe.receipts:
            known = state.seen[probe.index] is not None
            _set(state, table.leaves[index], False if known else None, touched)


def _resume(
    table: CompiledTable, state: EngineState, topic: int, now: float, touched: set[int]
) -> None:
    """Set the timers going that waited for a message of their topic."""
    waiting, state.idle[topic] = state.idle[topic], []
    for index in waiting:
        timer = table.timers[index]
        if timer.kind == "absent":
            if timer.probe >= 0 and state.seen[timer.probe] != now:
                state.idle[topic].append(index)
                continue
            _set(state, table.leaves[timer.leaves[0]], False, touched)
        elif timer.kind == "rate":
            if state.begun[index] is None:
                state.begun[index] = now
            elif enough(timer, state, now):
                _set(state, table.leaves[timer.leaves[0]], timer.above, touched)
        start(timer, state, now)


def _pulse(
    table: CompiledTable,
    state: EngineState,
    plan: TopicPlan,
    pulses: list[int],
    touched: set[int],
    now: float,
    out: list[Output],
) -> None:
    """Look at the rules with the leaves on that are true for this message, then off again."""
    verdicts = state.verdicts
    for index in pulses:
        verdicts[index] = True
    order = sorted(touched)
    for index in order:
        _look(table, state, table.rules[index], now, plan, out)
    for index in pulses:
        verdicts[index] = False
    for index in order:
        rule = table.rules[index]
        if rule.pulses:
            settle(state, rule, rule.evaluate(verdicts))


def _look(
    table: CompiledTable,
    state: EngineState,
    plan: RulePlan,
    at: float,
    topic: TopicPlan | None,
    out: list[Output],
) -> None:
    """Evaluate a rule, with a message of ``topic`` or by time alone, and trigger it if due."""
    rule = state.rules[plan.index]
    was = rule.verdict
    verdict = plan.evaluate(state.verdicts)
    sampled = topic is not None and topic.index in plan.topics
    if verdict is not True:
        if was is True and not plan.listening:
            rule.true += evaluated(plan, state) - int(sampled) - rule.rose
        if plan.parts or (plan.hold and was is True):
            look_for_miss(table, state, plan, at, out)
        settle(state, plan, verdict)
    else:
        if was is not True:
            rule.verdict = rule.close = True
            rule.since = at
            rule.rose = evaluated(plan, state) - int(sampled) if not plan.listening else 0
        if sampled and plan.listening:
            rule.true += 1
        if plan.hold and not _hold_over(state, plan, rule, at):
            pass
        elif plan.trigger == "edge" or (
            any(state.verdicts[leaf] for leaf in plan.changes)
            if plan.changes
            else sampled or was is not True
        ):
            trigger(table, state, plan, at, topic if sampled else None, out)
    wanted = plan.listening and plan.possible(state.verdicts) is True
    if wanted is not rule.live:
        if wanted:
            state.enlist(plan, plan.topics)
        else:
            state.delist(plan)


def _hold_over(state: EngineState, plan: RulePlan, rule: RuleState, at: float) -> bool:
    assert rule.since is not None
    end = rule.since + plan.hold
    if at >= end:
        return True
    if not rule.hold_timer:
        rule.hold_timer = True
        heappush(state.schedule, (end, HOLD, plan.index))
    return False


def _held(
    table: CompiledTable, state: EngineState, plan: RulePlan, at: float, out: list[Output]
) -> None:
    rule = state.rules[plan.index]
    rule.hold_timer = False
    if rule.since is not None and _hold_over(state, plan, rule, at):
        trigger(table, state, plan, at, None, out)


def settle(state: EngineState, plan: RulePlan, verdict: bool | None) -> None:
    """Take note that a rule is not true (any more), and re-arm it where that is due."""
    if verdict is True:
        return
    rule = state.rules[plan.index]
    rule.verdict = verdict
    rule.since = None
    if rule.armed == ARMED:
        return
    if plan.clear is None or rule.armed == WAITS_FOR_FALSE:
        if verdict is False:
            rule.armed = ARMED
    elif plan.clear(state.verdicts) is True:
        rule.armed = ARMED
