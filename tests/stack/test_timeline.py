"""The timeline of a whole robot in virtual time: what happens to it is found there, and stays."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import closing
from typing import Any

import pytest
from kompass_interfaces.srv import ChangeTimeline, GetTimeline
from std_msgs.msg import Empty, String

from kompass.monitor.timeline.timeline import SETTLED
from kompass.rules.schema.actions import ClearAlarm, RaiseAlarm
from kompass.rules.schema.conditions import Received
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table
from kompass.timeline.change import Acknowledge, AddNote, Shelve, TimelineChange
from kompass.timeline.entry import TimelineEntry
from kompass.timeline.query import TimelinePage, TimelineQuery
from tests.support.client import LATCHED
from tests.support.hand import Hand
from tests.support.rules import Rules
from tests.support.virtual_robot import VirtualRobot


def on(topic: str) -> Event:
    signal = Signal(topic=topic, type="std_msgs/msg/Empty")
    return Event(condition=Received(signal=signal))


BELL = Table(
    rules=(
        Rule(id="ring", event=on("/ring"), actions=(RaiseAlarm(alarm="bell", text="Somebody."),)),
        Rule(id="hush", event=on("/hush"), actions=(ClearAlarm(alarm="bell"),)),
    )
)


class RememberingRobot(VirtualRobot):
    """A robot, and what is asked of its timeline."""

    def __init__(self) -> None:
        super().__init__(remembers=True, table=BELL)
        self.subscribe(String, "/monitor/alarms", LATCHED)
        self._bells = {
            topic: self.node.create_publisher(Empty, topic, 10) for topic in ("/ring", "/hush")
        }
        self.ready()

    def page(self, **query: object) -> TimelinePage:
        asked = TimelineQuery.model_validate(query).model_dump_json()
        answer = self.call(GetTimeline, "/monitor/get_timeline", GetTimeline.Request(query=asked))
        assert answer.success, answer.message
        return TimelinePage.model_validate_json(answer.answer)

    def entries(self, *kinds: str) -> list[TimelineEntry]:
        """Of these kinds, the oldest first."""
        return list(reversed(self.page(kinds=kinds).entries))

    def titles(self, *kinds: str) -> list[str]:
        return [entry.title for entry in self.entries(*kinds)]

    def asks(self, change: TimelineChange, role: str = "operator") -> Any:
        request = ChangeTimeline.Request(change=change.model_dump_json(), author="ava", role=role)
        return self.call(ChangeTimeline, "/monitor/change_timeline", request)

    def alarms(self) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = json.loads(self.newest["/monitor/alarms"].data)
        return found

    def says(self, topic: str) -> None:
        self.wait_for_listeners(topic, "monitor")
        self._bells[topic].publish(Empty())


@pytest.fixture
def robot() -> Iterator[RememberingRobot]:
    with closing(RememberingRobot()) as client:
        yield client


def test_a_goal_a_stop_and_a_hand_are_told_with_who_and_how_they_ended(
    robot: RememberingRobot,
) -> None:
    robot.result(robot.send_goal(-1.0, -0.5), timeout=60)
    (goal,) = robot.entries("goal")
    assert goal.title == "Goal -1.00, -0.50"
    assert goal.text.startswith("Arrived")
    assert goal.ended is not None
    assert goal.ended - goal.time > 3.0
    handle = robot.send_goal(0.5, 0.5)
    robot.wait_until(lambda: robot.speed > 0.1, 20, "motion")
    robot.stop()
    robot.result(handle, timeout=10)
    robot.release()
    assert "pressed STOP" in robot.entries("goal")[-1].text
    robot.wait_until(lambda: not robot.entries("stop")[-1].lasts, 5, "the end of STOP")
    (stop,) = robot.entries("stop")
    assert (stop.title, stop.who, stop.text) == ("STOP", "tester", "test")
    ben = Hand(robot, "ben")
    ben.take()
    robot.wait_until(lambda: robot.titles("hand") == ["Driven by hand"], 5, "a hand")
    assert robot.entries("hand")[0].who == "ben"


def test_a_component_that_dies_is_told_of_once_with_its_restart(
    robot: RememberingRobot,
) -> None:
    robot.stack.kill("controller")
    robot.wait_until(lambda: robot.entries("fault"), 10, "a fault")
    robot.wait_until(lambda: not robot.entries("fault")[0].lasts, 20, "its restart")
    (died,) = robot.entries("fault")
    assert (died.source, died.title, died.level) == ("controller", "Died", "error")
    assert "Started again." in died.text


def test_alarms_are_told_of_acknowledged_and_shelved(robot: RememberingRobot) -> None:
    robot.says("/ring")
    robot.wait_until(robot.alarms, 10, "the alarm")
    (alarm,) = robot.alarms()
    assert robot.asks(Acknowledge(alarm="bell", since=alarm["since"])).success
    robot.wait_until(lambda: robot.alarms()[0]["acknowledged_by"] == "ava", 5, "who has seen it")
    robot.says("/ring")
    robot.wait_until(lambda: robot.alarms()[0]["count"] == 2, 5, "it again")
    assert robot.alarms()[0]["acknowledged_by"] == "ava", "it has stood all the time"
    robot.says("/hush")
    robot.wait_until(lambda: not robot.alarms(), 5, "its end")
    late = robot.asks(Acknowledge(alarm="bell", since=alarm["since"]))
    assert "stands no more" in late.message
    assert robot.titles("alarm") == ["bell", "Acknowledged: bell"]

    assert robot.asks(Shelve(alarm="bell", seconds=60.0)).success
    robot.says("/ring")
    robot.wait_until(robot.alarms, 5, "the alarm")
    assert robot.alarms()[0]["acknowledged_by"] == ""
    assert robot.alarms()[0]["shelved_by"] == "ava"
    robot.newest.pop("/monitor/alarms")
    robot.stack.kill("monitor")
    robot.wait_until(lambda: "/monitor/alarms" in robot.newest, 30, "a new monitor")
    robot.wait_until(lambda: robot.titles("robot").count("Monitor started") == 2, 10, "its entry")
    robot.says("/ring")
    robot.wait_until(lambda: robot.alarms() and robot.alarms()[0]["shelved_until"], 10, "shelved")
    robot.wait_until(lambda: not robot.alarms()[0]["shelved_until"], 70, "the end of the shelf")


def test_an_alarm_ends_with_the_rule_that_raised_it(robot: RememberingRobot) -> None:
    robot.says("/ring")
    robot.wait_until(robot.alarms, 10, "the alarm")
    rules = Rules(robot)
    hush = next(rule for rule in rules.rules() if rule["id"] == "hush")
    ring = next(rule for rule in rules.rules() if rule["id"] == "ring")
    # Of another name, but the same rule.
    rules.must_apply([{**ring, "name": "Ring"}, hush])
    assert robot.alarms()
    rules.must_apply([hush])
    robot.wait_until(lambda: not robot.alarms(), 5, "its end")
    assert "Ended with its rule: bell" in robot.titles("alarm")


def test_what_was_written_is_there_after_the_monitor_was_killed_and_goes_on(
    robot: RememberingRobot,
) -> None:
    robot.stop()
    robot.wait_until(lambda: robot.titles("stop"), 5, "STOP")
    assert robot.asks(AddNote(title="Wheel changed")).success
    robot.newest.pop("/monitor/alarms")
    robot.stack.kill("monitor")
    robot.wait_until(lambda: "/monitor/alarms" in robot.newest, 30, "a new monitor")
    robot.rest(SETTLED + 1.0)
    assert robot.titles("person") == ["Wheel changed"]
    (stop,) = robot.entries("stop")
    assert stop.lasts, "it is the same STOP"
    robot.release()
    robot.wait_until(lambda: not robot.entries("stop")[0].lasts, 5, "its end")
    assert [entry.source for entry in robot.entries("fault")] == ["monitor"]


def test_who_only_watches_writes_nothing_and_nonsense_is_refused_by_its_name(
    robot: RememberingRobot,
) -> None:
    assert "viewer" in robot.asks(AddNote(title="x"), role="viewer").message
    assert robot.titles("person") == []
    request = GetTimeline.Request(query='{"count": 100000}')
    answer = robot.call(GetTimeline, "/monitor/get_timeline", request)
    assert not answer.success
    assert "count = 100000" in answer.message
