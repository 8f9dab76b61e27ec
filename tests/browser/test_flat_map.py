"""Without WebGL the map is flat, and everything is done on it that is done in the scene."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import expect

from kompass_console.scene.layers.palette import palette
from tests.browser.conftest import OpenPage
from tests.browser.console_page import ConsolePage
from tests.browser.floor import Point
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import TOKEN

pytestmark = pytest.mark.browser

NO_WEBGL = """
const open = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
  return kind === "webgl2" ? null : open.call(this, kind, ...more);
};
"""


def checked(page: ConsolePage, at: Point, towards: Point | None = None) -> dict[str, Any]:
    """What the console answers to a goal that is picked there."""
    with page.page.expect_response("**/api/goals/check") as answer:
        page.pick(at, towards)
    return dict(answer.value.json())


def is_drawn(page: ConsolePage, colour: tuple[int, int, int], at: Point, within: int = 14) -> bool:
    """Whether something of this colour is drawn at most so many pixels from a place."""
    x, y = round(at[0]), round(at[1])
    part = page.picture()[y - within : y + within, x - within : x + within].astype(int)
    return bool((np.abs(part - np.array(colour)).max(axis=2) <= 2).any())


def test_without_webgl_a_robot_is_driven_and_stopped_on_a_flat_map(
    new_page: OpenPage, robot: Robot
) -> None:
    page = new_page()
    page.page.add_init_script(NO_WEBGL)
    page.open_flat(TOKEN)
    expect(page.get("no-webgl")).to_contain_text("no WebGL")
    canvas = page.page.locator("[data-testid=flat-canvas][data-cells]")
    box = canvas.bounding_box()
    assert box is not None
    colours = palette("light")
    here = (box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"])

    # The floor under a pixel stays under it, and where the hand takes it.
    first = checked(page, here)
    page.get("goal-cancel").click()
    page.page.mouse.move(*here)
    page.page.mouse.wheel(0, -300)
    closer = checked(page, here)
    page.get("goal-cancel").click()
    page.page.keyboard.press("Escape")
    expect(page.get("goal-overlay")).to_be_hidden()
    there = (here[0] - 90, here[1] + 60)
    page.page.mouse.move(*here)
    page.page.mouse.down()
    page.page.mouse.move(*there, steps=4)
    page.page.mouse.up()
    moved = checked(page, there)
    page.get("goal-cancel").click()
    for after in (closer, moved):
        assert (after["x"], after["y"]) == pytest.approx((first["x"], first["y"]), abs=0.01)
    page.page.get_by_label("Whole map").click()

    # The pillar in the middle of the world is at its origin: it is refused where it was pressed.
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    refused = checked(page, middle)
    assert not refused["ok"]
    expect(page.get("goal-card")).to_contain_text("obstacle")
    # Before the card has its place, nothing hides the mark; it lies below the pointer later on.
    wait_until(lambda: is_drawn(page, colours.alert, middle), 5, "the refused place is crossed out")
    page.get("goal-cancel").click()
    wait_until(lambda: not is_drawn(page, colours.alert, middle), 5, "and no more")

    # The robot's place is pressed and dragged here, too; each tool ends the other.
    page.page.keyboard.press("o")
    expect(page.get("goal-overlay")).to_be_hidden()
    assert not is_drawn(page, colours.preview, here, within=80)
    page.page.mouse.move(*here)
    page.page.mouse.down()
    page.page.mouse.move(here[0], here[1] + 60, steps=4)
    expect(page.get("locate-looked")).to_have_text(re.compile(r"^Scan and map agree \d+ % here\.$"))
    page.page.mouse.up()
    expect(page.get("locate-card")).to_contain_text(re.compile(r"Scan and map agree \d+ %"))
    # Half a metre about it, where the scan may fit better.
    wait_until(lambda: is_drawn(page, colours.preview, here, within=80), 5, "its mark")
    page.page.keyboard.press("g")
    expect(page.get("locate-card")).to_be_hidden()
    wait_until(lambda: not is_drawn(page, colours.preview, here, within=80), 5, "no mark")

    # Downwards: there the card has room, and leaves the goal to be seen.
    dragged = checked(page, here, (here[0], here[1] + 60))
    assert dragged["ok"], dragged
    assert dragged["yaw"] == pytest.approx(-np.pi / 2, abs=0.05)
    wait_until(lambda: is_drawn(page, colours.preview, here), 5, "the goal is drawn")
    page.get("goal-go").click()
    wait_until(lambda: robot.speed > 0.1, 15, "motion")
    wait_until(lambda: is_drawn(page, colours.goal, here), 5, "the goal is drawn")
    page.get("layers").click()
    page.get("layer-goal").click()
    wait_until(lambda: not is_drawn(page, colours.goal, here), 5, "its layer is off")
    expect(page.get("flat")).to_be_disabled()
    page.page.keyboard.press("Escape")
    page.get("stop-button").click()
    expect(page.get("stop-button")).to_have_attribute("data-phase", "stopped")
    robot.has_stopped()
    page.release_stop()


def test_a_flat_map_is_chosen_for_a_weak_tablet_and_stays_chosen(new_page: OpenPage) -> None:
    page = new_page(820, 1180, has_touch=True)
    page.open_flat(TOKEN)
    page.get("layers").click()
    page.get("flat").click()
    expect(page.get("scene-frame")).to_be_hidden()
    page.page.reload()
    canvas = page.page.locator("[data-testid=flat-canvas][data-cells]")
    box = canvas.bounding_box()
    assert box is not None
    assert page.get("no-webgl").count() == 0
    left = (box["x"] + 0.35 * box["width"], box["y"] + 0.5 * box["height"])
    right = (box["x"] + 0.65 * box["width"], left[1])
    before = [checked(page, at) for at in (left, right)]
    page.page.keyboard.press("Escape")
    page.page.keyboard.press("Escape")
    expect(page.get("goal-overlay")).to_be_hidden()

    middle = (left[0] + right[0]) / 2
    touches = page.page.context.new_cdp_session(page.page)

    def touch(kind: str, *apart: float) -> None:
        points = [{"x": middle + d, "y": left[1], "id": n} for n, d in enumerate(apart)]
        touches.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", -60, 60)
    for apart in (80, 100, 120):
        touch("touchMove", -apart, apart)
    touch("touchEnd")
    after = [checked(page, at) for at in (left, right)]
    shrunk = (after[1]["x"] - after[0]["x"]) / (before[1]["x"] - before[0]["x"])
    assert shrunk == pytest.approx(0.5, abs=0.03), "two fingers twice as far apart"
    assert re.search("flat", page.page.evaluate("() => localStorage.getItem('kompass.scene')"))
