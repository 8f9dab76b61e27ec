"""Why a rule fires or does not: every gate is named, with what is left of it."""

import pytest

from tests.rules.building import Robot, absent, both, compare, opposite, received, rule, slower


def kinds(robot: Robot, at: float | None = None) -> list[str]:
    return [gate.kind for gate in robot.explain(at=at).gates]


def test_a_value_that_was_never_received_is_unknown() -> None:
    robot = Robot(rule(both(compare("a", ">", 1), opposite(compare("b", ">", 1)))))
    robot.say("a", 2, at=1.0)
    explanation = robot.explain(at=1.5)
    assert kinds(robot, at=1.5) == ["unknown"]
    assert explanation.verdict is None
    assert [(leaf.value, leaf.age, leaf.verdict) for leaf in explanation.leaves] == [
        (2, 0.5, True),
        (None, None, None),
    ]


def test_a_value_grows_old_while_nobody_steps() -> None:
    robot = Robot(rule(compare("a", ">", 1)))
    robot.say("a", 2, at=0.0)
    assert kinds(robot, at=1.0) == []
    assert kinds(robot, at=1.1) == ["unknown"]
    assert kinds(robot, at=0.5) == []  # nothing was changed by having looked


def test_a_false_condition_shows_the_value_that_makes_it_false() -> None:
    robot = Robot(rule(compare("scan", "<", 0.3)))
    robot.say("scan", 0.42)
    (leaf,) = robot.explain().leaves
    assert (leaf.text, leaf.value, leaf.verdict) == ("scan.x < 0.3", 0.42, False)
    assert kinds(robot) == ["false"]


@pytest.mark.parametrize(
    ("value", "verdict", "gates"), [(0.2, True, []), (0.4, True, []), (0.5, False, ["false"])]
)
def test_a_band_shows_both_bounds_which_belong_to_it(
    value: float, verdict: bool, gates: list[str]
) -> None:
    robot = Robot(rule(compare("battery", "between", (0.2, 0.4))))
    robot.say("battery", value)
    (leaf,) = robot.explain().leaves
    said = (leaf.text, leaf.value, leaf.verdict)
    assert said == ("0.2 <= battery.x <= 0.4", value, verdict)
    assert kinds(robot) == gates


def test_a_hold_tells_what_is_left_of_it() -> None:
    robot = Robot(rule(compare("a", ">", 1, timeout=None), hold=2.0))
    robot.say("a", 2, at=1.0)
    (gate,) = robot.explain(at=1.5).gates
    assert (gate.kind, gate.left) == ("hold", 1.5)


def test_a_cooldown_tells_what_is_left_of_it() -> None:
    robot = Robot(rule(compare("a", ">", 1, timeout=None), cooldown=60.0))
    robot.say("a", 2, at=10.0)
    (gate,) = robot.explain(at=50.0).gates
    assert (gate.kind, gate.left) == ("cooldown", 20.0)


def test_busy_lasts_until_the_actions_are_done() -> None:
    robot = Robot(rule(compare("a", ">", 1)), finish=False)
    robot.say("a", 2)
    assert kinds(robot) == ["busy"]
    robot.done(robot.firings[0])
    assert kinds(robot) == []


def test_what_never_opens_by_itself_comes_first() -> None:
    robot = Robot(rule(compare("a", ">", 1), once=True))
    robot.say("a", 2)
    robot.say("a", 0)
    assert kinds(robot) == ["once", "false"]


def test_a_latched_rule_says_that_it_waits_for_a_person() -> None:
    robot = Robot(rule(compare("a", ">", 1), max_rate={"count": 1, "window": 1.0}))
    robot.say("a", 2)
    robot.say("a", 2)
    assert kinds(robot) == ["rate_latched"]
    assert "reset" in robot.explain().text


def test_an_edge_that_has_fired_waits_for_false() -> None:
    robot = Robot(rule(compare("a", ">", 1), trigger="edge"))
    robot.say("a", 2)
    assert kinds(robot) == ["not_armed"]


def test_a_rule_with_a_clear_condition_shows_its_leaves_too() -> None:
    robot = Robot(rule(compare("a", ">", 10), trigger="edge", clear=compare("a", "<", 8)))
    robot.say("a", 11)
    robot.say("a", 9)
    explanation = robot.explain()
    assert [leaf.text for leaf in explanation.clear_leaves] == ["a.x < 8"]
    assert [gate.kind for gate in explanation.gates] == ["false", "not_armed"]
    assert "clear condition" in explanation.text


def test_a_disabled_rule_shows_what_it_would_see() -> None:
    robot = Robot(rule(compare("a", ">", 1), enabled=False))
    robot.say("a", 2)
    assert robot.explain().verdict is True
    assert kinds(robot) == ["disabled"]


def test_silence_and_rates_are_told_as_of_now() -> None:
    robot = Robot(rule(both(absent("a", 2.0), slower("b", 5.0))))
    robot.say("a", at=1.0)
    robot.say("b", at=1.0)
    silence, rate = robot.explain(at=4.0).leaves
    assert (silence.value, silence.verdict) == (3.0, True)
    assert (rate.value, rate.verdict) == (0.0, True)
    silence, rate = robot.explain(at=1.5).leaves
    assert (silence.verdict, rate.verdict) == (False, None)


def test_explaining_changes_nothing() -> None:
    robot = Robot(rule(absent("a", 2.0), hold=1.0))
    robot.explain(at=100.0)
    assert robot.wait(3.0) == ["r"]
    assert robot.firings[0].at == 3.0


def test_long_values_are_summed_up() -> None:
    robot = Robot(rule(received("a")))
    robot.say("a", list(range(1000)))
    assert robot.explain().leaves[0].value == "SimpleNamespace"


def test_a_rule_that_does_not_exist_is_a_key_error() -> None:
    with pytest.raises(KeyError, match="nobody"):
        Robot().explain("nobody")


def test_a_rate_counts_a_whole_window_whenever_its_messages_came() -> None:
    robot = Robot(rule(slower("scan", 5.0, window=2.0)))
    for at in (0.0, 9.9997, 9.9998, 9.9999):
        robot.say("scan", at=at)
    (leaf,) = robot.explain(at=10.0).leaves
    assert (leaf.value, leaf.verdict) == (1.5, True), "three that came at once are no 10 kHz"
    for number in range(1, 101):  # 20 Hz, of which the rule needs ten messages to know
        robot.say("scan", at=10.0 + number / 20)
    (leaf,) = robot.explain(at=15.0).leaves
    assert (leaf.value, leaf.verdict) == (20.0, False)


def test_a_rate_beyond_what_is_remembered_is_told_from_what_is() -> None:
    robot = Robot(rule(slower("imu", 5.0, window=10.0)))
    for number in range(4001):
        robot.say("imu", at=number / 400)
    (leaf,) = robot.explain(at=10.0).leaves
    assert leaf.value == pytest.approx(400.0, rel=0.01)
