"""From one table to the next without losing what the unchanged rules know.

:func:`plan_migration` finds beforehand what of one table is the same in the other, so that
:func:`swap` need not search. The swap happens between two steps: every message is taken by exactly
one table. A message that the old table has taken makes no rule of the new one fire; only silence
that already lasts does.
"""

from collections import deque
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from heapq import heapify, heappush
from typing import NamedTuple

from kompass.rules.engine.compiled_table import (
    CompiledTable,
    LeafPlan,
    ProbePlan,
    RulePlan,
    TimerPlan,
)
from kompass.rules.engine.firing import Output, Tick
from kompass.rules.engine.schedule import start
from kompass.rules.engine.state import LEAF, LOOK, EngineState, RuleState, evaluated
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
        reset rule still keep it busy until their ``RunEnded`` arrives.
    """

    carried: tuple[str, ...]
    reset: tuple[str, ...]
    removed: tuple[str, ...]
    added: tuple[str, ...]
    running: tuple[tuple[str, int], ...]


@dataclass(slots=True)
class Migration:
    """What of one compiled table is the same in another; serves any state of the old one.

    Lists have an entry for each item of the new table: the index of the same item in the old
    table, or -1 for one that is new. Not to be changed.

    Attributes
    ----------
    topics, probes, leaves, timers, rules
        Index of each item in the old table; for ``rules`` only of those that go on unchanged.
    rule_at, timer_at
        Index in the new table by index in the old one, for the items that are in both.
    new_probes, new_leaves, new_timers
        Items that the old table does not have: their state is computed from the last messages.
    newly_watched
        Probes in both tables whose time of the last value only the new one keeps.
    longer
        Indices of the topics that keep another number of receive times than before.
    fresh
        Rules that start afresh, each with the old rule of the same id, if there is one.
    carried, reset, added
        Ids as in :class:`MigrationReport`.
    removed
        Rules of the old table that the new one does not have.
    """

    old: CompiledTable
    new: CompiledTable
    topics: list[int]
    probes: list[int]
    leaves: list[int]
    timers: list[int]
    rules: list[int]
    rule_at: dict[int, int]
    timer_at: dict[int, int]
    new_probes: list[ProbePlan]
    new_leaves: list[LeafPlan]
    new_timers: list[TimerPlan]
    newly_watched: list[ProbePlan]
    longer: list[int]
    fresh: list[tuple[RulePlan, RulePlan | None]]
    carried: tuple[str, ...]
    reset: tuple[str, ...]
    added: tuple[str, ...]
    removed: list[RulePlan]


def plan_migration(
    old: CompiledTable, new: CompiledTable, reset: Collection[str] = ()
) -> Migration:
    """Find what of ``old`` goes on in ``new``; the work is linear in the size of both.

    Parameters
    ----------
    reset
        Ids of rules that are to start afresh even if they are unchanged.

    Raises
    ------
    KeyError
        If a rule to be reset is not in the new table.
    """
    for rule_id in reset:
        if rule_id not in new.by_id:
            raise KeyError(f"rule {rule_id!r} cannot be reset: the table has no such rule")
    topics = [_index(old.by_topic.get(plan.name)) for plan in new.topics]
    probes = _twins(old.probes, new.probes)
    leaves = _twins(old.leaves, new.leaves)
    timers = _twins(old.timers, new.timers)
    rules, fresh = _rules(old, new, frozenset(reset))
    return Migration(
        old=old,
        new=new,
        topics=topics,
        probes=probes,
        leaves=leaves,
        timers=timers,
        rules=rules,
        rule_at={was: now for now, was in enumerate(rules) if was >= 0},
        timer_at={was: now for now, was in enumerate(timers) if was >= 0},
        new_probes=[probe for probe, was in zip(new.probes, probes, strict=True) if was < 0],
        new_leaves=[leaf for leaf, was in zip(new.leaves, leaves, strict=True) if was < 0],
        new_timers=[timer for timer, was in zip(new.timers, timers, strict=True) if was < 0],
        newly_watched=[
            probe
            for probe, was in zip(new.probes, probes, strict=True)
            if probe.watched and was >= 0 and not old.probes[was].watched
        ],
        longer=[
            plan.index
            for plan, was in zip(new.topics, topics, strict=True)
            if was >= 0 and old.topics[was].history != plan.history
        ],
        fresh=fresh,
        carried=tuple(plan.rule.id for plan, was in zip(new.rules, rules, strict=True) if was >= 0),
        reset=tuple(plan.rule.id for plan, was in fresh if was is not None),
        added=tuple(plan.rule.id for plan, was in fresh if was is None),
        removed=[plan for plan in old.rules if plan.rule.id not in new.by_id],
    )


def _rules(
    old: CompiledTable, new: CompiledTable, reset: frozenset[str]
) -> tuple[list[int], list[tuple[RulePlan, RulePlan | None]]]:
    places: list[int] = []
    fresh: list[tuple[RulePlan, RulePlan | None]] = []
    for plan in new.rules:
        rule_id = plan.rule.id
        twin = old.by_id.get(rule_id)
        if twin is not None and twin.hash == plan.hash and rule_id not in reset:
            places.append(twin.index)
        else:
            places.append(-1)
            fresh.append((plan, twin))
    return places, fresh


def _twins(
    old: Iterable[ProbePlan | LeafPlan | TimerPlan], new: Iterable[ProbePlan | LeafPlan | TimerPlan]
) -> list[int]:
    known = {item.key: item.index for item in old}
    return [known.get(item.key, -1) for item in new]


def _index(plan: object) -> int:
    return getattr(plan, "index", -1)


def swap(
    migration: Migration, state: EngineState, now: float
) -> tuple[EngineState, MigrationReport, list[Output]]:
    """Go on with another table: the old one first takes the time that has passed.

    A shell calls it between two messages, and plans the migration before: that takes longer.

    Parameters
    ----------
    migration
        From :func:`plan_migration`.
    state
        Of the old table; used up, and not to be used again.
    now
        Monotonic seconds.

    Returns
    -------
    EngineState, MigrationReport, list of Firing or Note
        The last as from :func:`kompass.rules.engine.step.step`: what the old table let fire by now.
    """
    state, outputs = step(migration.old, state, Tick(), now)
    state, report = _migrate(migration, state, now)
    return state, report, outputs


def migrate_state(
    old: CompiledTable,
    old_state: EngineState,
    new: CompiledTable,
    now: float,
    reset: Collection[str] = (),
) -> tuple[EngineState, MigrationReport]:
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
    return _migrate(plan_migration(old, new, reset), old_state.copy(), now)


def _migrate(
    migration: Migration, before: EngineState, now: float
) -> tuple[EngineState, MigrationReport]:
    """Move what stays into a state of the new table, and work out what is new."""
    now = max(now, before.now)
    state = _moved(migration, before)
    _new_values(migration, state)
    _new_leaves(migration, state, now)
    _new_timers(migration, state, now)
    return state, _fresh_rules(migration, before, state, now)


def _moved(migration: Migration, before: EngineState) -> EngineState:
    new = migration.new
    state: EngineState = object.__new__(EngineState)
    state.now, state.next_run = before.now, before.next_run
    topics, probes, leaves = migration.topics, migration.probes, migration.leaves
    state.counts = [before.counts[i] if i >= 0 else 0 for i in topics]
    state.received = [before.received[i] if i >= 0 else None for i in topics]
    state.messages = [before.messages[i] if i >= 0 else None for i in topics]
    state.fresh = [i >= 0 and before.fresh[i] for i in topics]
    state.times = [
        before.times[i] if i >= 0 else deque(maxlen=new.topics[place].history)
        for place, i in enumerate(topics)
    ]
    for place in migration.longer:
        state.times[place] = deque(state.times[place], maxlen=new.topics[place].history)
    state.values = [before.values[i] if i >= 0 else MISSING for i in probes]
    state.seen = [before.seen[i] if i >= 0 else None for i in probes]
    state.verdicts = [before.verdicts[i] if i >= 0 else None for i in leaves]
    state.references = [before.references[i] if i >= 0 else MISSING for i in leaves]
    state.begun = [before.begun[i] if i >= 0 else None for i in migration.timers]
    state.rules = [
        before.rules[i] if i >= 0 else RuleState(new.rules[place])
        for place, i in enumerate(migration.rules)
    ]
    rule_at, timer_at = migration.rule_at, migration.timer_at
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


def _new_values(migration: Migration, state: EngineState) -> None:
    for probe in migration.new_probes:
        if state.received[probe.topic] is not None:
            state.values[probe.index] = probe.read(state.messages[probe.topic])
    # When a probe that nobody watched had its value is not known better than by its message.
    for probe in (*migration.new_probes, *migration.newly_watched):
        known = kind_of(state.values[probe.index]) != "none"
        state.seen[probe.index] = state.received[probe.topic] if known else None


def _new_leaves(migration: Migration, state: EngineState, now: float) -> None:
    for leaf in migration.new_leaves:
        if isinstance(leaf.condition, Changed):
            state.references[leaf.index] = state.values[leaf.probe]
        state.verdicts[leaf.index] = _between_messages(leaf, state, now)


def _between_messages(leaf: LeafPlan, state: EngineState, now: float) -> Verdict:
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
    return leaf.predicate(state.values[leaf.probe])


def _new_timers(migration: Migration, state: EngineState, now: float) -> None:
    for timer in migration.new_timers:
        if timer.kind == "absent" or (
            timer.kind == "rate" and state.received[timer.topic] is not None
        ):
            state.begun[timer.index] = now
        _start_new(timer, state, now)


def _start_new(timer: TimerPlan, state: EngineState, now: float) -> None:
    received = state.received[timer.topic]
    if timer.kind == "stale" and received is not None and now > received + timer.seconds:
        # Stale already: the leaves are unknown, and the next message evaluates them anew.
        state.idle[timer.topic].append(timer.index)
        state.fresh[timer.topic] = False
    else:
        start(timer, state, now)


def _fresh_rules(
    migration: Migration, before: EngineState, state: EngineState, now: float
) -> MigrationReport:
    running: list[tuple[str, int]] = []
    for plan, twin in migration.fresh:
        if twin is not None:
            runs = before.rules[twin.index].runs
            state.rules[plan.index].runs = dict(runs)
            running.extend((plan.rule.id, run) for run in runs)
        _begin(migration.new, state, plan, now)
    for plan in migration.removed:
        running.extend((plan.rule.id, run) for run in before.rules[plan.index].runs)
    return MigrationReport(
        carried=migration.carried,
        reset=migration.reset,
        removed=tuple(plan.rule.id for plan in migration.removed),
        added=migration.added,
        running=tuple(running),
    )


def _begin(new: CompiledTable, state: EngineState, plan: RulePlan, now: float) -> None:
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
