"""From one table to the next without losing what the unchanged rules know.

The swap happens between two steps: every message is taken by exactly one table. A message that the
old table has taken makes no rule of the new one fire; only silence that already lasts does.
"""

from collections.abc import Collection
from heapq import heappush
from typing import NamedTuple

from kompass.rules.compiled import CompiledTable, LeafPlan, RulePlan, Timer
from kompass.rules.conditions import Absent, Changed, Rate, Received, timeout_of
from kompass.rules.engine import settle, step
from kompass.rules.firing import Output, Tick
from kompass.rules.schedule import start
from kompass.rules.state import HOLD, LOOK, QUEUE, RuleState, State, evaluated
from kompass.rules.values import MISSING, Verdict, kind_of


class Carried(NamedTuple):
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


def exchange(
    old: CompiledTable,
    old_state: State,
    new: CompiledTable,
    now: float,
    reset: Collection[str] = (),
) -> tuple[State, Carried, list[Output]]:
    """Go on with another table: the old one first takes the time that has passed, then carry.

    This is what a shell does between two messages. Compile the new table beforehand: that takes
    long, and this does not.

    Returns
    -------
    State, Carried, list of Firing or Note
        The last as from :func:`kompass.rules.engine.step`: what the old table let fire by now.
    """
    old_state, outputs = step(old, old_state, Tick(), now)
    state, carried = carry(old, old_state, new, now, reset)
    return state, carried, outputs


def carry(
    old: CompiledTable,
    old_state: State,
    new: CompiledTable,
    now: float,
    reset: Collection[str] = (),
) -> tuple[State, Carried]:
    """Return the state with which the new table goes on.

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
    for rule_id in reset:
        if rule_id not in new.by_id:
            raise KeyError(f"rule {rule_id!r} cannot be reset: the table has no such rule")
    state = State(new, old_state.now)
    now = max(now, old_state.now)
    state.next_run = old_state.next_run
    _topics(old, old_state, new, state)
    _probes(old, old_state, new, state)
    _leaves(old, old_state, new, state, now)
    _timers(old, old_state, new, state, now)
    return state, _rules(old, old_state, new, state, now, frozenset(reset))


def _topics(old: CompiledTable, before: State, new: CompiledTable, state: State) -> None:
    for plan in new.topics:
        known = old.by_topic.get(plan.name)
        if known is None:
            continue
        state.counts[plan.index] = before.counts[known.index]
        state.received[plan.index] = before.received[known.index]
        state.messages[plan.index] = before.messages[known.index]
        state.fresh[plan.index] = before.fresh[known.index]
        state.times[plan.index].extend(before.times[known.index])


def _probes(old: CompiledTable, before: State, new: CompiledTable, state: State) -> None:
    known = {probe.key: probe for probe in old.probes}
    for probe in new.probes:
        twin = known.get(probe.key)
        received = state.received[probe.topic]
        if twin is not None:
            state.values[probe.index] = before.values[twin.index]
            state.seen[probe.index] = before.seen[twin.index]
        elif received is not None:
            state.values[probe.index] = probe.read(state.messages[probe.topic])
        if state.seen[probe.index] is None and kind_of(state.values[probe.index]) != "none":
            state.seen[probe.index] = received


def _leaves(
    old: CompiledTable, before: State, new: CompiledTable, state: State, now: float
) -> None:
    known = {leaf.key: leaf for leaf in old.leaves}
    for leaf in new.leaves:
        twin = known.get(leaf.key)
        if twin is not None:
            state.verdicts[leaf.index] = before.verdicts[twin.index]
            state.references[leaf.index] = before.references[twin.index]
        else:
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


def _timers(
    old: CompiledTable, before: State, new: CompiledTable, state: State, now: float
) -> None:
    known = {timer.key: timer for timer in old.timers}
    for timer in new.timers:
        twin = known.get(timer.key)
        if twin is not None:
            state.begun[timer.index] = before.begun[twin.index]
            if twin.index in before.idle[twin.topic]:
                state.idle[timer.topic].append(timer.index)
            else:
                start(timer, state, before.now)
            continue
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


def _rules(
    old: CompiledTable,
    before: State,
    new: CompiledTable,
    state: State,
    now: float,
    reset: frozenset[str],
) -> Carried:
    carried, afresh, added = [], [], []
    running: list[tuple[str, int]] = []
    for plan in new.rules:
        rule_id = plan.rule.id
        twin = old.by_id.get(rule_id)
        if twin is not None and twin.hash == plan.hash and rule_id not in reset:
            carried.append(rule_id)
            _keep(before, twin, state, plan)
            continue
        if twin is None:
            added.append(rule_id)
        else:
            afresh.append(rule_id)
            runs = before.rules[twin.index].runs
            state.rules[plan.index].runs = dict(runs)
            running.extend((rule_id, run) for run in runs)
        _begin(new, state, plan, now)
    removed = [plan for plan in old.rules if plan.rule.id not in new.by_id]
    for plan in removed:
        running.extend((plan.rule.id, run) for run in before.rules[plan.index].runs)
    return Carried(
        carried=tuple(carried),
        reset=tuple(afresh),
        removed=tuple(plan.rule.id for plan in removed),
        added=tuple(added),
        running=tuple(running),
    )


def _keep(before: State, twin: RulePlan, state: State, plan: RulePlan) -> None:
    rule: RuleState = before.rules[twin.index].copy()
    state.rules[plan.index] = rule
    _count_from(state, plan, evaluated(twin, before))
    if rule.live:
        state.enlist(plan, plan.topics)
    if rule.hold_timer:
        rule.hold_timer = rule.since is not None
        if rule.since is not None:
            heappush(state.schedule, (rule.since + plan.hold, HOLD, plan.index))
    if rule.queue_timer:
        heappush(state.schedule, (rule.cooldown_end, QUEUE, plan.index))


def _begin(new: CompiledTable, state: State, plan: RulePlan, now: float) -> None:
    _count_from(state, plan, 0)
    if not plan.rule.enabled:
        return
    state.enlist(plan, plan.topics)
    settle(state, plan, plan.evaluate(state.verdicts))
    if any(new.leaves[i].timer >= 0 and state.verdicts[i] is True for _, i in plan.leaves):
        # The silence it asks for lasts already, and no message will come to have it looked at.
        heappush(state.schedule, (now, LOOK, plan.index))


def _count_from(state: State, plan: RulePlan, count: int) -> None:
    rule = state.rules[plan.index]
    rule.evaluated = 0
    rule.evaluated = count - evaluated(plan, state)
