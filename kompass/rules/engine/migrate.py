"""From one table to the next without losing what the unchanged rules know.

The swap happens between two steps: every message is taken by exactly one table. A message that the
old table has taken makes no rule of the new one fire; only silence that already lasts does.
"""

from collections import deque
from collections.abc import Collection
from heapq import heapify, heappush
from typing import NamedTuple

from kompass.rules.engine.compiled_table import CompiledTable, LeafPlan, RulePlan, Timer
from kompass.rules.engine.firing import Output, Tick
from kompass.rules.engine.migration import Migration, plan_migration
from kompass.rules.engine.schedule import start
from kompass.rules.engine.state import LEAF, LOOK, RuleState, State, evaluated
from kompass.rules.engine.step import settle, step
from kompass.rules.schema.conditions import Absent, Changed, Rate, Received, timeout_of
from kompass.rules.schema.values import MISSING, Verdict, kind_of


class MigrationReport(NamedTuple):
    """What became of the rules.

    Attributes
    ----------
    carried
        Ids of rules that behave as before and keep their holds, cooldowns, edges and counters.
    reset
        Those that start afresh: changed, switched on or off, or asked for.
    removed, added
        Those that only the old, or only the new table has.
    running
        Rule and run id of the runs in progress of rules that were reset or removed. Those of a
        reset rule still keep it busy until their ``Done`` arrives.
    """

    carried: tuple[str, ...]
    reset: tuple[str, ...]
    removed: tuple[str, ...]
    added: tuple[str, ...]
    running: tuple[tuple[str, int], ...]


def swap(way: Migration, state: State, now: float) -> tuple[State, MigrationReport, list[Output]]:
    """Go on with another table: the old one first takes the time that has passed.

    This is what a shell does between two messages; plan the migration beforehand, it takes
    longer.

    Parameters
    ----------
    way
        From :func:`kompass.rules.engine.migration.bridge`.
    state
        Of the old table; used up, and not to be used again.
    now
        Monotonic seconds.

    Returns
    -------
    State, MigrationReport, list of Firing or Note
        The last as from :func:`kompass.rules.engine.step.step`: what the old table let fire by now.
    """
    state, outputs = step(way.old, state, Tick(), now)
    state, carried = _cross(way, state, now)
    return state, carried, outputs


def migrate_state(
    old: CompiledTable,
    old_state: State,
    new: CompiledTable,
    now: float,
    reset: Collection[str] = (),
) -> tuple[State, MigrationReport]:
    """Return the state with which the new table would go on.

    Parameters
    ----------
    old, old_state
        The table in force and its state; neither is changed.
    new
        The table to come; may be the old one, to reset rules of it.
    now
        Monotonic seconds; silence that a new rule asks for is counted from the last message, or
        from ``now`` if there was none.
    reset
        Ids of rules that are to start afresh even if they are unchanged.

    Raises
    ------
    KeyError
        If a rule to be reset is not in the new table.
    """
    return _cross(plan_migration(old, new, reset), old_state.copy(), now)


def _cross(way: Migration, before: State, now: float) -> tuple[State, MigrationReport]:
    """Move what stays into a state of the new table, and work out what is new."""
    now = max(now, before.now)
    state = _moved(way, before)
    _new_values(way, state)
    _new_leaves(way, state, now)
    _new_timers(way, state, now)
    return state, _fresh_rules(way, before, state, now)


def _moved(way: Migration, before: State) -> State:
    new = way.new
    state: State = object.__new__(State)
    state.now, state.next_run = before.now, before.next_run
    topics, probes, leaves = way.topics, way.probes, way.leaves
    state.counts = [before.counts[i] if i >= 0 else 0 for i in topics]
    state.received = [before.received[i] if i >= 0 else None for i in topics]
    state.messages = [before.messages[i] if i >= 0 else None for i in topics]
    state.fresh = [i >= 0 and before.fresh[i] for i in topics]
    state.times = [
        before.times[i] if i >= 0 else deque(maxlen=new.topics[place].history)
        for place, i in enumerate(topics)
    ]
    for place in way.longer:
        state.times[place] = deque(state.times[place], maxlen=new.topics[place].history)
    state.values = [before.values[i] if i >= 0 else MISSING for i in probes]
    state.seen = [before.seen[i] if i >= 0 else None for i in probes]
    state.verdicts = [before.verdicts[i] if i >= 0 else None for i in leaves]
    state.references = [before.references[i] if i >= 0 else MISSING for i in leaves]
    state.begun = [before.begun[i] if i >= 0 else None for i in way.timers]
    state.rules = [
        before.rules[i] if i >= 0 else RuleState(new.rules[place])
        for place, i in enumerate(way.rules)
    ]
    rule_at, timer_at = way.rule_at, way.timer_at
    state.live = [
        {rule_at[rule] for rule in before.live[i] if rule in rule_at} if i >= 0 else set()
        for i in topics
    ]
    state.idle = [
        [timer_at[timer] for timer in before.idle[i] if timer in timer_at] if i >= 0 else []
        for i in topics
    ]
    state.schedule = [
        (when, phase, (timer_at if phase == LEAF else rule_at)[index])
        for when, phase, index in before.schedule
        if index in (timer_at if phase == LEAF else rule_at)
    ]
    heapify(state.schedule)
    return state


def _new_values(way: Migration, state: State) -> None:
    for probe in way.new_probes:
        if state.received[probe.topic] is not None:
            state.values[probe.index] = probe.read(state.messages[probe.topic])
    # When a probe that nobody watched had its value is not known better than by its message.
    for probe in (*way.new_probes, *way.newly_watched):
        known = kind_of(state.values[probe.index]) != "none"
        state.seen[probe.index] = state.received[probe.topic] if known else None


def _new_leaves(way: Migration, state: State, now: float) -> None:
    for leaf in way.new_leaves:
        if isinstance(leaf.condition, Changed):
            state.references[leaf.index] = state.values[leaf.probe]
        state.verdicts[leaf.index] = _between_messages(leaf, state, now)


def _between_messages(leaf: LeafPlan, state: State, now: float) -> Verdict:
    """Return the verdict of a new leaf on what was received before it existed."""
    condition = leaf.condition
    received = state.received[leaf.topic]
    if isinstance(condition, Rate):
        return None
    if isinstance(condition, Absent):
        last = received if leaf.probe < 0 else state.seen[leaf.probe]
        return False if last is not None or condition.from_start else None
    timeout = timeout_of(condition)
    if received is None or (timeout is not None and now > received + timeout):
        return None
    if isinstance(condition, Changed):
        return None if state.references[leaf.index] is MISSING else False
    if isinstance(condition, Received):
        return None if state.seen[leaf.probe] is None else False
    return leaf.judge(state.values[leaf.probe])


def _new_timers(way: Migration, state: State, now: float) -> None:
    for timer in way.new_timers:
        if timer.kind == "absent" or (
            timer.kind == "rate" and state.received[timer.topic] is not None
        ):
            state.begun[timer.index] = now
        _start_new(timer, state, now)


def _start_new(timer: Timer, state: State, now: float) -> None:
    received = state.received[timer.topic]
    if timer.kind == "stale" and received is not None and now > received + timer.seconds:
        # Stale already: the leaves are unknown, and the next message judges them anew.
        state.idle[timer.topic].append(timer.index)
        state.fresh[timer.topic] = False
    else:
        start(timer, state, now)


def _fresh_rules(way: Migration, before: State, state: State, now: float) -> MigrationReport:
    running: list[tuple[str, int]] = []
    for plan, twin in way.fresh:
        if twin is not None:
            runs = before.rules[twin.index].runs
            state.rules[plan.index].runs = dict(runs)
            running.extend((plan.rule.id, run) for run in runs)
        _begin(way.new, state, plan, now)
    for plan in way.removed:
        running.extend((plan.rule.id, run) for run in before.rules[plan.index].runs)
    return MigrationReport(
        carried=way.carried,
        reset=way.reset,
        removed=tuple(plan.rule.id for plan in way.removed),
        added=way.added,
        running=tuple(running),
    )


def _begin(new: CompiledTable, state: State, plan: RulePlan, now: float) -> None:
    # It is counted from here, and the counts of its topics are older.
    rule = state.rules[plan.index]
    rule.evaluated = -evaluated(plan, state)
    if not plan.rule.enabled:
        return
    state.enlist(plan, plan.topics)
    settle(state, plan, plan.evaluate(state.verdicts))
    if any(new.leaves[i].timer >= 0 and state.verdicts[i] is True for _, i in plan.leaves):
        # The silence it asks for lasts already, and no message will come to have it looked at.
        heappush(state.schedule, (now, LOOK, plan.index))
