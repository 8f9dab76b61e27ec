"""Drives as they might be observed, made up: along a polyline at an even speed, with halts."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from functools import cache

from kompass.drills.drive import DriveResult
from kompass.drills.facts import (
    ActionDone,
    Contact,
    DriveEnded,
    Fact,
    FaultBegan,
    FaultEnded,
    GoalEnd,
    GoalEnded,
    GoalSent,
    Motion,
    RuleFired,
    RunDone,
    Status,
)
from kompass.drills.judge import judge
from kompass.drills.scenario import Goal, Scenario, ScheduledFault

SPEED = 0.2  # m/s
STEP = 0.1  # s between two poses
SENT = 2.0  # s at which the goal is sent
A_WAY = ((1.2, 1.0), (5.2, 1.0))  # 20 s along the lower wall of the warehouse


def scenario(
    name: str = "1-0",
    faults: Sequence[tuple[str, float, float]] = (),
    limit: float = 120.0,
    goals: Sequence[tuple[float, float]] = (A_WAY[-1],),
) -> Scenario:
    """A drive in the warehouse."""
    return Scenario(
        name=name,
        world="warehouse",
        goals=tuple(Goal(x=x, y=y) for x, y in goals),
        faults=tuple(ScheduledFault(name=n, at=at, duration=d) for n, at, d in faults),
        limit=limit,
    )


def along(
    way: Sequence[tuple[float, float]], begin: float, halts: Iterable[tuple[float, float]] = ()
) -> list[Motion]:
    """A drive along a way; during each halt (begin, end) the robot stands."""
    lengths = [math.dist(a, b) for a, b in itertools.pairwise(way)]
    halts = tuple(halts)
    at, driven, facts = begin, 0.0, list[Motion]()
    while driven < sum(lengths) - 1e-9:
        stands = any(first <= at < last for first, last in halts)
        facts.append(_motion(way, lengths, at, driven, 0.0 if stands else SPEED))
        at = round(at + STEP, 6)
        driven += 0.0 if stands else SPEED * STEP
    facts.append(_motion(way, lengths, at, sum(lengths), 0.0))
    return facts


def standing(x: float, y: float, begin: float, end: float) -> list[Motion]:
    """A robot that stands."""
    steps = round((end - begin) / STEP)
    return [Motion(round(begin + n * STEP, 6), x, y, 0.0, 0.0, 0.0) for n in range(steps + 1)]


def _motion(
    way: Sequence[tuple[float, float]],
    lengths: Sequence[float],
    at: float,
    driven: float,
    speed: float,
) -> Motion:
    for (x0, y0), (x1, y1), length in zip(way, way[1:], lengths, strict=False):
        if driven <= length or (x1, y1) == way[-1]:
            share = min(driven / length, 1.0)
            yaw = math.atan2(y1 - y0, x1 - x0)
            return Motion(at, x0 + share * (x1 - x0), y0 + share * (y1 - y0), yaw, speed, 0.0)
        driven -= length
    raise AssertionError


def sent(goal: int = 1, at: float = SENT, place: tuple[float, float] = A_WAY[-1]) -> GoalSent:
    """A goal of the scenario."""
    return GoalSent(at, goal, *place, tolerance=0.1)


def ended(at: float, outcome: GoalEnd = "arrived", message: str = "", goal: int = 1) -> GoalEnded:
    """An answer; an arrival tells how far off it was, as the planner does."""
    usual = "Arrived, 2 cm off." if outcome == "arrived" else ""
    return GoalEnded(at, goal, outcome, message or usual)


def arriving(
    halts: Iterable[tuple[float, float]] = (), way: Sequence[tuple[float, float]] = A_WAY
) -> list[Fact]:
    """A drive that arrives, with halts on the way."""
    motions = along(way, SENT + 0.5, halts)
    last = motions[-1].at
    return [sent(place=way[-1]), *motions, ended(last + 0.5), DriveEnded(last + 1.0)]


def faulted(name: str, begin: float, end: float | None = None) -> list[Fact]:
    """A fault, from when to when."""
    return [FaultBegan(begin, name), *([] if end is None else [FaultEnded(end, name)])]


def firing(
    rule: str, at: float, action: str = "unblock", *, ok: bool = True, run: int = 1
) -> list[Fact]:
    """A rule that fires, and what came of it a second later."""
    return [
        RuleFired(at, rule, run, "controller.status.status == 1"),
        ActionDone(at + 1.0, rule, run, action, ok, "" if ok else "the planner did not answer"),
        RunDone(at + 1.0, rule, run, ok),
    ]


def failing(component: str, begin: float, end: float, message: str) -> list[Fact]:
    """A component that reports a failure every second, and is well afterwards."""
    said = [Status(float(at), component, 1, message) for at in range(math.ceil(begin), int(end))]
    return [Status(0.0, component, 0), *said, Status(end, component, 0)]


@cache
def undisturbed(name: str = "1-0") -> DriveResult:
    """It arrived as if nothing were."""
    return judge(scenario(name), arriving())


@cache
def recovered(name: str = "1-0", halt: float = 8.0) -> DriveResult:
    """Stood for ``halt`` seconds before a wall, and arrived."""
    made = scenario(name, [("way_blocked", 8.0, halt)])
    facts = [
        *arriving([(9.0, 9.0 + halt)]),
        *faulted("way_blocked", 8.0, 8.0 + halt),
        *firing("stuck-unblock", 8.0 + halt / 2),
    ]
    return judge(made, facts)


@cache
def gave_up(name: str = "1-0", halt: float = 8.0) -> DriveResult:
    """The planner ended the goal of the same scenario, and said why."""
    made = scenario(name, [("way_blocked", 8.0, halt)])
    motions = [motion for motion in along(A_WAY, SENT + 0.5) if motion.at < 9.0]
    last = motions[-1]
    facts = [
        sent(),
        *motions,
        *standing(last.x, last.y, 9.0, 40.0),
        *faulted("way_blocked", 8.0, 8.0 + halt),
        ended(40.0, "stuck", "No progress for 30 s."),
        DriveEnded(41.0),
    ]
    return judge(made, facts)


@cache
def refused(name: str = "1-0") -> DriveResult:
    """Nobody can get to the goal, whatever breaks."""
    facts: list[Fact] = [
        sent(),
        ended(SENT + 0.5, "refused", "It is inside an obstacle."),
        DriveEnded(8.0),
    ]
    return judge(scenario(name), facts)


@cache
def touched(name: str = "1-0", halt: float = 8.0) -> DriveResult:
    """It touched the wall of the same scenario, and arrived."""
    made = scenario(name, [("way_blocked", 8.0, halt)])
    facts = [
        *arriving([(9.0, 9.0 + halt)]),
        *faulted("way_blocked", 8.0, 8.0 + halt),
        Contact(9.0, "barrier_across"),
        Contact(9.3, "barrier_across"),
    ]
    return judge(made, facts)
