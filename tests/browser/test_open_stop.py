"""Whoever is locked out stops the robot all the same."""

import re

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import UNCOVERED
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import TOKEN, Stack

pytestmark = pytest.mark.browser


def stopped_by(robot: Robot) -> str:
    """Who has stopped the robot, once another client than the console has heard of it."""
    wait_until(lambda: robot.newest["/drive_state"].stopped, 5.0, "that the robot is stopped")
    return str(robot.newest["/drive_state"].stopped_by)


@pytest.mark.parametrize(("width", "height"), [(1120, 640), (390, 700)], ids=["desk", "phone"])
def test_the_log_in_page_stops_the_robot_and_cannot_release_it(
    new_page: OpenPage, robot: Robot, width: int, height: int
) -> None:
    page = new_page(width, height)
    page.page.goto(page.origin)
    button = page.get("stop-button")
    expect(button).to_have_attribute("data-phase", "idle")
    assert button.evaluate(UNCOVERED)
    submit, stop = page.get("login-submit").bounding_box(), button.bounding_box()
    assert submit is not None
    assert stop is not None
    assert submit["y"] + submit["height"] <= stop["y"]
    button.click()
    expect(button).to_have_attribute("data-phase", "stopped")
    assert stopped_by(robot) == "somebody at 127.0.0.1"
    expect(page.get("stop-band")).to_contain_text("until an operator has logged in")
    assert page.get("release-button").count() == 0
    page.keep(f"open-stop-{width}")
    robot.release()
    expect(button).to_have_attribute("data-phase", "idle")


def test_a_blank_in_a_password_is_no_stop_and_ctrl_space_is(
    new_page: OpenPage, robot: Robot
) -> None:
    page = new_page()
    page.page.goto(page.origin)
    expect(page.get("stop-button")).to_have_attribute("data-phase", "idle")
    page.get("login-token").press_sequentially("four words of mine")
    expect(page.get("login-token")).to_have_value("four words of mine")
    assert not robot.newest["/drive_state"].stopped
    page.page.keyboard.press("Control+Space")
    expect(page.get("stop-button")).to_have_attribute("data-phase", "stopped")
    assert stopped_by(robot) == "somebody at 127.0.0.1"


def test_a_page_whose_session_has_ended_keeps_its_stop(new_page: OpenPage, robot: Robot) -> None:
    page = new_page()
    page.open_flat(TOKEN)
    # Nothing has told the page yet: its sockets are open, and its requests are a stranger's.
    page.page.context.clear_cookies()
    page.get("stop-button").click()
    expect(page.get("stop-button")).to_have_attribute("data-phase", "stopped")
    assert stopped_by(robot) == "somebody at 127.0.0.1"


def test_who_is_logged_out_elsewhere_finds_stop_beside_the_log_in(
    new_page: OpenPage, stack: Stack, robot: Robot
) -> None:
    page = new_page()
    page.open_flat(TOKEN)
    page.page.context.request.post(f"{stack.url}/api/logout", headers={"Origin": stack.url})
    expect(page.get("login-token")).to_be_visible()
    page.page.get_by_role("heading", name=re.compile("Kompass")).click()  # out of the text field
    page.page.keyboard.press("Space")
    expect(page.get("stop-button")).to_have_attribute("data-phase", "stopped")
    assert stopped_by(robot) == "somebody at 127.0.0.1"


def test_a_console_that_does_not_answer_is_told_beside_the_button(new_page: OpenPage) -> None:
    page = new_page()
    page.page.goto(page.origin)
    expect(page.get("stop-button")).to_have_attribute("data-phase", "idle")
    page.page.context.set_offline(True)
    page.get("stop-button").click()
    expect(page.get("stop-button")).to_have_attribute("data-phase", "unconfirmed")
    expect(page.get("stop-unconfirmed")).to_contain_text("STOP is sent again until it does.")
    page.page.context.set_offline(False)
