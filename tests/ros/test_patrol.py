"""A patrol of a user's own, in the whole stack of the recipe that shows it."""

from collections.abc import Iterator
from typing import Any

import pytest
from kompass_interfaces.action import FollowPath
from rclpy.action import ActionClient
from std_msgs.msg import Int32

from tests.ros.test_recipes import drives_to_a_click
from tests.support.journal import Journal
from tests.support.own_stack import add_rule, logged_in, started
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import RECIPE, Stack

pytestmark = pytest.mark.ros


@pytest.fixture(scope="module")
def patrolling() -> Iterator[tuple[Stack, Robot]]:
    stack = Stack.simulated(recipe=RECIPE.with_name("08_patrol.py"))
    for client in started(stack):
        client.ready()
        client.subscribe(Int32, "/patrol/point")
        yield stack, client


@pytest.fixture
def patrol(patrolling: tuple[Stack, Robot]) -> Robot:
    return patrolling[1]


def send(robot: Robot, name: str) -> Any:
    client = ActionClient(robot.node, FollowPath, "/patrol/follow_path")
    wait_until(client.server_is_ready, 10, "the patrol's action")
    goal = FollowPath.Goal()
    goal.request.path_name = name
    sent = robot._executor.create_task(lambda: client.send_goal_async(goal))
    return robot.await_future(robot.await_future(sent, 5, "sending"), 5, "the answer to the goal")


def test_a_click_drives_the_patrol_there(patrolling: tuple[Stack, Robot]) -> None:
    drives_to_a_click(patrolling[1])


def test_a_rule_on_the_page_can_send_it_on_a_round(patrolling: tuple[Stack, Robot]) -> None:
    stack, robot = patrolling
    journal = Journal(robot)
    status = {
        "topic": "patrol/status",
        "type": "automatika_ros_sugar/msg/ComponentStatus",
        "path": ["status"],
    }
    healthy = {"kind": "compare", "signal": status, "operator": "==", "value": 0}
    go = {
        "kind": "send_goal",
        "action": "patrol/follow_path",
        "type": "kompass_interfaces/action/FollowPath",
        "goal": {"request": {"path_name": "west"}},
        "timeout": None,
    }
    with logged_in(stack) as page:
        event = {"condition": healthy, "trigger": "edge", "once": True}
        add_rule(page, {"id": "by-hand", "actions": [go], "event": event})
    ended = journal.done("by-hand", timeout=60)
    assert ended.ok, ended.text
