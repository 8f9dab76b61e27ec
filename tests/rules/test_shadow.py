"""A rule in shadow does all but act; a rule that comes close says so, now and then."""

import pytest

from kompass.rules.engine.firing import Note, RunEnded
from kompass.rules.schema.events import Restart
from tests.rules.building import Robot, both, compare, either, opposite, received, rule

# -- shadow ---------------------------------------------------------------------------------------


def test_a_rule_in_shadow_fires_and_cools_down_as_if_it_had_acted_at_once() -> None:
    shadow = rule(compare("a", "<", 1), "shadow", shadow=True, cooldown=2.0)
    robot = Robot(shadow, rule(compare("a", "<", 1), "real", cooldown=2.0), finish=False)
    assert robot.say("a", 0, at=0.0) == ["shadow", "real"]
    assert [f.shadow for f in robot.firings] == [True, False]
    # The real one still runs; nobody reports the end of the other.
    assert robot.say("a", 0, at=2.0) == ["shadow"]
    assert robot.counters("shadow").running == 0
    assert (robot.counters("shadow").fired, robot.counters("real").dropped) == (2, 1)


def test_a_rule_in_shadow_is_used_up_and_latches_like_any_other() -> None:
    robot = Robot(
        rule(received("a"), "once", shadow=True, once=True),
        rule(received("a"), "often", shadow=True, max_rate={"count": 2, "window": 10.0}),
    )
    fired = [robot.say("a", at=float(n)) for n in range(4)]
    assert fired == [["once", "often"], ["often"], [], []]
    assert [n.kind for n in robot.notes] == ["rate_latched"]


def test_a_rule_in_shadow_cancels_no_run_of_its_days_in_the_light() -> None:
    real = rule(received("a"), "r", mode=Restart())
    robot = Robot(real, finish=False)
    robot.say("a", at=0.0)
    robot.swap(real.model_copy(update={"shadow": True}), at=1.0)
    assert robot.say("a", at=2.0) == ["r"]
    assert robot.firings[-1].cancels == ()
    assert robot.counters().running == 1
    robot.feed(RunEnded("r", robot.firings[0].run_id), 3.0)
    assert robot.counters().running == 0


# -- near misses ----------------------------------------------------------------------------------


def misses(robot: Robot) -> list[tuple[float, str]]:
    return [(note.at, note.text) for note in robot.notes if note.kind == "near_miss"]


def test_a_hold_that_breaks_after_half_its_time_is_a_near_miss_and_an_early_one_is_none() -> None:
    robot = Robot(rule(compare("a", "<", 1, timeout=None), hold=2.0))
    robot.say("a", 0, at=0.0)
    robot.say("a", 5, at=0.9)
    assert misses(robot) == []
    robot.say("a", 0, at=1.0)
    robot.say("a", 5, at=2.5)
    assert misses(robot) == [(2.5, "was true for 1.5 of 2 s, then no longer: a.x < 1")]
    (note,) = robot.notes
    assert [(leaf.value, leaf.verdict) for leaf in note.leaves] == [(5, False)]


def test_a_hold_that_silence_breaks_says_that_it_is_unknown() -> None:
    robot = Robot(rule(compare("a", "<", 1, timeout=1.5), hold=2.0))
    robot.say("a", 0, at=0.0)
    robot.wait(5.0)
    ((at, text),) = misses(robot)
    assert at == pytest.approx(1.5)
    assert text == "was true for 1.5 of 2 s, then no longer: a.x < 1 (unknown)"


def test_a_hold_that_was_long_enough_is_no_near_miss() -> None:
    robot = Robot(rule(compare("a", "<", 1, timeout=None), hold=2.0))
    robot.say("a", 0, at=0.0)
    assert robot.say("a", 5, at=2.0) == ["r"]
    assert misses(robot) == []


def three() -> Robot:
    leaves = [compare(t, "<", 1, timeout=None) for t in "abc"]
    return Robot(rule(both(*leaves), cooldown=1.0))


def test_all_but_one_is_a_near_miss_when_it_comes_to_that() -> None:
    robot = three()
    robot.say("a", 0, at=0.0)
    assert misses(robot) == []
    robot.say("b", 0, at=1.0)
    assert misses(robot) == [(1.0, "all but one were true; wanting: c.x < 1 (unknown)")]
    robot.say("a", 0, at=20.0)
    assert len(robot.notes) == 1  # still the same state of affairs


def test_what_was_true_and_is_no_more_was_no_near_miss() -> None:
    robot = three()
    for topic in "abc":
        robot.say(topic, 0, at=0.0)
    robot.notes.clear()
    robot.say("c", 5, at=20.0)
    assert misses(robot) == []


@pytest.mark.parametrize(
    "condition",
    [
        both(compare("a", "<", 1), compare("b", "<", 1)),
        either(compare("a", "<", 1), compare("b", "<", 1), compare("c", "<", 1)),
        both(received("c"), compare("a", "<", 1), compare("b", "<", 1)),
        compare("a", "<", 1),
    ],
)
def test_with_fewer_than_three_parts_nothing_comes_close(condition: object) -> None:
    robot = Robot(rule(condition))  # type: ignore[arg-type]
    robot.say("a", 0)
    robot.say("b", 5)
    assert misses(robot) == []


def test_parts_that_are_trees_count_as_one() -> None:
    parts = (opposite(compare("a", ">", 1)), either(compare("b", "<", 1), compare("b", ">", 9)))
    robot = Robot(rule(both(*parts, compare("c", "<", 1, timeout=None))))
    robot.say("a", 0)
    robot.say("c", 5)
    robot.say("b", 0)
    assert misses(robot) == [(0.0, "all but one were true; wanting: c.x < 1")]


def test_an_edge_that_is_held_back_is_a_near_miss_of_its_own_sort() -> None:
    edge = rule(compare("a", "<", 1), trigger="edge", cooldown=3.0)
    robot = Robot(edge, finish=False)
    robot.say("a", 0, at=0.0)
    robot.say("a", 5, at=0.1)
    robot.say("a", 0, at=0.2)
    robot.done(robot.firings[0], at=1.0)
    robot.say("a", 5, at=1.1)
    robot.say("a", 0, at=1.5)
    assert misses(robot) == [
        (0.2, "became true, but its actions were still running"),
        (1.5, "became true, but cooled down for 2.5 s more"),
    ]


def test_an_edge_of_a_rule_that_is_used_up_is_a_near_miss() -> None:
    robot = Robot(rule(compare("a", "<", 1), trigger="edge", once=True))
    for at, x in enumerate((0, 5, 0)):
        robot.say("a", x, at=float(at))
    assert misses(robot) == [(2.0, "became true, but fires once only, and had fired")]


def test_a_level_rule_that_cools_down_is_held_back_all_the_time_and_says_nothing() -> None:
    robot = Robot(rule(compare("a", "<", 1), cooldown=3.0))
    for tenth in range(30):
        robot.say("a", 0, at=tenth / 10)
    assert robot.notes == []


def test_the_same_is_said_once_in_ten_seconds_at_most_and_remembered_across_a_swap() -> None:
    flicker = rule(compare("a", "<", 1), trigger="edge", cooldown=1000.0)
    robot = Robot(flicker)
    for second in range(40):
        if second == 20:
            robot.swap(flicker, rule(received("b"), "other"), at=20.0)
        robot.say("a", second % 2, at=float(second))
    assert [at for at, _ in misses(robot)] == [2.0, 12.0, 22.0, 32.0]
    assert all(isinstance(note, Note) and note.rule_id == "r" for note in robot.notes)


def test_a_rule_that_is_used_up_from_the_start_does_not_fire() -> None:
    from kompass.rules.engine.step import initial_state

    robot = Robot(rule(received("a"), "once", once=True), rule(received("a"), "often"))
    robot.state = initial_state(robot.table, 0.0, ("once", "often", "of another table"))
    assert robot.say("a") == ["often"]
