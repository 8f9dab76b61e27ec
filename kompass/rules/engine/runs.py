"""From a trigger to a firing: once, cooldown, mode and rate limit, in this order."""

from heapq import heappush

from kompass.rules.engine.compiled_table import CompiledTable, RulePlan, TopicPlan
from kompass.rules.engine.firing import Firing, Note, Output, RunEnded
from kompass.rules.engine.near_miss import report_miss
from kompass.rules.engine.readings import readings
from kompass.rules.engine.state import ARMED, QUEUE, SPENT, EngineState, Waiting
from kompass.rules.schema.events import Parallel, Restart


def trigger(
    table: CompiledTable,
    state: EngineState,
    plan: RulePlan,
    at: float,
    topic: TopicPlan | None,
    out: list[Output],
) -> None:
    """Fire a rule whose condition calls for it, unless something holds it back.

    An edge is used up by the attempt: while the rule runs or cools down it is dropped, as the
    counters tell.
    """
    rule = state.rules[plan.index]
    event = plan.rule.event
    if rule.latched_at is not None or (event.once and rule.fired):
        _missed_edge(table, state, plan, at, "once", out)
        return
    gated = plan.trigger == "edge" or plan.clear is not None
    if gated and rule.armed != ARMED:
        return
    if plan.trigger == "edge":
        rule.armed = SPENT
    if at < rule.cooldown_end:
        rule.dropped += 1
        _missed_edge(table, state, plan, at, "cooldown", out)
        return
    cancels: tuple[int, ...] = ()
    if rule.runs:
        mode = event.mode
        if isinstance(mode, Restart):
            cancels = tuple(rule.runs)
        elif not isinstance(mode, Parallel) or len(rule.runs) >= mode.size:
            if len(rule.queue) < plan.queue:
                rule.queue.append(_waiting(table, state, plan, at, topic))
                rule.armed = SPENT
            else:
                rule.dropped += 1
                _missed_edge(table, state, plan, at, "busy", out)
            return
    if _start(table, state, plan, _waiting(table, state, plan, at, topic), at, cancels, out):
        rule.armed = SPENT


def finish(
    table: CompiledTable,
    state: EngineState,
    plan: RulePlan,
    done: RunEnded,
    at: float,
    out: list[Output],
) -> None:
    """Count the end of a run and begin the cooldown; a run that is not in progress is ignored."""
    rule = state.rules[plan.index]
    if rule.runs.pop(done.run_id, None) is None:
        return
    if not done.ok:
        rule.failed += 1
        rule.error = done.error
    rule.cooldown_end = at + plan.cooldown
    if rule.queue:
        if not plan.cooldown:
            _dequeue(table, state, plan, at, out)
        elif not rule.queue_timer:
            rule.queue_timer = True
            heappush(state.schedule, (rule.cooldown_end, QUEUE, plan.index))


def next_in_queue(
    table: CompiledTable, state: EngineState, plan: RulePlan, at: float, out: list[Output]
) -> None:
    """Start what waits for the end of a cooldown."""
    rule = state.rules[plan.index]
    rule.queue_timer = False
    if rule.queue and not rule.runs:
        _dequeue(table, state, plan, at, out)


def _dequeue(
    table: CompiledTable, state: EngineState, plan: RulePlan, at: float, out: list[Output]
) -> None:
    rule = state.rules[plan.index]
    if rule.latched_at is not None or not _start(
        table, state, plan, rule.queue.popleft(), at, (), out
    ):
        rule.queue.clear()


def _start(
    table: CompiledTable,
    state: EngineState,
    plan: RulePlan,
    cause: Waiting,
    at: float,
    cancels: tuple[int, ...],
    out: list[Output],
) -> bool:
    rule = state.rules[plan.index]
    limit = plan.rule.event.max_rate
    if limit:
        recent = rule.recent
        if len(recent) == limit.count and at < recent[0] + limit.window:
            rule.latched_at = at
            out.append(_latched(plan, at))
            return False
        recent.append(at)
    run_id = state.next_run
    state.next_run += 1
    if plan.shadow:
        # Nothing is done, so nothing has to end first, and the cooldown begins at once.
        cancels = ()
        rule.cooldown_end = at + plan.cooldown
    else:
        for run in cancels:
            del rule.runs[run]
        rule.runs[run_id] = at
    rule.fired += 1
    rule.last_fired = at
    out.append(
        Firing(
            rule_id=plan.rule.id,
            run_id=run_id,
            at=at,
            triggered_at=cause.at,
            revision_hash=plan.hash,
            topic=cause.topic,
            message=cause.message,
            messages=cause.messages,
            leaves=cause.leaves,
            actions=plan.rule.actions,
            lane=plan.rule.lane,
            severity=plan.rule.severity,
            cancels=cancels,
            shadow=plan.shadow,
            rule=plan.rule,
        )
    )
    return True


def _missed_edge(
    table: CompiledTable,
    state: EngineState,
    plan: RulePlan,
    at: float,
    sort: str,
    out: list[Output],
) -> None:
    # At the rate of messages a level rule is held back all the time: only an edge is news.
    if plan.trigger == "edge" and state.rules[plan.index].latched_at is None:
        report_miss(table, state, plan, at, sort, out)


def _latched(plan: RulePlan, at: float) -> Note:
    limit = plan.rule.event.max_rate
    assert limit is not None
    return Note(
        kind="rate_latched",
        rule_id=plan.rule.id,
        at=at,
        revision_hash=plan.hash,
        severity=plan.rule.severity,
        text=(
            f"rule '{plan.rule.id}' fired {limit.count} times within {limit.window:g} s and was "
            "about to again; it stays off until it is reset"
        ),
    )


def _waiting(
    table: CompiledTable, state: EngineState, plan: RulePlan, at: float, topic: TopicPlan | None
) -> Waiting:
    index = _newest(state, plan) if topic is None else topic.index
    received = {
        table.topics[i].name: state.messages[i]
        for i in plan.message_topics
        if state.received[i] is not None
    }
    leaves = readings(table, state, plan, at)
    if index is None:
        return Waiting(at, None, None, received, leaves)
    return Waiting(at, table.topics[index].name, state.messages[index], received, leaves)


def _newest(state: EngineState, plan: RulePlan) -> int | None:
    newest, last = None, float("-inf")
    for topic in plan.topics:
        received = state.received[topic]
        if received is not None and received >= last:
            newest, last = topic, received
    return newest
