"""Fallbacks are tried in their order, stop when there is health, and begin anew."""

from kompass.actions import Action
from kompass.components import DriveManager
from kompass.recipe.fallbacks import FallbackSequence
from kompass.recipe.table import recipe_rules
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.firing import Sample, Tick
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.actions import Log

A, B, LAST = Log(text="a"), Log(text="b"), Log(text="last")


def tries(ladder: FallbackSequence, count: int) -> list[str]:
    return [getattr(ladder.next(), "text", "-") for _ in range(count)]


def test_a_single_action_without_a_limit_is_tried_for_ever() -> None:
    assert tries(FallbackSequence((A,), None), 5) == ["a"] * 5


def test_a_list_is_gone_through_once_and_then_given_up() -> None:
    assert tries(FallbackSequence((A, B), None, (LAST,)), 5) == ["a", "b", "last", "-", "-"]


def test_each_action_is_tried_as_often_as_allowed() -> None:
    assert tries(FallbackSequence((A, B), 2), 5) == ["a", "a", "b", "b", "-"]


def test_health_resets_the_counts() -> None:
    ladder = FallbackSequence((A,), 1)
    assert tries(ladder, 2) == ["a", "-"]
    ladder.reset()
    assert tries(ladder, 2) == ["a", "-"]


def test_on_fail_fires_for_any_failure_that_lasts_and_not_for_health() -> None:
    driver = DriveManager()
    driver.on_fail(action=Action(driver.restart))
    made = recipe_rules({}, [driver])
    table = compile_table(made.table)
    message = driver.status_topic.ros_msg_type
    for level, expected in (
        (0, []),
        (1, ["drive-manager-on-fail"]),
        (3, ["drive-manager-on-fail"]),
    ):
        state = initial_state(table, 0.0)
        fired = []
        for tenth in range(20):
            sample = Sample("drive_manager/status", message(status=level))
            state, out = step(table, state, sample, tenth / 10)
            fired += [firing.rule_id for firing in out]
        state, out = step(table, state, Tick(), 2.0)
        assert sorted(set(fired)) == expected


def test_waiting_for_inputs_after_a_restart_is_no_recovery() -> None:
    driver = DriveManager()
    driver.on_fail(action=Action(driver.restart), max_retries=1)
    table = compile_table(recipe_rules({}, [driver]).table)
    message = driver.status_topic.ros_msg_type
    state = initial_state(table, 0.0)
    healthy_for = driver.config.topic_subscription_timeout + 1.0
    fired = []
    for tenth in range(round(10 * healthy_for)):
        level = 3 if tenth < 15 else 0
        state, out = step(
            table, state, Sample("drive_manager/status", message(status=level)), tenth / 10
        )
        fired += [firing.rule_id for firing in out]
    assert fired == ["drive-manager-on-fail"]
    for tenth in range(round(10 * healthy_for), round(10 * healthy_for) + 60):
        state, out = step(
            table, state, Sample("drive_manager/status", message(status=0)), tenth / 10
        )
        fired += [firing.rule_id for firing in out]
    assert fired == ["drive-manager-on-fail", "drive-manager-recovered"]
