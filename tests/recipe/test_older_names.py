"""Import names and spellings of all generations of recipes lead to the same things."""

import importlib
from typing import Any

import pytest
from geometry_msgs.msg import Pose, PoseStamped
from kompass_interfaces.action import PlanPath
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool

from kompass import event
from kompass.actions import (
    Action,
    ComponentActions,
    send_component_action_server_goal,
    trigger_action_server,
    trigger_component_action_server,
    trigger_service,
    update_parameter,
)
from kompass.components import Controller, DriveManager, Planner
from kompass.control import ControllersID
from kompass.rclpy_ext.topic import Topic
from kompass.recipe.parsed import Parsed
from kompass.recipe.table import RecipeRules, recipe_rules
from kompass.ros import Event
from kompass.rules.schema.actions import Lifecycle, Method, Python, SendGoal, UpdateParameters

NUMBER = Topic(name="number", msg_type="Float64")
CLICKED = Topic(name="/clicked_point", msg_type="PointStamped")
PLANNER, CONTROLLER, DRIVER = Planner(), Controller(), DriveManager()


def made(action: Any, on: Any = None) -> RecipeRules:
    return recipe_rules({on or Event(NUMBER): action}, [PLANNER, CONTROLLER, DRIVER])


@pytest.mark.parametrize(
    ("module", "names"),
    [
        ("kompass.launcher", ["Launcher"]),
        ("kompass.event", ["OnAny", "OnEqual", "OnGreater", "OnChangeContainsAny", "Event"]),
        ("kompass.events", ["OnAny"]),
        ("kompass.ros", ["Launcher", "Topic", "QoSConfig", "AllowedTopics", "Event", "Action"]),
        ("kompass.ros", ["actions", "logger", "ServiceClientConfig", "ActionClientConfig"]),
        ("kompass.robot", ["RobotConfig", "RobotFrames", "RobotCtrlLimits", "RobotGeometry"]),
        ("kompass.config", ["RobotConfig", "ComponentRunType", "BaseComponentConfig"]),
        ("kompass.control", ["ControllersID", "StanleyConfig", "DWAConfig", "PurePursuitConfig"]),
        ("kompass.components", ["LocalMapperConfig", "MapServer", "MapServerConfig", "TopicsKeys"]),
        ("kompass_core.models", ["AngularCtrlLimits", "LinearCtrlLimits", "RobotType"]),
        ("kompass_core.control", ["ControllersID"]),
        ("ros_sugar", ["Launcher"]),
        ("ros_sugar.core", ["Event", "Action"]),
        ("ros_sugar.core.event", ["Event"]),
        ("ros_sugar.events", ["OnEqual"]),
        ("ros_sugar.actions", ["ComponentActions", "LogInfo"]),
        ("sugar", ["Launcher"]),
        ("sugar.msg", ["ComponentStatus"]),
        ("sugar.srv", ["ChangeParameter"]),
        ("ros_sugar_interfaces.msg", ["ComponentStatus"]),
        ("ros_sugar_interfaces.srv", ["ChangeParameter"]),
        ("automatika_ros_sugar.msg", ["ComponentStatus"]),
    ],
)
def test_older_import_names_resolve(module: str, names: list[str]) -> None:
    found = importlib.import_module(module)
    assert [name for name in names if not hasattr(found, name)] == []


def test_the_status_has_one_class_under_all_names() -> None:
    from automatika_ros_sugar.msg import ComponentStatus as here
    from sugar.msg import ComponentStatus as older

    assert here is older


def test_an_algorithm_may_be_an_argument() -> None:
    action = Action(CONTROLLER.set_algorithm, args=(ControllersID.PURE_PURSUIT,))
    data = made(action).table.rules[0].actions[0]
    assert isinstance(data, Method)
    assert data.kwargs == {"algorithm_value": "PurePursuit"}


def test_a_goal_from_a_click_takes_tolerances_by_position() -> None:
    point = CLICKED.msg.point
    action = Action(PLANNER.trigger_main_action_server, args=(point.x, point.y, 0.05, 0.2))
    data = made(action, event.OnAny("click", CLICKED)).table.rules[0].actions[0]
    assert isinstance(data, Method)
    assert data.kwargs == {
        "goal_x": "$topic[/clicked_point].point.x",
        "goal_y": "$topic[/clicked_point].point.y",
        "tolerance_dist": 0.05,
        "tolerance_ori": 0.2,
    }


def test_a_goal_may_be_sent_to_the_action_of_a_component() -> None:
    goal = PlanPath.Goal()
    goal.goal.position.x = 1.5
    data = made(send_component_action_server_goal(component=PLANNER, request_msg=goal))
    action = data.table.rules[0].actions[0]
    assert isinstance(action, SendGoal)
    assert action.action == "planner/plan_path"
    assert action.goal["goal"]["position"]["x"] == 1.5  # type: ignore[index, call-overload]
    with pytest.raises(TypeError, match="drive_manager has no action"):
        send_component_action_server_goal(component=DRIVER, request_msg=goal)


@pytest.mark.parametrize(
    "action",
    [
        trigger_component_action_server(component=PLANNER),
        trigger_action_server(server_name="/planner/plan_path", server_type=PlanPath),
        ComponentActions.trigger_service(srv_name="/light", srv_type=SetBool),
    ],
)
def test_a_request_may_be_made_of_the_fields_that_the_message_has(action: Action) -> None:
    rules = made(action)
    data = rules.table.rules[0].actions[0]
    assert isinstance(data, Python)
    entry = rules.functions[data.name]
    assert isinstance(entry, Parsed)
    with pytest.raises(TypeError, match="give the action an event_parser"):
        entry.parser.function(msg=String(data="x"), trigger=None)


def test_fields_are_copied_by_name_and_type() -> None:
    entry = made(trigger_service(srv_name="/light", srv_type=SetBool)).functions
    (parsed,) = (value for value in entry.values() if isinstance(value, Parsed))
    from std_msgs.msg import Bool

    assert parsed.parser.function(msg=Bool(data=True)).data is True
    assert isinstance(PoseStamped().pose, Pose)


def test_a_function_may_get_its_argument_from_a_parser() -> None:
    said = []

    def say(text: str, loud: bool = False) -> None:
        said.append((text, loud))

    action = Action(say, kwargs={"loud": True})
    action.event_parser(lambda *, msg, **_: f"it is {msg.data}", output_mapping="text")
    rules = made(action)
    data = rules.table.rules[0].actions[0]
    assert isinstance(data, Python)
    assert data.kwargs == {"loud": True, "msg": "$msg"}
    rules.functions[data.name](msg=Float64(data=2.0), loud=True)  # type: ignore[operator]
    assert said == [("it is 2.0", True)]


def test_an_action_may_be_the_condition_of_an_event() -> None:
    def is_night(limit: int) -> bool:
        return limit > 3

    polled = Event(Action(is_night, args=(5,)), check_rate=2.0)
    assert polled.function is not None
    assert polled.function() is True
    assert polled.rule_event.condition.name == "is_night"  # type: ignore[union-attr]
    with pytest.raises(TypeError, match="only plain functions can be called"):
        Action(DRIVER.restart)()


def test_a_parameter_may_be_taken_from_a_topic() -> None:
    action = update_parameter(
        component=DRIVER, param_name="scan_timeout", new_value=NUMBER.msg.data
    )
    data = made(action).table.rules[0].actions[0]
    assert isinstance(data, UpdateParameters)
    assert data.parameters == {"scan_timeout": "$topic[/number].data"}


def test_a_text_that_looks_like_a_reference_stays_a_text() -> None:
    def pay(price: str) -> None: ...

    data = made(Action(pay, args=("$5",))).table.rules[0].actions[0]
    assert isinstance(data, Python)
    assert data.kwargs == {"price": "$$5"}


def test_restart_of_the_same_component_and_logs_are_fallbacks() -> None:
    driver = DriveManager()
    driver.on_fail(ComponentActions.restart(component=driver))
    driver.on_giveup(fallback=ComponentActions.log(msg="look at it"))
    (ladder,) = (
        value for name, value in recipe_rules({}, [driver]).functions.items() if "on fail" in name
    )
    assert isinstance(ladder.next(), Lifecycle)  # type: ignore[union-attr]
    assert "fail" in repr(driver.fallbacks)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (
            lambda: Action(DRIVER.publish_status),
            TypeError,
            r"drive_manager\.publish_status cannot be called by a rule; .* restart",
        ),
        (
            lambda: Action(DRIVER.move_forward, args=("far",)),
            TypeError,
            r"drive_manager\.move_forward\(max_distance: float\).*: max_distance = 'far'",
        ),
        (lambda: Action(DRIVER.move_forward, args=(1, 2)), TypeError, "does not take"),
        (
            lambda: made(Action(DRIVER.move_forward)),
            ValueError,
            r"lacks max_distance; give it with args or kwargs",
        ),
        (
            lambda: update_parameter(component=CONTROLLER, param_name="algoritm", new_value="DWA"),
            ValueError,
            "'algoritm' is not a setting of ControllerConfig; did you mean 'algorithm'",
        ),
        (
            lambda: update_parameter(
                component=CONTROLLER, param_name="use_direct_sensor", new_value="perhaps"
            ),
            ValueError,
            "'use_direct_sensor' = 'perhaps'",
        ),
        (
            lambda: update_parameter(
                component=CONTROLLER, param_name="DWA.linear_sample", new_value=3
            ),
            ValueError,
            "did you mean 'linear_samples'",
        ),
    ],
)
def test_what_cannot_be_done_is_refused_when_it_is_written(
    make: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        make()
