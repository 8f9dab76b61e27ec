"""A recipe can say of a rule all that a rule is."""

from typing import Any

import pytest
from std_msgs.msg import Float64

from kompass.actions import log
from kompass.rclpy_ext.topic import Topic
from kompass.recipe.event import Event
from kompass.recipe.table import recipe_rules
from kompass.rules.schema.events import Parallel, Queued
from kompass.rules.schema.table import Rule, Severity

LEVEL = Topic(name="/level", msg_type=Float64)


def made(event: Event) -> Rule:
    return recipe_rules({event: log(msg="!")}, ()).table.rules[0]


def test_what_is_stated_is_in_the_rule_and_the_rest_is_as_ever() -> None:
    event = Event(LEVEL.msg.data < 0.3, keep_event_delay=5.0).as_rule(
        "low-level",
        name="Level is low",
        hold=2.0,
        clear=LEVEL.msg.data > 0.5,
        severity="critical",
        lane="safety",
        protected=True,
        mode=Queued(size=2),
    )
    rule = made(event)
    assert (rule.id, rule.name, rule.severity) == ("low-level", "Level is low", Severity.CRITICAL)
    assert (rule.lane, rule.protected, rule.source) == ("safety", True, "recipe")
    assert (rule.event.hold, rule.event.cooldown, rule.event.mode) == (2.0, 5.0, Queued(size=2))
    assert rule.event.clear is not None
    plain = made(Event(LEVEL.msg.data < 0.3))
    assert (plain.id, plain.protected) == ("level-data-below-0-3", False)


@pytest.mark.parametrize(
    ("fields", "error", "text"),
    [
        ({"hodl": 2.0}, TypeError, "did you mean 'hold'?"),
        ({"hold": -2.0}, ValueError, "hold"),
        ({"clear": 5}, TypeError, "is no condition"),
        ({"rule_id": [1]}, TypeError, "is no text; give one"),
        ({"protected": "x"}, ValueError, "as_rule: protected = 'x': it should be a valid bool"),
        ({"severity": "grave"}, ValueError, "'grave' is not a severity"),
        ({"name": 5}, ValueError, "as_rule: name = 5"),
    ],
)
def test_what_does_not_fit_is_refused_where_it_is_written(
    fields: dict[str, Any], error: type[Exception], text: str
) -> None:
    with pytest.raises(error, match=text.replace("?", r"\?")):
        Event(LEVEL.msg.data < 0.3).as_rule(**fields)


def test_two_rules_cannot_have_one_id() -> None:
    events = [Event(LEVEL.msg.data < bound).as_rule("same") for bound in (1.0, 2.0)]
    with pytest.raises(ValueError, match="two events are called 'same'"):
        recipe_rules({event: log(msg="!") for event in events}, ())


def test_kinds_of_actions_do_not_change_a_mode_that_is_stated() -> None:
    rule = made(Event(LEVEL).as_rule(mode=Parallel(size=3)))
    assert rule.event.mode == Parallel(size=3)
