"""A person names places, and sends the robot there in two taps, from a desk and from a phone."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import FIRST_PICTURE, UNCOVERED, ConsolePage
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import TOKEN

pytestmark = pytest.mark.browser

PHONE = (390, 844)
GATE = (0.55, -0.55)


def opened(
    new_page: OpenPage, user: str, width: int = 1120, height: int = 640, theme: str = "light"
) -> ConsolePage:
    """A page of somebody, without the scene, which takes a processor."""
    page = new_page(width, height, has_touch=width < 560, color_scheme=theme)
    page.leave_scene_out()
    assert page.post("/api/login", {"token": TOKEN, "user": user}).ok
    page.page.goto(f"{page.origin}/")
    expect(page.get("pose")).to_contain_text("m/s", timeout=FIRST_PICTURE * 1000)
    return page


def place(page: ConsolePage, name: str) -> Locator:
    return page.page.locator(f"[data-name='{name}']")


def menu(page: ConsolePage, name: str, item: str) -> None:
    place(page, name).get_by_test_id("place-menu").click()
    page.get(item).click()


def test_a_desk_and_a_phone_share_places_and_send_the_robot_there(
    new_page: OpenPage, robot: Robot
) -> None:
    desk, phone = opened(new_page, "ava"), opened(new_page, "ben", *PHONE, "dark")
    keys = desk.page.keyboard
    began = robot.truth

    # A point that was typed and checked is kept from its card; all by keys.
    keys.press("g")
    desk.get("goal-type").click()
    there = {"x": GATE[0], "y": GATE[1], "yaw": None}
    known = lambda: desk.post("/api/goals/check", there).json()["ok"]  # noqa: E731
    wait_until(known, 20, "the console knows map and robot")
    for name, value in zip(("x", "y"), GATE, strict=True):
        desk.get(f"coordinate-{name}").fill(str(value))
    keys.press("Enter")
    desk.get("goal-save-place").click()
    keys.press("Enter")
    expect(desk.page.get_by_text("Give the place a name.")).to_be_visible()
    desk.get("place-name").fill("Gate <i>2</i>")
    desk.get("place-note").fill("mind the step")
    keys.press("Enter")
    expect(place(desk, "Gate <i>2</i>")).to_contain_text("mind the step")
    desk.get("goal-cancel").click()
    desk.get("goal-tool").click()

    # To go to a place ends saying where the robot is, and the other way round.
    keys.press("o")
    expect(desk.get("locate-overlay")).to_be_visible()
    desk.page.get_by_label("Go to Gate").click()
    expect(desk.get("goal-card")).to_contain_text("To Gate <i>2</i>")
    expect(desk.get("locate-overlay")).to_be_hidden()
    keys.press("o")
    expect(desk.get("goal-card")).to_be_hidden()
    keys.press("o")

    # On the phone it is there at once, as it was written; there is one of each name.
    phone.get("tab-places").click()
    expect(place(phone, "Gate <i>2</i>")).to_be_visible()
    phone.get("place-add").click()
    phone.get("place-name").fill("GATE <i>2</i>")
    phone.get("place-save").click()
    expect(phone.get("place-problem")).to_contain_text("is taken by a place of this map")
    phone.get("place-name").fill("Home")
    phone.get("place-save").click()
    expect(place(desk, "Home")).to_be_visible()

    # Two taps: the place, which shows what will happen, and Go.
    phone.page.get_by_label("Go to Gate").tap()
    expect(phone.get("goal-card")).to_contain_text("To Gate <i>2</i>")
    expect(phone.get("goal-card")).to_contain_text("about")
    assert phone.get("stop-button").evaluate(UNCOVERED)
    assert robot.distance_to(*began[:2]) < 0.05
    phone.get("goal-go").tap()
    expect(desk.get("goal-status")).to_contain_text("Gate <i>2</i>")
    expect(desk.get("goal-status")).to_contain_text("Arrived", timeout=patient(60) * 1000)
    assert robot.distance_to(*GATE) < 0.15

    # Renamed for everybody; deleted, and brought back where it was.
    menu(desk, "Gate <i>2</i>", "place-edit")
    expect(desk.get("place-name")).to_have_value("Gate <i>2</i>")
    desk.get("place-name").fill("Gate")
    keys.press("Enter")
    phone.get("tab-places").click()
    expect(place(phone, "Gate")).to_be_visible()
    menu(desk, "Gate", "place-delete")
    expect(place(phone, "Gate")).to_be_hidden()
    desk.get("place-undo").click()
    expect(place(phone, "Gate")).to_contain_text("mind the step")
    expect(desk.get("place-undo")).to_be_hidden()

    # What is in the way is said where one asks, and one who stops ends it as ever.
    blocked = {"name": "Inside", "pose": {"x": 0.0, "y": 0.0}}
    assert desk.post("/api/places", blocked).status == 201
    desk.page.get_by_label("Go to Inside").click()
    expect(desk.get("goal-card")).to_contain_text("inside an obstacle")
    assert desk.get("goal-go").count() == 0
    keys.press("Escape")
    expect(desk.get("goal-card")).to_be_hidden()
    robot.stop()
    keys.press("p")
    expect(desk.page.get_by_label("Go to Gate")).to_be_focused()
    keys.press("Tab")
    keys.press("Tab")
    expect(desk.page.get_by_label("Go to Home")).to_be_focused()
    keys.press("Enter")
    expect(desk.get("goal-card")).to_contain_text("release the stop first")
    expect(desk.get("goal-go")).to_be_disabled()
    desk.get("goal-cancel").click()
    robot.release()

    # Among many one searches.
    for number in range(7):
        more = {"name": f"Bay {number}", "pose": {"x": GATE[0], "y": GATE[1]}}
        assert desk.post("/api/places", more).status == 201
    desk.get("place-search").fill("bay 3")
    expect(place(desk, "Bay 3")).to_be_visible()
    expect(place(desk, "Gate")).to_be_hidden()
    keys.press("Escape")
    expect(place(desk, "Gate")).to_be_visible()


def test_places_are_drawn_in_the_scene_with_their_names(page: ConsolePage) -> None:
    floor = page.await_scene()
    u, v = page.pixel(floor, -0.55, 0.55)

    def around() -> int:
        """Dark pixels where the pin is and its name stands."""
        picture = page.picture()[int(v) - 45 : int(v) + 20, int(u) - 40 : int(u) + 40]
        return int((picture.max(axis=2) < 130).sum())

    before = around()
    saved = page.post("/api/places", {"name": "Charger", "pose": {"x": -0.55, "y": 0.55}})
    assert saved.status == 201
    wait_until(lambda: around() > before + 60, 15, "the pin and its name")
    page.get("layers").click()
    page.get("layer-places").click()
    wait_until(lambda: around() < before + 20, 15, "the floor as it was")
    page.get("layer-places").click()
    page.page.keyboard.press("Escape")


def test_a_place_is_made_home_and_the_battery_is_always_told(
    new_page: OpenPage, robot: Robot
) -> None:
    page = opened(new_page, "ava")
    expect(page.get("battery")).to_contain_text(re.compile(r"\d+ %"))
    there = {"name": "Dock", "pose": {"x": GATE[0], "y": GATE[1], "yaw": None}}
    wait_until(lambda: page.post("/api/places", there).ok, 20, "a map whose place it is")
    row = place(page, "Dock")
    expect(row).to_be_visible()
    menu(page, "Dock", "place-home")
    expect(row.get_by_test_id("place-home-mark")).to_be_visible()
    page.keep("place-home")
    assert page.get("battery-band").count() == 0
    robot.fault("battery_low")
    expect(page.get("battery-band")).to_contain_text("Its home on this map is Dock.")
    page.keep("battery-low")
    page.get("go-home").dispatch_event("click")
    expect(page.get("goal-card")).to_contain_text("Dock")
    robot.fault("battery_low", on=False)
    page.page.keyboard.press("Escape")
    expect(page.get("battery-band")).to_be_hidden()
    menu(page, "Dock", "place-delete")
    expect(row).to_be_hidden()
