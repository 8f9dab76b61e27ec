"""What becomes due by time alone: values grow old, silence lasts, rates fall.

Every timer has one entry in the schedule at most. A message that moves a deadline leaves the entry
where it is; when the entry comes up early it is put back. A topic at 1 kHz thereby costs one
entry per timeout, not one per message.
"""

import math
from heapq import heappop, heappush

from kompass.rules.engine.compiled_table import CompiledTable, TimerPlan
from kompass.rules.engine.state import HOLD, LEAF, LOOK, EngineState


def due(timer: TimerPlan, state: EngineState) -> float | None:
    """Return when a timer's leaves change by time alone; None if only a message changes them."""
    last = state.received[timer.topic]
    if timer.kind == "stale":
        # "Older than": at exactly the timeout a value still counts.
        return None if last is None else math.nextafter(last + timer.seconds, math.inf)
    begun = state.begun[timer.index]
    if timer.kind == "absent":
        if timer.probe >= 0:
            last = state.seen[timer.probe]
        if last is None:
            return None if begun is None or not timer.from_start else begun + timer.seconds
        return last + timer.seconds
    if begun is None:
        return None
    if state.verdicts[timer.leaves[0]] is None:
        return begun + timer.seconds
    times = state.times[timer.topic]
    return times[-timer.need] + timer.seconds if enough(timer, state, state.now) else None


def enough(timer: TimerPlan, state: EngineState, now: float) -> bool:
    """Whether the window that ends now holds as many messages as the rate needs."""
    times = state.times[timer.topic]
    return len(times) >= timer.need and now < times[-timer.need] + timer.seconds


def rate_of(timer: TimerPlan, state: EngineState, now: float) -> bool:
    """Return the verdict of a rate whose first window has passed."""
    return enough(timer, state, now) is timer.above


def start(timer: TimerPlan, state: EngineState, at: float) -> None:
    """Put a timer into the schedule, or among those that wait for a message."""
    when = due(timer, state)
    if when is None:
        state.idle[timer.topic].append(timer.index)
    else:
        heappush(state.schedule, (max(when, at), LEAF, timer.index))


def next_deadline(table: CompiledTable, state: EngineState) -> float | None:
    """Return when the next ``Tick`` is needed, in monotonic seconds; None if none is.

    Entries that messages have moved are put where they belong, which changes nothing that can be
    observed.
    """
    schedule = state.schedule
    while schedule:
        when, phase, index = schedule[0]
        actual = _actual(table, state, phase, index)
        if actual is not None and actual <= when:
            return when
        heappop(schedule)
        if actual is not None:
            heappush(schedule, (actual, phase, index))
        elif phase == LEAF:
            state.idle[table.timers[index].topic].append(index)
        elif phase == HOLD:
            state.rules[index].hold_timer = False
        else:
            state.rules[index].queue_timer = False
    return None


def _actual(table: CompiledTable, state: EngineState, phase: int, index: int) -> float | None:
    if phase == LEAF:
        return due(table.timers[index], state)
    if phase == LOOK:
        return state.now
    rule = state.rules[index]
    if phase == HOLD:
        return None if rule.since is None else rule.since + table.rules[index].hold
    return rule.cooldown_end if rule.queue else None
