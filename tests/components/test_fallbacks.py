"""What a component does about its own failures is plain data, checked when the recipe is read."""

import math
from typing import Any

import pytest

from kompass.components import Controller, DriveManager, Planner


class Wrapped:
    """What an action of a recipe looks like from here."""

    def __init__(self, method: Any) -> None:
        self.method = method


class Generic:
    """An action without a component: a log entry, a message."""

    def to_data(self) -> dict[str, str]:
        return {"kind": "log"}


class OfComponent(Generic):
    """An action that names its component, as those made from data do."""

    def __init__(self, component: str) -> None:
        self.component = component


def test_a_fallback_is_kept_with_its_number_of_tries() -> None:
    driver = DriveManager()
    action = Wrapped(driver.restart)
    driver.on_fail(action=action)
    driver.on_system_fail([action, Generic()], max_retries=3)
    assert driver.fallbacks.on_fail is not None
    assert driver.fallbacks.on_fail.actions == (action,)
    assert driver.fallbacks.on_fail.max_retries is None
    assert driver.fallbacks.on_system_fail is not None
    assert len(driver.fallbacks.on_system_fail.actions) == 2
    assert driver.fallbacks.on_system_fail.max_retries == 3
    assert driver.fallbacks.on_algorithm_fail is None


@pytest.mark.parametrize("kind", ["fail", "algorithm_fail", "component_fail", "system_fail"])
def test_every_kind_of_failure_has_its_fallback_under_both_keywords(kind: str) -> None:
    planner = Planner()
    getattr(planner, f"on_{kind}")(fallback=planner.restart)
    kept = getattr(planner.fallbacks, f"on_{kind}")
    assert kept.actions == (planner.restart,)


def test_giving_up_is_done_once() -> None:
    planner = Planner()
    planner.on_giveup(Generic())
    assert planner.fallbacks.on_giveup is not None
    assert planner.fallbacks.on_giveup.max_retries == 1


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda _: None, ValueError, "needs an action"),
        (lambda _: [], ValueError, "needs an action"),
        (lambda _: Controller().restart, TypeError, "cannot be an action of 'controller'"),
        (lambda _: OfComponent("controller"), TypeError, "cannot be an action of 'controller'"),
        (lambda _: "restart", TypeError, "is no action; known are"),
        (lambda driver: driver.publish_status, TypeError, "publish_status is not a component"),
    ],
)
def test_what_cannot_be_a_fallback_is_refused(
    make: Any, error: type[Exception], message: str
) -> None:
    driver = DriveManager()
    with pytest.raises(error, match=message):
        driver.on_fail(make(driver))
    assert driver.fallbacks.on_fail is None


NO_NUMBER: Any = math.nan


def test_no_tries_at_all_are_refused() -> None:
    driver = DriveManager()
    with pytest.raises(ValueError, match="max_retries = nan is no whole number"):
        driver.on_fail(driver.restart, max_retries=NO_NUMBER)
    with pytest.raises(ValueError, match="max_retries = 0 is below 1"):
        driver.on_fail(driver.restart, max_retries=0)


def test_fallbacks_of_one_component_are_not_those_of_the_next() -> None:
    driver = DriveManager()
    driver.on_fail(driver.restart)
    assert DriveManager().fallbacks.on_fail is None


def test_an_action_of_its_own_may_be_named_by_the_component() -> None:
    driver = DriveManager()
    driver.on_fail(OfComponent("drive_manager"))
    assert driver.fallbacks.on_fail is not None
