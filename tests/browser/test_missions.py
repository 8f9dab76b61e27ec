"""A person makes a mission of places, sends the robot round, and steers it from a phone."""

from __future__ import annotations

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import UNCOVERED, ConsolePage
from tests.browser.test_places import PHONE, opened
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.robot import Robot

pytestmark = pytest.mark.browser

GATE, WALL = (0.55, -0.55), (0.55, 0.55)


def mission(page: ConsolePage, name: str) -> Locator:
    return page.page.locator(f"[data-testid^='mission-'][data-name='{name}']")


def pick(page: ConsolePage, name: str) -> None:
    page.page.get_by_role("option", name=name, exact=True).click()


def test_a_mission_made_at_a_desk_is_steered_from_a_phone(new_page: OpenPage, robot: Robot) -> None:
    desk, phone = opened(new_page, "ava"), opened(new_page, "ben", *PHONE, "dark")
    viewer_sees = phone.get("mission-status")
    for name, (x, y) in {"Gate": GATE, "Wall": WALL}.items():
        where = {"name": name, "pose": {"x": x, "y": y}}
        kept = lambda place=where: desk.post("/api/places", place).status in (201, 409)  # noqa: E731
        wait_until(kept, 20, name)

    # Made of what is there: a name, two places, what is done there.
    desk.get("mission-add").click()
    desk.get("mission-save").click()
    expect(desk.page.get_by_text("Give the mission a name.")).to_be_visible()
    desk.get("mission-name").fill("Round <b>1</b>")
    desk.get("mission-save").click()
    expect(desk.page.get_by_text("Add a place to go to.")).to_be_visible()
    for name in ("Gate", "Wall"):
        desk.get("add-waypoint").click()
        pick(desk, name)
    first = desk.get("waypoint-0")
    first.get_by_test_id("add-task").click()
    pick(desk, "Wait for a person")
    first.get_by_label("Wait for a person").fill("Load the boxes")
    second = desk.get("waypoint-1")
    second.get_by_test_id("add-task").click()
    pick(desk, "Raise an alarm")
    second.get_by_label("Alarm").fill("at-wall")
    # A key that closes it loses nothing, nor does a page that is loaded again.
    desk.page.keyboard.press("Escape")
    expect(desk.get("mission-add")).to_be_visible()
    desk.page.reload()
    desk.get("mission-add").click()
    expect(desk.get("mission-kept")).to_be_visible()
    expect(second.get_by_label("Alarm")).to_have_value("at-wall")
    desk.get("mission-save").click()
    expect(mission(desk, "Round <b>1</b>")).to_contain_text("2 places")

    # It is begun on the phone, where the sheet has both lists.
    phone.get("tab-places").click()
    phone.page.get_by_text("Missions", exact=True).click()
    phone.page.get_by_role("button", name="Start Round").tap()
    expect(desk.get("mission-status")).to_contain_text("Driving to Gate")
    expect(desk.get("mission-status")).to_contain_text("begun by ben")
    assert desk.get("goal-status").count() == 0  # the mission's goal is told of with it
    phone.get("mission-pause").tap()
    expect(desk.get("mission-status")).to_contain_text("Paused by ben")
    # It goes on by who has control; who has not is told so, and may pause and cancel it.
    desk.get("mission-resume").click()
    expect(desk.get("mission-problem")).to_contain_text("ben has control of the robot.")
    phone.get("mission-resume").tap()
    expect(viewer_sees).to_contain_text("Waits for a person at Gate", timeout=patient(60) * 1000)
    expect(viewer_sees).to_contain_text("Load the boxes")
    assert robot.distance_to(*GATE) < 0.15
    assert phone.get("stop-button").evaluate(UNCOVERED)
    phone.get("mission-confirm").tap()

    # STOP pauses it; released, it still stands until a person resumes it.
    expect(viewer_sees).to_contain_text("Driving to Wall")
    wait_until(lambda: robot.speed > 0.05, 20, "motion")
    robot.stop()
    expect(viewer_sees).to_contain_text("Paused")
    expect(viewer_sees).to_contain_text("pressed STOP")
    phone.get("mission-resume").tap()
    expect(phone.get("mission-problem")).to_contain_text("Release STOP")
    robot.release()
    wait_until(lambda: robot.speed < 0.01, 5, "a robot that stands")
    phone.get("mission-resume").tap()
    expect(viewer_sees).to_contain_text("Mission done", timeout=patient(60) * 1000)
    assert robot.distance_to(*WALL) < 0.15
    expect(desk.page.get_by_text("at-wall").first).to_be_visible()

    # Changed and deleted, and back again.
    mission(desk, "Round <b>1</b>").get_by_test_id("mission-menu").click()
    desk.get("mission-edit").click()
    desk.get("mission-name").fill("Round")
    desk.get("mission-again").click()
    desk.get("mission-rounds").fill("12")
    desk.get("mission-save").click()
    expect(mission(desk, "Round")).to_contain_text("2 places, 12 rounds")
    mission(desk, "Round").get_by_test_id("mission-menu").click()
    desk.get("mission-delete").click()
    expect(mission(desk, "Round")).to_be_hidden()
    desk.get("mission-undo").click()
    expect(mission(desk, "Round")).to_be_visible()
