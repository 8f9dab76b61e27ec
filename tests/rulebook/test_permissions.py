"""What the rules of people may touch, by whose hand is in them."""

from typing import Any

import pytest

from kompass.rulebook.permissions import Opened, Permissions, opened
from kompass.rules.checks.catalog import ComponentSpec, MethodSpec
from kompass.rules.schema.actions import (
    Action,
    CallService,
    CancelGoal,
    Lifecycle,
    Log,
    Method,
    Publish,
    Reconfigure,
    SendGoal,
    UpdateParameters,
)
from kompass.rules.schema.table import Source, Table
from tests.rules.building import compare, received, rule

TEXT = "std_msgs/msg/String"
STACK = {
    "drive_manager": ComponentSpec(
        "drive_manager",
        gate=True,
        hears=frozenset({"control", "scan", "odom"}),
        speaks=frozenset({"cmd_vel", "emergency_stop"}),
        methods={"move_to_unblock": MethodSpec("move_to_unblock")},
    ),
    "controller": ComponentSpec(
        "controller", hears=frozenset({"plan", "scan"}), speaks=frozenset({"control", "path"})
    ),
    "planner": ComponentSpec(
        "planner",
        hears=frozenset({"goal_point", "map"}),
        speaks=frozenset({"plan"}),
        serves=frozenset({"planner/plan_path"}),
    ),
    "lamp": ComponentSpec(
        "lamp",
        hears=frozenset({"lamp_color"}),
        methods={"blink": MethodSpec("blink"), "flash": MethodSpec("flash", recipe_only=True)},
    ),
}
RECIPE = Table(
    rules=(
        rule(
            compare("a", "<", 1),
            "declared",
            actions=(
                CallService(service="/dock/open", type="std_srvs/srv/Trigger"),
                Publish(topic="cmd_vel", type="geometry_msgs/msg/Twist"),
            ),
            source="recipe",
        ),
    )
)
PERMISSIONS = Permissions(
    STACK, RECIPE, Opened(topics=frozenset({"lights"}), actions=frozenset({"dock/go"}))
)


def code(action: Action, source: Source = "edited", rule_id: str = "new") -> str:
    by = rule(compare("a", "<", 1), rule_id, actions=(action,), source=source)
    refusal = PERMISSIONS.refusal(by, action)
    if refusal is None:
        return ""
    assert refusal.text
    assert refusal.remedy
    return refusal.code


def call(service: str, kind: str = "p/srv/X") -> CallService:
    return CallService(service=service, type=kind)


def publish(topic: str, kind: str = TEXT) -> Publish:
    return Publish(topic=topic, type=kind)


@pytest.mark.parametrize("source", ["edited", "engineer"])
@pytest.mark.parametrize(
    ("action", "why"),
    [
        # An operator that would be an engineer: rules that change rules.
        (call("monitor/apply_rules", "kompass_interfaces/srv/ApplyRules"), "changes-rules"),
        (call("/monitor/rollback_rules"), "changes-rules"),
        (call("monitor/anything_new"), "changes-rules"),
        (call("other/name", "kompass_interfaces/srv/ConfirmRules"), "changes-rules"),
        (call("~/apply_rules"), "odd-name"),
        (call("{node}/apply_rules"), "odd-name"),
        (SendGoal(action="monitor/backtest_rules", type="p/action/X"), "changes-rules"),
        # Past the gate: other topics, other files, other senses.
        (call("controller/change_topic", "automatika_ros_sugar/srv/ReplaceTopic"), "recipe-only"),
        (call("controller/signed_call", "kompass_interfaces/srv/SignedCall"), "recipe-only"),
        (
            call("controller/configure_from_file", "automatika_ros_sugar/srv/ConfigureFromFile"),
            "recipe-only",
        ),
        (call("controller/set_parameters", "rcl_interfaces/srv/SetParameters"), "recipe-only"),
        (call("drive_manager/change_topic"), "opens-gate"),
        (publish("scan", "sensor_msgs/msg/LaserScan"), "bypasses-gate"),
        (publish("/odom", "nav_msgs/msg/Odometry"), "bypasses-gate"),
        (publish("control", "geometry_msgs/msg/Pose"), "bypasses-gate"),
        (publish("drive_state"), "bypasses-gate"),
        (publish("tf", "tf2_msgs/msg/TFMessage"), "speaks-for-others"),
        (publish("planner/status"), "speaks-for-others"),
        (publish("planner_status"), "speaks-for-others"),
        (publish("monitor/rules_state"), "speaks-for-others"),
        (publish("x", "geometry_msgs/msg/TwistStamped"), "bypasses-gate"),
        (publish("planner/plan_path/_action/feedback"), "odd-name"),
        (call("planner/plan_path/_action/send_goal"), "odd-name"),
        (Reconfigure(component="controller", config="/etc/passwd"), "recipe-only"),
        (Method(component="controller", method="reconfigure"), "recipe-only"),
        (Method(component="controller", method="set_param"), "recipe-only"),
        (Method(component="lamp", method="flash"), "recipe-only"),
        (
            Method(component="drive_manager", method="restart", kwargs={"wait_time": 20}),
            "opens-gate",
        ),
        (UpdateParameters(component="drive_manager", parameters={"robot": {}}), "opens-gate"),
    ],
)
def test_nobody_gets_past_the_gate_or_into_the_rules(
    source: Source, action: Action, why: str
) -> None:
    assert code(action, source) == why


@pytest.mark.parametrize(
    ("action", "why"),
    [
        (call("map_server/load_map", "nav2_msgs/srv/LoadMap"), "not-opened"),
        (call("planner/do_something"), "not-opened"),
        (call("other/monitor/get_rules"), "not-opened"),
        (call("other/drive_manager/stop"), "not-opened"),
        (call("other/planner/check_goal"), "not-opened"),
        (publish("plan"), "speaks-for-others"),
        (publish("hello"), "not-opened"),
        (SendGoal(action="arm/wave", type="p/action/X"), "not-opened"),
        (CancelGoal(action="arm/wave"), "not-opened"),
    ],
)
def test_an_engineer_may_reach_out_of_the_stack_and_an_operator_may_not(
    action: Action, why: str
) -> None:
    assert code(action, "edited") == why
    assert code(action, "engineer") == ""


@pytest.mark.parametrize(
    "action",
    [
        Log(text="!"),
        Method(component="drive_manager", method="move_to_unblock"),
        Method(component="lamp", method="blink"),
        Lifecycle(component="controller", action="stop"),
        Lifecycle(component="drive_manager", action="restart"),
        UpdateParameters(component="controller", parameters={"scan_timeout": 1.0}),
        Reconfigure(component="controller", config={"loop_rate": 5.0}),
        call("/drive_manager/stop", "kompass_interfaces/srv/StopRobot"),
        call("planner/check_goal"),
        call("monitor/save_recording", "kompass_interfaces/srv/SaveRecording"),
        publish("/goal_point"),
        publish("lamp_color"),
        # Opened by the recipe: by name, and by using it.
        publish("/lights"),
        call("dock/open", "std_srvs/srv/Trigger"),
        SendGoal(action="/dock/go", type="p/action/X"),
        CancelGoal(action="planner/plan_path"),
    ],
)
def test_what_is_allowed_is_allowed_to_all(action: Action) -> None:
    assert code(action, "edited") == ""
    assert code(action, "engineer") == ""


def test_what_the_recipe_lets_one_rule_do_no_other_rule_may() -> None:
    past = RECIPE.rules[0].actions[1]
    assert code(past, "recipe", "declared") == ""
    assert code(past, "engineer", "copied") == "bypasses-gate"


@pytest.mark.parametrize(
    ("change", "allowed"),
    [
        ({"cooldown": 9.0}, True),
        ({"hold": 1.0}, True),
        ({"condition": compare("a", "<", 2)}, False),
        ({"condition": received("press")}, False),
        ({"clear": compare("a", ">", 9)}, False),
        ({"actions": RECIPE.rules[0].actions[:1]}, True),  # what is left is open to all
        ({"actions": RECIPE.rules[0].actions[1:]}, False),
    ],
)
def test_what_the_recipe_lets_a_rule_do_it_lets_it_do_on_that_condition_only(
    change: dict[str, Any], allowed: bool
) -> None:
    """Its timing may be edited; who changes when it acts must be allowed to do what it does."""
    actions = change.pop("actions", RECIPE.rules[0].actions)
    condition = change.pop("condition", compare("a", "<", 1))
    for source in ("edited", "engineer"):
        edited = rule(condition, "declared", actions=actions, source=source, **change)
        refused = [each for action in actions for each in PERMISSIONS.refusals(edited, action)]
        assert (refused == []) is allowed


def test_names_are_opened_however_they_are_spelled() -> None:
    assert opened(["/a", "b/c"], ("/d",)) == Opened(frozenset({"a", "b/c"}), frozenset({"d"}))
