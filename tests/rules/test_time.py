"""Age, silence, rates and holds, under a virtual clock."""

import pytest

from kompass.rules.engine.compiled_table import needed
from tests.rules.building import (
    Robot,
    absent,
    both,
    compare,
    faster,
    opposite,
    received,
    rule,
    slower,
)


def test_a_value_counts_until_its_timeout_and_no_longer() -> None:
    robot = Robot(rule(both(received("tick"), compare("a", ">", 1, timeout=2.0))))
    robot.say("a", 5, at=1.0)
    assert robot.say("tick", at=3.0) == ["r"]
    assert robot.say("tick", at=3.0001) == []


def test_each_rule_keeps_the_timeout_it_asked_for() -> None:
    robot = Robot(
        rule(both(received("tick"), compare("a", ">", 1, timeout=0.5)), "hasty"),
        rule(both(received("tick"), compare("a", ">", 1, timeout=60.0)), "patient"),
    )
    robot.say("a", 5, at=0.0)
    assert robot.say("tick", at=0.4) == ["hasty", "patient"]
    assert robot.say("tick", at=30.0) == ["patient"]
    assert robot.say("tick", at=61.0) == []


def test_a_rule_held_true_fires_when_the_time_is_up_not_at_the_next_message() -> None:
    robot = Robot(rule(compare("a", "<", 0.3, timeout=None), hold=2.0, trigger="edge"))
    robot.say("a", 0.2, at=1.0)
    assert robot.deadline() == 3.0
    assert robot.wait(2.99) == []
    assert robot.wait(3.0) == ["r"]
    assert robot.wait(10.0) == []


def test_a_late_tick_reports_the_moment_at_which_the_hold_was_over() -> None:
    robot = Robot(rule(compare("a", "<", 0.3, timeout=None), hold=2.0))
    robot.say("a", 0.2, at=1.0)
    robot.wait(3.7)
    assert robot.firings[0].at == 3.0


def test_a_hold_starts_again_after_every_break() -> None:
    robot = Robot(rule(compare("a", "<", 1, timeout=None), hold=1.0))
    for at, x in [(0.0, 0), (0.9, 2), (1.0, 0), (1.9, 2), (2.0, 0)]:
        assert robot.say("a", x, at=at) == []
    assert robot.wait(2.99) == []
    assert robot.wait(3.0) == ["r"]


def test_silence_breaks_a_hold() -> None:
    robot = Robot(rule(compare("a", "<", 1, timeout=0.5), hold=1.0))
    robot.say("a", 0, at=0.0)
    assert robot.wait(5.0) == []
    robot.say("a", 0, at=5.0)
    robot.say("a", 0, at=5.5)
    assert robot.wait(6.0) == ["r"]


def test_a_level_rule_fires_on_each_message_once_held() -> None:
    robot = Robot(rule(compare("a", "<", 1), hold=1.0))
    fired = [len(robot.say("a", 0, at=0.25 * i)) for i in range(8)]
    assert fired == [0, 0, 0, 0, 1, 1, 1, 1]


def test_silence_fires_once_and_again_after_the_next_silence() -> None:
    robot = Robot(rule(absent("scan", 1.0)))
    robot.say("scan", at=0.5)
    assert robot.deadline() == 1.5
    assert robot.wait(1.5) == ["r"]
    assert robot.wait(100.0) == []
    robot.say("scan", at=100.0)
    assert robot.wait(101.0) == ["r"]


def test_a_topic_that_never_spoke_is_silent_from_the_start() -> None:
    robot = Robot(rule(absent("scan", 1.0), "watchdog"))
    assert robot.wait(1.0) == ["watchdog"]


def test_a_topic_that_never_spoke_is_unknown_where_told_so() -> None:
    robot = Robot(rule(absent("scan", 1.0, from_start=False)))
    assert robot.wait(60.0) == []
    robot.say("scan", at=60.0)
    assert robot.wait(61.0) == ["r"]


def test_messages_without_the_value_are_silence() -> None:
    robot = Robot(rule(absent("seen", 1.0, "boxes", 0), trigger="edge"))
    for i in range(10):
        assert robot.say("seen", at=0.1 * i, boxes=["person"]) == []
    fired = []
    for i in range(10, 30):
        fired += robot.say("seen", at=0.1 * i, boxes=[])
    assert fired == ["r"]
    assert robot.firings[0].at == pytest.approx(1.9)


def test_a_fast_topic_costs_no_wake_ups() -> None:
    robot = Robot(rule(absent("scan", 1.0)))
    for i in range(1000):
        robot.say("scan", at=0.001 * i)
    assert len(robot.state.schedule) <= 2
    assert robot.deadline() == pytest.approx(1.999)


def test_a_rate_that_falls_fires_when_the_window_says_so() -> None:
    robot = Robot(rule(slower("scan", 8.0), trigger="edge"))
    for i in range(21):
        assert robot.say("scan", at=0.1 * i) == []
    # 10 Hz until 2.0: at 2.3 the window of 1 s holds 1.4 ... 2.0, seven messages.
    assert robot.wait(2.29) == []
    assert robot.wait(2.31) == ["r"]
    assert robot.firings[0].at == pytest.approx(2.3)


def test_a_rate_is_unknown_before_one_window_has_passed() -> None:
    robot = Robot(rule(slower("scan", 5.0)), rule(opposite(slower("scan", 5.0)), "ok"))
    assert robot.wait(60.0) == []
    robot.say("scan", at=60.0)
    assert robot.wait(60.99) == []
    assert robot.wait(61.0) == ["r"]


def test_a_rate_too_high_fires_on_the_message_that_exceeds_it() -> None:
    robot = Robot(rule(faster("a", 4.0), trigger="edge"))
    for i in range(8):
        assert robot.say("a", at=0.25 * i) == []
    assert robot.say("a", at=1.80) == ["r"]


def test_the_messages_that_a_rate_needs_are_counted_exactly() -> None:
    # 0.1 * 30 is a little more than 3 in floating point, and 3 messages are enough.
    assert needed(0.1, 30.0, above=False) == 3
    assert needed(0.1, 30.0, above=True) == 4
    assert [needed(hz, 1.0, above=False) for hz in (0.3, 1.0, 7.5, 8.0)] == [1, 1, 8, 8]
    assert [needed(hz, 1.0, above=True) for hz in (0.3, 1.0, 7.5, 8.0)] == [1, 2, 8, 9]


def test_two_silences_that_begin_together_are_seen_together() -> None:
    robot = Robot(rule(both(absent("a", 1.0), opposite(absent("b", 1.0))), "only_a"))
    robot.say("a", at=1.0)
    robot.say("b", at=1.0)
    assert robot.wait(10.0) == []


def test_a_clock_that_steps_back_is_no_time_travel() -> None:
    robot = Robot(rule(compare("a", ">", 1), cooldown=1.0))
    assert robot.say("a", 2, at=10.0) == ["r"]
    assert robot.say("a", 2, at=5.0) == []
    assert robot.say("a", 2, at=11.0) == ["r"]


def test_no_deadline_when_nothing_can_happen_by_itself() -> None:
    robot = Robot(rule(compare("a", ">", 1, timeout=None)))
    assert robot.deadline() is None
    robot.say("a", 0)
    assert robot.deadline() is None


def test_what_is_due_happens_before_the_message_that_comes_later() -> None:
    robot = Robot(rule(compare("a", "<", 1, timeout=None), hold=1.0, trigger="edge"))
    robot.say("a", 0, at=0.0)
    assert robot.say("a", 5, at=2.0) == ["r"]
    assert (robot.firings[0].at, robot.firings[0].message.x) == (1.0, 0)
