"""What components, drive manager, processes, planners and missions say, in people's words."""

from __future__ import annotations

from kompass.supervisor.news import ProcessNews
from kompass.timeline.drive import BLOCKED, DriveObserver, DriveSaid
from kompass.timeline.goal import GoalObserver, GoalReport
from kompass.timeline.happening import Began, Happened, Happening, Over
from kompass.timeline.health import HOLD, HealthObserver, Said
from kompass.timeline.process import ProcessObserver


def told(happenings: list[Happening]) -> list[str]:
    """The titles of what began or happened."""
    return [each.title for each in happenings if not isinstance(each, Over)]


def test_a_component_that_fails_for_a_moment_is_not_told_of_and_one_that_stays_so_is() -> None:
    health = HealthObserver()
    waits = Said(3, "Failure: System Level - no scan", ("scan",))
    assert told(health.says("mapper", waits, 0.0)) == []
    health.says("mapper", Said(0), 0.5)
    assert list(health.due(5.0)) == []
    health.says("mapper", waits, 10.0)
    health.says("mapper", waits, 10.9)
    (it,) = health.due(10.0 + HOLD)
    assert isinstance(it, Began)
    assert (it.title, it.text, it.time, it.level) == ("Waits for scan", "no scan", 10.0, "error")
    (over,) = health.says("mapper", Said(0), 20.0)
    assert isinstance(over, Over)
    assert over.key == it.key


def test_of_a_component_whose_process_is_lost_the_process_is_told_and_nothing_else() -> None:
    health, processes = HealthObserver(), ProcessObserver()
    (died,) = processes.told(ProcessNews("planner", ["planner"], "dead", reason="signal 9"), 1.0)
    assert isinstance(died, Began)
    assert (died.title, died.text, died.source) == ("Died", "signal 9", "planner")
    health.says("planner", Said(2, "Failure: Component Level - dead"), 1.1, processes.lost)
    assert list(health.due(9.0)) == []
    assert processes.told(ProcessNews("planner", ["planner"], "starting", restarts=1), 2.0) == []
    (again,) = processes.told(ProcessNews("planner", ["planner"], "active", restarts=1), 3.0)
    assert isinstance(again, Over)
    assert again.text == "Started again."
    assert not processes.lost


def test_a_process_that_hung_and_comes_round_was_not_started_again() -> None:
    processes = ProcessObserver()
    held = ProcessNews("planner", ["planner"], "stuck", reason="stopped by a signal")
    (began,) = processes.told(held, 1.0)
    assert isinstance(began, Began)
    (over,) = processes.told(ProcessNews("planner", ["planner"], "active"), 2.0)
    assert isinstance(over, Over)
    assert over.text == "Goes on without a new start."
    processes.told(held, 3.0)
    (again,) = processes.told(ProcessNews("planner", ["planner"], "active", restarts=1), 4.0)
    assert isinstance(again, Over)
    assert again.text == "Started again."


def test_a_restart_while_nobody_listened_is_told_and_a_first_start_is_not() -> None:
    processes = ProcessObserver()
    assert told(processes.told(ProcessNews("mapper", state="active"), 0.0)) == []
    assert processes.told(ProcessNews("monitor", state="starting", restarts=1), 0.0) == []
    (it,) = processes.told(ProcessNews("monitor", state="active", restarts=1), 0.0)
    assert isinstance(it, Happened)
    assert it.title == "Started again"
    assert told(processes.told(ProcessNews("monitor", state="active", restarts=1), 1.0)) == []


def test_stop_and_hands_are_told_at_once_with_who() -> None:
    drive = DriveObserver()
    stop, hand = drive.says(DriveSaid(stopped=True, stopped_by="ava", reason="a child"), 0.0)[:2]
    assert isinstance(stop, Began)
    assert (stop.title, stop.text, stop.who) == ("STOP", "a child", "ava")
    assert isinstance(hand, Over)
    assert told(drive.says(DriveSaid(driven_by="ben"), 1.0)) == ["Driven by hand"]


def test_what_holds_the_robot_back_is_told_when_it_lasts() -> None:
    drive = DriveObserver()
    blind = DriveSaid(limited_by="scan stale", speed_factor=0.0)
    drive.says(blind, 0.0)
    drive.says(DriveSaid(), 0.2)
    assert list(drive.due(9.0)) == []
    drive.says(blind, 10.0)
    (it,) = drive.due(10.6)
    assert isinstance(it, Began)
    assert (it.title, it.level) == ("Held: a scanner or camera is silent", "error")
    drive.says(DriveSaid(), 12.0)
    drive.says(DriveSaid(limited_by="obstacle", speed_factor=0.4), 13.0)
    assert list(drive.due(99.0)) == [], "slower is no standstill"
    drive.says(DriveSaid(limited_by="obstacle", speed_factor=0.0), 100.0)
    assert list(drive.due(99.0 + BLOCKED)) == []
    assert told(list(drive.due(100.0 + BLOCKED))) == ["Held: an obstacle"]


def test_a_goal_is_told_with_how_it_ended_and_is_lost_with_its_planner() -> None:
    goals = GoalObserver()
    report = GoalReport(planner="planner", id="7", x=1.0, y=-2.0, time=5.0)
    assert told(goals.told(report)) == ["Goal 1.00, -2.00"]
    stuck = report.model_copy(update={"outcome": "stuck", "message": "No way.", "time": 9.0})
    (over,) = goals.told(stuck)
    assert isinstance(over, Over)
    assert (over.text, over.level, over.time) == ("No way.", "warning", 9.0)
    assert goals.lost(["planner"], 10.0) == []
    goals.told(report.model_copy(update={"id": "8"}))
    (lost,) = goals.lost(["planner"], 11.0)
    assert isinstance(lost, Over)
    assert lost.level == "error"
