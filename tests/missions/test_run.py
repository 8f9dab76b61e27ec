"""A run goes from place to place, does what is to be done there, and stands when told to."""

from __future__ import annotations

from datetime import datetime
from zoneinfo import ZoneInfo

import pytest
from hypothesis import strategies as st
from pydantic import ValidationError

from kompass.missions.mission import Act, Ask, Halt, Schedule, Wait
from kompass.missions.queue import is_due, looked_at
from kompass.missions.run import Cease, GoTo, MissionRefused, MissionRun, Perform
from kompass.rules.schema.actions import Log
from tests.missions.missions import at, fresh, mission, plan
from tests.support.properties import property_test

LOG = Act(action=Log(text="here"))


def begun(*tasks: tuple[object, ...], **fields: object) -> MissionRun:
    made = MissionRun(fresh(mission(*tasks, **fields)), at(0))  # type: ignore[arg-type]
    made.begin(at(0))
    return made


def ticket_of(run: MissionRun) -> int:
    return next(n for n in range(1000) if run.awaits(n))


def arrive(run: MissionRun, seconds: float = 0.0) -> tuple[object, ...]:
    return run.drive_ended(ticket_of(run), "arrived", "", at(seconds))


def test_it_goes_to_its_places_in_order_and_is_done() -> None:
    run = MissionRun(fresh(mission((), ())), at(0))
    (first,) = run.begin(at(0))
    (second,) = arrive(run)
    assert isinstance(first, GoTo)
    assert isinstance(second, GoTo)
    assert (first.place, second.place) == (1, 2)
    assert arrive(run) == ()
    assert (run.run.phase, run.run.over) == ("done", True)


def test_it_waits_as_long_as_it_was_told_to() -> None:
    run = begun((Wait(seconds=5.0),), ())
    assert arrive(run, 10) == ()
    assert (run.run.phase, run.left(at(12))) == ("waiting", 3.0)
    assert run.tick(at(14.9)) == ()
    (effect,) = run.tick(at(15.0))
    assert isinstance(effect, GoTo)


def test_a_wait_that_was_interrupted_goes_on_where_it_was_and_at_its_place() -> None:
    run = begun((Wait(seconds=5.0),))
    arrive(run, 10)
    run.pause("ben", at(12))
    assert run.due is None
    (effect,) = run.resume("ben", at(60))
    assert isinstance(effect, GoTo)  # somebody may have moved it
    arrive(run, 61)
    assert run.left(at(61)) == 3.0


def test_it_asks_until_a_person_confirms() -> None:
    run = begun((Ask(text="Load it"),))
    arrive(run)
    assert run.tick(at(1e6)) == ()
    assert not run.run.over
    run.confirm("ben", at(1e6))
    assert run.run.phase == "done"


def test_what_is_done_at_a_place_is_done_in_order_and_stop_is_left_to_a_person() -> None:
    run = begun((LOG, Halt(), Ask()))
    (effect,) = arrive(run)
    assert isinstance(effect, Perform)
    assert effect.task == LOG
    (halt,) = run.task_ended(effect.ticket, True, "", at(1))
    assert isinstance(halt, Perform)
    assert isinstance(halt.task, Halt)
    assert run.interrupted("mission Round pressed STOP", at(1)) == ()  # its own
    assert run.task_ended(halt.ticket, True, "", at(2)) == ()
    assert (run.run.phase, run.run.tasks_done) == ("paused", 2)
    run.resume("ben", at(3))
    arrive(run, 4)
    assert run.run.phase == "asking"


@pytest.mark.parametrize(
    ("policy", "phase"), [("pause", "paused"), ("skip", "driving"), ("end", "failed")]
)
def test_a_place_that_cannot_be_reached_is_tried_as_often_as_said_and_then_as_decided(
    policy: str, phase: str
) -> None:
    run = begun((), (), attempts=2, on_failure=policy)
    (again,) = run.drive_ended(ticket_of(run), "failed", "A wall.", at(1))
    assert isinstance(again, GoTo)
    assert (again.place, run.run.attempt) == (1, 2)
    run.drive_ended(again.ticket, "failed", "A wall.", at(2))
    assert run.run.phase == phase
    if policy == "skip":
        assert run.run.skipped[0].reason == "A wall."
        assert run.run.here.place == 2
    else:
        assert run.run.reason == "A wall."


def test_rounds_are_counted_and_one_in_which_nothing_was_reached_is_the_last() -> None:
    run = begun((), (), rounds=0, on_failure="skip")
    for _ in range(3):
        arrive(run)
        arrive(run)
    assert (run.run.round, run.run.phase) == (4, "driving")
    run.drive_ended(ticket_of(run), "failed", "A wall.", at(1))
    run.drive_ended(ticket_of(run), "failed", "A wall.", at(1))
    assert (run.run.phase, run.run.reason) == ("paused", "No place was reached in a whole round.")


def test_what_is_told_of_a_drive_that_nobody_awaits_changes_nothing() -> None:
    run = begun((), ())
    old = ticket_of(run)
    assert run.pause("ben", at(1)) == (Cease(),)
    before = run.run
    assert run.drive_ended(old, "arrived", "", at(2)) == ()
    run.resume("ben", at(3))
    assert run.drive_ended(old, "arrived", "", at(4)) == ()
    assert (before.phase, run.run.phase, run.run.waypoint) == ("paused", "driving", 0)


def test_skip_leaves_out_a_task_where_it_stands_and_the_place_where_it_drives() -> None:
    run = begun((Wait(seconds=5.0), Ask()), ())
    arrive(run)
    run.skip("ben", at(1))
    assert run.run.phase == "asking"
    (onward,) = run.skip("ben", at(2))
    assert isinstance(onward, GoTo)
    assert onward.place == 2
    run.skip("ben", at(3))
    assert (run.run.phase, run.run.skipped[-1].waypoint) == ("done", 1)


def test_a_run_of_a_program_that_died_is_paused_and_says_so() -> None:
    run = begun((), ())
    found = MissionRun(run.run, at(50))
    assert found.run.phase == "paused"
    assert "while it was driving" in found.run.reason
    assert found.resume("ben", at(60))


def test_what_cannot_be_decided_is_refused_in_a_sentence() -> None:
    run = begun(())
    for refused in (run.resume, run.confirm):
        with pytest.raises(MissionRefused):
            refused("ben", at(1))
    run.cancel("ben", at(2))
    for refused in (run.pause, run.resume, run.skip, run.confirm, run.cancel):
        with pytest.raises(MissionRefused, match="is over"):
            refused("ben", at(3))


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ({"rounds": 0}, "add another place, or a wait"),
        ({"rounds": 5}, "add another place, or a wait"),
        ({"schedule": {"at": "24:00"}}, "at"),
        ({"schedule": {"at": "08:00", "days": ()}}, "days"),
        ({"attempts": 0}, "attempts"),
    ],
)
def test_a_mission_that_makes_no_sense_is_refused(fields: dict[str, object], told: str) -> None:
    with pytest.raises(ValidationError, match=told):
        plan((), **fields)


# What may happen to a run, and how long after what came before.
HAPPENINGS = st.lists(
    st.tuples(
        st.sampled_from(
            [
                "arrived",
                "failed",
                "interrupted",
                "done",
                "undone",
                "tick",
                "stop",
                "pause",
                "resume",
                "skip",
                "confirm",
                "cancel",
            ]
        ),
        st.floats(0.0, 20.0),
    ),
    max_size=40,
)
TASKS = st.sampled_from([Wait(seconds=3.0), Ask(), Halt(), LOG])
MISSIONS = st.builds(
    lambda tasks, rounds, attempts, policy: mission(
        (Ask(),), *map(tuple, tasks), rounds=rounds, attempts=attempts, on_failure=policy
    ),
    st.lists(st.lists(TASKS, max_size=3), max_size=4),
    st.integers(0, 3),
    st.integers(1, 3),
    st.sampled_from(["pause", "skip", "end"]),
)


@property_test(MISSIONS, HAPPENINGS)
def test_once_it_stands_only_a_person_sets_it_in_motion(of, happenings) -> None:  # type: ignore[no-untyped-def]
    run = MissionRun(fresh(of), at(0))
    now, under_way = 0.0, None
    effects = run.begin(at(0))
    for what, later in [("begin", 0.0), *happenings]:
        now += later
        before = run.run
        by_person = what in ("begin", "resume", "skip", "confirm")
        if what in ("arrived", "failed", "interrupted"):
            ticket = 0 if under_way is None else under_way
            effects = run.drive_ended(ticket, what, "why", at(now))
        elif what in ("done", "undone"):
            effects = run.task_ended(under_way or 0, what == "done", "why", at(now))
        elif what == "tick":
            effects = run.tick(at(now))
        elif what == "stop":
            effects = run.interrupted("STOP", at(now))
        elif what != "begin":
            try:
                effects = getattr(run, what)("ben", at(now))
            except MissionRefused:
                assert run.run is before
                effects = ()
        begun_now = [each for each in effects if isinstance(each, GoTo | Perform)]
        if before.phase == "paused" and not by_person:
            assert not begun_now
            assert run.run is before or what == "cancel"
        assert len(begun_now) <= 1
        if what in ("pause", "stop", "cancel"):
            assert not begun_now
        if begun_now:
            under_way = begun_now[0].ticket
            assert run.awaits(under_way)
        moving = run.run.phase in ("driving", "acting")
        assert moving == (under_way is not None and run.awaits(under_way))
        if before.over:
            assert run.run is before
        assert run.run.waypoint < len(of.waypoints)
        assert run.run == type(run.run).model_validate_json(run.run.model_dump_json())


@pytest.mark.parametrize(
    ("before", "now", "due"),
    [
        ("2026-11-23T07:59:58", "2026-11-23T08:00:03", True),
        ("2026-11-23T08:00:03", "2026-11-23T08:00:08", False),
        ("2026-11-23T06:00:00", "2026-11-23T08:00:30", True),
        ("2026-11-23T06:00:00", "2026-11-23T09:00:00", False),
        ("2026-11-22T07:59:58", "2026-11-22T08:00:03", False),
        ("2026-11-23T08:01:00", "2026-11-23T07:59:59", False),
    ],
    ids=["its hour", "again", "late", "the robot was off", "a Sunday", "a clock set back"],
)
def test_a_schedule_is_due_once_at_its_hour_and_not_for_an_hour_that_nobody_saw(
    before: str, now: str, due: bool
) -> None:
    schedule = Schedule(at="08:00", days=(0, 1, 2, 3, 4))
    saved, last = datetime(2026, 11, 1), datetime.fromisoformat(before)
    assert is_due(schedule, saved, last, datetime.fromisoformat(now)) is due


def test_a_mission_that_is_saved_just_after_its_hour_is_due_at_the_next() -> None:
    schedule = Schedule(at="08:00")
    before, saved, now = (datetime(2026, 11, 23, 8, 0, second) for second in (0, 1, 4))
    assert not is_due(schedule, saved, before.replace(minute=59, hour=7), now)
    assert is_due(schedule, saved, before.replace(day=24, hour=7), now.replace(day=24))


def test_the_hour_that_comes_twice_at_the_end_of_summer_is_due_once() -> None:
    zone, schedule = ZoneInfo("Europe/Berlin"), Schedule(at="02:30")
    begun = datetime(2026, 10, 25, 1, 0, tzinfo=zone).timestamp()
    looked, due = datetime(2026, 10, 25, 1, 0), 0
    for seconds in range(0, 4 * 3600, 5):
        now = datetime.fromtimestamp(begun + seconds, zone).replace(tzinfo=None)
        due += is_due(schedule, datetime(2026, 10, 1), looked, now)
        looked = looked_at(looked, now)
    assert (due, looked.hour) == (1, 3)
    assert looked_at(datetime(2027, 1, 1), now) == now  # a clock that was wrong
