"""Components of a user's own, in the whole stack of the recipe that shows them."""

from collections.abc import Iterator

import httpx
import pytest
from geometry_msgs.msg import PoseArray
from rclpy.qos import ReliabilityPolicy
from std_msgs.msg import Empty, Float32

from tests.ros.test_recipes import drives_to_a_click
from tests.support.journal import Journal
from tests.support.own_stack import add_rule, logged_in, started
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import RECIPE, Stack

pytestmark = pytest.mark.ros


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


@pytest.fixture(scope="module")
def marking() -> Iterator[tuple[Stack, Robot]]:
    stack = Stack.simulated(recipe=RECIPE.with_name("07_own_components.py"))
    for client in started(stack):
        client.ready()
        client.subscribe(Float32, "/battery/level")
        client.subscribe(PoseArray, "/places")
        yield stack, client


@pytest.fixture
def page(marking: tuple[Stack, Robot]) -> Iterator[httpx.Client]:
    with logged_in(marking[0]) as client:
        yield client


def test_the_page_knows_them_their_settings_actions_and_rules(page: httpx.Client) -> None:
    wait_until(lambda: page.get("/api/graph").status_code == 200, 20, "the monitor's answer")
    known = {each["name"]: each for each in page.get("/api/graph").json()["components"]}
    battery = known["battery"]
    assert battery["kind"] == "Battery"
    assert "changed" in [method["name"] for method in battery["methods"]]
    settings = {each["name"]: each["text"] for each in battery["parameters"]}
    assert settings["lasts_metres"] == "m driving"
    offered = {each["name"] for each in page.get("/api/graph").json()["services"]}
    assert "drive_manager/stop" in offered
    assert not [name for name in offered if name.endswith("/signed_call")]
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
