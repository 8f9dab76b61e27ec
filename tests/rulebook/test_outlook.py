"""What is true now is said before a table is applied, with when it fires; and it does fire then."""

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import strategies as st

from kompass.rulebook.outlook import Newest, Outlook, acts, outlook
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.explain import verdict_at
from kompass.rules.engine.firing import Sample
from kompass.rules.engine.migration import migrate_state
from kompass.rules.engine.step import step
from kompass.rules.schema.actions import (
    CallService,
    Lifecycle,
    Log,
    Method,
    RaiseAlarm,
    SendGoal,
    UpdateParameters,
)
from kompass.rules.schema.conditions import CallableCondition, Compare, Rate, leaves, timeout_of
from kompass.rules.schema.table import Rule, Table
from tests.backtest.live_loop import NS, LiveLoop
from tests.rules.building import (
    Robot,
    absent,
    both,
    changed,
    compare,
    either,
    opposite,
    received,
    rule,
)
from tests.rules.strategies import GRID, TOPICS, callable_samples, messages, samples, tables
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
        rule(both(compare("a", ">", 1), received("a"))),
        rule(absent("a", 2.0)),  # it speaks ten times a second
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


@pytest.mark.parametrize(
    ("made", "fires", "text"),
    [
        (rule(received("a")), "with a message", "fires with the next message on /a"),
        (
            rule(both(received("a"), compare("a", "<", 1)), trigger="edge"),
            "with a message",
            "fires with the next message on /a",
        ),
        (
            rule(either(received("a"), compare("a", ">", 1))),
            "with a message",
            "fires with the next message on /a",
        ),
        (
            rule(both(changed("a"), compare("a", "<", 1))),
            "with a message",
            "fires with the next message on /a that brings another value",
        ),
        (
            rule(compare("a", "<", 1), trigger="change"),
            "with a message",
            "true now; it fires when a value changes",
        ),
        (
            rule(both(received("a"), compare("b", "<", 1))),
            "unknown",
            "not known yet whether it is true now: nothing received on b yet",
        ),
    ],
)
def test_what_a_message_makes_true_is_said_of_topics_that_speak_and_of_no_others(
    made: Rule, fires: str, text: str
) -> None:
    (prospect,) = look(watching("a"), made, rates={"a": 10.0}).prospects
    assert (prospect.fires, prospect.text) == (fires, text)
    if fires == "with a message" and made.event.trigger != "change":
        assert told(watching("a"), made, rates={}) == []


def test_what_a_message_makes_true_is_said_first() -> None:
    made = rule(received("a"), "any", name="Any", actions=(STOP,))
    found = look(watching("a"), made, rates={"a": 10.0})
    expected = "'Any' fires with the next message on /a (call /drive_manager/stop)"
    assert (found.text, found.prospects[0].acts) == (expected, True)


@pytest.mark.parametrize(
    ("made", "text"),
    [
        (
            rule(absent("a", 60.0)),
            "will be true: it will fire in 3.0 s after Apply if /a stays silent",
        ),
        (
            rule(either(absent("a", 60.0), compare("a", ">", 1))),
            "will be true: it will fire in 3.0 s after Apply if /a stays silent",
        ),
        (
            rule(absent("a", 60.0), trigger="edge", first_true_is_edge=False),
            "will be true: it will fire in 3.0 s after Apply if /a stays silent",
        ),
        (
            rule(both(absent("a", 60.0), received("b"))),
            "will be true: it will fire in 3.0 s after Apply with a message on /b "
            "if /a stays silent",
        ),
        (rule(absent("a", 57.0)), "true now: it will fire at once after Apply"),
    ],
)
def test_a_silence_that_lasts_already_is_counted_from_the_last_message(
    made: Rule, text: str
) -> None:
    robot = watching("a", "b")
    robot.wait(57.0)
    robot.say("b", 0.41)
    assert told(robot, made, rates={"b": 10.0}) == [text]


def test_a_silence_that_ends_too_late_for_an_old_value_is_no_matter() -> None:
    robot = watching("a", "b")
    made = rule(both(absent("a", 3.0), compare("b", "<", 1, timeout=1.0)))
    assert told(robot, made, rates={}) == []
    assert told(robot, made, rates={"b": 10.0}) != []


def test_an_element_that_is_not_there_is_silent_on_a_topic_that_speaks() -> None:
    text = "will be true: it will fire in 2.0 s after Apply if a.items[9] stays silent"
    assert told(watching("a"), rule(absent("a", 2.0, "items", 9))) == [text]


def test_what_was_heard_for_the_check_alone_is_silent_from_apply_on() -> None:
    robot = watching("a")
    robot.wait(10.0)
    made, message = rule(absent("map", 2.0)), SimpleNamespace(x=0.41)
    latched = {"map": Newest(message, 5.0, comes=True)}
    text = "will be true: it will fire in 2.0 s after Apply if /map stays silent"
    assert told(robot, made, heard=latched) == [text]
    assert told(robot, made, heard={"map": Newest(message, 9.9, True, rate=10.0)}) == []
    arrives = "fires with the next message on /map"
    assert told(robot, rule(received("map")), heard=latched) == [arrives]
    assert told(robot, rule(changed("map")), heard=latched) == []


def test_a_changed_rule_whose_actions_run_may_be_dropped() -> None:
    robot = Robot(rule(compare("a", "<", 1), trigger="edge"), finish=False)
    robot.say("a", 0.41)
    expected = "true now: it will fire at once after Apply, unless its actions are still running"
    assert told(robot, rule(compare("a", "<", 2))) == [f"{expected} then"]
    (text,) = told(robot, rule(compare("a", "<", 2), mode={"kind": "restart"}))
    assert text == "true now: it will fire at once after Apply"


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
        tested = [leaf for _, leaf in leaves(event.condition)]
        if made in old.rules or not all(map(_lasts, tested)):
            continue
        prospect = said.get(made.id)
        if prospect is not None and prospect.seconds is not None and event.hold < 1.5:
            # A value that grows too old has its rules looked at before a message does.
            early = GRID if any(map(timeout_of, tested)) else 0.0
            late = first[made.id] - prospect.seconds
            assert -early - ROUND <= late <= ROUND
        if first.get(made.id, 9.0) <= event.hold + ROUND and event.trigger != "change":
            assert prospect is not None


def _lasts(leaf: Any) -> bool:
    return isinstance(leaf, Compare)


SOON = NS  # after it was applied
# Grid steps between two messages of a topic, and what they say in turn; 0 for one that fell silent.
speaking = st.tuples(st.sampled_from((0, 1, 1, 2, 4)), st.lists(messages, min_size=1, max_size=2))


@property_test(
    tables(), tables(), st.tuples(speaking, speaking, speaking), st.integers(0, 24), many=MANY * 4
)
def test_nothing_fires_in_the_next_second_of_which_nothing_was_said(
    old: Table, new: Table, topics: Any, silent: int
) -> None:
    """Unless a value is another than at the check, which nobody can know."""
    monitor = LiveLoop(old)
    newest: dict[str, Newest] = {}
    world = dict(zip(TOPICS, topics, strict=True))

    def go_on(begin: int, end: int) -> None:
        for count in range(begin, end):
            monitor.pass_time(NS + count * NS // 8)
            for name, (period, said) in world.items():
                if count % period == 0 if period else count == 0:
                    message = said[count // (period or 1) % len(said)]
                    monitor.say(name, message, 0)
                    rate = 8.0 / period if period else 0.0
                    newest[name] = Newest(message, monitor.now_ns * 1e-9, bool(rate), rate)

    go_on(0, 2 + silent)
    table, state = monitor.loop.table, monitor.loop.state
    rates = {name: each.rate for name, each in newest.items() if name in table.by_topic}
    compiled = compile_table(new)
    heard = {
        name: each for name, each in newest.items() if name not in table.by_topic and each.rate
    }
    now = monitor.now_ns * 1e-9
    found = outlook(table, state, compiled, now, rates=rates, heard=heard)
    then, _ = migrate_state(table, state, compiled, now)
    for name, each in heard.items():
        step(compiled, then, Sample(name, each.message), now)
    monitor.apply(new)
    until = monitor.now_ns + SOON
    go_on(2 + silent, 2 + silent + 8)
    said = {each.rule_id for each in found.prospects}
    for firing, revision in monitor.fired:
        made = compiled.by_id.get(firing.rule_id)
        if revision == 1 or made is None or made.rule in old.rules or firing.at * NS > until:
            continue
        before = {
            path: verdict_at(compiled, then, compiled.leaves[index], now)
            for path, index in made.leaves
            if isinstance(compiled.leaves[index].condition, Compare | Rate | CallableCondition)
        }
        if all(before.get(leaf.path, leaf.verdict) is leaf.verdict for leaf in firing.leaves):
            assert firing.rule_id in said
