"""A person measures on the floor how far it is, in the scene and on the flat map."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import ConsolePage
from tests.support.stack import TOKEN

pytestmark = pytest.mark.browser


def told(page: ConsolePage) -> float:
    """The length that the card begins with, m."""
    found = re.match(r"(\d+(?:\.\d+)?) (cm|m)\b", page.get("measured").inner_text())
    assert found, page.get("measured").inner_text()
    return float(found[1]) * (0.01 if found[2] == "cm" else 1.0)


def test_a_drag_and_a_tap_in_the_scene_tell_how_far_it_is(page: ConsolePage) -> None:
    floor = page.await_scene()
    page.page.keyboard.press("m")
    expect(page.get("measured")).to_contain_text("Press two points")
    page.page.mouse.move(*page.pixel(floor, -0.5, 0.0))
    page.page.mouse.down()
    page.page.mouse.move(*page.pixel(floor, 0.5, 0.0), steps=5)
    page.page.mouse.up()
    expect(page.get("measured")).to_have_text(re.compile(r"^(9\d cm|1\.0\d m), to [−+]?[0-3]°$"))
    page.page.mouse.click(*page.pixel(floor, 0.5, 0.8))
    expect(page.get("measured")).to_contain_text("along 3 points")
    assert told(page) == pytest.approx(1.8, abs=0.08)
    page.keep("measured")
    page.get("measure-undo").click()
    expect(page.get("measured")).not_to_contain_text("points")
    # Escape drops the points first, and leaves the tool then.
    page.page.keyboard.press("Escape")
    expect(page.get("measured")).to_contain_text("Press two points")
    page.page.keyboard.press("Escape")
    expect(page.get("measure-card")).to_be_hidden()
    # One gesture means one thing.
    page.page.keyboard.press("m")
    page.page.keyboard.press("g")
    expect(page.get("measure-card")).to_be_hidden()
    expect(page.get("goal-overlay")).to_be_visible()
    page.page.keyboard.press("m")
    expect(page.get("goal-overlay")).to_be_hidden()
    page.get("measure-done").click()
    expect(page.get("measure-card")).to_be_hidden()


def test_a_phone_measures_on_the_flat_map(new_page: OpenPage) -> None:
    page = new_page(390, 844, has_touch=True, is_mobile=True)
    page.page.add_init_script("localStorage.setItem('kompass.scene', 'flat')")
    page.open_flat(TOKEN)
    expect(page.page.locator("[data-testid=flat-canvas][data-cells]")).to_be_visible()
    page.get("measure-tool").tap()
    for x in (100, 300):
        page.page.touchscreen.tap(x, 300)
    expect(page.get("measured")).to_have_text(re.compile(r"m, to \+?0°$"))
    across = told(page)
    page.page.touchscreen.tap(300, 500)
    expect(page.get("measured")).to_contain_text("along 3 points")
    # 200 px each.
    assert told(page) == pytest.approx(2.0 * across, rel=0.02)
    page.keep("measured-phone")
    page.get("measure-done").tap()
    expect(page.get("measure-card")).to_be_hidden()
