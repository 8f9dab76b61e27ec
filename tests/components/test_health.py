"""A status tells the truth: a failure shows, stays while it lasts, and takes its sources along."""

from collections.abc import Callable
from typing import Any

from automatika_ros_sugar.msg import ComponentStatus

from kompass.components import Component
from kompass.components.base.health import HEALTHY_TEXT, INACTIVE_TEXT
from tests.components.alive import LATCHED, Alive

Run = Callable[..., Alive]


class Moody(Component):
    """Does in each step what the test wants."""

    def init_variables(self) -> None:
        self.mood: Callable[[Any], None] = lambda health: health.set_healthy()
        self.steps = 0

    def _execution_step(self) -> None:
        self.steps += 1
        self.mood(self.health)


def raises(_health: Any) -> None:
    raise ZeroDivisionError("no such thing")


def last(alive: Alive) -> ComponentStatus:
    alive.wait_until(lambda: alive.statuses, 5, "a status")
    return alive.statuses[-1]


def test_an_exception_in_a_step_is_a_failure_and_the_steps_go_on(run: Run) -> None:
    component = Moody("moody")
    alive = run(component)
    component.mood = raises
    alive.wait_until(lambda: last(alive).status == 2, 5, "a COMPONENT failure")
    assert "ZeroDivisionError: no such thing" in last(alive).msg
    assert list(last(alive).src_components) == ["moody"]
    steps = component.steps
    alive.wait_until(lambda: component.steps > steps + 3, 5, "more steps")
    component.mood = lambda health: health.set_healthy()
    alive.wait_until(lambda: last(alive).status == 0, 5, "health")
    assert list(last(alive).src_components) == []


def test_a_failure_stays_and_is_repeated_though_nothing_is_done_about_it(run: Run) -> None:
    component = Moody("moody")
    alive = run(component)
    component.mood = lambda health: health.set_fail_system(
        topics=["/scan"], message="nothing on /scan"
    )
    alive.wait_until(lambda: last(alive).status == 3, 5, "a SYSTEM failure")
    since = len(alive.statuses)
    alive.wait_until(lambda: len(alive.statuses) > since + 5, 5, "repetitions")
    assert {status.status for status in alive.statuses[since:]} == {3}


def test_one_failure_after_another_keeps_no_sources_of_the_last(run: Run) -> None:
    component = Moody("moody")
    alive = run(component)
    component.mood = lambda health: health.set_fail_system(topics=["/scan"], message="a")
    alive.wait_until(lambda: last(alive).status == 3, 5, "a SYSTEM failure")
    component.mood = lambda health: health.set_fail_algorithm(["Stanley"], "b")
    alive.wait_until(lambda: last(alive).status == 1, 5, "an ALGORITHM failure")
    assert list(last(alive).src_topics) == []
    assert list(last(alive).src_algorithms) == ["Stanley"]


def test_a_late_listener_of_either_name_knows_at_once(run: Run) -> None:
    component = Moody("moody")
    component.config.status_rate = 0.1
    alive = run(component)
    component.mood = raises
    alive.wait_until(lambda: last(alive).status == 2, 5, "a COMPONENT failure")
    heard = [
        alive.hear(ComponentStatus, name, LATCHED) for name in ("moody/status", "moody_status")
    ]
    alive.wait_until(lambda: all(heard), 3, "the latched status")
    assert {message.status for messages in heard for message in messages[:1]} == {2}


def test_one_that_is_stopped_says_again_and_again_that_it_is_inactive(run: Run) -> None:
    component = Moody("moody")
    alive = run(component)
    alive.wait_until(lambda: last(alive).msg == HEALTHY_TEXT, 5, "health")
    assert alive.execute("stop").success
    alive.wait_until(lambda: last(alive).msg == INACTIVE_TEXT, 5, "word that it is inactive")
    since = len(alive.statuses)
    alive.wait_until(lambda: len(alive.statuses) > since + 5, 5, "repetitions")
    assert {status.msg for status in alive.statuses[since:]} == {INACTIVE_TEXT}
    assert alive.execute("start").success
    alive.wait_until(lambda: last(alive).msg == HEALTHY_TEXT, 5, "health")


def test_one_that_failed_and_is_stopped_has_no_failure_that_a_rule_would_answer(run: Run) -> None:
    component = Moody("moody")
    alive = run(component)
    component.mood = raises
    alive.wait_until(lambda: last(alive).status == 2, 5, "a COMPONENT failure")
    assert alive.execute("stop").success
    alive.wait_until(lambda: last(alive).msg == INACTIVE_TEXT, 5, "word that it is inactive")
    assert last(alive).status == 0
    assert list(last(alive).src_components) == []
