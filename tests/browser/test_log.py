"""A person reads the robot's log beside its health, and looks for what matters in it."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.test_places import opened
from tests.support.robot import Robot

pytestmark = pytest.mark.browser

EVIL = "<img src=x onerror=alert(1)> stuck"
TRACEBACK = 'Traceback:\n  File "wheel.py", line 7\n    turn()\nValueError: left'


@pytest.fixture
def logged(robot: Robot) -> Robot:
    """A node that has complained."""
    logger = robot.node.get_logger()
    logger.info("all is well")
    logger.warning(EVIL)
    logger.error(TRACEBACK)
    return robot


def test_complaints_stand_beside_health_and_the_whole_log_is_filtered_and_paused(
    new_page: OpenPage, logged: Robot
) -> None:
    page = opened(new_page, "ava", 1400, 900)
    panel = page.get("log-panel")
    expect(panel).to_contain_text("ValueError: left")
    expect(panel).to_contain_text(EVIL)  # as text
    assert panel.locator("img").count() == 0
    expect(panel).not_to_contain_text("all is well")
    page.get("log-all").click()
    lines = page.get("log-line")
    mine = lines.filter(has_text="independent_tester")
    expect(mine.first).to_contain_text("Traceback")
    expect(mine.first).to_contain_text("ago")
    family = "e => getComputedStyle(e).fontFamily"
    assert "mono" in mine.first.get_by_text("ValueError").evaluate(family)
    assert "mono" not in mine.nth(1).get_by_text("stuck").evaluate(family)
    page.keep("log-desk")

    page.get("log-level").click()
    page.page.get_by_role("option", name="errors only").click()
    expect(mine).to_have_count(1)
    page.get("log-level").click()
    page.page.get_by_role("option", name="everything").click()
    page.get("log-node").click()
    page.page.get_by_role("option", name="independent_tester").click()
    expect(mine).to_have_count(3)
    expect(lines).to_have_count(3)
    page.get("log-text").fill("ALL is")
    expect(lines).to_have_count(1)
    page.get("log-text").fill("no such words")
    expect(page.get("log")).to_contain_text("No line like that.")
    page.get("log-text").fill("")
    expect(lines).to_have_count(3)

    page.get("log-pause").click()
    logged.node.get_logger().error("came while it was paused")
    expect(page.get("log-paused")).to_contain_text("since, of all kinds")
    expect(lines).to_have_count(3)
    page.get("log-pause").click()
    expect(lines.first).to_contain_text("came while it was paused")


def test_on_a_phone_the_log_is_two_taps_away_and_fits(new_page: OpenPage, logged: Robot) -> None:
    page = opened(new_page, "ava", 390, 844)
    page.get("tab-health").tap()
    expect(page.get("log-panel")).to_contain_text("stuck")
    page.get("log-all").tap()
    expect(page.get("log-line").filter(has_text="ValueError").first).to_be_visible()
    page.keep("log-phone")
    assert page.page.evaluate("() => document.documentElement.scrollWidth <= innerWidth")
    stop = page.get("stop-button").bounding_box()
    assert stop is not None
    assert stop["width"] >= 80
