"""Before a goal is given up the robot tries to help itself; and when it is, people hear of what."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from kompass_interfaces.msg import GoalHindrance
from kompass_interfaces.srv import SetFault
from std_msgs.msg import String

from tests.support.journal import Journal
from tests.support.tester import LATCHED
from tests.support.virtual_robot import VirtualRobot

RECIPE = Path(__file__).parents[2] / "recipes" / "10_recovery.py"
LADDER = "launcher.recovery()\n"
SUCCEEDED, ABORTED = 4, 6
REFUSED, BLOCKED, STOPPED, STUCK = 1, 2, 3, 6
STEPS = ("forget", "back-off", "turn", "wider", "narrower", "wait")
HALL, LIVING = (2.45, 3.6), (2.45, 2.2)  # before and behind a doorway at y = 2.85

Variant = Callable[..., Path]


@pytest.fixture
def variant(tmp_path: Path) -> Variant:
    """Recipe 09 with a ladder or without, and a planner that looks or not."""

    def write(*, ladder: bool = True, sees: bool = False) -> Path:
        text = RECIPE.read_text(encoding="utf-8")
        for said, instead in (
            (LADDER, LADDER if ladder else ""),
            ("patience=20.0", f"patience=20.0, use_sensor={sees}"),
        ):
            assert text.count(said) == 1
            text = text.replace(said, instead)
        made = tmp_path / f"recovery_{ladder}_{sees}.py"
        made.write_text(text, encoding="utf-8")
        return made

    return write


def fault(robot: VirtualRobot, name: str, *, on: bool = True, duration: float = 0.0) -> None:
    request = SetFault.Request(fault=name, on=on, duration=duration)
    robot.wait_until(
        lambda: robot.call(SetFault, "/simulator/set_fault", request).success, 20, f"fault {name}"
    )


def steps_of(journal: Journal) -> list[str]:
    """The steps of the ladder that were taken, in their order."""
    fired = [step.rule.removeprefix("recovery-") for step in journal.of("recovery-", "fired")]
    return [name for name in fired if name in STEPS]


@pytest.mark.parametrize("sees", [False, True])
def test_a_doorway_that_is_closed_for_a_while_is_waited_for(variant: Variant, sees: bool) -> None:
    for ladder in (False, True):
        recipe = variant(ladder=ladder, sees=sees)
        with closing(VirtualRobot(recipe, place="apartment")) as robot:
            robot.ready()
            handle = robot.send_goal(*LIVING)
            robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
            fault(robot, "door_closed:living", duration=40.0)
            ended = robot.result(handle, timeout=150)
            assert ended.status == (SUCCEEDED if ladder else ABORTED), ended.result.message
            assert robot.contacts == 0


def test_a_way_that_stays_blocked_is_driven_around_by_a_planner_that_plans_on_the_map_alone(
    variant: Variant,
) -> None:
    with closing(VirtualRobot(variant())) as robot:
        journal = Journal(robot)
        robot.ready()
        handle = robot.send_goal(-0.5, -0.55)
        robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
        fault(robot, "way_blocked")
        ended = robot.result(handle, timeout=90)
        assert ended.status == SUCCEEDED, ended.result.message
        assert steps_of(journal)[:4] == ["forget", "back-off", "turn", "wider"]
        assert robot.contacts == 0


def test_what_is_only_remembered_is_forgotten(variant: Variant) -> None:
    """A doorway that was closed when the robot saw it, and is open when it comes back."""
    for ladder in (False, True):
        with closing(VirtualRobot(variant(ladder=ladder, sees=True), place="apartment")) as robot:
            journal = Journal(robot)
            robot.ready()
            fault(robot, "door_closed:living")
            robot.result(robot.send_goal(*HALL), timeout=60)
            ended = robot.result(robot.send_goal(0.6, 5.0 - 0.2), timeout=90)
            assert ended.status == SUCCEEDED, ended.result.message
            fault(robot, "door_closed:living", on=False)
            ended = robot.result(robot.send_goal(*LIVING), timeout=120)
            if not ladder:
                assert (ended.status, ended.result.outcome) == (ABORTED, REFUSED)
                continue
            assert ended.status == SUCCEEDED, ended.result.message
            assert steps_of(journal) == ["forget"]
            (forgotten,) = journal.actions(journal.of("recovery-forget", "done")[0])
            assert "forgot" in forgotten.text
            assert robot.contacts == 0


def test_a_robot_that_is_boxed_in_waits_until_it_is_free(variant: Variant) -> None:
    with closing(VirtualRobot(variant())) as robot:
        journal = Journal(robot)
        robot.ready()
        handle = robot.send_goal(-0.5, -0.55)
        robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
        fault(robot, "boxed_in", duration=40.0)
        ended = robot.result(handle, timeout=120)
        assert ended.status == SUCCEEDED, ended.result.message
        waited = journal.actions(journal.of("recovery-wait", "done")[0])[0]
        assert waited.ok
        assert "it got on after" in waited.text
        backed = journal.actions(journal.of("recovery-back-off", "done")[0])[0]
        assert "behind are free" in backed.text
        assert robot.contacts == 0


def test_somebody_who_stands_in_the_way_for_a_while_does_not_end_the_goal(
    variant: Variant,
) -> None:
    with closing(VirtualRobot(variant(), place="apartment", start=(1.0, 3.6, 0.0))) as robot:
        robot.ready()
        handle = robot.send_goal(6.0, 3.6)
        robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
        fault(robot, "person_ahead", duration=20.0)
        ended = robot.result(handle, timeout=150)
        assert ended.status == SUCCEEDED, ended.result.message
        assert robot.contacts == 0


def test_at_a_dead_end_every_step_is_taken_and_the_reason_names_place_and_obstacle(
    variant: Variant,
) -> None:
    with closing(VirtualRobot(variant(sees=True), place="apartment")) as robot:
        journal = Journal(robot)
        robot.subscribe(GoalHindrance, "/goal_hindrance", LATCHED)
        robot.subscribe(String, "/monitor/alarms", LATCHED)
        robot.ready()
        handle = robot.send_goal(*LIVING)
        robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
        fault(robot, "door_closed:living")
        ended = robot.result(handle, timeout=180)
        assert (ended.status, ended.result.outcome) == (ABORTED, BLOCKED), ended.result.message
        assert steps_of(journal) == list(STEPS)
        outcomes = {step.rule: step.text for step in journal.of("recovery-", "done")}
        assert all(f"recovery-{name}" in outcomes for name in STEPS)
        told = robot.newest["/goal_hindrance"]
        assert told.given_up
        assert told.kind == "seen"
        assert 2.0 < told.place.x < 2.9
        assert told.place.y == pytest.approx(2.87, abs=0.15)
        assert told.lasted > 40.0
        assert told.text in ended.result.message
        assert f"({told.place.x:.2f}, {told.place.y:.2f})" in told.text
        robot.wait_until(lambda: "/monitor/alarms" in robot.newest, 5, "alarms")
        robot.wait_until(lambda: alarms(robot) == [told.text], 5, "an alarm with the reason")
        assert robot.contacts == 0
        robot.result(robot.send_goal(*HALL), timeout=60)
        robot.wait_until(lambda: alarms(robot) == [], 5, "no alarm after the next goal")


def alarms(robot: VirtualRobot) -> list[str]:
    return [each["text"] for each in json.loads(robot.newest["/monitor/alarms"].data)]


def test_nothing_of_the_ladder_moves_a_robot_that_was_stopped(variant: Variant) -> None:
    with closing(VirtualRobot(variant())) as robot:
        journal = Journal(robot)
        robot.ready()
        handle = robot.send_goal(-0.5, -0.55)
        robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
        fault(robot, "way_blocked")
        robot.wait_until(lambda: "forget" in steps_of(journal), 30, "the first step")
        robot.wait_until(lambda: robot.newest["/drive_state"].manoeuvre == "back_off", 20, "a step")
        robot.stop()
        ended = robot.result(handle, timeout=10)
        assert ended.result.outcome == STOPPED
        robot.wait_until(lambda: robot.newest["/drive_state"].standstill, 5, "standstill")
        before, taken = robot.truth, steps_of(journal)
        robot.rest(60.0)
        assert robot.distance_to(*before[:2]) < 0.01
        assert steps_of(journal) == taken
