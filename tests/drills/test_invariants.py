"""What must hold in every drive is found broken where it is, and nowhere else."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from kompass.drills.facts import (
    ActionDone,
    Contact,
    DriveEnded,
    Fact,
    FaultBegan,
    GoalEnded,
    Motion,
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
from kompass.drills.invariants import INVARIANTS, broken_invariants
from tests.drills.drives import arriving, firing, sent, standing


def statuses(component: str, times: Sequence[float], *, own: bool = True) -> list[Fact]:
    return [Status(at, component, 0 if own else 2, "" if own else "died", own) for at in times]


def healthy(until: float) -> list[Fact]:
    return statuses("mapper", [float(n) for n in range(int(until) + 1)])


AT_REST: list[Fact] = [*standing(1.2, 1.0, 0.0, 30.0), DriveEnded(30.0)]
CREEPS = Motion(10.0, 1.2, 1.0, 0.0, 0.05, 0.0)
TURNS = Motion(10.0, 1.2, 1.0, 0.0, 0.0, -0.1)


@pytest.mark.parametrize(
    ("invariant", "facts"),
    [
        ("stays_stopped", [*AT_REST, StopPressed(9.4, "ava"), CREEPS]),
        ("stays_stopped", [*AT_REST, StopPressed(9.4, "ava"), TURNS]),
        ("stays_stopped", [*AT_REST, StopPressed(9.0, "ava"), StopPressed(9.8, "ava"), CREEPS]),
        ("stays_stopped", [*AT_REST, StopPressed(9.0, "ava"), StopReleased(9.2, "a rule", False)]),
        ("stays_stopped", [*AT_REST, StopPressed(9.0, "ava"), CREEPS, StopReleased(20.0, "ava")]),
        ("goals_end_with_a_reason", [*AT_REST, sent(), GoalEnded(9.0, 1, "stuck", " ")]),
        ("goals_end_with_a_reason", [*AT_REST[:-1], sent(), DriveEnded(63.0)]),
        ("firings_have_an_outcome", [*AT_REST, RuleFired(9.0, "a", 1)]),
        ("firings_have_an_outcome", [*AT_REST, RuleFired(9.0, "a", 1, epoch="x"),
                                     RunDone(9.5, "a", 1, True, epoch="y")]),
        ("firings_have_an_outcome", [*AT_REST, ActionDone(9.0, "a", 1, "stop", True)]),
        ("nobody_is_silent_unspoken_for", [*AT_REST, *healthy(20)]),
        ("nobody_is_silent_unspoken_for",
         [*AT_REST, *healthy(30), ProcessEnded(10.0, "mapper", ("mapper",))]),
        ("stands_when_blind", [*AT_REST, WentBlind(9.4, "scan"), CREEPS]),
        ("stands_when_blind", [*AT_REST, WentBlind(9.4, "scan"), CREEPS, SeesAgain(11.0, "scan")]),
        ("stands_when_blind", [*AT_REST, WentBlind(9.0, "scan"), WentBlind(9.1, "odometry"),
                               SeesAgain(9.5, "scan"), CREEPS]),
        ("stands_when_blind", [*AT_REST, WentBlind(9.2, "scan", 0.2), CREEPS]),
        ("touches_nothing_blind",
         [*AT_REST, WentBlind(9.7, "scan"), CREEPS, Contact(10.1, "wall")]),
        ("touches_nothing_blind",  # it stood there before the robot went blind
         [*AT_REST, FaultBegan(9.6, "boxed_in"), WentBlind(9.7, "scan"), CREEPS,
          Contact(10.1, "wall")]),
    ],
)  # fmt: skip
def test_what_breaks_an_invariant_is_found(invariant: str, facts: list[Fact]) -> None:
    assert {broken.invariant for broken in broken_invariants(facts)} >= {invariant}
    others = broken_invariants(facts)
    assert all(broken.text and 0.0 <= broken.at <= 63.0 for broken in others)


@pytest.mark.parametrize(
    "facts",
    [
        arriving(),
        [*AT_REST, StopPressed(9.6, "ava"), CREEPS],
        [*AT_REST, StopPressed(5.0, "ava"), StopReleased(9.0, "ava"), CREEPS],
        [*AT_REST, sent(), GoalEnded(9.0, 1, "stuck", "No progress.")],
        [*AT_REST, sent(), GoalEnded(9.0, 1, "arrived", "")],
        [*AT_REST, sent()],
        [*AT_REST, *firing("a", 5.0)],
        [*AT_REST, RuleFired(5.0, "a", 1, shadow=True)],
        [*AT_REST, RuleFired(20.5, "a", 1)],
        [*AT_REST, *healthy(30)],
        [*AT_REST, *statuses("mapper", range(11)), ProcessEnded(10.0, "mapper", ("mapper",)),
         *statuses("mapper", range(12, 31), own=False)],
        [*AT_REST, *healthy(30), ProcessEnded(10.0, "mapper", ("mapper",)),
         ProcessStarted(13.0, "mapper")],
        [*AT_REST, WentBlind(9.6, "scan"), CREEPS],
        [*AT_REST, WentBlind(5.0, "scan"), SeesAgain(9.0, "scan"), CREEPS],
        [*AT_REST, WentBlind(5.0, "scan"), SeesAgain(10.0, "scan"), CREEPS],
        [*AT_REST, Contact(5.0, "wall")],
        [*AT_REST, WentBlind(9.7, "scan"), FaultBegan(9.72, "boxed_in"), CREEPS,
         Contact(10.1, "wall")],
        [*AT_REST, WentBlind(9.4, "scan", 0.2), CREEPS],
        [*AT_REST, WentBlind(4.0, "scan"), Contact(5.0, "a person")],
        [*AT_REST, RuleFired(9.0, "a", 1), ProcessEnded(12.0, "monitor", ())],
    ],
)  # fmt: skip
def test_what_is_well_breaks_nothing(facts: list[Fact]) -> None:
    assert broken_invariants(facts) == ()


def test_the_place_and_the_words_are_told() -> None:
    (broken,) = broken_invariants([*AT_REST, StopPressed(9.0, "ava"), CREEPS])
    assert (broken.invariant, broken.at) == ("stays_stopped", 10.0)
    assert broken.text == "the robot moved 1.0 s after STOP of ava"
    assert set(INVARIANTS) == {
        "stays_stopped", "goals_end_with_a_reason", "firings_have_an_outcome",
        "nobody_is_silent_unspoken_for", "stands_when_blind",
        "touches_nothing_blind",
    }  # fmt: skip
