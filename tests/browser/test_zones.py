"""A person draws zones on the floor, with the hand and by typing, and sees them in force."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playwright.sync_api import Locator, expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import UNCOVERED, ConsolePage
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import TOKEN

pytestmark = pytest.mark.browser

PHONE = (390, 844)
LOW, HIGH = (0.3, 0.3), (0.8, 0.8)
INSIDE = {"x": 0.55, "y": 0.55, "yaw": None}


def zone(page: ConsolePage, name: str) -> Locator:
    return page.page.locator(f"[data-name='{name}']")


def menu(page: ConsolePage, name: str, item: str) -> None:
    zone(page, name).get_by_test_id("zone-menu").click()
    page.get(item).click()


def refused(page: ConsolePage) -> str:
    """Why the robot does not go into it."""
    message: str = page.post("/api/goals/check", INSIDE).json()["message"]
    return message


def test_a_zone_is_drawn_in_the_scene_kept_out_of_changed_and_taken_back(
    page: ConsolePage, robot: Robot
) -> None:
    floor = page.await_scene()
    began = robot.truth[:2]
    page.get("zone-add").click()
    expect(page.get("zone-problem")).to_contain_text("Drag a rectangle")
    before = page.picture()
    page.page.mouse.move(*page.pixel(floor, *LOW))
    page.page.mouse.down()
    page.page.mouse.move(*page.pixel(floor, *HIGH), steps=5)
    page.page.mouse.up()
    expect(page.get("zone-problem")).to_have_text("4 corners.")
    scene = np.s_[60:500, 100:740]

    def drawn() -> int:
        return int((page.picture()[scene] != before[scene]).any(axis=2).sum())

    wait_until(lambda: drawn() > 100, 15, "its outline in the scene")
    page.keep("zone-drawn")
    page.get("zone-next").click()
    page.get("zone-save").click()
    expect(page.page.get_by_text("Give the zone a name.")).to_be_visible()
    page.get("zone-name").fill("Wet <i>floor</i>")
    page.page.keyboard.press("Enter")
    expect(page.get("zone-card")).to_be_hidden()
    row = zone(page, "Wet <i>floor</i>")
    expect(row).to_contain_text("Keep out")
    assert "inside the keep-out zone 'Wet <i>floor</i>'" in refused(page)
    wait_until(lambda: drawn() > 500, 15, "the zone in the scene")
    page.keep("zone-in-force")

    menu(page, "Wet <i>floor</i>", "zone-edit")
    page.get("zone-kind").get_by_text("Speed limit").click()
    page.get("zone-speed").fill("fast")
    page.get("zone-save").click()
    expect(page.page.get_by_text("A number of m/s above 0")).to_be_visible()
    page.get("zone-speed").fill("0.1")
    page.get("zone-save").click()
    expect(row).to_contain_text("At most 0.1 m/s")
    wait_until(lambda: page.post("/api/goals/check", INSIDE).json()["ok"], 10, "a way there")
    row.get_by_test_id("zone-revert").click()
    expect(row).to_contain_text("Keep out")

    menu(page, "Wet <i>floor</i>", "zone-delete")
    expect(row).to_be_hidden()
    page.get("zone-undo").click()
    expect(row).to_be_visible()
    menu(page, "Wet <i>floor</i>", "zone-delete")
    expect(row).to_be_hidden()
    assert math.dist(robot.truth[:2], began) < 0.01, "a gesture drove it"


def test_on_a_phone_corners_are_tapped_or_typed_on_the_flat_map(
    new_page: OpenPage, robot: Robot
) -> None:
    page = new_page(*PHONE, has_touch=True, color_scheme="dark")
    page.open_flat(TOKEN)
    page.get("layers").click()
    page.get("flat").click()
    page.page.keyboard.press("Escape")
    expect(page.get("flat-canvas")).to_be_visible()
    page.get("tab-places").click()
    page.page.get_by_text("Zones", exact=True).first.click()
    page.get("zone-add").tap()
    expect(page.get("zone-card")).to_be_visible()
    for at in ((60, 320), (300, 320), (300, 500)):
        page.page.touchscreen.tap(*at)
    expect(page.get("zone-problem")).to_have_text("3 corners.")
    page.keep("zone-phone-tapped")
    for part in ("zone-next", "zone-cancel", "stop-button"):
        assert page.get(part).evaluate(UNCOVERED), part
    page.page.keyboard.press("Escape")
    expect(page.get("zone-card")).to_be_hidden()
    page.get("tab-places").click()
    page.page.get_by_text("Zones", exact=True).first.click()
    page.get("zone-add").tap()
    page.get("zone-type").tap()
    for part in ("zone-save", "zone-leave", "stop-button"):
        assert page.get(part).evaluate(UNCOVERED), part
    page.get("zone-corners").fill("0.3, 0.3\n0.8, 0.8\n0.8, 0.3\n0.3, 0.8")
    expect(page.get("zone-problem")).to_contain_text("crosses")
    expect(page.get("zone-save")).to_be_disabled()
    page.get("zone-corners").fill("0.3, 0.3\n0.8, 0.3\n0.8, 0.8\n0.3, 0.8")
    expect(page.get("zone-problem")).to_have_text("4 corners.")
    page.get("zone-name").fill("Bay")
    page.keep("zone-phone")
    page.get("zone-save").tap()
    expect(page.get("zone-card")).to_be_hidden()
    page.keep("zone-phone-saved")
    assert "'Bay'" in refused(page)
    page.get("tab-places").click()
    menu(page, "Bay", "zone-delete")
    expect(zone(page, "Bay")).to_be_hidden()
    assert robot.speed < 0.01
