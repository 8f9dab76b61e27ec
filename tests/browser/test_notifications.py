"""Who looks elsewhere is told by the browser what happens to the robot, if he wants that."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.test_places import opened
from tests.support.robot import Robot

pytestmark = pytest.mark.browser

# Keeps what the browser is told to show; a headless one is never looked away from.
EARS = """
window.told = [];
window.Notification = class extends Notification {
  constructor(title, options) { super(title, options); window.told.push(title); }
};
Object.defineProperty(document, "hidden", { get: () => window.away === true });
"""


def test_somebody_who_looks_elsewhere_is_told_that_the_robot_was_stopped(
    new_page: OpenPage, robot: Robot
) -> None:
    page = opened(new_page, "ava")
    page.page.context.grant_permissions(["notifications"], origin=page.origin)
    page.page.add_init_script(EARS)
    page.page.reload()
    page.get("user-menu").click()
    page.get("notify-item").click()
    page.page.get_by_label("With a sound").check()
    message = page.page.get_by_label("With a message, while I look elsewhere")
    message.click()
    expect(message).to_be_checked()  # once the browser has answered
    page.page.wait_for_function("() => told.length === 1")  # how it will be
    page.page.keyboard.press("Escape")
    page.page.reload()

    expect(page.get("pose")).to_contain_text("m/s")
    page.page.evaluate("() => { window.away = true; }")
    robot.stop()
    page.page.wait_for_function("() => told.some((title) => title.includes('Stopped by tester'))")
    robot.release()
    expect(page.get("stop-band")).to_be_hidden()

    # Not in quiet hours, which this browser keeps, too.
    page.get("user-menu").click()
    page.get("notify-item").click()
    expect(page.page.get_by_label("With a sound")).to_be_checked()
    page.page.get_by_label("Not during quiet hours").check()
    page.page.get_by_label("from").fill("00:00")
    page.page.get_by_label("to", exact=True).fill("23:59")
    page.page.keyboard.press("Escape")
    page.page.evaluate("() => { told.length = 0; }")
    robot.stop()
    expect(page.get("stop-band")).to_be_visible()
    assert page.page.evaluate("() => told") == []
