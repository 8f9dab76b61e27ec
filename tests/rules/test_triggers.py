"""When a rule fires, and above all when it does not."""

from types import SimpleNamespace
from typing import Any

import pytest

from kompass.rules.engine.firing import Sample
from kompass.rules.schema.actions import Method
from kompass.rules.schema.conditions import CallableCondition, Compare
from kompass.rules.schema.signals import Signal
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
    signal,
)


def test_level_fires_on_each_message_for_which_it_is_true() -> None:
    robot = Robot(rule(compare("a", ">", 1)))
    fired = [robot.say("a", x, at=0.1 * i) for i, x in enumerate([0, 2, 3, 0, 5])]
    assert fired == [[], ["r"], ["r"], [], ["r"]]


def test_twenty_messages_make_twenty_runs() -> None:
    robot = Robot(rule(received("a")))
    assert sum(len(robot.say("a", 1, at=0.01 * i)) for i in range(20)) == 20


def test_a_topic_is_the_same_with_and_without_its_slash() -> None:
    robot = Robot(rule(received("/clicked_point")))
    assert robot.say("/clicked_point") == robot.say("clicked_point") == ["r"]


def test_edge_fires_on_becoming_true_only() -> None:
    robot = Robot(rule(compare("a", ">", 1), trigger="edge"))
    fired = [bool(robot.say("a", x, at=0.1 * i)) for i, x in enumerate([2, 3, 0, 2, 2])]
    assert fired == [True, False, False, True, False]


def test_edge_does_not_count_a_first_true_when_told_so() -> None:
    robot = Robot(rule(compare("a", ">", 1), trigger="edge", first_true_is_edge=False))
    assert [bool(robot.say("a", x)) for x in [2, 3, 0, 2]] == [False, False, False, True]


def test_edge_with_a_second_topic_fires_once_not_five_times() -> None:
    both_high = both(compare("fast", ">", 1), compare("slow", ">", 1, timeout=None))
    robot = Robot(rule(both_high, trigger="edge"))
    fired = []
    for i in range(50):
        fired += robot.say("fast", 2, at=0.1 * i)
        if i % 10 == 0:
            fired += robot.say("slow", 2)
    assert fired == ["r"]


def test_a_value_that_grows_old_and_comes_back_makes_no_edge() -> None:
    robot = Robot(rule(both(compare("fast", ">", 1), compare("slow", ">", 1)), trigger="edge"))
    fired = []
    for i in range(100):  # `slow` speaks every 2 s and counts for 1 s
        fired += robot.say("fast", 2, at=0.1 * i)
        if i % 20 == 0:
            fired += robot.say("slow", 2)
    assert fired == ["r"]


def test_an_argument_from_another_topic_makes_no_edge() -> None:
    action = Method(component="c", method="m", kwargs={"value": "$topic[/b].x"})
    robot = Robot(rule(compare("a", ">", 1), trigger="edge", actions=(action,)))
    fired = []
    for i in range(5):
        fired += robot.say("a", 2, at=i * 0.1) + robot.say("b", i)
    assert fired == ["r"]


def test_an_argument_from_a_slow_topic_is_there_for_every_firing() -> None:
    action = Method(component="c", method="m", kwargs={"value": "$topic[/b].x"})
    robot = Robot(rule(compare("a", ">", 1), actions=(action,)))
    robot.say("b", "slow", at=0.0)
    for i in range(5):
        robot.say("a", 2, at=0.1 * i)
    assert [f.messages["b"].x for f in robot.firings] == ["slow"] * 5


def test_not_over_a_topic_that_never_spoke_does_not_fire() -> None:
    robot = Robot(rule(both(compare("a", ">", 1), opposite(compare("b", ">", 1)))))
    assert robot.say("a", 2) == []
    assert robot.say("b", 0) == ["r"]


def test_an_interlock_does_not_open_when_its_topic_goes_silent() -> None:
    robot = Robot(rule(both(compare("a", ">", 1), opposite(compare("b", ">", 1)))))
    robot.say("b", 5, at=0.0)
    assert [robot.say("a", 2, at=0.1 * i) for i in range(50)] == [[]] * 50


def test_and_of_a_fast_topic_with_a_latched_one_fires() -> None:
    robot = Robot(rule(both(compare("fast", ">", 1), compare("mode", "==", 3, timeout=None))))
    robot.say("mode", 3, at=0.0)
    assert robot.say("fast", 2, at=3600.0) == ["r"]


def test_a_message_and_a_state_fire_once_per_message() -> None:
    healthy = compare("status", "==", 0)
    robot = Robot(rule(both(received("command"), healthy)))
    fired = []
    for i in range(50):
        fired += robot.say("status", 0, at=0.02 * i)
        if i in (10, 30):
            fired += robot.say("command")
    assert fired == ["r", "r"]


def test_old_on_any_and_on_greater_of_the_stamp_are_equivalent() -> None:
    stamp = Signal(
        topic="/clicked_point",
        type="geometry_msgs/msg/PointStamped",
        path=("header", "stamp", "sec"),
    )
    robot = Robot(
        rule(received("clicked_point"), "any"),
        rule(Compare(signal=stamp, operator=">", value=0), "greater"),
    )
    header = SimpleNamespace(stamp=SimpleNamespace(sec=7))
    for i in range(3):
        assert robot.say("clicked_point", at=2.0 * i, header=header) == ["any", "greater"]


def test_change_fires_on_each_new_value_and_never_on_the_first() -> None:
    robot = Robot(rule(changed("a")))
    fired = [bool(robot.say("a", x, at=0.1 * i)) for i, x in enumerate([1, 1, 2, 2, 1])]
    assert fired == [False, False, True, False, True]


def test_a_change_is_noticed_across_a_silence() -> None:
    robot = Robot(rule(changed("a")))
    robot.say("a", 1, at=0.0)
    assert robot.say("a", 2, at=100.0) == ["r"]


def test_change_to_a_value_fires_on_every_change_into_it() -> None:
    robot = Robot(rule(both(changed("a"), compare("a", "==", 3))))
    fired = [bool(robot.say("a", x)) for x in [3, 3, 1, 3, 3, 2, 3]]
    assert fired == [False, False, False, True, False, False, True]


def test_the_change_trigger_needs_the_condition_too() -> None:
    robot = Robot(rule(compare("a", ">", 1), trigger="change"))
    fired = [bool(robot.say("a", x)) for x in [5, 5, 6, 0, 1, 7]]
    assert fired == [False, False, True, False, False, True]


def test_a_slow_drift_is_a_change_and_noise_is_none() -> None:
    robot = Robot(rule(changed("a", deadband=1.0)))
    drift = [bool(robot.say("a", 0.3 * i)) for i in range(8)]
    assert drift == [False, False, False, False, True, False, False, False]
    assert not any(robot.say("a", 1.2 + noise) for noise in (0.9, -0.9, 0.5))


def test_first_any_of_the_labels_and_none_of_them_any_more() -> None:
    def labels(operator: Any) -> Compare:
        return Compare(signal=signal("seen", "labels"), operator=operator, value=("person", "dog"))

    robot = Robot(
        rule(labels("contains_any"), "came", trigger="edge", first_true_is_edge=False),
        rule(labels("not_contains_any"), "went", trigger="edge", first_true_is_edge=False),
    )
    stream = [["car"], ["car", "dog"], ["person"], [], ["car"], ["dog"]]
    fired = [robot.say("seen", labels=found) for found in stream]
    assert fired == [[], ["came"], [], ["went"], [], ["came"]]


def test_hysteresis_rearms_on_the_clear_condition_only() -> None:
    robot = Robot(rule(compare("a", ">", 10), trigger="edge", clear=compare("a", "<", 8)))
    fired = [bool(robot.say("a", x)) for x in [11, 9, 11, 9, 7, 11, 9, 12]]
    assert fired == [True, False, False, False, False, True, False, False]


def test_a_level_rule_with_a_clear_condition_fires_once_per_excursion() -> None:
    robot = Robot(rule(compare("a", ">", 10), clear=received("ack")))
    assert [bool(robot.say("a", 11)) for _ in range(3)] == [True, False, False]
    robot.say("ack")  # while it is still true: nothing to re-arm
    assert robot.say("a", 11) == []
    robot.say("a", 0)
    robot.say("ack")
    assert robot.say("a", 11) == ["r"]


def test_a_callable_condition_is_an_answer_like_a_message() -> None:
    robot = Robot(rule(CallableCondition(name="charger_near"), trigger="edge"))
    answers = [False, True, True, False, True]
    fired = [bool(robot.feed(Sample("callable/charger_near", a), 0.1)) for a in answers]
    assert fired == [False, True, False, False, True]


def test_a_callable_that_is_true_at_the_first_poll_is_an_edge() -> None:
    robot = Robot(rule(CallableCondition(name="f"), trigger="edge"))
    assert robot.feed(Sample("callable/f", True)) == ["r"]


def test_any_of_a_message_and_a_state_fires_on_either() -> None:
    robot = Robot(rule(either(received("stop"), compare("a", ">", 1))))
    assert robot.say("stop") == ["r"]
    assert robot.say("a", 0) == []
    assert robot.say("a", 2) == ["r"]


def test_a_message_of_a_strange_shape_makes_no_rule_fire_and_breaks_none() -> None:
    robot = Robot(rule(compare("a", ">", 1), "number"), rule(received("a"), "any"))
    strange: list[Any] = [3, "text", [], SimpleNamespace(x="5"), SimpleNamespace(x=None)]
    for message in strange:
        assert robot.feed(Sample("a", message)) == ["any"]
    assert robot.say("a", 2) == ["number", "any"]


def test_the_firing_says_what_was_true_and_how_old_it_was() -> None:
    condition = both(compare("a", ">", 1), either(compare("b", "<", 0), absent("c", 0.5)))
    robot = Robot(rule(condition, severity="error", lane="safety"))
    robot.say("b", 3, at=0.25)
    robot.say("a", 2, at=0.75)
    (firing,) = robot.firings
    assert [leaf.path for leaf in firing.leaves] == [(0,), (1, 0), (1, 1)]
    assert [leaf.text for leaf in firing.leaves] == ["a.x > 1", "b.x < 0", "c absent for 0.5 s"]
    assert [leaf.value for leaf in firing.leaves] == [2, 3, 0.75]
    assert [leaf.age for leaf in firing.leaves] == [0.0, 0.5, None]
    assert [leaf.verdict for leaf in firing.leaves] == [True, False, True]
    assert (firing.at, firing.topic, firing.message.x) == (0.75, "a", 2)
    assert (firing.severity.name, firing.lane) == ("ERROR", "safety")
    assert set(firing.messages) == {"a", "b"}


@pytest.mark.parametrize("field", ["name", "type", "topic"])
def test_fields_may_be_called_like_anything(field: str) -> None:
    condition = Compare(signal=signal("joints", field), operator="contains", value="wheel")
    robot = Robot(rule(condition))
    message = SimpleNamespace(**{field: ["arm", "wheel"]})
    assert robot.feed(Sample("joints", message)) == ["r"]
