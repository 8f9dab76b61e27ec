"""What is probably not meant so is said once, at its place; of a sound rule nothing is said."""

from typing import Any

import pytest

from kompass.rulebook.lint.context import LintContext, TopicFacts
from kompass.rulebook.lint.lint import findings_of, lint_table
from kompass.rulebook.outlook import outlook
from kompass.rulebook.schema.report import Finding
from kompass.rules.checks.catalog import ComponentSpec, FieldType
from kompass.rules.checks.problem import Problem
from kompass.rules.schema.actions import (
    CallService,
    Lifecycle,
    Log,
    Method,
    Publish,
    SendGoal,
    UpdateParameters,
)
from kompass.rules.schema.conditions import Condition
from kompass.rules.schema.table import Rule, Table
from tests.rules.building import (
    FLOAT,
    Robot,
    absent,
    both,
    changed,
    compare,
    either,
    opposite,
    received,
    rule,
    slower,
)

COMPONENTS = {"mapper": ComponentSpec("mapper"), "controller": ComponentSpec("controller")}


def context(**fields: Any) -> LintContext:
    topics = {
        "a": TopicFacts(FLOAT, 10.0),
        "slow": TopicFacts(FLOAT, 1.0),
        "map": TopicFacts(FLOAT, None, latched=True),
        "click": TopicFacts(FLOAT, None),
        "mapper/status": TopicFacts(FLOAT, 5.0, latched=True),
        "controller/status": TopicFacts(FLOAT, 5.0, latched=True),
    }
    known = LintContext(
        topics, {"load_map": ["p/srv/Load"]}, {"plan_path": ["p/action/Plan"]}, COMPONENTS
    )
    return known._replace(**fields)


def lints(*rules: Rule, **fields: Any) -> list[Finding]:
    return lint_table(Table(rules=rules), context(**fields))


def codes(*rules: Rule, **fields: Any) -> list[str]:
    return [finding.code for finding in lints(*rules, **fields)]


def acting(action: Any, rule_id: str = "r", topic: str = "a", **fields: Any) -> Rule:
    return rule(compare(topic, "<", 1), rule_id, actions=(action,), **{"cooldown": 5.0, **fields})


def calm(condition: Condition, **fields: Any) -> Rule:
    return rule(condition, **{"cooldown": 5.0, **fields})


def stop(name: str) -> Lifecycle:
    return Lifecycle(component=name, action="stop")


def start(name: str) -> Lifecycle:
    return Lifecycle(component=name, action="start")


@pytest.mark.parametrize(
    "good",
    [
        calm(compare("a", "<", 1)),
        calm(compare("slow", "<", 1, timeout=3.0)),
        calm(compare("map", "<", 1, timeout=None)),
        calm(absent("gone", 1.0)),
        rule(received("click")),
        rule(changed("click")),
        rule(compare("a", "<", 1), trigger="edge"),
        rule(compare("a", "<", 1), once=True),
        calm(either(opposite(compare("a", "<", 1)), absent("a", 1.0))),
        calm(compare("a", "<", 1), hold=1.0, clear=compare("a", ">", 2)),
        acting(CallService(service="/load_map", type="p/srv/Load")),
        acting(SendGoal(action="plan_path", type="p/action/Plan")),
        acting(Publish(topic="b", type=FLOAT)),
        acting(Lifecycle(component="mapper", action="restart"), topic="mapper/status"),
        acting(Publish(topic="a", type=FLOAT), trigger="edge", cooldown=0.0),
        rule(compare("gone", "<", 1), enabled=False),
    ],
)
def test_a_sound_rule_is_left_alone(good: Rule) -> None:
    assert codes(good) == []


@pytest.mark.parametrize(
    ("bad", "code", "field", "text"),
    [
        (calm(compare("slow", "<", 1)), "rate-vs-timeout", "signal.timeout", "come every 1 s"),
        (calm(compare("map", "<", 1)), "latched-timeout", "signal.timeout", "is latched"),
        (calm(compare("slwo", "<", 1)), "no-topic", "signal.topic", "nobody publishes on /slwo"),
        (calm(slower("gone", 1.0)), "no-topic", "event.condition.topic", "on /gone"),
        (calm(absent("slow", 0.5)), "rate-vs-absence", "seconds", "absent that long again"),
        (calm(compare("a", "<", 1), hold=0.05), "hold-vs-rate", "event.hold", "a single one"),
        (rule(compare("a", "<", 1)), "no-cooldown", "event.cooldown", "up to 10 times a second"),
        (rule(received("a")), "no-cooldown", "event.cooldown", "up to 10 times a second"),
        (rule(compare("click", "<", 1)), "no-cooldown", "event.cooldown", "with every message"),
        (
            calm(both(received("a"), opposite(compare("a", "<", 1)))),
            "not-of-silence",
            "event.condition.conditions[1].condition",
            "while /a is silent",
        ),
        (
            calm(compare("a", "<", 1), clear=compare("a", "<", 1)),
            "never-clears",
            "event.clear",
            "what must be false",
        ),
        (
            calm(compare("a", "<", 1), once=True, lane="safety"),
            "once-safety",
            "event.once",
            "guards nothing",
        ),
        (
            acting(CallService(service="load_map", type="q/srv/Load")),
            "service-type",
            "actions[0].type",
            "the service /load_map is there, but of type p/srv/Load",
        ),
        (
            acting(SendGoal(action="plan_path", type="p/action/Follow")),
            "action-type",
            "actions[0].type",
            "the action /plan_path is there, but of type p/action/Plan",
        ),
        (
            acting(CallService(service="lod_map", type="p/srv/Load")),
            "no-service",
            "actions[0].service",
            "no node offers the service /lod_map",
        ),
        (
            acting(SendGoal(action="plan", type="p/action/Plan")),
            "no-action",
            "actions[0].action",
            "no node serves",
        ),
        (
            acting(Publish(topic="b", type=FLOAT, rate=1.0, timeout=None)),
            "endless",
            "actions[0].period",
            "for ever",
        ),
        (
            acting(Publish(topic="a", type=FLOAT), cooldown=0.5),
            "self-trigger",
            "actions",
            "it publishes on /a",
        ),
        (
            acting(
                Method(component="mapper", method="restart"), topic="mapper/status", cooldown=0.5
            ),
            "self-trigger",
            "actions",
            "acts on mapper, whose status it looks at",
        ),
    ],
)
def test_what_is_probably_not_meant_is_said_at_its_place(
    bad: Rule, code: str, field: str, text: str
) -> None:
    (finding,) = lints(bad)
    assert (finding.level, finding.code, finding.rule_id) == ("lint", code, "r")
    assert finding.field.endswith(field)
    assert text in finding.text
    assert finding.remedy


def test_a_topic_of_another_type_is_told_with_the_right_one() -> None:
    (finding,) = lints(calm(compare("a", "<", 1)), topics={"a": TopicFacts("p/msg/Other", 10.0)})
    assert (finding.code, finding.remedy) == ("other-type", "set the type to p/msg/Other")


def test_the_remedy_of_a_short_timeout_is_enough() -> None:
    (finding,) = lints(calm(compare("slow", "<", 1)))
    assert finding.remedy == "set the timeout to 3.2 s or more"
    assert codes(calm(compare("slow", "<", 1, timeout=3.2))) == []


def test_what_is_true_now_fires_when_it_is_applied() -> None:
    robot = Robot(calm(compare("a", "<", 1), rule_id="old"))
    robot.say("a", 0)
    new = [
        calm(compare("a", "<", 1), rule_id="old"),
        calm(compare("a", "<", 2), rule_id="now"),
        calm(compare("a", "<", 2), rule_id="held", hold=3.0),
        calm(compare("a", ">", 2), rule_id="false"),
        rule(compare("a", "<", 2), "edge", trigger="edge", first_true_is_edge=False),
    ]
    after = Robot(*new).table
    verdicts = outlook(robot.table, robot.state, after, robot.now).verdicts
    assert verdicts == {"now": True, "held": True, "false": False, "edge": True}
    found = lints(*new, verdicts=verdicts)
    assert [(f.rule_id, f.code) for f in found] == [("now", "true-now"), ("held", "true-now")]
    assert "it fires 3 s after it is applied" in found[1].text


def test_a_component_that_publishes_what_the_rule_looks_at_closes_a_loop() -> None:
    action = UpdateParameters(component="controller", parameters={"x": 1})
    bad = acting(action, cooldown=0.1)
    assert codes(bad) == []
    assert codes(bad, publishes={"controller": {"a"}}) == ["self-trigger"]


@pytest.mark.parametrize(
    ("condition", "fields", "said"),
    [
        (compare("mapper/status", "!=", 0), {"once": True, "trigger": "edge"}, True),
        (both(compare("a", ">", 1), absent("a", 2.0)), {"once": True}, True),
        (slower("a", 2.0), {"once": True}, True),
        # A hold waits until it is more than a hiccup.
        (compare("mapper/status", "!=", 0), {"once": True, "hold": 1.0}, False),
        (compare("mapper/status", "!=", 0), {"cooldown": 5.0}, False),
        # A click, or a value that somebody means.
        (compare("a", ">", 1), {"once": True}, False),
        (received("click"), {"once": True}, False),
    ],
)
def test_a_hiccup_that_would_use_up_a_rule_is_pointed_out(
    condition: Condition, fields: dict[str, Any], said: bool
) -> None:
    found = [f for f in lints(rule(condition, **fields)) if f.code == "once-hiccup"]
    assert len(found) == said
    assert all("give it a hold" in f.remedy for f in found)


def test_a_circle_of_rules_is_found_once_and_a_chain_is_none() -> None:
    def link(rule_id: str, hears: str, says: str) -> Rule:
        return acting(Publish(topic=says, type=FLOAT), rule_id, hears, cooldown=0.1)

    circle = [link("x", "a", "slow"), link("y", "slow", "click"), link("z", "click", "a")]
    found = [f for f in lints(*circle) if f.code == "self-trigger"]
    assert [f.rule_id for f in found] == ["x"]
    assert "x → y → z → x" in found[0].text
    assert "self-trigger" not in codes(*circle[:2])
    rested = [circle[0], circle[1], acting(Publish(topic="a", type=FLOAT), "z", "click")]
    assert "self-trigger" not in codes(*rested)


@pytest.mark.parametrize(
    ("one", "other", "both_true"),
    [
        (compare("a", "<", 1), compare("a", "<", 2), True),
        (compare("a", "<", 1), compare("a", ">", 2), False),
        (compare("a", "<", 1), compare("a", ">=", 1), False),
        (compare("a", "<=", 1), compare("a", ">=", 1), True),
        (compare("a", "==", 1), compare("a", "==", 2), False),
        (compare("a", "==", 1), compare("a", "in", (1, 2)), True),
        (compare("a", "between", (1, 3)), compare("a", "==", 2.0), True),
        (compare("a", "==", 5), compare("a", ">", 5), False),
        (both(compare("a", "<", 1), compare("slow", "<", 1)), compare("a", ">", 2), False),
        (compare("a", "<", 1), compare("click", "<", 1), False),
        # Several comparisons of one signal hold together.
        (both(compare("a", ">", 1), compare("a", "<", 3)), compare("a", "<", 0), False),
        (both(compare("a", "<", 3), compare("a", ">", 1)), compare("a", ">", 5), False),
        (both(compare("a", "<", 3), compare("a", ">", 1)), compare("a", "==", 2), True),
        (both(compare("a", "in", (1, 2, 3)), compare("a", ">", 1)), compare("a", "==", 1), False),
        (both(compare("a", "in", (1, 2)), compare("a", "in", (2, 3))), compare("a", "==", 2), True),
        (both(compare("a", ">", 1), compare("a", ">=", 1)), compare("a", "==", 1), False),
        (both(compare("a", "<", 1), compare("a", "!=", 7)), compare("a", ">", 2), False),
        # What is never true is never true together with anything.
        (both(compare("a", ">", 3), compare("a", "<", 1)), compare("a", "<", 9), False),
        (received("a"), received("a"), True),
        (compare("a", "<", 10**400), compare("a", ">", 10**400), False),
        (compare("a", "<=", 10**400), compare("a", ">=", 10**400), True),
        (compare("a", "==", 10**400), compare("a", ">", -(10**400)), True),
        (compare("a", "==", 10**400), compare("a", "==", 10**400 + 1), False),
        (compare("a", "between", (1, 10**400)), compare("a", "==", 2.0), True),
        (compare("a", "==", True), compare("a", "==", 1), False),
        (compare("a", "==", 1), compare("a", "==", 1.0), True),
    ],
)
def test_rules_that_set_one_thing_to_two_values_at_once_contradict(
    one: Condition, other: Condition, both_true: bool
) -> None:
    def setting(condition: Condition, rule_id: str, value: float) -> Rule:
        action = UpdateParameters(component="controller", parameters={"speed": value})
        return rule(condition, rule_id, actions=(action,), cooldown=5.0)

    pair = [setting(one, "one", 1.0), setting(other, "other", 2.0)]
    found = [f for f in lints(*pair) if f.code == "contradiction"]
    assert [f.rule_id for f in found] == (["other"] if both_true else [])
    alike = [setting(one, "one", 1.0), setting(other, "other", 1.0)]
    assert "contradiction" not in codes(*alike)


@pytest.mark.parametrize(("value", "told"), [("$$5", ["contradiction"]), ("$msg.text", [])])
def test_what_a_message_brings_contradicts_nothing_and_a_text_may(
    value: str, told: list[str]
) -> None:
    set_prices = [
        UpdateParameters(component="controller", parameters={"price": price})
        for price in ("$$6", value)
    ]
    pair = [
        acting(each, rule_id) for rule_id, each in zip(("one", "other"), set_prices, strict=True)
    ]
    assert codes(*pair) == told


def test_starting_and_stopping_one_component_contradicts_but_not_in_one_rule() -> None:
    pair = [acting(start("mapper"), "one"), acting(stop("mapper"), "other")]
    assert codes(*pair) == ["contradiction"]
    again = rule(compare("a", "<", 1), actions=(stop("mapper"), start("mapper")), cooldown=5.0)
    assert codes(again) == []


def test_where_nothing_is_known_of_the_graph_nothing_is_said_of_it() -> None:
    made = acting(CallService(service="x", type="p/srv/Load"), topic="gone")
    assert lint_table(Table(rules=(made,)), LintContext()) == []


def test_of_many_rules_that_contradict_each_other_not_every_pair_is_listed() -> None:
    rules = tuple(
        acting(UpdateParameters(component="controller", parameters={"x": n}), f"r{n}")
        for n in range(1_000)
    )
    found = lint_table(Table(rules=rules), context())
    assert 0 < len(found) < 1_000


def test_problems_become_errors_with_all_that_they_say() -> None:
    problem = Problem("r", "event.hold", 1.0, "is wrong", "mend it", "wrong-type")
    (finding,) = findings_of([problem])
    assert finding == Finding(
        level="error",
        code="wrong-type",
        rule_id="r",
        field="event.hold",
        value=1.0,
        text="is wrong",
        remedy="mend it",
    )


def test_a_log_is_no_reason_for_anything() -> None:
    assert codes(calm(compare("a", "<", 1), actions=(Log(text="!"),))) == []


class Bytes:
    """A catalog in which every field is a byte."""

    def fields(self, type_name: str) -> list[str]:
        return ["x"]

    def field_type(self, type_name: str, path: tuple[str | int, ...]) -> FieldType | None:
        return FieldType("int", primitive="octet")


@pytest.mark.parametrize(
    ("operator", "value", "code"),
    [
        ("<", 256, "always-true"),
        ("<=", 255, "always-true"),
        (">=", 0, "always-true"),
        (">", -1, "always-true"),
        ("!=", 300, "always-true"),
        ("!=", 1.5, "always-true"),
        ("between", (-1, 300), "always-true"),
        (">", 255, "never-true"),
        ("<", 0, "never-true"),
        (">=", 300, "never-true"),
        ("<=", -0.5, "never-true"),
        ("between", (256, 300), "never-true"),
    ],
)
def test_a_bound_beyond_what_the_field_holds_is_told(operator: Any, value: Any, code: str) -> None:
    (finding,) = lints(calm(compare("a", operator, value)), messages=Bytes())
    assert (finding.code, finding.field) == (code, "event.condition.value")
    truth = code.removesuffix("-true")
    assert finding.text == f"'x' is an integer (byte: 0 to 255): this is {truth} true"


@pytest.mark.parametrize(
    ("operator", "value"),
    [("<", 255), ("<=", 254.5), (">", 0), (">=", 255), ("!=", 3), ("between", (255, 300))],
)
def test_of_a_bound_that_decides_something_nothing_is_told(operator: Any, value: Any) -> None:
    assert lints(calm(compare("a", operator, value)), messages=Bytes()) == []
