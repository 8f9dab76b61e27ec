"""Judges a drive by what was observed of it. docs/drills.md has the definitions in words."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

from kompass.drills.course import STALL, STANDING, Attempt, Course, Spell, union
from kompass.drills.drive import (
    ActionResult,
    ContactResult,
    DriveMoment,
    DriveResult,
    DriveSpell,
    FaultResult,
    FiringResult,
    GoalResult,
    MomentKind,
    Outcome,
    RefusedFault,
)
from kompass.drills.facts import (
    HEALTHY,
    ActionDone,
    AlarmCleared,
    AlarmRaised,
    Contact,
    Fact,
    FaultBegan,
    FaultEnded,
    FaultFailed,
    GoalEnded,
    GoalSent,
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
from kompass.drills.invariants import broken_invariants
from kompass.drills.scenario import Scenario

BOUNCE = 1.0  # s within which touching the same thing again is the same contact
_STEP = 0.04  # m between two places of a track


def judge(scenario: Scenario, facts: Iterable[Fact]) -> DriveResult:
    """What became of a drive.

    Parameters
    ----------
    scenario
        As it was to be.
    facts
        What was observed, in any order; those after its end do not count.
    """
    course = Course(facts)
    course = Course(fact for fact in course.facts if fact.at <= course.end)
    goals = tuple(_goals(scenario, course))
    wanted = [goal for goal in goals if not goal.superseded]
    all_sent = len(goals) == len(scenario.goals)
    arrived = all_sent and all(goal.reached for goal in wanted)
    arrivals = [goal.ended for goal in wanted if goal.reached and goal.ended is not None]
    finish = max(arrivals) if arrived and arrivals else course.end
    unwell = course.unwell(finish)
    faults = tuple(_faults(course, unwell, finish, arrived=arrived))
    contacts = tuple(_contacts(course))
    outcome, why = _outcome(course, wanted, faults, contacts, arrived=arrived)
    recoveries = [fault.recovered_after for fault in faults if fault.disturbed]
    known = [seconds for seconds in recoveries if seconds is not None]
    return DriveResult(
        scenario=scenario,
        outcome=outcome,
        why=why,
        duration=_rounded(course.end),
        recovery=max(known) if known and len(known) == len(recoveries) else None,
        goals=goals,
        faults=faults,
        refused=tuple(
            RefusedFault(name=one.name, at=_rounded(one.at), reason=one.reason)
            for one in course.of(FaultFailed)
        ),
        firings=tuple(_firings(course)),
        contacts=contacts,
        broken=broken_invariants(course.facts),
        unwell=tuple(
            DriveSpell(begin=_rounded(one.begin), end=_rounded(one.end), causes=one.causes)
            for one in union(unwell)
        ),
        moments=tuple(_moments(course)),
        left_stopped=_left_stopped(course),
        track=tuple(_track(course)),
    )


def _goals(scenario: Scenario, course: Course) -> Iterator[GoalResult]:
    given = [attempt for attempt in course.attempts if attempt.sent.given]
    for index, (sent, _) in enumerate(given[: len(scenario.goals)]):
        attempts = list(course.same_place(sent))
        best = _best(attempts)
        is_followed = index + 1 < min(len(given), len(scenario.goals))
        yield GoalResult(
            x=_rounded(sent.x),
            y=_rounded(sent.y),
            tolerance=sent.tolerance,
            sent=_rounded(sent.at),
            ended=None if best is None else _rounded(best.at),
            outcome=best.outcome if best else "",
            message=best.message if best else "",
            attempts=len(attempts),
            superseded=is_followed
            and scenario.goals[index + 1].at is not None
            and best is not None
            and best.outcome == "preempted",
        )


def _best(attempts: Sequence[Attempt]) -> GoalEnded | None:
    """The first arrival; else the answer to the last attempt, if there is one."""
    for attempt in attempts:
        if attempt.ended is not None and attempt.ended.outcome == "arrived":
            return attempt.ended
    return attempts[-1].ended


def _faults(
    course: Course, unwell: Sequence[Spell], finish: float, *, arrived: bool
) -> Iterator[FaultResult]:
    began = course.of(FaultBegan)
    ends = list(course.of(FaultEnded))
    caused: dict[FaultBegan, list[Spell]] = {fault: [] for fault in began}
    for spell in unwell:
        cause = _cause(spell, began)
        if cause is not None:
            caused[cause].append(spell)
    for fault in began:
        end = next((e for e in ends if e.name == fault.name and e.at >= fault.at), None)
        if end is not None:
            ends.remove(end)
        spells = caused[fault]
        last = max((spell.end for spell in spells), default=None)
        is_over = last is not None and (last < finish or arrived)
        yield FaultResult(
            name=fault.name,
            began=_rounded(fault.at),
            ended=None if end is None else _rounded(end.at),
            disturbed=bool(spells),
            causes=tuple(dict.fromkeys(cause for spell in spells for cause in spell.causes)),
            recovered_after=_rounded(last - fault.at) if last is not None and is_over else None,
        )


def _cause(spell: Spell, began: Sequence[FaultBegan]) -> FaultBegan | None:
    """The fault whose doing a stretch is: the last that began before it."""
    before = [fault for fault in began if fault.at <= spell.begin]
    if before:
        return before[-1]
    if spell.causes == (STANDING,):
        # It had not set off yet, or waited for something else; but it should have gone on since.
        return next((fault for fault in began if spell.end - fault.at >= STALL), None)
    return None


def _contacts(course: Course) -> Iterator[ContactResult]:
    last: dict[str, float] = {}
    for contact in course.of(Contact):
        if contact.at - last.get(contact.what, -math.inf) > BOUNCE:
            x, y = _place(course, contact.at)
            yield ContactResult(at=_rounded(contact.at), what=contact.what, x=x, y=y)
        last[contact.what] = contact.at


def _firings(course: Course) -> Iterator[FiringResult]:
    actions: dict[tuple[str, str, int], list[ActionResult]] = {}
    for done in course.of(ActionDone):
        result = ActionResult(action=done.action, ok=done.ok, text=done.text)
        actions.setdefault((done.epoch, done.rule_id, done.run), []).append(result)
    ends = {(done.epoch, done.rule_id, done.run): done for done in course.of(RunDone)}
    for fired in course.of(RuleFired):
        key = fired.epoch, fired.rule_id, fired.run
        end = ends.get(key)
        x, y = _place(course, fired.at)
        yield FiringResult(
            rule_id=fired.rule_id,
            at=_rounded(fired.at),
            text=fired.text,
            shadow=fired.shadow,
            actions=tuple(actions.get(key, ())),
            ended=None if end is None else _rounded(end.at),
            ok=None if end is None else end.ok,
            error="" if end is None else end.error,
            x=x,
            y=y,
        )


def _outcome(
    course: Course,
    wanted: Sequence[GoalResult],
    faults: Sequence[FaultResult],
    contacts: Sequence[ContactResult],
    *,
    arrived: bool,
) -> tuple[Outcome, str]:
    disturbing = [fault for fault in faults if fault.disturbed]
    if contacts:
        first = contacts[0]
        return "contact", f"Touched {first.what} after {first.at:.1f} s."
    stop = _told_of_stop(course) if _left_stopped(course) else ""
    if arrived:
        afterwards = f" {stop}" if stop else ""
        if not disturbing:
            return "arrived", f"Arrived; no fault disturbed it.{afterwards}"
        worst = max(disturbing, key=lambda fault: fault.recovered_after or 0.0)
        took = f"{worst.recovered_after:.1f} s"
        return "recovered", f"Recovered {took} after {worst.name} began.{afterwards}"
    missed = [goal for goal in wanted if not goal.reached]
    if stop:
        return "stopped", stop
    if any(goal.outcome == "stopped" for goal in missed):
        return "stopped", "A goal was ended by STOP, and not sent again."
    if not missed or any(not goal.outcome for goal in missed):
        return _at_a_loss(course)
    silent = next((goal for goal in missed if not goal.message.strip()), None)
    if silent is not None:
        return "stood_silent", f"A goal ended as {silent.outcome}, and nobody said why."
    last = missed[-1]
    return "gave_up", f"A goal ended as {last.outcome}: {last.message}"


def _left_stopped(course: Course) -> bool:
    return bool(course.stops) and course.stops[-1].end >= course.end


def _told_of_stop(course: Course) -> str:
    pressed = course.of(StopPressed)[-1]
    reason = f": {pressed.reason}" if pressed.reason else ""
    return f"STOP by {pressed.by} was in force at the end{reason}."


def _at_a_loss(course: Course) -> tuple[Outcome, str]:
    """Of a drive that ended while a goal was under way, or before all goals were sent."""
    stood = course.end - course.stood_since()
    if stood < STALL:
        return "out_of_time", f"Still moving when the drive ended after {course.end:.0f} s."
    reason = _reason(course)
    if reason:
        return "stood", f"Stood for the last {stood:.0f} s: {reason}"
    return "stood_silent", f"Stood for the last {stood:.0f} s, and nobody said why."


def _reason(course: Course) -> str:
    """What was said, at the end, of why the robot stands; empty for nothing."""
    health: dict[str, Status] = {}
    for status in course.of(Status):
        health[status.component] = status
    alarms: dict[str, AlarmRaised] = {}
    for fact in course.facts:
        if isinstance(fact, AlarmRaised):
            alarms[fact.name] = fact
        elif isinstance(fact, AlarmCleared):
            alarms.pop(fact.name, None)
    said = [alarm.text for alarm in alarms.values() if alarm.text.strip()]
    said += [
        f"{status.component}: {status.message}"
        for status in health.values()
        if status.level != HEALTHY and status.message.strip()
    ]
    return said[0] if said else ""


def _moments(course: Course) -> Iterator[DriveMoment]:
    levels: dict[str, int] = {}
    for fact in course.facts:
        if isinstance(fact, Status):
            before = levels.get(fact.component, HEALTHY)
            levels[fact.component] = fact.level
            if fact.level == before:
                continue
        told = _told(fact)
        if told is not None:
            x, y = _place(course, fact.at)
            yield DriveMoment(at=_rounded(fact.at), kind=told[0], text=told[1], x=x, y=y)


def _told(fact: Fact) -> tuple[MomentKind, str] | None:
    match fact:
        case GoalSent():
            by = "" if fact.given else " by the stack itself"
            return "goal", f"Goal ({fact.x:z.2f}, {fact.y:z.2f}) sent{by}"
        case GoalEnded():
            return "goal end", f"Goal ended: {fact.outcome}. {fact.message}".strip()
        case FaultBegan():
            return "fault", f"{fact.name} began"
        case FaultEnded():
            return "fault end", f"{fact.name} ended"
        case FaultFailed():
            return "fault", f"{fact.name} did not begin: {fact.reason}"
        case RuleFired():
            shadow = " (in shadow)" if fact.shadow else ""
            return "firing", f"{fact.rule_id} fired{shadow}"
        case Contact():
            return "contact", f"Touched {fact.what}"
        case StopPressed():
            return "stop", f"STOP by {fact.by}"
        case StopReleased():
            return "release", f"STOP released by {fact.by}"
        case ProcessEnded(hangs=True):
            return "hang", f"{fact.process} hangs: {fact.reason}"
        case ProcessEnded():
            return "death", f"{fact.process} died: {fact.reason}" if fact.reason else (
                f"{fact.process} died"
            )
        case ProcessStarted():
            return "restart", f"{fact.process} runs"
        case Status():
            if fact.level == HEALTHY:
                return "status", f"{fact.component} is well"
            return "status", f"{fact.component} failing: {fact.message}"
        case AlarmRaised():
            return "alarm", f"Alarm {fact.name}: {fact.text}"
        case WentBlind():
            return "blind", f"Last {fact.sense}"
        case SeesAgain():
            return "sees", f"{fact.sense} again"
        case _:
            return None


def _track(course: Course) -> Iterator[tuple[float, float, float]]:
    last: tuple[float, float] | None = None
    for index, motion in enumerate(course.motions):
        here = motion.x, motion.y
        is_end = index == len(course.motions) - 1
        if last is None or is_end or math.dist(here, last) >= _STEP:
            last = here
            yield _rounded(motion.at), _rounded(motion.x), _rounded(motion.y)


def _place(course: Course, at: float) -> tuple[float | None, float | None]:
    motion = course.at(at)
    return (None, None) if motion is None else (_rounded(motion.x), _rounded(motion.y))


def _rounded(value: float) -> float:
    # To the millisecond and the millimetre; + 0.0 makes no difference of -0.0.
    return round(value, 3) + 0.0
