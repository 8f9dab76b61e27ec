"""Cooldown, once, modes and the rate limit: what becomes of a trigger."""

from tests.rules.building import Robot, absent, compare, received, rule


def test_a_cooldown_starts_when_the_actions_finish() -> None:
    robot = Robot(rule(compare("a", ">", 1), cooldown=1.0), finish=False)
    robot.say("a", 2, at=0.0)
    robot.done(robot.firings[0], at=5.0)
    assert robot.say("a", 2, at=5.99) == []
    assert robot.say("a", 2, at=6.0) == ["r"]


def test_one_firing_per_cooldown_under_a_stream_of_100_hz() -> None:
    robot = Robot(rule(compare("status", "==", 1), cooldown=60.0))
    fired = sum(len(robot.say("status", 1, at=0.01 * i)) for i in range(18_100))
    assert fired == 4  # at 0, 60, 120 and 180 s
    assert robot.counters().dropped == 18_100 - 4


def test_once_means_once_even_if_it_fails() -> None:
    robot = Robot(rule(received("a"), once=True), finish=False)
    robot.say("a")
    robot.done(robot.firings[0], ok=False)
    assert [robot.say("a") for _ in range(5)] == [[]] * 5
    counters = robot.counters()
    assert (counters.fired, counters.failed, counters.error) == (1, 1, "broken")


def test_single_drops_and_counts_while_it_runs() -> None:
    robot = Robot(rule(received("a")), finish=False)
    for _ in range(4):
        robot.say("a")
    assert (robot.counters().fired, robot.counters().dropped) == (1, 3)
    assert robot.counters().running == 1


def test_an_edge_while_it_runs_is_dropped_counted_and_explained() -> None:
    robot = Robot(rule(compare("a", ">", 1), trigger="edge"), finish=False)
    for x in (2, 0, 2):
        robot.say("a", x)
    robot.done(robot.firings[0])
    assert robot.say("a", 2) == []
    assert robot.counters().dropped == 1
    assert [gate.kind for gate in robot.explain().gates] == ["not_armed"]


def test_queued_runs_one_after_the_other_each_with_its_own_message() -> None:
    robot = Robot(rule(received("a"), mode={"kind": "queued", "size": 2}), finish=False)
    for x in range(4):
        robot.say("a", x, at=float(x))
    assert (robot.counters().waiting, robot.counters().dropped) == (2, 1)
    for n in range(3):
        robot.done(robot.firings[n], at=10.0 + n)
    assert [f.message.x for f in robot.firings] == [0, 1, 2]
    assert [f.triggered_at for f in robot.firings] == [0.0, 1.0, 2.0]
    assert [f.at for f in robot.firings] == [0.0, 10.0, 11.0]


def test_what_waits_in_the_queue_waits_for_the_cooldown_too() -> None:
    queued = {"kind": "queued", "size": 5}
    robot = Robot(rule(received("a"), mode=queued, cooldown=2.0), finish=False)
    robot.say("a", at=0.0)
    robot.say("a", at=0.0)
    robot.done(robot.firings[0], at=1.0)
    assert robot.wait(1.5) == []
    assert robot.deadline() == 3.0
    assert robot.wait(2.99) == []
    assert robot.wait(3.0) == ["r"]


def test_restart_cancels_the_run_in_progress() -> None:
    robot = Robot(rule(received("a"), mode={"kind": "restart"}), finish=False)
    robot.say("a")
    robot.say("a")
    first, second = robot.firings
    assert second.cancels == (first.run_id,)
    assert robot.counters().running == 1
    robot.done(first)  # the end of a cancelled run is no end
    assert robot.counters().running == 1


def test_parallel_runs_as_many_as_it_may() -> None:
    robot = Robot(rule(received("a"), mode={"kind": "parallel", "size": 2}), finish=False)
    for _ in range(3):
        robot.say("a")
    assert (robot.counters().running, robot.counters().dropped) == (2, 1)
    robot.done(robot.firings[0])
    assert robot.say("a") == ["r"]


def test_firing_too_often_latches_and_says_so_once() -> None:
    robot = Robot(rule(received("a"), max_rate={"count": 3, "window": 1.0}, severity="error"))
    fired = [bool(robot.say("a", at=0.1 * i)) for i in range(6)]
    assert fired == [True, True, True, False, False, False]
    (note,) = robot.notes
    assert (note.kind, note.rule_id, note.severity.name) == ("rate_latched", "r", "ERROR")
    assert robot.say("a", at=100.0) == []  # it stays off until somebody resets it
    robot.swap(robot.table.rules[0].rule, reset=("r",))
    assert robot.say("a", at=101.0) == ["r"]


def test_as_often_as_allowed_does_not_latch() -> None:
    robot = Robot(rule(received("a"), max_rate={"count": 2, "window": 1.0}))
    assert all(robot.say("a", at=0.5 * i) for i in range(20))
    assert robot.notes == []


def test_twelve_slow_rules_delay_no_other() -> None:
    slow = [rule(received("a"), f"slow{i}", cooldown=3.0) for i in range(12)]
    robot = Robot(*slow, rule(received("stop"), "emergency", lane="safety"), finish=False)
    robot.say("a", at=0.0)
    assert robot.say("stop", at=0.001) == ["emergency"]
    assert robot.firings[-1].at == 0.001


def test_the_end_of_a_run_that_nobody_knows_changes_nothing() -> None:
    robot = Robot(rule(received("a"), cooldown=5.0), finish=False)
    robot.say("a", at=0.0)
    robot.done(robot.firings[0]._replace(run_id=77), at=1.0)
    robot.done(robot.firings[0]._replace(rule_id="nobody"), at=1.0)
    assert robot.counters().running == 1


def test_a_disabled_rule_never_fires() -> None:
    robot = Robot(rule(received("a"), enabled=False), rule(absent("b", 1.0), "s", enabled=False))
    assert robot.say("a") == []
    assert robot.wait(10.0) == []
    assert robot.counters().evaluated == 0


def test_counters_count_messages_that_were_never_looked_at() -> None:
    robot = Robot(rule(compare("a", ">", 100), "never"), rule(compare("a", ">", 1), trigger="edge"))
    for x in (0, 5, 6, 7, 0, 5):
        robot.say("a", x)
    assert robot.counters("never")[:3] == (6, 0, 0)
    assert robot.counters()[:3] == (6, 4, 2)
