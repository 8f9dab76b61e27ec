"""How a drive went on: when the robot moved, which goals were under way, and when it was unwell."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from typing import NamedTuple, TypeVar

from kompass.drills.facts import (
    HEALTHY,
    DriveEnded,
    Fact,
    GoalEnded,
    GoalSent,
    Motion,
    ProcessEnded,
    ProcessStarted,
    Status,
    StopPressed,
    StopReleased,
    in_order,
)

# What still counts as standing: below the noise of a robot at rest in the physics.
STANDSTILL_SPEED = 0.02  # m/s
STANDSTILL_TURNING = 0.05  # rad/s
STANDING = "standing"
STALL = 3.0  # s of standing, with a goal under way, that are no planning and no passing of somebody
_F = TypeVar("_F", bound=Fact)
_G = TypeVar("_G", bound=Fact)


class Spell(NamedTuple):
    """A stretch of time in which something was wrong: from ``begin`` up to ``end`` [s]."""

    begin: float
    end: float
    causes: tuple[str, ...]


class Attempt(NamedTuple):
    """A goal that was sent, and how it ended; None while it was under way at the drive's end."""

    sent: GoalSent
    ended: GoalEnded | None


class Course:
    """The facts of one drive in order, and what follows from them without judging anything.

    Parameters
    ----------
    facts
        In any order.
    """

    def __init__(self, facts: Iterable[Fact]) -> None:
        self.facts = in_order(facts)
        ends = [fact.at for fact in self.of(DriveEnded)]
        self.end = min(ends) if ends else max((fact.at for fact in self.facts), default=0.0)

    def of(self, kind: type[_F]) -> tuple[_F, ...]:
        """The facts of one kind, by time."""
        return tuple(fact for fact in self.facts if isinstance(fact, kind))

    def of_either(self, one: type[_F], other: type[_G]) -> tuple[_F | _G, ...]:
        """The facts of two kinds, by time."""
        return tuple(fact for fact in self.facts if isinstance(fact, (one, other)))

    @cached_property
    def motions(self) -> tuple[Motion, ...]:
        """Where the robot was, by time."""
        return self.of(Motion)

    @cached_property
    def _motion_times(self) -> list[float]:
        return [motion.at for motion in self.motions]

    @cached_property
    def moving(self) -> list[float]:
        """The times at which the robot was seen to move."""
        return [motion.at for motion in self.motions if moves(motion)]

    @cached_property
    def attempts(self) -> tuple[Attempt, ...]:
        """All goals that were sent, by time; of two answers to one goal the first counts."""
        answers: dict[int, GoalEnded] = {}
        for ended in self.of(GoalEnded):
            answers.setdefault(ended.goal, ended)
        return tuple(Attempt(sent, answers.get(sent.goal)) for sent in self.of(GoalSent))

    def at(self, time: float) -> Motion | None:
        """Where the robot was last seen at a time; None when it was not seen by then."""
        place = bisect_right(self._motion_times, time)
        return self.motions[place - 1] if place else None

    def moved_between(self, begin: float, end: float) -> float | None:
        """When the robot was first seen to move after ``begin`` and up to ``end``; None: never."""
        place = bisect_right(self.moving, begin)
        if place < len(self.moving) and self.moving[place] <= end:
            return self.moving[place]
        return None

    def stood_since(self) -> float:
        """Since when the robot has stood at the end of the drive."""
        place = bisect_right(self.moving, self.end)
        return self.moving[place - 1] if place else 0.0

    @cached_property
    def stops(self) -> tuple[Spell, ...]:
        """The stretches in which STOP was in force: until anybody released it."""
        changes = (
            (fact.at, "STOP", isinstance(fact, StopPressed))
            for fact in self.of_either(StopPressed, StopReleased)
        )
        return tuple(_spells(changes, self.end))

    def same_place(self, sent: GoalSent) -> Iterator[Attempt]:
        """This goal, and those after it that were sent to the same place, whoever sent them."""
        for attempt in self.attempts:
            other = attempt.sent
            near = math.dist((other.x, other.y), (sent.x, sent.y)) <= sent.tolerance
            if other.at >= sent.at and (other.goal == sent.goal or near):
                yield attempt

    def unwell(self, until: float) -> tuple[Spell, ...]:
        """The stretches up to ``until`` [s] in which the robot was not well, one for each cause.

        It is unwell while a process of the stack is dead, a component reports a failure (or the
        monitor does for it), STOP is in force, a given goal has ended otherwise than by arriving
        and was not sent again, or a goal is under way and the robot has stood for ``STALL`` or
        more: then from when it stood.
        """
        found = [
            *self._processes(),
            *self._components(),
            *self.stops,
            *self._lost_goals(),
            *self._standing(),
        ]
        clipped = (spell._replace(end=min(spell.end, until)) for spell in found)
        return tuple(sorted(spell for spell in clipped if spell.begin < spell.end))

    def _processes(self) -> Iterator[Spell]:
        changes = (
            (fact.at, f"{fact.process} dead", isinstance(fact, ProcessEnded))
            for fact in self.of_either(ProcessEnded, ProcessStarted)
        )
        return _spells(changes, self.end)

    def _components(self) -> Iterator[Spell]:
        changes = (
            (status.at, f"{status.component} failing", status.level != HEALTHY)
            for status in self.of(Status)
        )
        return _spells(changes, self.end)

    def _lost_goals(self) -> Iterator[Spell]:
        given = [attempt.sent for attempt in self.attempts if attempt.sent.given]
        for sent, ended in self.attempts:
            if not sent.given or ended is None or ended.outcome == "arrived":
                continue
            if ended.outcome == "preempted" and any(later.at > sent.at for later in given):
                continue  # by the next goal of the scenario: it is not missed
            again = [
                other.sent.at
                for other in self.same_place(sent)
                if other.sent.goal != sent.goal and other.sent.at >= ended.at
            ]
            yield Spell(ended.at, min(again, default=self.end), ("goal lost",))

    def _standing(self) -> Iterator[Spell]:
        for sent, ended in self.attempts:
            end = ended.at if ended else self.end
            first = bisect_left(self.moving, sent.at)
            seen = self.moving[first : bisect_right(self.moving, end)]
            for begin, over in zip([sent.at, *seen], [*seen, end], strict=True):
                if over - begin >= STALL:
                    yield Spell(self._stood_from(begin, over), over, (STANDING,))

    def _stood_from(self, moved: float, over: float) -> float:
        """When the robot was first seen to stand after it last moved, or was given a goal."""
        if moved not in self.moving:
            return moved
        place = bisect_right(self._motion_times, moved)
        return min(self._motion_times[place], over) if place < len(self.motions) else moved


def moves(motion: Motion) -> bool:
    """Whether that is more than standing."""
    return abs(motion.speed) > STANDSTILL_SPEED or abs(motion.turning) > STANDSTILL_TURNING


def _spells(changes: Iterable[tuple[float, str, bool]], end: float) -> Iterator[Spell]:
    """Stretches of each cause, from (time, cause, whether it is so now)."""
    since: dict[str, float] = {}
    for at, cause, is_so in changes:
        if is_so:
            since.setdefault(cause, at)
        elif cause in since:
            yield Spell(since.pop(cause), at, (cause,))
    for cause, begin in since.items():
        yield Spell(begin, end, (cause,))


def union(spells: Sequence[Spell]) -> tuple[Spell, ...]:
    """Stretches as ones that do not overlap, each with all of its causes."""
    joined: list[Spell] = []
    for spell in sorted(spells):
        if joined and spell.begin <= joined[-1].end:
            last = joined[-1]
            causes = tuple(dict.fromkeys((*last.causes, *spell.causes)))
            joined[-1] = Spell(last.begin, max(last.end, spell.end), causes)
        else:
            joined.append(spell)
    return tuple(joined)
