"""Rules as data: what is refused, and what identifies a rule."""

from typing import Any

import pytest
from pydantic import TypeAdapter, ValidationError

from kompass.rules.schema.actions import Action
from kompass.rules.schema.conditions import Condition
from kompass.rules.schema.events import Event
from kompass.rules.schema.table import Rule, Severity, Table, rule_hash, table_hash
from tests.rules.building import (
    absent,
    both,
    changed,
    compare,
    either,
    opposite,
    received,
    rule,
)

SIGNAL = {"topic": "/a", "type": "std_msgs/msg/Float64", "path": ["data"]}
ACTIONS: list[dict[str, Any]] = [
    {"kind": "log", "text": "hello", "level": "warning"},
    {"kind": "method", "component": "c", "method": "m", "kwargs": {"x": [1, {"y": None}]}},
    {"kind": "lifecycle", "component": "c", "action": "restart"},
    {"kind": "reconfigure", "component": "c", "config": {"a": 1}, "keep_alive": True},
    {"kind": "reconfigure", "component": "c", "config": "robot.yaml"},
    {"kind": "update_parameters", "component": "c", "parameters": {"use_direct_sensor": True}},
    {"kind": "publish", "topic": "/t", "type": "std_msgs/msg/Bool", "message": {"data": True}},
    {"kind": "call_service", "service": "/s", "type": "nav2_msgs/srv/LoadMap", "request": {}},
    {"kind": "send_goal", "action": "/p", "type": "kompass_interfaces/action/PlanPath"},
    {"kind": "cancel_goal", "action": "/p"},
    {"kind": "raise_alarm", "alarm": "stuck", "text": "the robot is stuck"},
    {"kind": "clear_alarm", "alarm": "stuck"},
    {"kind": "start_mission", "mission": "Night round"},
    {"kind": "python", "name": "recipe.py:goal", "timeout": None, "on_error": "continue"},
]


@pytest.mark.parametrize("data", ACTIONS, ids=lambda data: str(data["kind"]))
def test_every_kind_of_action_survives_a_round_trip(data: dict[str, Any]) -> None:
    adapter: TypeAdapter[Action] = TypeAdapter(Action)
    action = adapter.validate_python(data)
    assert adapter.validate_json(adapter.dump_json(action)) == action


@pytest.mark.parametrize(
    ("data", "complaint"),
    [
        ({"operator": "<", "value": [1]}, "'<' takes one number or text"),
        ({"operator": ">", "value": True}, "'>' takes one number or text"),
        ({"operator": "between", "value": [2, 1]}, "two numbers, the lower one first"),
        ({"operator": "between", "value": 2}, "'between' takes a list"),
        ({"operator": "in", "value": 2}, "'in' takes a list of options"),
        ({"operator": "contains_any", "value": []}, "needs at least one item"),
        ({"operator": "<", "value": 1, "tolerance": 0.1}, "only '==' and '!=' take one"),
        ({"operator": "==", "value": 10**400, "tolerance": 0.1}, "leave the tolerance out"),
        ({"operator": "=", "value": 1}, "operator"),
        ({"operator": "==", "value": float("nan")}, "finite"),
        ({"operator": "==", "value": 1, "valeu": 1}, "valeu"),
    ],
)
def test_a_comparison_that_makes_no_sense_is_refused(data: dict[str, Any], complaint: str) -> None:
    adapter: TypeAdapter[Condition] = TypeAdapter(Condition)
    with pytest.raises(ValidationError, match=complaint):
        adapter.validate_python({"kind": "compare", "signal": SIGNAL, **data})


@pytest.mark.parametrize(
    ("condition", "complaint"),
    [
        ({"kind": "rate", "topic": "a"}, "give exactly one of them"),
        ({"kind": "rate", "topic": "a", "below": 1, "above": 2}, "give exactly one of them"),
        ({"kind": "rate", "topic": "a", "below": 1e6, "window": 60}, "shorten the window"),
        ({"kind": "received", "signal": {**SIGNAL, "topic": "/"}}, "not valid"),
        ({"kind": "received", "signal": {**SIGNAL, "type": "Float64"}}, "pattern"),
        ({"kind": "received", "signal": {**SIGNAL, "path": ["a.b"]}}, "pattern"),
        ({"kind": "received", "signal": {**SIGNAL, "timeout": 0}}, "greater than 0"),
        ({"kind": "all", "conditions": []}, "at least 1"),
        ({"kind": "nonsense"}, "nonsense"),
    ],
)
def test_a_condition_that_makes_no_sense_is_refused(
    condition: dict[str, Any], complaint: str
) -> None:
    adapter: TypeAdapter[Condition] = TypeAdapter(Condition)
    with pytest.raises(ValidationError, match=complaint):
        adapter.validate_python(condition)


@pytest.mark.parametrize(
    ("fields", "complaint"),
    [
        ({"condition": opposite(received("a"))}, "use 'absent' for silence"),
        ({"condition": opposite(either(changed("a"), compare("a", ">", 1)))}, "use 'absent'"),
        ({"condition": received("a"), "clear": opposite(received("a"))}, "use 'absent'"),
        ({"condition": received("a"), "hold": 1.0}, "true for one message at a time"),
        ({"condition": both(compare("a", ">", 1), changed("a")), "hold": 1.0}, "cannot stay true"),
        ({"condition": compare("a", ">", 1), "trigger": "change", "hold": 1.0}, "a change lasts"),
        ({"condition": absent("a", 1), "trigger": "change"}, "no value that could change"),
        ({"condition": received("a"), "mode": {"kind": "queued", "size": 0}}, "greater than"),
    ],
)
def test_an_event_that_could_never_do_what_it_says_is_refused(
    fields: dict[str, Any], complaint: str
) -> None:
    with pytest.raises(ValidationError, match=complaint):
        Event.model_validate(fields)


def test_two_rules_with_one_id_are_refused_and_both_are_named() -> None:
    rules = (rule(received("a"), "x", name="first"), rule(received("b"), "x", name="second"))
    with pytest.raises(
        ValidationError, match=r"rules\[0\] \('first'\) and rules\[1\] \('second'\)"
    ):
        Table(rules=rules)


@pytest.mark.parametrize("bad", ["", "Has Space", "UPPER", "-x", "x" * 101])
def test_an_id_is_a_slug(bad: str) -> None:
    with pytest.raises(ValidationError, match="id"):
        rule(received("a"), bad)


def test_a_rule_does_something() -> None:
    with pytest.raises(ValidationError, match="actions"):
        rule(received("a"), actions=())


def test_severity_is_told_by_its_name_as_the_schema_says() -> None:
    named = rule(received("a"), severity="error")
    assert named == rule(received("a"), severity=Severity.ERROR)
    assert named.severity is Severity.ERROR
    assert named.model_dump(mode="json")["severity"] == "error"
    for mode in ("validation", "serialization"):
        told = Table.model_json_schema(mode=mode)["$defs"]["Rule"]["properties"]["severity"]
        assert told["enum"] == [each.name.lower() for each in Severity]
        assert told["default"] == rule(received("a")).model_dump(mode="json")["severity"]
        assert told["default"] in told["enum"]


@pytest.mark.parametrize("wrong", ["fatal", "ERROR", 2, True, None])
def test_a_severity_that_is_not_in_the_schema_is_refused(wrong: object) -> None:
    with pytest.raises(ValidationError, match="known are: info, warning, error, critical"):
        rule(received("a"), severity=wrong)


def test_numbers_that_json_cannot_say_are_refused_in_arguments() -> None:
    action = {"kind": "python", "name": "f", "kwargs": {"deep": [{"x": float("inf")}]}}
    with pytest.raises(ValidationError, match="finite"):
        Rule.model_validate({"id": "r", "event": {"condition": received("a")}, "actions": [action]})


def test_a_name_and_a_note_change_no_hash() -> None:
    plain = rule(received("a"))
    dressed = rule(received("a"), name="A rule", note="why", source="recipe")
    assert rule_hash(plain) == rule_hash(dressed)
    assert table_hash(Table(rules=(plain,))) == table_hash(Table(rules=(dressed,)))


@pytest.mark.parametrize(
    "other",
    [
        rule(received("a"), cooldown=1.0),
        rule(received("b")),
        rule(received("a"), enabled=False),
        rule(received("a"), lane="safety"),
        rule(received("a"), severity="error"),
        rule(received("a"), "other"),
    ],
)
def test_what_a_rule_does_changes_its_hash(other: Rule) -> None:
    assert rule_hash(rule(received("a"))) != rule_hash(other)


def test_one_and_true_are_different_rules() -> None:
    assert rule_hash(rule(compare("a", "==", 1))) != rule_hash(rule(compare("a", "==", True)))


def test_the_order_of_rules_changes_the_hash_of_the_table() -> None:
    a, b = rule(received("a"), "a"), rule(received("a"), "b")
    assert table_hash(Table(rules=(a, b))) != table_hash(Table(rules=(b, a)))


def test_the_table_has_a_json_schema_that_tells_the_kinds_apart() -> None:
    schema = Table.model_json_schema()
    names = set(schema["$defs"])
    assert {"Compare", "Absent", "Rate", "AllOf", "Method", "SendGoal", "Queued"} <= names
    condition = schema["$defs"]["Event"]["properties"]["condition"]
    assert condition["discriminator"]["propertyName"] == "kind"


def test_a_table_cannot_be_changed() -> None:
    table = Table(rules=(rule(received("a")),))
    with pytest.raises(ValidationError, match="frozen"):
        table.rules[0].event.cooldown = 5.0
