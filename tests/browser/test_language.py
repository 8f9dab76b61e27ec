"""A German operator drives in German, and a warehouse that measures in feet is told feet."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import ConsolePage
from tests.browser.test_small_screens import fits_a_thumb
from tests.support.robot import Robot
from tests.support.stack import TOKEN

pytestmark = pytest.mark.browser

AXE = Path(__file__).parents[2] / "web" / "node_modules" / "axe-core" / "axe.min.js"
RUN = """() => axe.run(document, { resultTypes: ["violations"] })
  .then(({ violations }) => violations.map(({ id, nodes }) => `${id}: ${nodes[0].html}`))"""
# Words that their button, tool, tab or head has no room for.
CUT = """() => [...document.querySelectorAll(
    "header strong, header [role=status] span, nav button span, aside button, "
    + "[data-testid=stop-button] > span:not(.visually-hidden)")]
  .filter((each) => each.checkVisibility() && each.clientWidth > 0)
  .filter((each) => !each.closest(".visually-hidden"))
  .filter((each) => {
    const room = each.closest("button")?.getBoundingClientRect();
    const box = each.getBoundingClientRect();
    return each.scrollWidth > each.clientWidth + 1
      || (room !== undefined && (box.left < room.left + 2 || box.right > room.right - 2)
          && each.tagName !== "BUTTON");
  })
  .map((each) => each.textContent)"""


def opened_flat(page: ConsolePage) -> None:
    page.page.add_init_script("localStorage.setItem('kompass.scene', 'flat')")
    page.open_flat(TOKEN)
    expect(page.page.locator("[data-testid=flat-canvas][data-cells]")).to_be_visible()


def axe_finds_nothing(page: ConsolePage) -> None:
    page.page.wait_for_function("() => document.getAnimations().length === 0")
    if not page.page.evaluate("() => 'axe' in window"):
        page.page.evaluate(AXE.read_text(encoding="utf-8"))
    assert page.page.evaluate(RUN) == []


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (360, 640)], ids=["desk", "phone"])
def test_a_german_browser_sends_the_robot_stops_and_releases_it_in_german(
    new_page: OpenPage, robot: Robot, width: int, height: int
) -> None:
    phone = width < 560
    page = new_page(
        width, height, locale="de-DE", has_touch=phone, is_mobile=phone, bypass_csp=True
    )
    opened_flat(page)
    name = page.page.get_by_role
    assert page.page.locator("html").get_attribute("lang") == "de"
    expect(page.get("overall")).to_contain_text(re.compile("Alles OK|Fehlerfrei"))
    expect(page.get("pose")).to_contain_text(re.compile(r"\d,\d\d m"))
    assert page.page.evaluate(CUT) == []

    name("button", name="Ziel", exact=True).click()
    name("button", name="Koordinaten eingeben").click()
    page.page.get_by_label("x (m)").fill("0,9")
    page.page.get_by_label("y (m)").fill("0,55")
    name("button", name="Prüfen").click()
    expect(page.get("goal-card")).to_contain_text(re.compile(r"\d,\d m, etwa \d+ s, frei"))
    if phone:
        fits_a_thumb(page)
    axe_finds_nothing(page)
    name("button", name="Fahren", exact=True).click()
    expect(page.get("goal-status")).to_contain_text(re.compile(r"noch \d,\d m"))
    name("button", name=re.compile("^STOPP")).click()
    expect(page.get("stop-button")).to_contain_text("Gestoppt")
    expect(page.get("stop-band")).to_contain_text("Gestoppt von operator")
    expect(page.get("goal-status")).to_contain_text("Gestoppt: operator hat STOPP gedrückt.")
    assert page.page.evaluate(CUT) == []
    axe_finds_nothing(page)
    release = name("button", name=re.compile("^Halten zum Freigeben"))
    release.focus()
    page.page.keyboard.down("Enter")
    expect(page.get("stop-band")).to_be_hidden()
    page.page.keyboard.up("Enter")
    robot.has_stopped(False)
    if phone:
        for tab in ("places", "health", "data"):
            page.get(f"tab-{tab}").click()
            fits_a_thumb(page)
            assert page.page.evaluate(CUT) == []


def test_language_and_units_are_chosen_in_the_menu_and_what_is_stored_stays_metric(
    new_page: OpenPage,
) -> None:
    page = new_page(1280, 800)
    opened_flat(page)
    page.get("goal-tool").click()
    page.get("goal-type").click()
    page.get("coordinate-x").fill("3")  # typed before somebody chooses, and not lost with it
    page.get("user-menu").click()
    page.get("units-item").click()
    page.get("language-item").click()
    page.page.keyboard.press("Escape")
    expect(page.page.get_by_label("x (ft)")).to_have_value("3")
    page.get("coordinate-y").fill("1.5")
    page.get("coordinate-check").click()
    expect(page.get("goal-card")).to_contain_text("x 3,00, y 1,50 ft")
    page.get("goal-save-place").click()
    page.get("place-name").fill("Dock")
    page.get("place-save").click()
    expect(page.page.get_by_role("button", name="Nach Dock fahren")).to_be_visible()
    answer = page.page.context.request.get(f"{page.origin}/api/places")
    pose = next(each["pose"] for each in answer.json()["places"] if each["name"] == "Dock")
    assert (pose["x"], pose["y"]) == (0.9144, 0.4572)
    page.page.keyboard.press("Escape")

    # Both are this browser's from now on.
    page.page.reload()
    expect(page.get("pose")).to_contain_text("ft/s")
    assert page.page.locator("html").get_attribute("lang") == "de"
    page.get("measure-tool").click()
    box = page.get("flat-canvas").bounding_box()
    assert box is not None
    for x in (0.4, 0.6):
        page.page.mouse.click(box["x"] + box["width"] * x, box["y"] + box["height"] * 0.5)
    expect(page.get("measured")).to_contain_text(re.compile(r"^\d+ ft \d+ in, Richtung 0°"))
