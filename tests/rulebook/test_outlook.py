"""What is true now is said before a table is applied, with when it fires; and it does fire then."""

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import strategies as st

from kompass.rulebook.outlook import Newest, Outlook, acts, outlook
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.schema.actions import (
    CallService,
    Lifecycle,
    Log,
    Method,
    RaiseAlarm,
    SendGoal,
    UpdateParameters,
)
from kompass.rules.schema.conditions import Compare, leaves
from kompass.rules.schema.table import Rule, Table
from tests.backtest.live_loop import NS, LiveLoop
from tests.rules.building import Robot, absent, both, changed, compare, opposite, received, rule
from tests.rules.strategies import GRID, callable_samples, samples, tables
from tests.support.properties import MANY, property_test

STOP = CallService(service="drive_manager/stop", type="std_srvs/srv/Trigger")


def look(robot: Robot, *rules: Rule, **known: Any) -> Outlook:
    new = compile_table(Table(rules=rules))
    return outlook(robot.table, robot.state, new, robot.now, **known)


def watching(*topics: str) -> Robot:
    """A robot with a rule on some topics; each says 0.41."""
    robot = Robot(*(rule(compare(topic, ">", 90), f"on-{topic}") for topic in topics))
    for topic in topics:
        robot.say(topic, 0.41)
    return robot


def told(robot: Robot, made: Rule, **known: Any) -> list[str]:
    return [each.text for each in look(robot, made, **{"rates": {"a": 10.0}, **known}).prospects]


@pytest.mark.parametrize(
    ("made", "text"),
    [
        (rule(compare("a", "<", 1), hold=2.0), "true now: it will fire in 2.0 s after Apply"),
        (rule(compare("a", "<", 1)), "true now: it will fire at once after Apply"),
        (
            rule(compare("a", "<", 1), trigger="edge", hold=0.25),
            "true now: it will fire in 0.25 s after Apply",
        ),
        (
            rule(compare("a", "<", 1), trigger="edge", first_true_is_edge=False),
            "true now; it fires when it next becomes true",
        ),
        (rule(compare("a", "<", 1), trigger="change"), "true now; it fires when a value changes"),
        (
            rule(compare("a", "<", 1), shadow=True),
            "true now: it will fire at once after Apply (in shadow: it does nothing)",
        ),
        (
            rule(compare("b", "<", 1), hold=2.0),
            "not known yet whether it is true now: nothing received on b yet",
        ),
        (
            rule(absent("b", 3.0), hold=2.0),
            "will be true: it will fire in 5.0 s after Apply if /b stays silent",
        ),
    ],
)
def test_each_new_rule_that_is_true_now_says_when_it_fires(made: Rule, text: str) -> None:
    assert told(watching("a"), made) == [text]


@pytest.mark.parametrize(
    "made",
    [
        rule(compare("a", ">", 1)),
        rule(compare("a", "<", 1), enabled=False),
        rule(compare("a", ">", 90), "on-a"),  # is in force already, and goes on
        rule(received("a")),  # true for a message only
        rule(both(compare("a", "<", 1), changed("a"))),
        rule(compare("b", "<", 1), trigger="edge", first_true_is_edge=False),
        rule(opposite(compare("a", "<", 1))),
    ],
)
def test_of_a_rule_that_does_not_fire_by_itself_nothing_is_said(made: Rule) -> None:
    assert told(watching("a"), made) == []


def test_where_messages_are_rare_it_waits_for_the_next() -> None:
    made = rule(compare("a", "<", 1), hold=2.0)
    expected = ["true now: it will fire 2.0 s after the next message on /a"]
    assert told(watching("a"), made, rates={}) == expected
    assert told(watching("a"), made, rates={"a": 0.2}) == expected


def test_what_was_heard_for_the_check_alone_counts_as_long_as_it_is_valid() -> None:
    made = rule(compare("b", "<", 1, timeout=1.0), hold=2.0)
    robot = watching("a")
    robot.wait(10.0)
    message = SimpleNamespace(x=0.41)
    heard = {"b": Newest(message, 9.9, comes=True)}
    assert told(robot, made, heard=heard) == ["true now: it will fire in 2.0 s after Apply"]
    heard = {"b": Newest(message, 8.0, comes=True)}
    (text,) = told(robot, made, heard=heard)
    assert text == "not known yet whether it is true now: b silent for 2 s"


def test_the_first_line_names_what_fires_and_what_it_does() -> None:
    robot = watching("a")
    near = rule(compare("a", "<", 1), "near", name="Too near", hold=2.0, actions=(STOP,))
    found = look(robot, near, rates={"a": 10.0})
    assert found.text == (
        "'Too near' is true now: it will fire in 2.0 s after Apply (call /drive_manager/stop)"
    )
    assert found.prospects[0].acts
    unknown = rule(compare("b", "<", 1), "other")
    quiet = rule(compare("a", "<", 1), "quiet", trigger="edge", first_true_is_edge=False)
    several = look(robot, unknown, quiet, near, rates={"a": 10.0})
    assert several.text == (
        "'Too near' is true now: it will fire in 2.0 s after Apply; "
        "not known yet whether 'other' is true now: nothing received on b yet; "
        "'quiet' is true now; it fires when it next becomes true"
    )
    many = [rule(compare("a", "<", 1), f"r{number}") for number in range(5)]
    assert look(robot, *many, rates={"a": 10.0}).text.endswith("; and 2 more")


def test_that_nothing_is_true_is_said_and_of_nothing_new_nothing() -> None:
    robot = watching("a")
    assert look(robot, rule(compare("a", ">", 1))).text == "no new or changed rule is true now"
    assert look(robot, rule(compare("a", ">", 90), "on-a")).text == ""


@pytest.mark.parametrize(
    ("action", "does"),
    [
        (Log(text="!"), False),
        (RaiseAlarm(alarm="low"), False),
        (UpdateParameters(component="controller", parameters={"x": 1}), False),
        (CallService(service="monitor/save_recording", type="a/srv/B"), False),
        (STOP, True),
        (Method(component="drive_manager", method="move_to_unblock"), True),
        (Lifecycle(component="controller", action="stop"), True),
        (SendGoal(action="plan_path", type="a/action/B"), True),
    ],
)
def test_what_stops_or_moves_the_robot_is_told_from_what_only_tells(
    action: Any, does: bool
) -> None:
    made = rule(compare("a", "<", 1), actions=(Log(text="!"), action))
    assert acts(made) is does
    assert not acts(made.model_copy(update={"shadow": True}))


ROUND = 1e-3  # s in which every topic has said something
happenings = st.one_of(samples, samples, callable_samples)
streams = st.lists(st.tuples(st.sampled_from((0, 1, 1, 2)), happenings), max_size=12)


@property_test(tables(), tables(), streams, many=MANY * 2)
def test_what_is_said_to_fire_fires_then_if_all_stays_as_it_is(
    old: Table, new: Table, stream: list[Any]
) -> None:
    """And of what compares values and fires then, it was said, or that it was not known."""
    monitor, newest = LiveLoop(old), {}
    for gap, (topic, message) in stream:
        monitor.say(topic, message, gap * GRID)
        if topic in monitor.loop.table.by_topic:
            newest[topic.removeprefix("/")] = message
    compiled = compile_table(new)
    now = monitor.now_ns * 1e-9
    rates = dict.fromkeys(newest, 8.0)
    found = outlook(monitor.loop.table, monitor.loop.state, compiled, now, rates=rates)
    monitor.apply(new)
    begun = monitor.now_ns * 1e-9 + GRID
    for count in range(16):
        for number, (topic, message) in enumerate(newest.items()):
            monitor.say(topic, message, 0 if number else GRID)
        if not newest:
            monitor.pass_time(monitor.now_ns + NS // 8)
        assert count or monitor.now_ns * 1e-9 == pytest.approx(begun, abs=ROUND)
    first: dict[str, float] = {}
    for firing, revision in monitor.fired:
        if revision > 1:
            first.setdefault(firing.rule_id, firing.at - begun)
    said = {each.rule_id: each for each in found.prospects}
    for made in new.rules:
        event = made.event
        if made in old.rules or any(not _lasts(leaf) for _, leaf in leaves(event.condition)):
            continue
        prospect = said.get(made.id)
        if prospect is not None and prospect.seconds is not None and event.hold < 1.5:
            assert first[made.id] == pytest.approx(prospect.seconds, abs=ROUND)
        if first.get(made.id, 9.0) <= event.hold + ROUND and event.trigger != "change":
            assert prospect is not None


def _lasts(leaf: Any) -> bool:
    return isinstance(leaf, Compare)
