"""On a phone nothing is cut, nothing is too small for a thumb, and what is edited has the room."""

from __future__ import annotations

import re
from functools import partial

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import UNCOVERED, ConsolePage
from tests.browser.rules_page import RulesPage
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import TOKEN

pytestmark = pytest.mark.browser

TARGET = 44  # px

# What a finger presses and cannot: too small, or partly off the screen.
_TOO_SMALL = """(target) => [...document.querySelectorAll(
  "button, a, input, select, textarea, summary, [role=menuitem], [role=menuitemcheckbox]")]
  .filter((each) => each.checkVisibility({ visibilityProperty: true }))
  .filter((each) => each.closest("[aria-hidden=true]") === null)
  .map((each) => {
    const { left, right, width, height } = each.getBoundingClientRect();
    const bad = width < target || height < target || left < 0 || right > innerWidth + 1;
    const name = each.dataset.testid ?? each.getAttribute("aria-label") ?? each.textContent;
    return bad && width > 1 ? `${name}: ${width} x ${height}, ${left} to ${right}` : null;
  })
  .filter((each) => each !== null)"""
_CUT = """() => [...document.querySelectorAll("header strong, header [role=status] span")]
  .filter((each) => each.scrollWidth > each.clientWidth + 1 && each.clientWidth > 0)
  .map((each) => each.textContent)"""


def fits_a_thumb(page: ConsolePage) -> None:
    assert page.page.evaluate(_TOO_SMALL, TARGET) == []
    assert page.page.evaluate("() => document.documentElement.scrollWidth <= innerWidth")


def leaves_the_map_its_buttons(page: ConsolePage, bar: str) -> None:
    """While a tool of the scene is on."""
    expect(page.get(bar)).to_be_visible()
    assert page.get(bar).evaluate("(bar) => bar.scrollWidth <= bar.clientWidth + 1")
    words = page.get(bar).locator("span").first
    inside, outside = words.bounding_box(), page.get(bar).bounding_box()
    assert inside is not None
    assert outside is not None
    assert inside["x"] >= outside["x"]
    assert inside["x"] + inside["width"] <= outside["x"] + outside["width"]
    for name in ("Larger", "Smaller", "Whole map"):
        button = page.get("flat-map").get_by_role("button", name=name)
        wait_until(partial(button.evaluate, UNCOVERED), 3, f"{name}, uncovered")


@pytest.mark.parametrize(("width", "height"), [(390, 844), (360, 640)])
def test_a_phone_has_room_for_name_thumb_and_editor(
    new_page: OpenPage, robot: Robot, width: int, height: int
) -> None:
    page = new_page(width, height, has_touch=True, is_mobile=True)
    page.page.add_init_script("localStorage.setItem('kompass.scene', 'flat')")
    page.open_flat(TOKEN)
    expect(page.page.locator("[data-testid=flat-canvas][data-cells]")).to_be_visible()
    fits_a_thumb(page)
    # What is wrong may be told in more words than fit; Health has them all.
    expect(page.get("overall")).to_contain_text(re.compile("All well|No faults"))
    assert page.page.evaluate(_CUT) == []
    page.get("user-menu").tap()
    expect(page.get("theme-item")).to_be_visible()
    expect(page.page.get_by_text(re.compile(r"^Battery \d+ %"))).to_be_visible()
    fits_a_thumb(page)
    page.page.keyboard.press("Escape")
    page.get("goal-tool").tap()
    page.get("goal-type").tap()
    fits_a_thumb(page)
    page.get("goal-tool").tap()
    page.get("hand-tool").tap()
    fits_a_thumb(page)
    page.get("hand-tool").tap()
    for tool, bar in (("locate-tool", "locate-bar"), ("measure-tool", "measure-card")):
        page.get(tool).tap()
        leaves_the_map_its_buttons(page, bar)
        page.get(tool).tap()
    page.get("tab-places").tap()
    page.page.get_by_text("Zones", exact=True).first.tap()
    page.get("zone-add").tap()
    leaves_the_map_its_buttons(page, "zone-card")
    page.get("zone-cancel").tap()

    # The narrowest case: the robot is stopped, and a rule is written meanwhile.
    page.get("stop-button").tap()
    expect(page.get("stop-button")).to_have_attribute("data-phase", "stopped")
    rules = RulesPage.of(page, "tab-rules")
    fits_a_thumb(page)
    page.page.get_by_role("button", name="Add rule").first.tap()
    expect(rules.get("rule-editor")).to_be_visible()
    fits_a_thumb(page)
    expect(page.get("release-button")).to_be_in_viewport(ratio=1)
    form = rules.get("rule-editor").evaluate(
        """(element) => {
          let box = element;
          while (getComputedStyle(box).overflowY !== "auto") box = box.parentElement;
          return box.clientHeight;
        }"""
    )
    assert form >= 0.45 * height
    page.release_stop()
    page.get("draft-discard").tap()
