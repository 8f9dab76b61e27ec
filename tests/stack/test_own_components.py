"""What the recipes with components of their own promise: they drive, and their rules heal."""

from collections.abc import Iterator
from contextlib import closing
from typing import Any

import pytest
from automatika_ros_sugar.srv import ChangeParameter
from geometry_msgs.msg import PoseArray
from kompass_interfaces.action import FollowPath
from rclpy.qos import ReliabilityPolicy
from std_msgs.msg import Empty, Float32
from std_srvs.srv import Trigger

from tests.support.journal import Journal
from tests.support.stack import RECIPE
from tests.support.virtual_robot import VirtualRobot

CANCELED, ABORTED = 5, 6


def say(robot: VirtualRobot, topic: str) -> None:
    publisher = robot.node.create_publisher(Empty, topic, 10)

    def heard() -> bool:
        # The monitor's reader is a best-effort one until it knows the publisher; then another
        # takes its place.
        found = robot.node.get_subscriptions_info_by_topic(topic)
        readers = [one.qos_profile.reliability for one in found if one.node_name == "monitor"]
        return readers == [ReliabilityPolicy.RELIABLE]

    robot.wait_until(heard, 10, f"a reliable listener on {topic}")
    publisher.publish(Empty())


# -- recipe 07 --------------------------------------------------------------------------------


@pytest.fixture
def battery() -> Iterator[VirtualRobot]:
    with closing(VirtualRobot(RECIPE.with_name("07_own_components.py"))) as client:
        client.ready()
        client.subscribe(Float32, "/battery/level")
        client.subscribe(PoseArray, "/places")
        yield client


def change(robot: VirtualRobot, component: str, name: str, value: str) -> Any:
    request = ChangeParameter.Request(name=name, value=value, keep_alive=True)
    return robot.call(ChangeParameter, f"/{component}/update_config_parameter", request)


def test_a_low_battery_has_the_place_marked_and_a_fresh_one_has_it_forgotten(
    battery: VirtualRobot,
) -> None:
    journal = Journal(battery)
    battery.wait_until(lambda: "/battery/level" in battery.newest, 10, "the battery's level")
    refused = change(battery, "battery", "lasts_metres", "0.0")
    assert not refused.success
    assert "lasts_metres" in refused.error_msg
    assert change(battery, "battery", "lasts_metres", "0.2").success
    battery.click(-1.5, 0.5, taker="planner")
    ended = journal.done("battery-low", timeout=40)
    assert [(step.ok, step.text) for step in journal.actions(ended) if not step.ok] == []
    battery.wait_until(lambda: "/places" in battery.newest, 10, "the marked place")
    assert len(battery.newest["/places"].poses) == 1
    since = journal.mark
    say(battery, "/battery/changed")
    assert journal.done("battery-changed", since).ok
    answer = battery.call(Trigger, "/mark_place", Trigger.Request())
    assert answer.success
    assert answer.message.startswith("place 1 is at (")


# -- recipe 08 --------------------------------------------------------------------------------


@pytest.fixture
def patrol() -> Iterator[VirtualRobot]:
    with closing(VirtualRobot(RECIPE.with_name("08_patrol.py"))) as client:
        client.ready()
        yield client


def send(robot: VirtualRobot, name: str) -> Any:
    goal = FollowPath.Goal()
    goal.request.path_name = name
    return robot.send(robot.action_client(FollowPath, "/patrol/follow_path"), goal)


def test_a_rule_starts_a_round_and_each_point_is_reached_and_noted(patrol: VirtualRobot) -> None:
    journal = Journal(patrol)
    say(patrol, "/patrol/start")
    patrol.wait_until(lambda: patrol.distance_to(-1.5, -0.5) < 0.2, 40, "the first point")
    assert not send(patrol, "west").accepted, "one round at a time"
    ended = journal.done("patrol-start", timeout=60)
    assert ended.ok, ended.text
    assert patrol.distance_to(-1.5, 0.5) < 0.2
    patrol.wait_until(lambda: len(journal.of("patrol-point", "done")) == 2, 10, "both notes")
    assert all(step.ok for step in journal.of("patrol-point", "done"))


def test_a_round_that_is_cancelled_stops_the_robot(patrol: VirtualRobot) -> None:
    handle = send(patrol, "west")
    assert handle.accepted
    patrol.wait_until(lambda: patrol.speed > 0.05, 20, "motion")
    handle.cancel_goal_async()
    assert patrol.result(handle).status == CANCELED
    patrol.wait_until(lambda: patrol.speed < 0.01, 10, "standstill")


def test_an_unknown_round_is_aborted_at_once(patrol: VirtualRobot) -> None:
    handle = send(patrol, "north")
    assert handle.accepted
    assert patrol.result(handle).status == ABORTED


def test_a_round_that_is_walled_in_tries_again_until_it_is_free_and_goes_on(
    patrol: VirtualRobot,
) -> None:
    """As with ``--fault boxed_in:20:60``, with a person who puts up the walls and takes them."""
    journal = Journal(patrol)

    def walls(*, on: bool) -> None:
        patrol.fault("boxed_in", on=on)

    handle = send(patrol, "west")
    assert handle.accepted
    patrol.wait_until(lambda: patrol.speed > 0.05, 20, "motion")
    walls(on=True)
    assert patrol.result(handle, timeout=60).status == ABORTED
    patrol.wait_until(lambda: len(journal.of("patrol-blocked", "done")) == 2, 20, "a second try")
    for tried in journal.of("patrol-blocked", "done"):
        assert not tried.ok
        assert "boxed in: no way is free" in tried.text
    walls(on=False)
    patrol.wait_until(
        lambda: any(step.ok for step in journal.of("patrol-blocked", "done")), 60, "a whole round"
    )
    assert patrol.distance_to(-1.5, 0.5) < 0.2
