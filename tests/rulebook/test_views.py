"""How a rule is doing, and why it fires or does not, in words that a person would use."""

import math
from typing import Any

import pytest

from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.journal import FiringRecord
from kompass.rulebook.schema.status import RuleStatus
from kompass.rulebook.views.views import (
    NO_EXTRAS,
    Extras,
    effect_of,
    explanation_view,
    firing_view,
    leaf_reading,
    rule_status,
    table_view,
)
from kompass.rules.engine.firing import LeafVerdict
from kompass.rules.schema.actions import Log, Python
from kompass.rules.schema.conditions import CallableCondition
from kompass.rules.schema.events import MaxRate
from kompass.rules.schema.table import Rule, Table, rule_hash
from tests.rules.building import (
    Robot,
    absent,
    both,
    compare,
    faster,
    opposite,
    received,
    rule,
)

WALL = 1_000.0


def status(robot: Robot, at: float, extras: Extras = NO_EXTRAS) -> RuleStatus:
    return rule_status(robot.table, robot.state, "r", at, WALL, extras=extras)


def state(robot: Robot, at: float, **extras: Any) -> tuple[str, str, float | None]:
    found = status(robot, at, Extras(**extras))
    return found.state, found.text, found.left


def test_a_rule_passes_through_its_states() -> None:
    robot = Robot(rule(compare("a", "<", 1, timeout=None), hold=2.0, cooldown=60.0), finish=False)
    assert state(robot, 0.0) == ("unknown", "nothing received on a yet", None)
    robot.say("a", 5, at=1.0)
    assert state(robot, 1.0) == ("ready", "the condition is false", None)
    robot.say("a", 0, at=2.0)
    assert state(robot, 3.25) == ("holding", "holding 1.2/2 s", 0.75)
    robot.wait(4.0)
    assert state(robot, 7.0) == ("running", "its actions run, for 3 s", None)
    robot.done(robot.firings[0], at=10.0)
    found, text, left = state(robot, 29.0)
    assert (found, text) == ("cooling", "cools down for 41 s more")
    assert left == pytest.approx(41.0)
    last = status(robot, 29.0)
    assert (last.last_fired, last.fired) == (WALL + 4.0, 1)


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (rule(received("a"), enabled=False), ("disabled", "switched off")),
        (
            rule(received("a"), once=True),
            ("used up", "has fired once; will not fire again until it is reset"),
        ),
        (
            rule(received("a"), max_rate=MaxRate(count=1, window=9.0)),
            ("latched", "fired too often; stays off until it is reset"),
        ),
        (
            rule(compare("a", "<", 1), trigger="edge"),
            ("waiting", "it fires on becoming true, and was not false since it last did"),
        ),
        (
            rule(compare("a", "<", 1), cooldown=9.0, shadow=True),
            ("shadow", "does not act; cools down for 8.5 s more"),
        ),
        (rule(both(compare("a", "<", 1), compare("b", "<", 1))), ("unknown", "nothing received")),
        (rule(opposite(compare("a", "<", 1))), ("ready", "the condition is false")),
        (
            rule(compare("a", "<", 1)),
            ("ready", "the condition is true: it fires with the next message"),
        ),
    ],
)
def test_what_holds_a_rule_back_is_its_state(made: Rule, expected: tuple[str, str]) -> None:
    robot = Robot(made)
    robot.say("a", 0, at=0.0)
    robot.say("a", 0, at=0.1)
    found, text, _ = state(robot, 0.5)
    assert found == expected[0]
    assert text.startswith(expected[1])


@pytest.mark.parametrize(
    ("condition", "text"),
    [
        (compare("a", "<", 1), "a silent for 3 s"),
        (both(compare("a", "<", 1), compare("a", ">", -1)), "a silent for 3 s"),
        (both(compare("b", "<", 1), compare("a", "<", 1)), "b yet; a silent for 3 s"),
        (compare("a", "<", 1, timeout=None), ""),
        (compare("a", "==", "word", timeout=None), 'no usable value: a.x == "word"'),
        (CallableCondition(name="is_low"), "nothing received on is_low yet"),
        (faster("a", 5.0, 30.0), "a not watched for 30 s yet"),
    ],
)
def test_what_is_unknown_is_said_with_the_reason(condition: Any, text: str) -> None:
    robot = Robot(rule(condition))
    robot.say("a", 5, at=1.0)
    found, said, _ = state(robot, 4.0)
    assert (found == "unknown") is bool(text)
    assert text in said


def test_a_rule_that_cannot_work_is_broken_whatever_else() -> None:
    robot = Robot(rule(received("a"), enabled=False))
    extras = {"broken": "/a carries p/msg/Other", "outranked": 2, "last_ok": False}
    assert state(robot, 0.0, **extras) == ("broken", "/a carries p/msg/Other", None)
    found = status(robot, 0.0, Extras(**extras))  # type: ignore[arg-type]
    assert (found.outranked, found.last_ok, found.error) == (2, False, "/a carries p/msg/Other")


@pytest.mark.parametrize(("value", "shown"), [(math.inf, "inf"), (math.nan, "nan"), (0.5, 0.5)])
def test_a_reading_is_json_even_of_what_json_has_no_number_for(value: float, shown: Any) -> None:
    reading = leaf_reading(LeafVerdict((0,), "a.x < 1", value, 0.1, None))
    assert reading.value == shown
    assert reading.model_validate_json(reading.model_dump_json()) == reading


# -- why ------------------------------------------------------------------------------------------


def why(robot: Robot, at: float, **more: Any) -> ExplanationView:
    return explanation_view(robot.table, robot.state, "r", at, WALL, revision=7, **more)


def test_why_not_now_names_every_gate_with_the_time_left() -> None:
    condition = both(compare("a", "<", 1, timeout=None), compare("b", "<", 1))
    robot = Robot(rule(condition, hold=2.0, cooldown=60.0))
    robot.say("a", 5, at=0.0)
    robot.say("b", 0, at=0.5)
    found = why(robot, 1.0)
    assert found.text == "false: a.x < 1"
    assert (found.condition, found.revision, found.time) == ("a.x < 1 and b.x < 1", 7, WALL + 1.0)
    assert [(leaf.value, leaf.verdict) for leaf in found.leaves] == [(5, False), (0, True)]
    robot.say("a", 0, at=1.0)
    gates = [(g.kind, g.text) for g in why(robot, 1.4).gates]
    assert gates == [("hold", "it has been true for 0.4 of 2 s")]
    robot.say("b", 0, at=1.4)
    robot.say("b", 0, at=2.0)
    robot.wait(3.0)
    gates = [(g.kind, g.text) for g in why(robot, 3.5).gates]
    assert gates == [
        ("unknown", "unknown: b silent for 1.5 s"),
        ("cooldown", "it cools down for 60 s more"),
    ]


def test_shadow_and_what_is_broken_are_gates_too() -> None:
    robot = Robot(rule(compare("a", "<", 1), shadow=True))
    robot.say("a", 0)
    found = why(robot, 0.0, extras=Extras(broken="no such topic"))
    assert [g.kind for g in found.gates] == ["broken", "shadow"]
    assert found.status is not None
    assert found.status.state == "broken"


def record_of(robot: Robot) -> FiringRecord:
    """The first firing as an entry of the journal."""
    firing = robot.firings[0]
    return FiringRecord(
        number=4,
        epoch="session",
        run_id=firing.run_id,
        rule_id=firing.rule_id,
        name="",
        kind="shadow" if firing.shadow else "firing",
        time=firing.at + WALL,
        revision=7,
        rule_hash=firing.revision_hash,
        severity="warning",
        topic=firing.topic,
        leaves=tuple(map(leaf_reading, firing.leaves)),
    )


def record_at_once(of: Rule) -> FiringRecord:
    robot = Robot(of)
    robot.say("a", 0, at=1.0)
    return record_of(robot)


def test_a_firing_is_explained_by_what_was_seen_then_and_by_the_rule_of_then() -> None:
    then = rule(compare("a", "<", 0.5), name="low")
    record = record_at_once(then)
    view = firing_view(record, then, current=then)
    assert (view.text, view.changed_since) == ("fired: a.x < 0.5 (was 0); its actions run", False)
    now = then.model_copy(update={"event": rule(compare("a", "<", 9)).event})
    assert firing_view(record, then, current=now).changed_since
    assert firing_view(record, then, current=None).changed_since
    failed = record.model_copy(update={"ok": False, "error": "no server"})
    assert firing_view(failed, then, current=then).text.endswith("its actions failed: no server")
    assert rule_hash(view.rule) == record.rule_hash


def test_a_firing_in_shadow_is_told_from_one_that_acted() -> None:
    quiet = rule(compare("a", "<", 1), shadow=True)
    text = firing_view(record_at_once(quiet), quiet, current=quiet).text
    assert text == "would have fired (shadow): a.x < 1 (was 0)"


def test_time_alone_is_a_reason_too() -> None:
    silent = rule(absent("a", 1.0))
    robot = Robot(silent)
    robot.wait(1.0)
    text = firing_view(record_of(robot), silent, current=silent).text
    assert text == "fired: a absent for 1 s (was 1); its actions run"


# -- the table ------------------------------------------------------------------------------------


def test_a_table_is_shown_with_its_texts_and_what_is_code() -> None:
    condition = CallableCondition(name="f", rate=1.0)
    rules = (
        rule(compare("a", "<", 1), "data", actions=(Log(text="hello"),)),
        rule(compare("a", "<", 1), "calls", actions=(Python(name="shout"),)),
        rule(condition, "asks"),
        rule(compare("a", "<", 1), "clears", clear=condition),
    )
    view = table_view(Table(rules=rules), revision=3, active=4, confirmed=2, robot="tb3")
    assert view.conditions["data"] == "a.x < 1"
    assert view.actions["data"] == ('log "hello"',)
    assert view.hashes["data"] == rule_hash(rules[0])
    assert view.from_recipe == ("calls", "asks", "clears")
    assert view.model_validate_json(view.model_dump_json()) == view


def test_the_effect_of_a_swap_names_each_running_rule_once() -> None:
    robot = Robot(rule(received("a"), mode={"kind": "parallel", "size": 3}), finish=False)
    robot.say("a")
    robot.say("a")
    effect = effect_of(robot.swap(rule(received("b"))))
    assert (effect.reset, effect.running) == (("r",), ("r",))
