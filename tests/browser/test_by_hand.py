"""The robot does what the hand on the page does, while it does it, and everybody sees whose."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import FIRST_PICTURE, UNCOVERED, ConsolePage
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import TOKEN

pytestmark = pytest.mark.browser

PHONE = (390, 844)


def opened(new_page: OpenPage, user: str, width: int = 1120, height: int = 640) -> ConsolePage:
    """A page with its panel for driving, and without the scene, which takes a processor."""
    page = new_page(width, height, has_touch=width < 560)
    page.page.route("**/scene/**", lambda route: route.fulfill(body=""))
    login = {"token": TOKEN, "user": user}
    assert page.post("/api/login", login).ok
    page.page.goto(f"{page.origin}/")
    expect(page.get("pose")).to_contain_text("m/s", timeout=FIRST_PICTURE * 1000)
    page.get("hand-tool").click()
    return page


def take(page: ConsolePage) -> None:
    page.get("hand-take").click()
    expect(page.get("hand-stick")).to_be_visible()


def turning(robot: Robot) -> float:
    """How fast it really turns to the left [rad/s]."""
    return float(robot.newest["/simulator/ground_truth"].twist.twist.angular.z)


def stands(robot: Robot) -> None:
    wait_until(lambda: abs(turning(robot)) < 0.01 and robot.speed < 0.01, 5, "a standstill")


def turns(page: ConsolePage, robot: Robot, key: str) -> None:
    """Hold a key until the robot turns; a page that was starved lets go first."""

    def obeys() -> bool:
        if abs(turning(robot)) > 0.2:
            return True
        page.page.keyboard.up(key)
        page.page.wait_for_timeout(400)
        page.page.keyboard.down(key)
        page.page.wait_for_timeout(600)
        return False

    wait_until(obeys, 20, "a turn")


def test_keys_drive_while_they_are_held_and_others_see_who_drives_and_ask(
    new_page: OpenPage, robot: Robot
) -> None:
    ava, ben = opened(new_page, "ava"), opened(new_page, "ben")
    take(ava)
    expect(ava.get("driven-by-bar")).to_have_text("You drive")
    turns(ava, robot, "KeyA")
    assert turning(robot) > 0
    ava.page.keyboard.up("KeyA")
    stands(robot)

    expect(ben.get("driven-by-bar")).to_have_text("Driven by ava")
    assert ben.get("hand-take-over").count() == 0
    ben.get("hand-ask").click()
    expect(ava.get("hand-notice")).to_contain_text("ben asks for the wheel")
    ava.page.keyboard.press("Escape")
    expect(ava.get("hand-take")).to_be_visible()
    take(ben)
    expect(ava.get("driven-by-bar")).to_have_text("Driven by ben")
    ben.page.goto("about:blank")
    wait_until(lambda: not robot.newest["/drive_state"].driven_by, 10, "a free wheel")
    expect(ava.get("driven-by-bar")).to_be_hidden()


def test_a_hand_that_the_page_loses_sight_of_has_let_go(new_page: OpenPage, robot: Robot) -> None:
    page = opened(new_page, "ava")
    take(page)
    turns(page, robot, "ArrowRight")
    page.page.evaluate("() => window.dispatchEvent(new Event('blur'))")
    stands(robot)  # and the key is still down
    page.page.keyboard.up("ArrowRight")
    turns(page, robot, "ArrowRight")
    robot.stop()
    expect(page.get("hand-notice")).to_contain_text("Stopped")
    stands(robot)
    robot.release()
    expect(page.get("hand-notice")).to_contain_text("Let go first")
    stands(robot)
    page.page.keyboard.up("ArrowRight")
    expect(page.get("hand-notice")).not_to_contain_text("Let go first")

    # What lies over the page goes first, and then the wheel.
    page.page.keyboard.press("h")
    expect(page.get("help-panel")).to_be_visible()
    page.page.keyboard.press("Escape")
    expect(page.get("help-panel")).to_be_hidden()
    expect(page.get("hand-stick")).to_be_visible()
    page.page.keyboard.press("Escape")
    expect(page.get("hand-take")).to_be_visible()


def test_the_stick_on_a_phone_covers_neither_the_scene_nor_stop(
    new_page: OpenPage, robot: Robot
) -> None:
    page = opened(new_page, "ava", *PHONE)
    take(page)
    panel, scene = (page.get(one).bounding_box() for one in ("hand-panel", "scene-frame"))
    stick = page.get("hand-stick").bounding_box()
    assert panel is not None
    assert scene is not None
    assert stick is not None
    assert scene["y"] + scene["height"] <= panel["y"] + 1
    assert scene["height"] > 0.5 * PHONE[1]
    assert stick["width"] >= 100
    assert page.get("stop-button").evaluate(UNCOVERED)
    page.get("follow").click()
    expect(page.get("follow")).to_have_attribute("aria-pressed", "true")

    middle = stick["x"] + stick["width"] / 2, stick["y"] + stick["height"] / 2

    def obeys() -> bool:
        page.page.mouse.move(*middle)
        page.page.mouse.down()
        page.page.mouse.move(stick["x"] + 2, middle[1])
        page.page.wait_for_timeout(600)
        if turning(robot) > 0.2:
            return True
        page.page.mouse.up()
        page.page.wait_for_timeout(400)
        return False

    wait_until(obeys, 20, "a turn to the left")
    page.page.mouse.up()
    stands(robot)
    page.get("hand-give").click()
    wait_until(lambda: not robot.newest["/drive_state"].driven_by, 10, "a free wheel")
