"""What is told of the robot, and what is not: found between states."""

from __future__ import annotations

from typing import Any

from kompass_console.schema.models import (
    BatteryInfo,
    ComponentInfo,
    DriveInfo,
    GoalInfo,
    MissionRunInfo,
    MissionsInfo,
    ProcessInfo,
    RulesInfo,
    State,
)
from kompass_console.webhooks.notice import Notice, NoticeFinder
from tests.console.test_state_feed import build

_PLAIN = build(0, 0)


def state(time: float, **parts: Any) -> State:
    return _PLAIN.model_copy(update={"time": time, **parts})


def drive(stopped_by: str = "", reason: str = "") -> DriveInfo:
    return DriveInfo(
        available=True,
        stopped=bool(stopped_by),
        standstill=True,
        stopped_by=stopped_by,
        reason=reason,
        limited_by="",
        driven_by="",
        speed_factor=1.0,
        age=0.0,
    )


def goal(phase: str, message: str = "") -> GoalInfo:
    return GoalInfo.model_validate(
        {
            "id": "7",
            "phase": phase,
            "x": 1.0,
            "y": 2.0,
            "yaw": None,
            "sent_by": "ava",
            "message": message,
            "distance_left": None,
            "eta": None,
            "error": None,
            "elapsed": 3.0,
        }
    )


def component(name: str, status: str = "healthy", **more: Any) -> ComponentInfo:
    said = {"label": name.title(), "message": "", "sources": [], "age": 0.1, "topic": f"/{name}"}
    return ComponentInfo.model_validate({"name": name, "status": status, **said, **more})


def process(name: str, phase: str) -> ProcessInfo:
    return ProcessInfo.model_validate(
        {"name": name, "state": phase, "pid": 1, "restarts": 0, "reason": "SIGKILL"}
    )


def titles(*states: State) -> list[str]:
    """Of all notices between these states."""
    finder = NoticeFinder()
    return [notice.title for each in states for notice in finder.look(each)]


def test_a_stop_is_told_with_who_and_why_and_once() -> None:
    was = state(0.0, drive=drive())
    stopped = state(1.0, drive=drive("ava", "a child"))
    assert titles(was, stopped, stopped) == ["Stopped by ava: a child"]
    assert titles(stopped, stopped) == []  # it was so when the console came
    assert titles(state(0.0), stopped) == []


def test_a_failure_is_told_when_it_lasts_and_again_only_after_it_was_over() -> None:
    well = [component("planner"), component("mapper")]
    ill = [component("planner", "system_failure", message="no map"), component("mapper")]
    flicker = (state(0.0, components=well), state(1.0, components=ill))
    assert titles(*flicker, state(1.5, components=well), state(9.0, components=well)) == []
    again = [state(1.0 + k, components=ill) for k in range(5)]
    assert titles(*flicker, *again) == ["Planner: no map"]
    over = state(7.0, components=well)
    later = [state(8.0 + k, components=ill) for k in range(3)]
    assert titles(*flicker, *again, over, *later) == ["Planner: no map"] * 2


def test_what_fails_together_is_one_notice_that_begins_with_who_died() -> None:
    dead = process("mapper", "dead")
    ill = [
        component("controller", "system_failure", src_components=["mapper"]),
        component("mapper", "component_failure", process=dead),
    ]
    finder = NoticeFinder()
    assert finder.look(state(0.0)) == []
    assert finder.look(state(1.0, components=ill)) == []
    told = finder.look(state(2.1, components=ill))
    assert told == [Notice("fault", "Mapper died (SIGKILL)", "Also: Controller fails.")]


def test_a_goal_that_is_given_up_is_told_but_for_one_of_a_mission() -> None:
    drives, gave_up = goal("driving"), goal("failed", "The way is blocked.")
    was = state(0.0, goal=drives)
    assert titles(was, state(1.0, goal=gave_up), state(2.0, goal=gave_up)) == [
        "Goal given up: The way is blocked."
    ]
    assert titles(was, state(1.0, goal=goal("arrived"))) == []
    patrol = MissionsInfo(run=run("driving", 1))
    assert (
        titles(state(0.0, goal=drives, missions=patrol), state(1.0, goal=gave_up, missions=patrol))
        == []
    )


def run(phase: str, step: int) -> MissionRunInfo:
    return MissionRunInfo.model_validate(
        {
            "number": 1,
            "mission": 1,
            "name": "Patrol",
            "by": "ava",
            "phase": phase,
            "step": step,
            "elapsed": 0.0,
            "round": 1,
            "rounds": 1,
            "waypoint": 1,
            "waypoints": 2,
            "attempt": 1,
            "place": "Dock",
            "task": "",
            "ask": "Is the door open?",
            "left": None,
            "reason": "blocked",
            "decided_by": "",
            "skipped": [],
        }
    )


def test_a_mission_is_told_of_when_it_waits_for_somebody_and_when_it_is_over() -> None:
    phases = ["driving", "asking", "asking", "driving", "paused", "done"]
    steps = [1, 2, 2, 3, 4, 5]
    states = [
        state(float(k), missions=MissionsInfo(run=run(phase, step)))
        for k, (phase, step) in enumerate(zip(phases, steps, strict=True))
    ]
    assert titles(*states) == ["Patrol: waits for a person", "Patrol: paused", "Patrol: done"]
    queued = state(0.0), state(1.0, missions=MissionsInfo(notice="It has no places."))
    assert titles(*queued) == ["A mission did not begin"]


def test_rules_tell_of_alarms_and_of_how_a_probation_ended() -> None:
    def rules(**more: Any) -> RulesInfo:
        return RulesInfo(**{"available": True, "revision": 3, **more})

    def two(was: RulesInfo, is_: RulesInfo) -> list[str]:
        return titles(state(0.0, rules=was), state(1.0, rules=is_))

    tried = rules(probation_left=20.0)
    assert two(tried, rules()) == ["Probation of revision 3 has ended"]
    assert two(tried, rules(revision=2)) == ["Rules went back: revision 2 is in force"]
    assert two(rules(), rules(alarms=1)) == ["A rule has raised an alarm"]
    assert two(rules(alarms=1), rules()) == []
    assert two(tried, RulesInfo()) == []  # its monitor is gone: nothing has ended


def test_a_low_battery_is_told_once_and_not_while_it_charges() -> None:
    def battery(charge: float, *, charging: bool = False) -> BatteryInfo:
        return BatteryInfo(
            charge=charge, charging=charging, low=charge < 0.2, voltage=None, topic="/b", age=0.0
        )

    full, low = state(0.0, battery=battery(0.9)), state(1.0, battery=battery(0.195))
    assert titles(full, low, low) == ["Battery low: 19 %"]
    assert titles(full, state(1.0, battery=battery(0.19, charging=True))) == []
