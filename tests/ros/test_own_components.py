"""Components of a user's own, in whole stacks: the recipes that show them, and one that breaks."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ChangeParameter
from geometry_msgs.msg import PoseArray
from kompass_interfaces.action import FollowPath
from rclpy.action import ActionClient
from rclpy.qos import ReliabilityPolicy
from std_msgs.msg import Empty, Float32, Int32
from std_srvs.srv import SetBool

from tests.ros.test_recipes import drives_to_a_click
from tests.support.journal import Journal
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot
from tests.support.stack import RECIPE, TOKEN, Stack

pytestmark = pytest.mark.ros

HEALTHY, COMPONENT = 0, 2
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6


def started(stack: Stack) -> Iterator[Robot]:
    try:
        client = Robot(stack.domain)
        try:
            yield client
        finally:
            client.close()
    finally:
        assert stack.close() == 0, stack.output


def change(robot: Robot, component: str, name: str, value: str) -> Any:
    request = ChangeParameter.Request(name=name, value=value, keep_alive=True)
    return robot.call(ChangeParameter, f"/{component}/update_config_parameter", request)


def say(robot: Robot, topic: str) -> None:
    publisher = robot.node.create_publisher(Empty, topic, 10)

    def heard() -> bool:
        # The monitor's reader is a best-effort one until it knows the publisher; then another
        # takes its place.
        found = robot.node.get_subscriptions_info_by_topic(topic)
        readers = [one.qos_profile.reliability for one in found if one.node_name == "monitor"]
        return readers == [ReliabilityPolicy.RELIABLE]

    wait_until(heard, 10, f"a reliable listener on {topic}")
    publisher.publish(Empty())


# -- recipe 07 --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def marking() -> Iterator[tuple[Stack, Robot]]:
    stack = Stack.simulated(recipe=RECIPE.with_name("07_own_components.py"))
    for client in started(stack):
        client.ready()
        client.subscribe(Float32, "/battery/level")
        client.subscribe(PoseArray, "/places")
        yield stack, client


@contextmanager
def logged_in(stack: Stack) -> Iterator[httpx.Client]:
    """The console, as the page asks it."""
    with httpx.Client(base_url=stack.url, headers={"Origin": stack.url}, timeout=30) as client:
        assert client.post("/api/login", json={"token": TOKEN}).status_code == 200
        yield client


@pytest.fixture
def page(marking: tuple[Stack, Robot]) -> Iterator[httpx.Client]:
    with logged_in(marking[0]) as client:
        yield client


def add_rule(page: httpx.Client, rule: dict[str, Any]) -> None:
    """As an operator does it on the page; it stays."""
    view = page.get("/api/rules").json()
    table = {**view["table"], "rules": [*view["table"]["rules"], rule]}
    wanted = {"table": table, "expected_revision": view["revision"], "probation": 0.0}
    answer = page.post("/api/rules/apply", json=wanted)
    assert answer.status_code == 200, answer.text


def test_the_page_knows_them_their_settings_actions_and_rules(page: httpx.Client) -> None:
    wait_until(lambda: page.get("/api/graph").status_code == 200, 20, "the monitor's answer")
    known = {each["name"]: each for each in page.get("/api/graph").json()["components"]}
    battery = known["battery"]
    assert battery["kind"] == "Battery"
    assert "changed" in [method["name"] for method in battery["methods"]]
    settings = {each["name"]: each["text"] for each in battery["parameters"]}
    assert settings["lasts_metres"] == "m driving"
    rules = page.get("/api/rules").json()["table"]["rules"]
    names = {rule["id"]: rule["name"] for rule in rules}
    assert names["battery-low"] == "Battery low → mark the place"


def test_a_click_drives_it_there(marking: tuple[Stack, Robot]) -> None:
    drives_to_a_click(marking[1])


def test_what_its_text_says_of_rules_on_the_page_works_there(
    marking: tuple[Stack, Robot], page: httpx.Client
) -> None:
    """They fire when they are applied: what they wait for is true already."""
    journal = Journal(marking[1])
    level = {"topic": "battery/level", "type": "std_msgs/msg/Float32", "path": ["data"]}
    full = {"kind": "compare", "signal": level, "operator": ">", "value": 20.0}
    actions = [
        {"kind": "update_parameters", "component": "battery", "parameters": {"lasts_metres": 5.0}},
        {"kind": "call_service", "service": "mark_place", "type": "std_srvs/srv/Trigger"},
        {"kind": "method", "component": "battery", "method": "changed"},
    ]
    event = {"condition": full, "trigger": "edge"}
    add_rule(page, {"id": "by-hand", "actions": actions, "event": event})
    ended = journal.done("by-hand", timeout=20)
    assert ended.ok, ended.text
    told = page.get("/api/firings", params={"rule_id": "by-hand"}).json()["firings"]
    assert told, "the page shows the firing"
    say(marking[1], "/battery/changed")
    assert journal.done("battery-changed").ok  # and nothing is marked


# -- recipe 08 --------------------------------------------------------------------------------


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


# -- one that breaks --------------------------------------------------------------------------


@pytest.fixture(scope="module")
def mending() -> Iterator[tuple[Stack, Robot]]:
    recipe = RECIPE.parents[1] / "tests" / "recipes" / "mending_components.py"
    stack = Stack.active(recipe)
    for client in started(stack):
        yield stack, client


def test_one_that_raises_says_so_is_mended_by_its_fallback_and_the_others_go_on(
    mending: tuple[Stack, Robot],
) -> None:
    stack, robot = mending
    heard: list[ComponentStatus] = []
    counts: list[int] = []
    robot.node.create_subscription(ComponentStatus, "/flaky/status", heard.append, LATCHED)
    robot.node.create_subscription(Int32, "/count", lambda told: counts.append(told.data), 10)
    wait_until(lambda: heard and counts, 10, "both components")
    pids = [stack.pid_of(name) for name in ("flaky", "steady")]
    assert robot.call(SetBool, "/flaky/set_bool", SetBool.Request(data=True)).success
    wait_until(lambda: heard[-1].status == COMPONENT, 5, "the failure")
    assert "OSError: the device is gone" in heard[-1].msg
    wait_until(lambda: heard[-1].status == HEALTHY, 15, "the fallback's mending")
    before = counts[-1]
    wait_until(lambda: counts[-1] > before + 3, 5, "the other one's work")
    assert pids == [stack.pid_of(name) for name in ("flaky", "steady")], "nothing died"
    assert counts == sorted(counts), "the other one has never begun anew"
