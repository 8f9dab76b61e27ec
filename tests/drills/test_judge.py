"""A drive is judged by what was observed of it, as docs/drills.md defines the outcomes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kompass.drills.drive import CAME_THROUGH, GRADES, OUTCOMES, DriveResult
from kompass.drills.facts import (
    GOAL_OUTCOMES,
    ActionDone,
    AlarmCleared,
    AlarmRaised,
    Contact,
    DriveEnded,
    Fact,
    FaultBegan,
    FaultEnded,
    FaultFailed,
    GoalEnded,
    GoalSent,
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
from kompass.drills.judge import judge
from kompass.drills.scenario import Goal
from tests.drills.drives import (
    A_WAY,
    along,
    arriving,
    ended,
    failing,
    faulted,
    firing,
    scenario,
    sent,
    standing,
)

WALL = [("way_blocked", 8.0, 8.0)]
X, Y = 2.5, 1.0  # where it stops on the way


def test_goals_end_here_as_they_do_in_the_planner() -> None:
    from kompass.components.planner.goal_progress import GoalOutcome

    assert [outcome.name.lower() for outcome in GoalOutcome] == list(GOAL_OUTCOMES)


def test_a_drive_that_nothing_disturbs_has_arrived() -> None:
    found = judge(scenario(faults=WALL), [*arriving(), *faulted("way_blocked", 8.0, 16.0)])
    assert (found.outcome, found.recovery, found.disturbed) == ("arrived", None, False)
    assert found.time_to_goal == pytest.approx(21.0, abs=0.2)
    assert found.faults[0].ended == 16.0


def test_recovery_lasts_from_the_fault_to_the_end_of_what_it_did() -> None:
    facts = [*arriving([(9.0, 17.0)]), *faulted("way_blocked", 8.0, 16.0)]
    found = judge(scenario(faults=WALL), facts)
    assert found.outcome == "recovered"
    assert found.recovery == pytest.approx(9.0, abs=0.11)
    assert found.faults[0].causes == ("standing",)
    assert found.why == f"Recovered {found.recovery:.1f} s after way_blocked began."


def test_a_halt_shorter_than_a_stall_disturbs_nothing() -> None:
    facts = [*arriving([(9.0, 11.5)]), *faulted("way_blocked", 8.0, 16.0)]
    assert judge(scenario(faults=WALL), facts).outcome == "arrived"


def test_a_failure_disturbs_a_robot_that_drives_on() -> None:
    facts = [
        *arriving(),
        *faulted("scan_frozen", 8.0, 12.0),
        *failing("mapper", 9.0, 14.0, "The scan is frozen."),
    ]
    found = judge(scenario(faults=[("scan_frozen", 8.0, 4.0)]), facts)
    assert (found.outcome, found.recovery) == ("recovered", 6.0)
    assert found.faults[0].causes == ("mapper failing",)


def test_a_dead_process_disturbs_until_it_runs_again() -> None:
    facts = [
        *arriving(),
        FaultBegan(8.0, "kill:mapper"),
        ProcessEnded(8.1, "mapper", ("mapper",), "SIGKILL"),
        ProcessStarted(10.5, "mapper"),
    ]
    found = judge(scenario(faults=[("kill:mapper", 8.0, 0.0)]), facts)
    assert (found.outcome, found.recovery) == ("recovered", 2.5)


def test_what_was_wrong_before_any_fault_is_no_faults_doing() -> None:
    facts = [
        *arriving(),
        *failing("mapper", 0.5, 4.0, "no scan yet"),
        *faulted("way_blocked", 8.0, 16.0),
    ]
    assert judge(scenario(faults=WALL), facts).outcome == "arrived"


def test_what_lasts_into_a_fault_is_not_its_doing_either() -> None:
    facts = [
        *arriving(),
        *failing("mapper", 0.5, 12.0, "no scan yet"),
        *faulted("way_blocked", 8.0, 16.0),
    ]
    assert judge(scenario(faults=WALL), facts).outcome == "arrived"


def test_a_robot_that_does_not_set_off_is_disturbed_by_the_fault_that_begins_meanwhile() -> None:
    late = [
        *(motion for motion in along(A_WAY, 2.5, [(2.5, 9.0)]) if motion.at >= 2.5),
        *faulted("way_blocked", 3.0, 8.0),
        sent(),
        ended(29.5),
        DriveEnded(30.0),
    ]
    found = judge(scenario(faults=[("way_blocked", 3.0, 5.0)]), late)
    assert (found.outcome, found.faults[0].causes) == ("recovered", ("standing",))
    assert found.recovery == pytest.approx(6.0, abs=0.11)


def test_a_fault_that_stops_the_robot_at_once_disturbs_it() -> None:
    """The last motion is seen before the fault, the first standstill after it."""
    facts = [
        *arriving([(9.0, 17.0)]),
        *faulted("scan_frozen", 5.0, 6.0),
        *faulted("wheel_blocked", 8.96, 16.96),
    ]
    made = scenario(faults=[("scan_frozen", 5.0, 1.0), ("wheel_blocked", 8.96, 8.0)])
    assert [fault.causes for fault in judge(made, facts).faults] == [(), ("standing",)]


def test_of_two_faults_each_answers_for_what_begins_after_it() -> None:
    facts = [
        *arriving([(9.0, 13.0), (20.0, 26.0)]),
        *faulted("way_blocked", 8.0, 12.0),
        *faulted("wheel_blocked", 19.0, 25.0),
    ]
    made = scenario(faults=[("way_blocked", 8.0, 4.0), ("wheel_blocked", 19.0, 6.0)])
    found = judge(made, facts)
    assert [fault.recovered_after for fault in found.faults] == pytest.approx([5.0, 7.0], abs=0.11)
    assert found.recovery == pytest.approx(7.0, abs=0.11)


def test_recovery_ends_with_the_arrival_at_the_latest() -> None:
    facts = [*arriving(), *faulted("scan_frozen", 8.0), *failing("mapper", 9.0, 50.0, "frozen")]
    found = judge(scenario(faults=[("scan_frozen", 8.0, 0.0)]), facts)
    arrived = found.goals[0].ended
    assert arrived is not None
    assert found.outcome == "recovered"
    assert found.recovery == pytest.approx(arrived - 8.0)


def stuck(*more: Fact, until: float = 60.0) -> list[Fact]:
    motions = [motion for motion in along(A_WAY, 2.5) if motion.at < 9.0]
    return [
        sent(),
        *motions,
        *standing(motions[-1].x, motions[-1].y, 9.0, until),
        *faulted("way_blocked", 8.0),
        *more,
        DriveEnded(until),
    ]


@pytest.mark.parametrize(
    ("more", "outcome", "why"),
    [
        ((), "stood_silent", "nobody said why"),
        ((AlarmRaised(20.0, "jam", "The way is blocked."),), "stood", "The way is blocked."),
        ((AlarmRaised(20.0, "jam", "x"), AlarmCleared(30.0, "jam")), "stood_silent", "nobody"),
        ((Status(20.0, "controller", 1, "No way on."),), "stood", "controller: No way on."),
        ((Status(20.0, "controller", 1, " "),), "stood_silent", "nobody said why"),
        ((Status(20.0, "planner", 1, "x"), Status(21.0, "planner", 0)), "stood_silent", "nobody"),
        ((ended(50.0, "stuck", "No progress."),), "gave_up", "ended as stuck: No progress."),
        ((GoalEnded(50.0, 1, "stuck", " "),), "stood_silent", "ended as stuck, and nobody"),
        ((StopPressed(20.0, "ava", "a child"),), "stopped", "in force at the end: a child"),
        ((StopPressed(20.0, "ava"), StopReleased(25.0, "ava")), "stood_silent", "nobody said why"),
        ((ended(20.0, "stopped", "STOP"), StopPressed(20.0, "ava"), StopReleased(25.0, "ava")),
         "stopped", "ended by STOP, and not sent again"),
        ((Contact(9.0, "barrier"), ended(50.0, "stuck", "No progress.")),
         "contact", "Touched barrier after 9.0 s."),
    ],
)  # fmt: skip
def test_a_robot_that_does_not_get_there(more: Sequence[Fact], outcome: str, why: str) -> None:
    found = judge(scenario(faults=WALL), stuck(*more))
    assert found.outcome == outcome
    assert why in found.why
    assert found.recovery is None
    assert found.time_to_goal is None


def test_a_robot_that_still_drives_at_the_end_ran_out_of_time() -> None:
    motions = [motion for motion in along(A_WAY, 2.5) if motion.at < 12.0]
    facts: list[Fact] = [sent(), *motions, DriveEnded(12.0)]
    assert judge(scenario(), facts).outcome == "out_of_time"


def test_a_drive_in_which_no_goal_was_sent_did_not_arrive() -> None:
    found = judge(scenario(), [*standing(1.2, 1.0, 0.0, 30.0), DriveEnded(30.0)])
    assert found.outcome == "stood_silent"


def test_a_goal_that_a_rule_sends_again_counts_as_that_goal() -> None:
    motions = along(A_WAY, 2.5, [(9.0, 20.0)])
    again = GoalSent(19.0, 2, A_WAY[-1][0] + 0.05, A_WAY[-1][1], 0.1, given=False)
    facts: list[Fact] = [
        sent(), *motions, *faulted("way_blocked", 8.0, 16.0), ended(18.0, "stuck", "No progress."),
        again, ended(35.0, goal=2), DriveEnded(36.0),
    ]  # fmt: skip
    found = judge(scenario(faults=WALL), facts)
    assert found.outcome == "recovered"
    assert (found.goals[0].attempts, found.goals[0].ended) == (2, 35.0)
    assert set(found.faults[0].causes) == {"standing", "goal lost"}
    elsewhere: list[Fact] = [
        GoalSent(19.0, 2, 9.0, 1.0, 0.1, given=False) if fact == again else fact for fact in facts
    ]
    assert judge(scenario(faults=WALL), elsewhere).outcome == "gave_up"


def test_a_goal_that_the_scenario_itself_replaces_need_not_be_reached() -> None:
    first, second = (9.0, 1.0), A_WAY[-1]
    made = scenario().model_copy(
        update={"goals": (Goal(x=first[0], y=1.0), Goal(x=second[0], y=1.0, at=5.0))}
    )
    facts: list[Fact] = [
        sent(1, 2.0, first), *along(A_WAY, 2.5), ended(5.0, "preempted", "A newer goal."),
        sent(2, 5.0, second), ended(24.0, goal=2), DriveEnded(25.0),
    ]  # fmt: skip
    assert judge(made, [*facts, FaultBegan(4.0, "scan_frozen")]).outcome == "arrived"
    follows = made.model_copy(update={"goals": (made.goals[0], Goal(x=second[0], y=1.0))})
    assert judge(follows, facts).outcome == "gave_up"


def test_a_goal_that_a_rules_goal_replaces_is_missed_until_it_is_sent_again() -> None:
    facts: list[Fact] = [
        sent(), *along(A_WAY, 2.5), *faulted("scan_frozen", 8.0, 12.0),
        GoalSent(9.0, 2, 9.0, 8.0, 0.1, given=False), ended(9.0, "preempted", "A newer goal."),
        GoalSent(13.0, 3, *A_WAY[-1], 0.1, given=False), ended(24.0, goal=3), DriveEnded(25.0),
    ]  # fmt: skip
    found = judge(scenario(faults=[("scan_frozen", 8.0, 4.0)]), facts)
    assert (found.outcome, found.recovery) == ("recovered", 5.0)
    assert found.faults[0].causes == ("goal lost",)


def test_touching_the_same_thing_again_at_once_is_one_contact() -> None:
    touches = [Contact(9.0, "wall"), Contact(9.8, "wall"), Contact(10.6, "wall")]
    later = [Contact(9.1, "column"), Contact(15.0, "wall")]
    found = judge(scenario(), [*arriving(), *touches, *later])
    assert [(one.at, one.what) for one in found.contacts] == [
        (9.0, "wall"), (9.1, "column"), (15.0, "wall"),
    ]  # fmt: skip
    assert found.contacts[0].x == pytest.approx(2.5, abs=0.03)


def test_firings_are_told_with_what_they_did() -> None:
    facts = [*arriving(), *firing("a", 5.0), *firing("b", 6.0, ok=False, run=2),
             RuleFired(7.0, "c", 3, shadow=True), RuleFired(22.0, "a", 4)]  # fmt: skip
    found = judge(scenario(), facts)
    assert [(one.rule_id, one.ok) for one in found.firings] == [
        ("a", True), ("b", False), ("c", None), ("a", None),
    ]  # fmt: skip
    assert found.firings[1].actions[0].text == "the planner did not answer"
    assert found.firings[0].ended == 6.0


def test_what_happens_after_the_end_does_not_count() -> None:
    facts = arriving()
    assert judge(scenario(), [*facts, Contact(99.0, "wall")]) == judge(scenario(), facts)


def test_every_outcome_has_its_words_and_its_grade() -> None:
    assert set(OUTCOMES) == set(GRADES)
    assert all(GRADES[outcome] == 0 for outcome in CAME_THROUGH)


TIMES = st.sampled_from([0.0, 1.0, 5.0, 8.0, 8.5, 9.0, 20.0, 30.0])
WORDS = st.sampled_from(["a", "b"])
FACTS = st.one_of(
    st.builds(
        Motion, TIMES, st.just(X), st.just(Y), st.just(0.0), st.sampled_from([0.0, 0.2]),
        st.just(0.0),
    ),
    st.builds(
        GoalSent, TIMES, st.integers(1, 3), st.just(X), st.just(Y), st.just(0.1), st.booleans()
    ),
    st.builds(
        GoalEnded, TIMES, st.integers(1, 3), st.sampled_from(GOAL_OUTCOMES),
        st.sampled_from(["", "x"]),
    ),
    st.builds(Contact, TIMES, WORDS),
    st.builds(StopPressed, TIMES, WORDS),
    st.builds(StopReleased, TIMES, WORDS, st.booleans()),
    st.builds(Status, TIMES, WORDS, st.integers(0, 2), st.sampled_from(["", "x"]), st.booleans()),
    st.builds(ProcessEnded, TIMES, WORDS, st.just(("a",))),
    st.builds(ProcessStarted, TIMES, WORDS),
    st.builds(RuleFired, TIMES, WORDS, st.integers(1, 2)),
    st.builds(ActionDone, TIMES, WORDS, st.integers(1, 2), WORDS, st.booleans()),
    st.builds(RunDone, TIMES, WORDS, st.integers(1, 2), st.booleans()),
    st.builds(FaultBegan, TIMES, WORDS),
    st.builds(FaultEnded, TIMES, WORDS),
    st.builds(AlarmRaised, TIMES, WORDS, st.just("x")),
    st.builds(AlarmCleared, TIMES, WORDS),
    st.builds(WentBlind, TIMES, WORDS),
    st.builds(SeesAgain, TIMES, WORDS),
    st.builds(DriveEnded, TIMES),
)  # fmt: skip


def judged(facts: Iterable[Fact]) -> DriveResult:
    return judge(scenario(faults=WALL), facts)


@settings(max_examples=300)
@given(st.lists(FACTS, max_size=25), st.randoms(use_true_random=False))
def test_no_verdict_depends_on_the_order_in_which_facts_were_written(
    facts: list[Fact], random: object
) -> None:
    shuffled = list(facts)
    random.shuffle(shuffled)  # type: ignore[attr-defined]
    assert judged(shuffled) == judged(facts)


@settings(max_examples=300)
@given(st.lists(FACTS, max_size=25))
def test_every_drive_has_one_outcome_that_fits_its_numbers(facts: list[Fact]) -> None:
    found = judged(facts)
    assert found.outcome in OUTCOMES
    assert found.why
    assert (found.outcome == "contact") == bool(found.contacts)
    if found.outcome == "recovered":
        assert found.disturbed
        assert found.recovery is not None
    if found.outcome == "arrived":
        assert not found.disturbed
    for before, after in zip(found.unwell, found.unwell[1:], strict=False):
        assert before.begin < before.end < after.begin
    assert DriveResult.model_validate_json(found.model_dump_json()) == found


def test_a_fault_that_could_not_be_switched_on_is_told_and_disturbed_nothing() -> None:
    made = scenario(faults=[("person_ahead", 5.0, 3.0)])
    result = judge(made, [*arriving(), FaultFailed(5.0, "person_ahead", "there is no room")])
    (refused,) = result.refused
    assert (refused.name, refused.at, refused.reason) == ("person_ahead", 5.0, "there is no room")
    assert (result.faults, result.disturbed) == ((), False)
    assert "person_ahead did not begin: there is no room" in [one.text for one in result.moments]
