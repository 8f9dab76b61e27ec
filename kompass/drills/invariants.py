"""What must hold in every drive, whatever broke: functions over the facts of one.

Each returns the places where it does not hold, and none when it does.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

from kompass.drills.course import Course, moves
from kompass.drills.drive import BrokenInvariant
from kompass.drills.facts import (
    HEALTHY,
    ActionDone,
    Contact,
    Fact,
    FaultBegan,
    ProcessEnded,
    ProcessStarted,
    RuleFired,
    RunDone,
    SeesAgain,
    Status,
    StopPressed,
    StopReleased,
    WentBlind,
)

MONITOR = "monitor"  # name of the process that carries rules out
HALT = 0.5  # s in which a robot at full speed has come to rest
SLOW_HALT = 0.7  # s; the same, of one that hears its sensor too seldom to miss it sooner
USUAL_PERIOD = 0.15  # s between two messages of a sensor that is missed soon
LOOK = 0.1  # s between two looks at the robot
PATIENCE = 60.0  # s of standing after which a goal that is still under way has been forgotten
RUN = 10.0  # s; runs that began later than this before the end may still be under way
# Faults that put something where nothing was.
SUDDEN = ("way_blocked", "boxed_in", "person_ahead", "person_crossing", "door_closed")
SILENCE = 5.0  # s without a word of, or for, a component


def stays_stopped(course: Course) -> Iterator[tuple[float, str]]:
    """Nothing moves from ``HALT`` after STOP until a person releases it; and nobody else does."""
    since: StopPressed | None = None
    for fact in (*course.of_either(StopPressed, StopReleased), None):
        if isinstance(fact, StopPressed):
            since = since or fact
            continue
        if fact is not None and not fact.person:
            if since is not None:
                yield fact.at, f"STOP of {since.by} was released by {fact.by}, who is no person"
            continue
        if since is not None:
            until = course.end if fact is None else fact.at
            moved = course.moved_between(since.at + HALT, until)
            if moved is not None:
                yield moved, f"the robot moved {moved - since.at:.1f} s after STOP of {since.by}"
            since = None


def goals_end_with_a_reason(course: Course) -> Iterator[tuple[float, str]]:
    """Every goal is answered; and one that was not reached, with a reason.

    A goal under way at the drive's end counts as forgotten when the robot has stood since for
    ``PATIENCE`` or more.
    """
    for sent, ended in course.attempts:
        place = f"the goal ({sent.x:z.2f}, {sent.y:z.2f})"
        if ended is None:
            stood = course.end - max(sent.at, course.stood_since())
            if stood >= PATIENCE:
                yield course.end, f"{place} was never answered; the robot stood for {stood:.0f} s"
        elif ended.outcome != "arrived" and not ended.message.strip():
            yield ended.at, f"{place} ended as {ended.outcome} without a reason"


def firings_have_an_outcome(course: Course, run: float = RUN) -> Iterator[tuple[float, str]]:
    """The end of every run is told, but for those that began in the last ``run`` seconds.

    And for those that were under way when the monitor died: its journal says so.
    """
    deaths = [
        fact.at
        for fact in course.of_either(ProcessEnded, ProcessStarted)
        if isinstance(fact, ProcessEnded) and fact.process == MONITOR
    ]
    ended = {(done.epoch, done.rule_id, done.run) for done in course.of(RunDone)}
    fired = {(fact.epoch, fact.rule_id, fact.run) for fact in course.of(RuleFired)}
    for fact in course.of(RuleFired):
        key = fact.epoch, fact.rule_id, fact.run
        until = min((at for at in deaths if at >= fact.at), default=math.inf)
        lost = until - fact.at < run
        if not fact.shadow and key not in ended and not lost and course.end - fact.at >= run:
            yield fact.at, f"what came of {fact.rule_id} was never told"
    for done in course.of_either(ActionDone, RunDone):
        if (done.epoch, done.rule_id, done.run) not in fired:
            yield done.at, f"{done.rule_id} acted without having fired"


def nobody_is_silent_unspoken_for(course: Course) -> Iterator[tuple[float, str]]:
    """Each component is heard, or somebody speaks for it, at least every ``SILENCE`` seconds.

    It counts from the component's first status. When its process ends, a failure must be told of
    it within that time, by whomever, unless the process runs again by then.
    """
    statuses: dict[str, list[Status]] = {}
    for status in course.of(Status):
        statuses.setdefault(status.component, []).append(status)
    for component, said in sorted(statuses.items()):
        times = [status.at for status in said]
        for before, after in zip(times, [*times[1:], course.end], strict=True):
            if after - before > SILENCE:
                yield (
                    before + SILENCE,
                    (f"{component} said nothing for {after - before:.1f} s, and nobody for it"),
                )
    starts = course.of(ProcessStarted)
    for death in course.of(ProcessEnded):
        latest = death.at + SILENCE
        back = any(s.process == death.process and death.at <= s.at <= latest for s in starts)
        for component in death.components:
            told = any(
                status.level != HEALTHY and death.at <= status.at <= latest
                for status in statuses.get(component, ())
            )
            if not told and not back and course.end > latest:
                yield latest, f"{component} was dead for {SILENCE:g} s, and nobody said so"


def stands_when_blind(course: Course) -> Iterator[tuple[float, str]]:
    """The robot stands from ``HALT`` after it went blind until it sees again.

    From ``SLOW_HALT`` after it where the sensor's messages came so seldom that none was missed
    before.
    """
    for blind, end in _blind(course):
        halt = HALT if blind.period <= USUAL_PERIOD else SLOW_HALT
        moved = course.moved_between(blind.at + halt, min(end, course.end))
        # The sample at the very moment of seeing again is no longer blind.
        if moved is not None and moved < end:
            yield moved, f"the robot moved {moved - blind.at:.1f} s after the last {blind.sense}"


def touches_nothing_blind(course: Course) -> Iterator[tuple[float, str]]:
    """A robot that went blind drives into nothing; what comes to one that stands may touch it.

    Nor does it count what came into its way after it had gone blind, as long as it comes to rest:
    nobody can have seen it.
    """
    sudden = [fact.at for fact in course.of(FaultBegan) if fact.name.startswith(SUDDEN)]
    for blind, end in _blind(course):
        for contact in course.of(Contact):
            unseen = any(blind.at <= at <= contact.at <= blind.at + HALT for at in sudden)
            if blind.at < contact.at < end and not unseen:
                # The look before the contact: the contact itself may have brought it to rest.
                before = course.at(contact.at - LOOK)
                if before is not None and moves(before):
                    yield (
                        contact.at,
                        f"the robot touched {contact.what} {contact.at - blind.at:.1f} s after "
                        f"the last {blind.sense}",
                    )


def _blind(course: Course) -> Iterator[tuple[WentBlind, float]]:
    """From when and until when the robot was blind."""
    since: dict[str, WentBlind] = {}
    for fact in course.of_either(WentBlind, SeesAgain):
        if isinstance(fact, WentBlind):
            since.setdefault(fact.sense, fact)
        elif fact.sense in since:
            yield since.pop(fact.sense), fact.at
    for blind in since.values():
        yield blind, math.inf


Invariant = Callable[[Course], Iterator[tuple[float, str]]]
INVARIANTS: dict[str, Invariant] = {
    "stays_stopped": stays_stopped,
    "goals_end_with_a_reason": goals_end_with_a_reason,
    "firings_have_an_outcome": firings_have_an_outcome,
    "nobody_is_silent_unspoken_for": nobody_is_silent_unspoken_for,
    "stands_when_blind": stands_when_blind,
    "touches_nothing_blind": touches_nothing_blind,
}


def broken_invariants(facts: Iterable[Fact]) -> tuple[BrokenInvariant, ...]:
    """All places where something did not hold that must, by time."""
    course = Course(facts)
    found = [
        BrokenInvariant(invariant=name, at=round(at, 3), text=text)
        for name, check in INVARIANTS.items()
        for at, text in check(course)
    ]
    return tuple(sorted(found, key=lambda one: (one.at, one.invariant, one.text)))
