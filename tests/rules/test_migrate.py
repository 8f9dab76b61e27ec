"""Another table, put in force while the robot drives."""

import pytest

from tests.rules.building import Robot, absent, both, compare, received, rule, slower


def test_the_answer_says_what_became_of_each_rule() -> None:
    robot = Robot(
        rule(received("a"), "same"), rule(received("a"), "edited"), rule(received("a"), "gone")
    )
    result = robot.swap(
        rule(received("a"), "new"),
        rule(received("a"), "edited", cooldown=1.0),
        rule(received("a"), "same", name="renamed", note="but not changed"),
    )
    assert (result.carried, result.reset) == (("same",), ("edited",))
    assert (result.removed, result.added) == (("gone",), ("new",))


def test_a_cooldown_goes_on_across_the_swap() -> None:
    kept = rule(received("a"), "kept", cooldown=10.0)
    robot = Robot(kept)
    robot.say("a", at=0.0)
    robot.swap(rule(received("a"), "new"), kept, at=5.0)
    assert robot.say("a", at=9.999) == ["new"]
    assert robot.say("a", at=10.0) == ["new", "kept"]


def test_a_hold_goes_on_across_the_swap() -> None:
    kept = rule(compare("a", "<", 1, timeout=None), "kept", hold=2.0)
    robot = Robot(kept)
    robot.say("a", 0, at=0.0)
    robot.swap(rule(received("b"), "new"), kept, at=1.5)
    assert robot.deadline() == 2.0
    assert robot.wait(2.0) == ["kept"]


def test_a_hold_that_ended_during_the_swap_fires_at_its_moment() -> None:
    kept = rule(compare("a", "<", 1, timeout=None), "kept", hold=2.0)
    robot = Robot(kept)
    robot.say("a", 0, at=0.0)
    robot.swap(kept, at=2.25)
    assert robot.wait(2.3) == ["kept"]
    assert robot.firings[0].at == 2.0


def test_no_message_is_handled_again_by_the_new_table() -> None:
    robot = Robot(rule(compare("a", ">", 1), "r"))
    assert robot.say("a", 2, at=0.0) == ["r"]
    robot.swap(rule(compare("a", ">", 1), "r", cooldown=0.5), rule(compare("a", ">", 0), "new"))
    assert robot.wait(0.9) == []
    assert robot.say("a", 2, at=1.0) == ["r", "new"]


def test_an_edge_that_was_seen_is_not_seen_again() -> None:
    kept = rule(compare("a", ">", 1), "kept", trigger="edge")
    robot = Robot(kept)
    robot.say("a", 2)
    robot.swap(kept, rule(received("b"), "new"))
    assert robot.say("a", 3) == []


def test_a_new_edge_rule_whose_condition_is_true_already_fires_with_the_next_message() -> None:
    robot = Robot()
    robot.swap(rule(received("a"), "other"))
    robot.say("a", 2)
    robot.swap(rule(compare("a", ">", 1), trigger="edge"))
    assert robot.say("a", 2) == ["r"]


def test_a_new_rule_knows_the_values_that_were_received_before_it() -> None:
    robot = Robot(rule(compare("mode", "==", 0, timeout=None), "old"))
    robot.say("mode", 3, at=0.0)
    robot.swap(rule(both(compare("a", ">", 1), compare("mode", "==", 3, timeout=None))), at=50.0)
    assert robot.say("a", 2) == ["r"]


def test_a_new_rule_does_not_believe_a_value_that_is_too_old_for_it() -> None:
    robot = Robot(rule(compare("mode", "==", 0, timeout=None), "old"))
    robot.say("mode", 3, at=0.0)
    robot.swap(rule(both(compare("a", ">", 1), compare("mode", "==", 3, timeout=1.0))), at=50.0)
    assert robot.say("a", 2) == []
    assert robot.say("mode", 3) == ["r"]


def test_a_new_watchdog_notices_a_silence_that_lasts_already() -> None:
    robot = Robot(rule(received("scan"), "old"))
    robot.say("scan", at=0.0)
    robot.swap(rule(absent("scan", 5.0)), at=60.0)
    assert robot.wait(60.0) == ["r"]


def test_a_second_watchdog_notices_the_silence_that_the_first_has_seen() -> None:
    first = rule(absent("scan", 5.0), "first")
    robot = Robot(first)
    assert robot.wait(5.0) == ["first"]
    robot.swap(first, rule(absent("scan", 5.0), "second"), at=6.0)
    assert robot.wait(6.0) == ["second"]


def test_a_new_watchdog_waits_its_time_for_a_topic_that_never_spoke() -> None:
    robot = Robot()
    robot.swap(rule(absent("scan", 5.0)), at=60.0)
    assert robot.wait(64.9) == []
    assert robot.wait(65.0) == ["r"]


def test_a_new_rate_is_unknown_for_one_window() -> None:
    robot = Robot(rule(received("scan"), "old"))
    robot.say("scan", at=0.0)
    robot.swap(rule(slower("scan", 5.0)), at=60.0)
    assert robot.wait(60.99) == []
    assert robot.wait(61.0) == ["r"]


def test_a_changed_rule_is_busy_until_the_run_of_its_old_version_ends() -> None:
    robot = Robot(rule(received("a")), rule(received("b"), "gone"), finish=False)
    robot.say("a")
    robot.say("b")
    result = robot.swap(rule(received("a"), cooldown=1.0))
    assert result.running == (("r", 1), ("gone", 2))
    assert robot.say("a", at=1.0) == []
    robot.done(robot.firings[0], at=2.0)
    robot.done(robot.firings[1], at=2.0)
    assert robot.say("a", at=3.0) == ["r"]


def test_run_ids_are_never_given_twice() -> None:
    robot = Robot(rule(received("a")))
    robot.say("a")
    robot.swap(rule(received("a"), "other"))
    robot.say("a")
    assert [f.run_id for f in robot.firings] == [1, 2]


def test_switching_a_rule_off_is_remembered_as_a_reset() -> None:
    robot = Robot(rule(received("a")))
    assert robot.swap(rule(received("a"), enabled=False)).reset == ("r",)
    assert robot.say("a") == []
    robot.swap(rule(received("a")))
    assert robot.say("a") == ["r"]


def test_counters_of_a_carried_rule_go_on() -> None:
    kept = rule(compare("a", ">", 1), "kept")
    robot = Robot(kept)
    for x in (0, 2, 2):
        robot.say("a", x)
    robot.swap(rule(compare("a", ">", 1), "new"), kept)
    robot.say("a", 2)
    assert robot.counters("kept")[:3] == (4, 3, 3)
    assert robot.counters("new")[:3] == (1, 1, 1)


def test_the_old_state_is_left_as_it_was() -> None:
    robot = Robot(rule(received("a"), cooldown=1.0))
    robot.say("a", at=0.0)
    old_table, old_state = robot.table, robot.state
    robot.swap(rule(received("a"), cooldown=1.0), at=0.5)
    robot.say("a", at=2.0)
    robot.table, robot.state = old_table, old_state
    assert robot.say("a", at=0.9) == []
    assert robot.counters().fired == 1


def test_resetting_a_rule_that_is_not_there_is_refused() -> None:
    robot = Robot(rule(received("a")))
    with pytest.raises(KeyError, match="nobody"):
        robot.swap(rule(received("a")), reset=("nobody",))
