"""A person sees that the robot is lost, shows it where it is, and sends it on."""

from __future__ import annotations

import math
import re

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import UNCOVERED, ConsolePage
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import TOKEN

pytestmark = pytest.mark.browser

JUMP = "localizer_jump:0.7"
PHONE = (390, 844)


def lose(robot: Robot, page: ConsolePage) -> None:
    """Have the robot lose its place, and wait until the page warns of it."""
    robot.fault(JUMP)
    expect(page.get("map-fit")).to_have_attribute("data-level", "degraded")


def found(page: ConsolePage) -> None:
    expect(page.get("map-fit")).to_have_attribute("data-level", "healthy")
    expect(page.get("map-fit")).to_have_text(re.compile(r"^map fit (9\d|100) %$"))


@pytest.fixture(autouse=True)
def sound(robot: Robot) -> None:
    """No fault of the test before."""
    robot.fault(JUMP, on=False)


def test_a_lost_robot_is_shown_its_place_with_the_hand_and_drives_on(
    page: ConsolePage, robot: Robot
) -> None:
    found(page)
    expect(page.get("cause-band")).to_be_hidden()
    lose(robot, page)
    expect(page.get("cause-band")).to_contain_text("Set its place")
    expect(page.get("cause-band")).to_contain_text("Scan and map agree")

    floor = page.await_scene()
    x, y, yaw = robot.truth
    x, y = x + 0.15, y - 0.1  # as a hand points
    page.page.keyboard.press("o")
    page.page.mouse.move(*page.pixel(floor, x, y))
    page.page.mouse.down()
    ahead = page.pixel(floor, x + 0.6 * math.cos(yaw), y + 0.6 * math.sin(yaw))
    page.page.mouse.move(*ahead, steps=6)
    expect(page.get("locate-looked")).to_have_text(re.compile(r"^Scan and map agree \d+ % here\.$"))
    page.page.mouse.up()
    card = page.get("locate-card")
    expect(card).to_contain_text(re.compile(r"Scan and map agree (9\d|100) %"))
    expect(card).to_contain_text("from the one you pressed")
    expect(page.get("locate-set")).to_be_focused()
    page.page.keyboard.press("Enter")
    expect(card).to_contain_text("The robot was told")
    found(page)
    expect(page.get("cause-band")).to_be_hidden()
    page.get("locate-done").click()
    expect(page.get("locate-overlay")).to_be_hidden()

    page.pick(page.pixel(floor, 0.55, 0.55))
    page.get("goal-go").click()
    expect(page.get("goal-status")).to_have_attribute(
        "data-phase", "arrived", timeout=patient(60) * 1000
    )
    wait_until(lambda: robot.distance_to(0.55, 0.55) < 0.15, 5, "really there")


def test_on_a_phone_coordinates_will_do_and_a_place_in_a_wall_will_not(
    new_page: OpenPage, robot: Robot
) -> None:
    page = new_page(*PHONE, has_touch=True)
    page.open_flat(TOKEN)
    found(page)
    assert page.get("map-fit").evaluate(UNCOVERED)
    lose(robot, page)
    page.get("locate-tool").click()
    page.get("locate-type").click()
    page.get("coordinate-x").fill("0")
    page.get("coordinate-y").fill("0")
    page.get("coordinate-check").click()
    expect(page.get("locate-card")).to_contain_text("inside an obstacle")
    expect(page.get("locate-set")).to_be_hidden()
    page.get("locate-cancel").click()
    x, y, yaw = robot.truth
    page.get("coordinate-x").fill(f"{x:.2f}")
    page.get("coordinate-y").fill(f"{y:.2f}")
    page.get("coordinate-heading").fill(f"{math.degrees(yaw):.0f}")
    page.get("coordinate-check").click()
    expect(page.get("locate-set")).to_be_visible()
    for button in ("locate-set", "locate-cancel"):
        assert page.get(button).evaluate(UNCOVERED), button
    page.get("locate-set").click()
    found(page)
