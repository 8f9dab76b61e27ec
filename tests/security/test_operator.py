"""An operator who wants more than an operator may: by rules, on the running robot."""

import json
import random
from collections.abc import Iterator
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from geometry_msgs.msg import Twist
from kompass_interfaces.srv import ApplyRules
from pydantic import TypeAdapter, ValidationError
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from std_msgs.msg import Bool, String

from kompass.components import Controller, DriveManager, LocalMapper, Planner
from kompass.monitor.introspection.component_specs import component_spec
from kompass.rulebook.permissions import Permissions, opened
from kompass.rulebook.schema.graph_view import GraphView
from kompass.rules.schema.actions import Action as TableAction
from kompass.rules.schema.actions import (
    CallService,
    Lifecycle,
    Method,
    Publish,
    Reconfigure,
    UpdateParameters,
)
from kompass.rules.schema.table import Rule as TableRule
from kompass.rules.schema.table import Table
from tests.security.random_rules import random_actions
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.rules import Rule, Rules, rule, signal
from tests.support.stack import Stack

pytestmark = pytest.mark.ros
RECIPE = Path(__file__).parents[1] / "recipes" / "guarded_robot.py"
REFUSED, APPLIED = ApplyRules.Request.REFUSED, ApplyRules.Request.APPLIED
ACTION: TypeAdapter[TableAction] = TypeAdapter(TableAction)
# Fires when the test says so.
PRESSED = {"kind": "received", "signal": signal("press", "", "Bool")}


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    with closing(Stack.simulated(recipe=RECIPE)) as running:
        yield running


@pytest.fixture(scope="module")
def rules(robot: Robot) -> Rules:
    return Rules(robot)


def call(service: str, kind: str, **request: Any) -> Rule:
    return {"kind": "call_service", "service": service, "type": kind, "request": request}


def publish(topic: str, kind: str, **message: Any) -> Rule:
    return {"kind": "publish", "topic": topic, "type": kind, "message": message}


ATTACKS = {
    "become an engineer": call(
        "monitor/apply_rules",
        "kompass_interfaces/srv/ApplyRules",
        table='{"rules":[]}',
        role="engineer",
        author="chief",
        expected_revision=1,
    ),
    "send the controller to the wheels": call(
        "controller/change_topic",
        "automatika_ros_sugar/srv/ReplaceTopic",
        direction=1,
        old_name="control",
        new_name="cmd_vel",
        new_msg_type="Twist",
    ),
    "read a file": call("map_server/load_map", "nav2_msgs/srv/LoadMap", map_url="/etc/passwd"),
    "configure from a file": call(
        "controller/configure_from_file",
        "automatika_ros_sugar/srv/ConfigureFromFile",
        path_to_file="/tmp/evil.yaml",
    ),
    "reconfigure from a file": {
        "kind": "reconfigure",
        "component": "controller",
        "config": "/tmp/evil.yaml",
    },
    "blind the gate": publish("scan", "sensor_msgs/msg/LaserScan"),
    "lie about the place": publish("odometry/filtered", "nav_msgs/msg/Odometry"),
    "command the gate": publish("control", "geometry_msgs/msg/Twist"),
    "make the robot smaller": {
        "kind": "update_parameters",
        "component": "drive_manager",
        "parameters": {"robot": {"geometry_params": [0.01, 0.1]}},
    },
    "release the STOP": call("drive_manager/release_stop", "kompass_interfaces/srv/ReleaseStop"),
    "take the wheel": call(
        "drive_manager/take_wheel", "kompass_interfaces/srv/TakeWheel", operator_name="ava"
    ),
    "turn the wheel": publish("drive_manager/hand", "kompass_interfaces/msg/HandCommand"),
}


@pytest.mark.parametrize("attack", ATTACKS)
def test_a_rule_of_an_operator_that_reaches_past_its_rights_is_refused(
    rules: Rules, attack: str
) -> None:
    before = rules.view()
    added = [*rules.rules(), rule("attack", PRESSED, ATTACKS[attack])]
    answer = rules.apply(added, role="operator")
    assert answer.outcome == REFUSED, attack
    assert "actions[0]" in answer.message
    assert rules.view().table == before.table


def test_what_the_recipe_opened_an_operator_may_use(rules: Rules, robot: Robot) -> None:
    robot.subscribe(String, "/lights")
    rules.add(
        rule("blink", PRESSED, publish("/lights", "std_msgs/msg/String", data="on")),
        role="operator",
    )
    press(rules, robot, "blink")
    wait_until(lambda: "/lights" in robot.newest, 10, "the lights")
    assert rules.view().table.rules[-1].source == "edited"
    rules.remove("blink")


def test_a_second_publisher_of_velocities_halts_the_robot(rules: Rules, robot: Robot) -> None:
    handle = robot.send_goal(0.0, -1.5)
    wait_until(lambda: robot.speed > 0.1, 20, "motion")
    for topic in ("/cmd_vel", "/control"):
        intruder = robot.do(partial(robot.node.create_publisher, Twist, topic, 10))
        wait_until(lambda: limited(robot) == "second publisher", 10, f"the halt, {topic}")
        wait_until(lambda: robot.speed < 0.01, 5, "standstill")
        robot.do(partial(robot.node.destroy_publisher, intruder))
        wait_until(lambda: limited(robot) != "second publisher", 10, "the end of it")
    robot.cancel(handle)


def test_random_rules_of_an_operator_change_nothing_that_is_protected(
    rules: Rules, robot: Robot
) -> None:
    """Whatever passes fires on the real robot; then no promise may be broken."""
    graph: GraphView = rules.monitor.graph().wait().parsed()
    assert robot.stop().success
    source = random.Random(20261122)
    passed = tried = 0
    place = robot.truth[:2]
    while passed < 100:
        batch = random_actions(source, graph, 25)
        tried += len(batch)
        good = [each for each in batch if allowed(rules, each)]
        passed += len(good)
        if good:
            rules.add(
                *(rule(f"r{n}", PRESSED, each) for n, each in enumerate(good)), role="operator"
            )
            press(rules, robot, *(f"r{n}" for n in range(len(good))))
            rules.remove(*(f"r{n}" for n in range(len(good))))
        assert limited(robot) == "stop"
    assert passed < tried
    names = {info.node_name for info in robot.node.get_publishers_info_by_topic("/cmd_vel")}
    assert names == {"drive_manager", "halt"}
    assert any(each.id == "keep" and each.enabled for each in rules.view().table.rules)
    assert {each.author for each in rules.history().revisions} <= {"tester", "monitor"}
    assert robot.distance_to(*place) < 0.01
    assert robot.release().success


def test_no_random_action_that_passes_reaches_past_the_gate(rules: Rules, robot: Robot) -> None:
    """Judged by what the names mean to ROS and who is really there, not by what recipes declare."""
    graph: GraphView = rules.monitor.graph().wait().parsed()
    recipe = Table(rules=tuple(each for each in rules.view().table.rules if each.id == "keep"))
    components = {
        name: component_spec(kind(name))
        for name, kind in (
            ("planner", Planner),
            ("controller", Controller),
            ("mapper", LocalMapper),
            ("drive_manager", DriveManager),
        )
    }
    permissions = Permissions(components, recipe, opened(["/lights"]))
    reality = Reality(robot.node)
    new = TableRule.model_validate(rule("new", PRESSED))
    source = random.Random(9)
    passed = 0
    for data in random_actions(source, graph, 100_000):
        try:
            action = ACTION.validate_python(data)
        except ValidationError:
            continue
        if permissions.refusal(new.model_copy(update={"actions": (action,)}), action) is None:
            passed += 1
            assert reality.way_round(action) == "", data
    assert passed > 100


class Reality:
    """What an action would reach, by the robot's own graph."""

    def __init__(self, node: Node) -> None:
        gate = ("drive_manager", "/")
        heard = node.get_subscriber_names_and_types_by_node(*gate)
        said = node.get_publisher_names_and_types_by_node(*gate)
        self._of_gate = {name for name, _ in (*heard, *said)} - {"/parameter_events", "/rosout"}
        self._services = {
            owner: dict(node.get_service_names_and_types_by_node(owner, "/"))
            for owner in ("monitor", "drive_manager", "controller", "planner", "mapper")
        }

    def way_round(self, action: TableAction) -> str:
        """What the action would do that it may not; empty if nothing."""
        if isinstance(action, Publish):
            topic = expand_topic_name(action.topic, "monitor", "/")
            wheels = "Twist" in action.type
            return f"publishes {topic}" if topic in self._of_gate or wheels else ""
        if isinstance(action, CallService):
            return self._called(expand_topic_name(action.service, "monitor", "/"))
        if isinstance(action, Reconfigure):
            return "another file" if isinstance(action.config, str) else self._gate(action)
        if isinstance(action, Method):
            setting = action.method.startswith(("set_param", "reconfigure", "release"))
            stopping = action.component == "drive_manager" and action.method == "stop"
            return action.method if setting or stopping else ""
        if isinstance(action, Lifecycle):
            return self._gate(action) if action.action in ("stop", "configure") else ""
        return self._gate(action) if isinstance(action, UpdateParameters) else ""

    def _gate(self, action: Reconfigure | Lifecycle | UpdateParameters) -> str:
        return action.kind if action.component == "drive_manager" else ""

    def _called(self, service: str) -> str:
        for owner, services in self._services.items():
            if service in services:
                name = service.rpartition("/")[2]
                asks = name.startswith(("get_", "list_", "describe_", "check_", "explain_"))
                harmless = asks or name in ("save_recording",) or service == "/drive_manager/stop"
                return "" if harmless else f"calls {service} of {owner}"
        return f"calls {service} of nobody knows whom"


def allowed(rules: Rules, action: Rule) -> bool:
    table = {"rules": [*rules.rules(), rule("tried", PRESSED, action)]}
    return bool(rules.check(json.dumps(table), "operator").success)


def press(rules: Rules, robot: Robot, *ids: str) -> None:
    """Let rules fire, and wait until their actions have begun or ended."""
    publisher = robot.do(lambda: robot.node.create_publisher(Bool, "/press", 10))
    before = len(rules.firings)

    def fired() -> bool:
        publisher.publish(Bool(data=True))
        return {step.rule_id for step in rules.firings[before:]} >= set(ids)

    try:
        wait_until(fired, 15, f"a firing of {ids}")
    finally:
        robot.do(lambda: robot.node.destroy_publisher(publisher))


def limited(robot: Robot) -> str:
    state = robot.newest.get("/drive_state")
    return "" if state is None else str(state.limited_by)
