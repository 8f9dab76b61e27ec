"""Both generations of events and actions become rules as data."""

import math

import pytest
from geometry_msgs.msg import PointStamped
from kompass_interfaces.action import PlanPath
from nav2_msgs.srv import LoadMap

from kompass import event
from kompass.actions import Action, ComponentActions, LogInfo, update_parameter
from kompass.components import Controller, DriveManager, Planner
from kompass.rclpy_ext.topic import Topic
from kompass.recipe.parsed import Parsed
from kompass.recipe.table import recipe_rules
from kompass.ros import Event
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.firing import Firing, RunEnded, Sample
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.actions import (
    CallService,
    Lifecycle,
    Log,
    Python,
    SendGoal,
    UpdateParameters,
)
from kompass.rules.schema.conditions import Received
from kompass.rules.schema.table import Table

CLICKED = Topic(name="/clicked_point", msg_type="PointStamped")
NUMBER = Topic(name="number", msg_type="Float64")
PLANNER, DRIVER, CONTROLLER = Planner(), DriveManager(), Controller()
COMPONENTS = [PLANNER, DRIVER, CONTROLLER]


def firings(made: Event, values: list[float]) -> list[int]:
    """Indices of the values at which an event on NUMBER fires."""
    table = compile_table(recipe_rules({made: LogInfo(msg="x")}, COMPONENTS).table)
    state = initial_state(table, 0.0)
    fired = []
    for index, value in enumerate(values):
        message = NUMBER.ros_msg_type(data=value)
        state, out = step(table, state, Sample("number", message), 0.1 * index)
        for firing in out:
            assert isinstance(firing, Firing)
            fired.append(index)
            state, _ = step(table, state, RunEnded(firing.rule_id, firing.run_id), 0.1 * index)
    return fired


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (event.OnAny("e", NUMBER), [0, 1, 2, 3, 4, 5]),
        (event.OnEqual("e", NUMBER, 2.0, "data"), [1, 2, 5]),
        (event.OnDifferent("e", NUMBER, 2.0, ["data"]), [0, 3, 4]),
        (event.OnGreater("e", NUMBER, 2.0, ("data",)), [3]),
        (event.OnGreater("e", NUMBER, 2.0, "data", True), [1, 2, 3, 5]),
        (event.OnLess("e", NUMBER, 2.0, "data"), [0, 4]),
        (event.OnLess("e", NUMBER, 2.0, "data", or_equal=True), [0, 1, 2, 4, 5]),
        (event.OnChange("e", NUMBER, "data"), [1, 3, 4, 5]),
        (event.OnChangeEqual("e", NUMBER, 2.0, "data"), [1, 5]),
        (Event(NUMBER), [0, 1, 2, 3, 4, 5]),
        (Event(NUMBER.msg.data == 2.0), [1, 2, 5]),
        (Event(NUMBER.msg.data == 2.0, on_change=True), [1, 5]),
        (Event(NUMBER.msg.data == 2.0, handle_once=True), [1]),
        (Event(NUMBER.msg.data >= 0, keep_event_delay=0.25), [0, 3]),
        (event.OnEqual("e", NUMBER, 2.0, "data", handle_once=True), [1]),
    ],
)
def test_every_kind_of_event_fires_when_its_documentation_says(
    made: Event, expected: list[int]
) -> None:
    assert firings(made, [1.0, 2.0, 2.0, 3.0, 1.0, 2.0]) == expected


def test_on_greater_and_on_any_on_the_clicked_point_are_equivalent() -> None:
    table = recipe_rules(
        {
            event.OnGreater("a", CLICKED, 0, ["header", "stamp", "sec"]): LogInfo(msg="a"),
            event.OnAny("b", CLICKED): LogInfo(msg="b"),
        },
        COMPONENTS,
    ).table
    compiled = compile_table(table)
    message = PointStamped()
    message.header.stamp.sec = 5
    _, out = step(compiled, initial_state(compiled, 0.0), Sample("clicked_point", message), 1.0)
    assert sorted(firing.rule_id for firing in out) == ["a", "b"]


def test_actions_become_data_in_the_order_of_the_list() -> None:
    load = LoadMap()  # as a published tutorial writes it
    load.map_url = "/maps/floor.yaml"
    made = recipe_rules(
        {
            event.OnAny("e", NUMBER): [
                LogInfo(msg="hello"),
                ComponentActions.restart(component=PLANNER),
                Action(DRIVER.restart),
                ComponentActions.send_srv_request(
                    srv_name="/map_server/load_map", srv_type=LoadMap, srv_request_msg=load
                ),
                update_parameter(component=DRIVER, param_name="scan_timeout", new_value=0.4),
            ]
        },
        COMPONENTS,
    )
    actions = made.table.rules[0].actions
    assert [type(action) for action in actions] == [
        Log,
        Lifecycle,
        Lifecycle,
        CallService,
        UpdateParameters,
    ]
    assert isinstance(actions[3], CallService)
    assert actions[3].request == {"map_url": "/maps/floor.yaml"}
    assert Table.model_validate_json(made.table.model_dump_json()) == made.table


def test_a_parser_stays_code_and_is_named() -> None:
    send = ComponentActions.send_action_goal(
        action_name="/planner/plan_path",
        action_type=PlanPath,
        action_request_msg=PlanPath.Goal(),
    )

    def to_goal(*, msg: PointStamped, **_: object) -> PlanPath.Goal:
        return PlanPath.Goal()

    send.event_parser(to_goal, output_mapping="action_request_msg")
    made = recipe_rules({event.OnAny("e", CLICKED): send}, COMPONENTS)
    action = made.table.rules[0].actions[0]
    assert isinstance(action, Python)
    entry = made.functions[action.name]
    assert isinstance(entry, Parsed)
    assert isinstance(entry.action, SendGoal)
    assert made.table.rules[0].event.mode.kind == "parallel"


def test_arguments_may_come_from_a_topic() -> None:
    def note(value: float) -> None: ...

    made = recipe_rules({Event(NUMBER): Action(note, args=(NUMBER.msg.data,))}, COMPONENTS)
    action = made.table.rules[0].actions[0]
    assert isinstance(action, Python)
    assert action.kwargs == {"value": "$topic[/number].data"}


def test_ids_are_stable_and_readable() -> None:
    rules = recipe_rules(
        {
            event.OnEqual("controller_fail", NUMBER, 1.0, "data"): LogInfo(msg="x"),
            Event(PLANNER.status_topic.msg.status == 1): LogInfo(msg="x"),
            Event(PLANNER.status_topic.msg.status == 1, on_change=True): LogInfo(msg="x"),
        },
        COMPONENTS,
    ).table.rules
    assert rules[0].id == "controller-fail"
    assert rules[1].id.startswith("planner")
    assert rules[2].id == f"{rules[1].id}-2"


def test_two_events_of_one_name_are_refused() -> None:
    with pytest.raises(ValueError, match="two events are called 'e'"):
        recipe_rules(
            {
                event.OnAny("e", NUMBER): LogInfo(msg="x"),
                event.OnAny("e", CLICKED): LogInfo(msg="y"),
            },
            COMPONENTS,
        )


def test_an_action_on_a_component_that_was_not_added_is_refused() -> None:
    with pytest.raises(ValueError, match="'drive_manager' is not among the components"):
        recipe_rules({Event(NUMBER): Action(DRIVER.restart)}, [PLANNER])


def test_wrong_arguments_are_refused_when_the_recipe_is_read() -> None:
    with pytest.raises(TypeError, match="does not take"):
        Action(DRIVER.set_input, args=(1, 2))
    with pytest.raises(ValueError, match=r"did you mean 'scan_timeout'"):
        update_parameter(component=DRIVER, param_name="scan_timeot", new_value=1.0)
    with pytest.raises(ValueError, match="scan_timeout"):
        update_parameter(component=DRIVER, param_name="scan_timeout", new_value=-1.0)


def test_a_function_is_a_condition_unless_it_returns_something_else() -> None:
    def low() -> bool:
        return True

    def number() -> int:
        return 1

    assert recipe_rules({Event(low, check_rate=5): LogInfo(msg="x")}, COMPONENTS).polled
    with pytest.raises(TypeError, match="returns bool"):
        Event(number)


def test_a_value_alone_is_no_event() -> None:
    with pytest.raises(TypeError, match="compare it"):
        Event(NUMBER.msg.data)
    with pytest.raises(ValueError, match="must not be negative"):
        Event(NUMBER, keep_event_delay=-math.inf)


def test_a_topic_event_is_each_message() -> None:
    assert isinstance(Event(NUMBER).rule_event.condition, Received)
