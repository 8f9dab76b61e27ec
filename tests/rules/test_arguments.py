"""Arguments taken from messages."""

from types import SimpleNamespace as Message
from typing import Any

import pytest

from kompass.rules.schema.actions import Publish, Python, UpdateParameters, topics_in
from kompass.rules.schema.arguments import ArgumentError, expand, resolve

CLICK = Message(point=Message(x=1.5, y=-2.0), labels=["a", "b"])


def test_references_are_taken_from_the_message_wherever_they_stand() -> None:
    arguments: dict[str, Any] = {
        "goal.position.x": "$msg.point.x",
        "nested": {"list": [1, "$msg.labels[1]", {"deep": "$msg.point.y"}]},
        "whole": "$msg",
        "plain": "text",
    }
    assert resolve(arguments, CLICK) == {
        "goal.position.x": 1.5,
        "nested": {"list": [1, "b", {"deep": -2.0}]},
        "whole": CLICK,
        "plain": "text",
    }


def test_the_newest_message_of_another_topic_can_be_asked_for() -> None:
    messages = {"odom": Message(x=4)}
    assert resolve({"x": "$topic[/odom].x"}, None, messages) == {"x": 4}


def test_two_dollar_signs_are_one() -> None:
    assert resolve({"price": "$$5"}, CLICK) == {"price": "$5"}


def test_the_arguments_of_the_rule_are_not_changed() -> None:
    arguments: dict[str, Any] = {"a": ["$msg.point.x"]}
    resolve(arguments, CLICK)
    assert arguments == {"a": ["$msg.point.x"]}


@pytest.mark.parametrize(
    ("reference", "complaint"),
    [
        ("$msg.point.z", r"argument 'goal' = '\$msg.point.z': .* has no field 'z'.*: x, y"),
        ("$msg.labels[5]", r"no item \[5\]; list has 2 items"),
        ("$msg.point[0]", r"no item \[0\]; SimpleNamespace is no sequence"),
        ("$topic[/odom].x", r"/odom was never received"),
    ],
)
def test_a_field_that_is_not_there_is_named(reference: str, complaint: str) -> None:
    with pytest.raises(ArgumentError, match=complaint):
        resolve({"goal": reference}, CLICK)


def test_a_firing_without_a_message_says_so() -> None:
    with pytest.raises(ArgumentError, match="the firing has no message"):
        resolve({"goal": "$msg.x"}, None)


@pytest.mark.parametrize("text", ["$mgs.x", "$msg.", "$msg.a-b", "$topic[].x", "$5", "$msg.a\n"])
def test_what_only_looks_like_a_reference_is_refused_when_the_rule_is_made(text: str) -> None:
    with pytest.raises(ValueError, match=r"is not a reference; write '\$msg.field'"):
        Python(name="f", kwargs={"a": [text]})


def test_the_topics_in_an_action_are_known_before_it_runs() -> None:
    action = UpdateParameters(component="c", parameters={"x": "$topic[/a].x", "y": "$msg.y"})
    assert list(topics_in(action)) == ["a"]
    publish = Publish(topic="t", type="p/msg/N", message={"l": [{"x": "$topic[b].x"}]})
    assert list(topics_in(publish)) == ["b"]


def test_keys_with_dots_are_nested_messages() -> None:
    assert expand({"a.b.x": 1, "a.b": {"y": 2}, "c": [1]}) == {
        "a": {"b": {"x": 1, "y": 2}},
        "c": [1],
    }


@pytest.mark.parametrize("arguments", [{"a": 1, "a.b": 2}, {"a.b": 2, "a": 1}])
def test_a_key_set_twice_is_refused(arguments: dict[str, Any]) -> None:
    with pytest.raises(ArgumentError, match="is already set; give it once"):
        expand(arguments)


def test_keys_with_dots_are_parts_in_the_items_of_lists_too() -> None:
    poses: dict[str, Any] = {"poses": [{"position.x": 1.0, "position.y": 2.0}]}
    assert expand(poses) == {"poses": [{"position": {"x": 1.0, "y": 2.0}}]}
