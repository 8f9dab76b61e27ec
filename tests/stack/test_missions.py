"""Missions on a whole robot in virtual time: driven, steered, interrupted, never by surprise."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from contextlib import closing
from datetime import datetime
from typing import Any

import pytest
from kompass_interfaces.srv import ChangeMissions, ChangePlaces, ChangeTimeline
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import Empty, String

from kompass.components.base.convert import grid_of
from kompass.missions.change import (
    EditMission,
    MissionChange,
    SaveMission,
    StartMission,
    StartNext,
    SteerRun,
    Unqueue,
)
from kompass.missions.mission import (
    Act,
    Ask,
    Halt,
    Mission,
    MissionBook,
    MissionPlan,
    Schedule,
    Task,
    Wait,
    Waypoint,
)
from kompass.missions.queue import MissionState
from kompass.missions.run import Run
from kompass.places.change import DeletePlace, EditPlace, PlaceChange, SavePlace
from kompass.places.map_identity import identify
from kompass.places.place import MapIdentity, Place, PlacePose
from kompass.rules.schema.actions import CallService, Log, Method, RaiseAlarm
from kompass.rules.schema.actions import StartMission as StartMissionAction
from kompass.rules.schema.conditions import Received
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table
from kompass.timeline.change import Acknowledge
from tests.support.client import LATCHED
from tests.support.hand import Hand
from tests.support.virtual_robot import VirtualRobot

NORTH, WEST = (0.5, 0.5), (-1.5, 0.5)


class MissionRobot(VirtualRobot):
    """A robot with two places, and what is done with its missions."""

    def __init__(self, table: Table | None = None) -> None:
        super().__init__(remembers=True, table=table)
        self._go = self.node.create_publisher(Empty, "/test/go", 10)
        self.subscribe(String, "/monitor/missions", LATCHED)
        self.subscribe(String, "/monitor/mission_state", LATCHED)
        self.subscribe(String, "/monitor/alarms", LATCHED)
        self.subscribe(OccupancyGrid, "/map", LATCHED)
        self.ready()
        self.wait_until(lambda: "/map" in self.newest, 10, "the map")
        self.map = identify(grid_of(self.newest["/map"]))
        self.north = self.place("North", *NORTH)
        self.west = self.place("West", *WEST)

    def go(self) -> None:
        """Say what the rule waits for."""
        self.wait_for_listeners("/test/go", "monitor")
        self._go.publish(Empty())

    def place(self, name: str, x: float, y: float) -> Place:
        return self.change_place(SavePlace(name=name, pose=PlacePose(x=x, y=y), map=self.map))

    def change_place(self, change: PlaceChange) -> Place:
        request = ChangePlaces.Request(
            change=change.model_dump_json(), author="ava", role="operator"
        )
        answer = self.call(ChangePlaces, "/monitor/change_places", request)
        assert answer.success, answer.message
        return Place.model_validate_json(answer.answer)

    def asks(self, change: MissionChange, role: str = "operator", author: str = "ava") -> Any:
        """The answer to a change."""
        request = ChangeMissions.Request(change=change.model_dump_json(), author=author, role=role)
        return self.call(ChangeMissions, "/monitor/change_missions", request)

    def begins(self, change: MissionChange) -> None:
        """Ask for a change, whether it is answered or not."""
        request = ChangeMissions.Request(
            change=change.model_dump_json(), author="ava", role="operator"
        )
        self._calls.begin(ChangeMissions, "/monitor/change_missions", request, 60.0)

    def change(self, change: MissionChange, role: str = "operator", author: str = "ava") -> Any:
        """Have it done; the mission that it was about."""
        answer = self.asks(change, role, author)
        assert answer.success, answer.message
        return Mission.model_validate_json(answer.answer) if answer.answer else None

    def plan(self, *stops: tuple[Place, tuple[Task, ...]], **fields: object) -> MissionPlan:
        waypoints = tuple(Waypoint(place=place.id, tasks=tasks) for place, tasks in stops)
        given = {"name": "Round", "map": self.map, "waypoints": waypoints, **fields}
        return MissionPlan.model_validate(given)

    def saved(self, *stops: tuple[Place, tuple[Task, ...]], **fields: object) -> Mission:
        mission = self.change(SaveMission(plan=self.plan(*stops, **fields)))
        assert isinstance(mission, Mission)
        return mission

    def start(self, mission: Mission) -> None:
        self.change(StartMission(id=mission.id, version=mission.version))

    def steer(self, verb: str, author: str = "ben") -> None:
        steer = {"verb": verb, "run": self.run.number, "step": self.run.step}
        change = SteerRun.model_validate(steer)
        self.change(change, author=author)

    @property
    def state(self) -> MissionState:
        return MissionState.model_validate_json(self.newest["/monitor/mission_state"].data)

    @property
    def book(self) -> MissionBook:
        return MissionBook.model_validate_json(self.newest["/monitor/missions"].data)

    @property
    def run(self) -> Run:
        run = self.state.run
        assert run is not None
        return run

    def until(self, phase: str, timeout: float = 60.0) -> Run:
        self.wait_until(
            lambda: self.state.run is not None and self.run.phase == phase,
            timeout,
            f"a mission that is {phase}",
        )
        return self.run

    def moves(self) -> None:
        self.wait_until(lambda: self.speed > 0.1, 20, "motion")

    def stands(self, seconds: float = 3.0) -> None:
        """It comes to rest, and stays."""
        self.wait_until(lambda: self.speed < 0.01, 3, "a standstill")
        x, y, _ = self.truth
        assert max(math.hypot(at[0] - x, at[1] - y) for at in self.watch(seconds)) < 0.01


@pytest.fixture
def robot() -> Iterator[MissionRobot]:
    with closing(MissionRobot()) as client:
        yield client


def test_it_goes_round_its_places_waits_and_does_what_is_to_be_done_there(
    robot: MissionRobot,
) -> None:
    alarm = Act(action=RaiseAlarm(alarm="at-north", text="Look at the north wall"))
    mission = robot.saved((robot.north, (Wait(seconds=4.0), alarm)), (robot.west, ()), rounds=2)
    robot.start(mission)
    waiting = robot.until("waiting")
    assert robot.distance_to(*NORTH) < 0.15
    assert (waiting.round, waiting.waypoint, waiting.by) == (1, 0, "ava")
    began = robot.clock.monotonic()
    robot.until("driving")
    assert robot.clock.monotonic() - began == pytest.approx(4.0, abs=0.5)
    assert "Look at the north wall" in robot.newest["/monitor/alarms"].data
    robot.wait_until(lambda: robot.run.round == 2, 60, "the second round")
    assert robot.distance_to(*WEST) < 0.3
    done = robot.until("done", 120)
    assert (done.round, done.skipped) == (2, ())
    assert robot.distance_to(*WEST) < 0.15
    assert robot.contacts == 0


def test_its_alarm_ends_when_somebody_has_seen_it(robot: MissionRobot) -> None:
    """Nobody else would end it: there is no rule that clears it."""
    alarm = Act(action=RaiseAlarm(alarm="at-north", text="The shelf is empty"))
    robot.start(robot.saved((robot.north, (alarm,))))
    robot.until("done")
    [raised] = json.loads(robot.newest["/monitor/alarms"].data)
    seen = Acknowledge(alarm="at-north", since=raised["since"])
    request = ChangeTimeline.Request(change=seen.model_dump_json(), author="ava", role="operator")
    answer = robot.call(ChangeTimeline, "/monitor/change_timeline", request)
    assert answer.success, answer.message
    robot.wait_until(
        lambda: json.loads(robot.newest["/monitor/alarms"].data) == [], 5, "the alarm's end"
    )


def test_people_pause_resume_skip_confirm_and_cancel_it(robot: MissionRobot) -> None:
    mission = robot.saved((robot.north, (Ask(text="Load it"),)), (robot.west, ()))
    robot.start(mission)
    robot.moves()
    robot.steer("pause")
    assert robot.until("paused", 5).decided_by == "ben"
    robot.stands()
    robot.steer("resume")
    robot.until("asking")
    robot.stands(5.0)
    robot.steer("confirm")
    robot.until("driving", 5)
    robot.moves()
    robot.steer("skip")
    skipped = robot.until("done", 5)
    assert skipped.skipped[0].reason == "ben skipped it"
    robot.stands()

    refused = robot.asks(SteerRun(verb="pause", run=1, step=0))
    assert not refused.success
    assert refused.message == "the mission is over (done); start it again"
    robot.start(robot.saved((robot.west, ()), name="Second"))
    robot.moves()
    robot.steer("cancel")
    assert robot.until("canceled", 5).decided_by == "ben"
    robot.stands()


def test_after_stop_only_a_person_sets_it_in_motion_again(robot: MissionRobot) -> None:
    robot.start(robot.saved((robot.north, ()), (robot.west, ())))
    robot.moves()
    assert robot.stop().success
    paused = robot.until("paused", 3)
    assert "tester pressed STOP" in paused.reason
    robot.stands()
    robot.steer("resume")
    robot.wait_until(lambda: robot.run.phase == "paused", 5, "a robot that says why it stands")
    assert "tester pressed STOP" in robot.until("paused", 5).reason
    assert robot.release().success
    robot.stands(4.0)
    assert robot.run.phase == "paused"
    robot.steer("resume")
    robot.until("done", 90)


@pytest.mark.parametrize("verb", ["start", "resume", "skip", "next"])
def test_what_was_asked_of_a_held_monitor_before_a_stop_does_not_begin_after_it(
    robot: MissionRobot, verb: str
) -> None:
    mission = robot.saved((robot.north, ()), (robot.west, ()))
    if verb != "start":
        robot.start(mission)
        robot.moves()
        robot.steer("pause")
        robot.until("paused", 5)
        robot.stands(1.0)
    if verb == "next":
        robot.start(mission)
        robot.steer("cancel")
    robot.wait_until(lambda: "/drive_state" in robot.newest, 10, "the drive manager")
    count = robot.newest["/drive_state"].interruptions
    changes: dict[str, MissionChange] = {
        "start": StartMission(id=mission.id, version=mission.version, interruptions=count),
        "next": StartNext(interruptions=count),
    }
    change = changes.get(verb)
    if change is None:
        fields = {"verb": verb, "run": 1, "step": robot.run.step, "interruptions": count}
        change = SteerRun.model_validate(fields)
    robot.stack.stop("monitor")
    robot.begins(change)
    robot.rest(0.3)
    assert robot.stop().success
    robot.rest(0.3)
    assert robot.release().success
    robot.rest(0.3)
    robot.stack.go_on("monitor")
    robot.wait_until(
        lambda: robot.state.run is not None and "after this was asked for" in robot.run.reason,
        10,
        "a robot that says why",
    )
    robot.stands(3.0)
    assert robot.run.phase == "paused"
    robot.steer("resume")
    robot.moves()


def test_what_is_asked_with_the_newest_count_begins(robot: MissionRobot) -> None:
    assert robot.stop().success
    assert robot.release().success
    robot.rest(0.5)
    count = robot.newest["/drive_state"].interruptions
    mission = robot.saved((robot.north, ()))
    change = StartMission(id=mission.id, version=mission.version, interruptions=count)
    robot.change(change)
    robot.until("done", 90)


def test_stop_while_it_waits_pauses_it_too(robot: MissionRobot) -> None:
    robot.start(robot.saved((robot.north, (Wait(seconds=5.0),)), (robot.west, ())))
    robot.until("waiting")
    assert robot.stop().success
    robot.until("paused", 3)
    assert robot.release().success
    robot.stands(8.0)
    robot.steer("resume")
    robot.until("done", 90)


def test_the_stop_of_a_mission_is_the_robots_own(robot: MissionRobot) -> None:
    robot.start(robot.saved((robot.north, (Halt(), Ask())), (robot.west, ())))
    robot.until("paused")
    assert robot.newest["/drive_state"].stopped_by == "mission Round"
    assert robot.release().success
    robot.stands()
    robot.steer("resume")
    robot.until("asking", 10)


def test_who_sends_another_goal_or_takes_the_wheel_has_the_robot(robot: MissionRobot) -> None:
    robot.start(robot.saved((robot.north, ()), (robot.west, ())))
    robot.moves()
    other = robot.send_goal(-1.0, -0.5)
    assert "newer goal" in robot.until("paused", 5).reason
    assert robot.result(other).result.reached_end
    robot.stands(2.0)
    robot.steer("resume")
    robot.moves()
    ava = Hand(robot, "ava")
    ava.take()
    assert "ava" in robot.until("paused", 5).reason
    robot.stands(2.0)


def test_who_sends_a_goal_while_it_waits_has_the_robot(robot: MissionRobot) -> None:
    robot.start(robot.saved((robot.north, (Wait(seconds=4.0),)), (robot.west, ())))
    robot.until("waiting")
    other = robot.send_goal(-1.0, -0.5)
    assert "sent the robot elsewhere" in robot.until("paused", 5).reason
    assert robot.result(other).result.reached_end
    robot.stands(6.0)
    robot.steer("resume")
    robot.until("done", 90)


def test_what_lets_it_go_on_is_for_the_step_that_was_looked_at(robot: MissionRobot) -> None:
    robot.start(robot.saved((robot.north, (Ask(text="one"), Ask(text="two"))), (robot.west, ())))
    first = robot.until("asking")
    press = SteerRun(verb="confirm", run=first.number, step=first.step)
    robot.change(press)
    again = robot.asks(press)
    assert "has gone on meanwhile; look" in again.message
    assert (robot.run.phase, robot.run.tasks_done) == ("asking", 1)
    robot.change(SteerRun(verb="pause", run=first.number, step=first.step))
    assert robot.until("paused", 5).decided_by == "ava"


def test_a_monitor_that_dies_leaves_the_mission_paused_and_the_goal_under_way(
    robot: MissionRobot,
) -> None:
    robot.start(robot.saved((robot.north, ()), (robot.west, ())))
    robot.moves()
    before = robot.run
    robot.newest.pop("/monitor/mission_state")
    robot.stack.kill("monitor")
    robot.wait_until(lambda: "/monitor/mission_state" in robot.newest, 20, "another monitor")
    found = robot.until("paused", 5)
    assert (found.number, found.waypoint) == (before.number, before.waypoint)
    assert "ended while it was driving" in found.reason
    robot.wait_until(lambda: robot.distance_to(*NORTH) < 0.15, 60, "the goal that was under way")
    robot.stands()
    assert robot.book.missions[0].name == "Round"
    robot.steer("resume")
    robot.until("done", 90)


def test_a_planner_that_dies_leaves_the_mission_paused(robot: MissionRobot) -> None:
    robot.start(robot.saved((robot.north, ()), (robot.west, ())))
    robot.moves()
    robot.stack.kill("planner")
    assert "planner, which had the goal, was lost" in robot.until("paused", 5).reason
    robot.rest(15.0)  # it is started again, and asks for nothing
    assert robot.run.phase == "paused"
    robot.steer("resume")
    robot.until("done", 90)


def test_missions_wait_for_their_turn_and_after_a_cancelled_one_for_a_person(
    robot: MissionRobot,
) -> None:
    first = robot.saved((robot.north, ()))
    second = robot.saved((robot.west, ()), name="Second")
    for mission in (first, second, first):
        robot.start(mission)
    assert [each.mission for each in robot.state.queue] == [second.id, first.id]
    robot.wait_until(lambda: robot.run.mission.id == second.id, 60, "the second mission")
    robot.change(Unqueue(number=robot.state.queue[0].number))
    robot.start(first)
    robot.moves()
    robot.steer("cancel")
    robot.stands(3.0)
    assert [each.mission for each in robot.state.queue] == [first.id]
    robot.change(StartNext(), author="ben")
    done = robot.until("done")
    assert (done.mission.id, done.by, robot.state.queue) == (first.id, "ben", ())


def test_a_place_that_was_moved_is_where_it_goes_and_one_that_was_deleted_is_told_of(
    robot: MissionRobot,
) -> None:
    mission = robot.saved((robot.north, ()), (robot.west, ()))
    moved = EditPlace(id=robot.north.id, version=1, pose=PlacePose(x=0.0, y=-0.5))
    robot.change_place(moved)
    robot.start(mission)
    robot.wait_until(lambda: robot.run.waypoint == 1, 60, "the first place")
    assert robot.distance_to(0.0, -0.5) < 0.3
    robot.steer("pause")
    robot.change_place(DeletePlace(id=robot.west.id, version=1))
    robot.steer("resume")
    assert "has been deleted" in robot.until("paused", 5).reason


def test_the_place_that_it_drives_to_is_deleted_and_it_stands_and_says_so(
    robot: MissionRobot,
) -> None:
    robot.start(robot.saved((robot.north, ()), (robot.west, ())))
    robot.wait_until(lambda: robot.speed > 0.1, 30, "motion")
    robot.change_place(DeletePlace(id=robot.north.id, version=1))
    assert "has been deleted" in robot.until("paused", 5).reason
    robot.wait_until(lambda: robot.speed < 0.01, 3, "a halt")
    stood = robot.truth
    robot.rest(5.0)
    assert math.dist(robot.truth[:2], stood[:2]) < 0.01


def test_it_drives_on_its_own_map_only(robot: MissionRobot) -> None:
    mission = robot.saved((robot.north, ()))
    elsewhere = MapIdentity(id="0" * 32, label="9 × 9 m")
    moved = EditPlace(id=robot.north.id, version=1, map=elsewhere)
    robot.change_place(moved)
    robot.start(mission)
    assert "is a place of another map by now" in robot.until("paused", 5).reason
    edit = EditMission(id=mission.id, version=1, plan=robot.plan((robot.north, ())))
    assert "is on another map" in robot.asks(edit).message
    plan = robot.plan((robot.north, ()), map=elsewhere)
    robot.steer("cancel")
    edited = robot.change(EditMission(id=mission.id, version=1, plan=plan))
    robot.start(edited)
    assert "another map now than the one of the mission" in robot.until("paused", 5).reason
    robot.stands()


def test_it_begins_at_its_hour_by_itself(robot: MissionRobot) -> None:
    soon = datetime.fromtimestamp(robot.clock.wall() + 65).astimezone()
    schedule = Schedule(at=soon.strftime("%H:%M"), days=(soon.weekday(),))
    robot.saved((robot.north, ()), schedule=schedule)
    assert robot.state.run is None
    done = robot.until("done", 150)
    assert (done.by, datetime.fromtimestamp(done.started).minute) == ("the clock", soon.minute)
    robot.rest(70)
    assert robot.state.runs == 1


def test_an_hour_that_passed_while_the_monitor_was_started_is_told(robot: MissionRobot) -> None:
    due = (robot.clock.wall() // 60 + 2) * 60
    schedule = Schedule(at=datetime.fromtimestamp(due).strftime("%H:%M"))
    robot.saved((robot.north, ()), schedule=schedule)
    robot.rest(due - 0.05 - robot.clock.wall())
    robot.newest.pop("/monitor/mission_state")
    robot.stack.kill("monitor")
    robot.wait_until(lambda: "/monitor/mission_state" in robot.newest, 20, "another monitor")
    assert "'Round' was due while the robot's program was being started" in robot.state.notice
    robot.rest(5.0)
    assert robot.state.run is None


def test_its_hour_takes_the_robot_from_nobody(robot: MissionRobot) -> None:
    due = (robot.clock.wall() // 60 + 2) * 60
    schedule = Schedule(at=datetime.fromtimestamp(due).strftime("%H:%M"))
    robot.saved((robot.north, ()), schedule=schedule)
    robot.rest(due - 3.0 - robot.clock.wall())
    other = robot.send_goal(-1.5, 0.5)
    paused = robot.until("paused", 20)
    assert "a goal that somebody gave it" in paused.reason
    assert robot.result(other).result.reached_end
    robot.stands()
    robot.steer("resume")
    robot.until("done", 90)


def test_a_rule_begins_a_mission_by_its_name_and_not_against_stop() -> None:
    signal = Signal(topic="test/go", type="std_msgs/msg/Empty")
    rule = Rule(
        id="go",
        name="Go",
        event=Event(condition=Received(signal=signal)),
        actions=(StartMissionAction(mission="ROUND"),),
    )
    with closing(MissionRobot(Table(rules=(rule,)))) as robot:
        robot.go()
        robot.wait_for_line("there is no mission called 'ROUND'", 5)
        robot.saved((robot.north, ()))
        robot.go()
        robot.moves()
        robot.go()
        robot.wait_for_line("runs or waits already", 5)
        assert robot.until("done").by == "rule Go"
        assert robot.state.runs == 1
        assert robot.stop().success
        robot.go()
        robot.wait_until(lambda: robot.run.number == 2, 5, "the second run")
        assert "pressed STOP" in robot.until("paused", 5).reason
        assert robot.release().success
        robot.stands(5.0)


FOREIGN = CallService(
    service="/drive_manager/release_stop", type="kompass_interfaces/srv/ReleaseStop"
)


@pytest.mark.parametrize(
    ("action", "told"),
    [
        (FOREIGN, "it would let the robot move again after STOP"),
        (Method(component="nobody", method="stop"), "nobody"),
        (
            Method(
                component="planner",
                method="trigger_main_action_server",
                kwargs={"goal_x": "$msg.x", "goal_y": 0.0},
            ),
            "at a place there is none",
        ),
    ],
    ids=["forbidden", "unknown", "of a message"],
)
def test_an_action_that_it_could_not_do_or_may_not_is_refused_when_it_is_saved(
    robot: MissionRobot, action: Any, told: str
) -> None:
    plan = robot.plan((robot.north, (Act(action=Log(text="hi")), Act(action=action))))
    answer = robot.asks(SaveMission(plan=plan))
    assert not answer.success
    assert answer.message.startswith("place 1, task 2: ")
    assert told in answer.message
    assert robot.book.missions == ()


def test_viewers_change_nothing(robot: MissionRobot) -> None:
    answer = robot.asks(SaveMission(plan=robot.plan((robot.north, ()))), role="viewer")
    assert not answer.success
    assert "may look at missions and change none" in answer.message
