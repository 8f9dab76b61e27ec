"""Takes the pictures of the documentation: ``scripts/screenshots``."""

from __future__ import annotations

import io
import os
import re
import signal
from pathlib import Path
from typing import Any, Literal

from PIL import Image
from playwright.sync_api import Browser, expect

from tests.browser.chromium import chromium
from tests.browser.console_page import ConsolePage
from tests.browser.rules_page import RulesPage
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import RECIPE, TOKEN, Stack

FOLDER = Path("docs")
DESKTOP, PHONE = (1440, 900), (390, 844)
LARGEST = 300_000  # bytes
RULES_RECIPE = RECIPE.with_name("03_events_and_actions.py")
STUCK = "stuck-unblock"

GATE, SHELF = {"x": 0.9, "y": 0.55, "yaw": None}, {"x": -1.65, "y": -0.55, "yaw": None}
Theme = Literal["light", "dark"]


def main() -> None:
    stack = Stack.simulated()
    robot = Robot(stack.domain)
    try:
        robot.ready()
        with chromium() as browser:
            furnish(browser, stack)
            take(browser, stack, robot, "console-light", DESKTOP, "light", (0.9, 0.55))
            take(browser, stack, robot, "console-dark", DESKTOP, "dark", (-1.65, -0.55))
            take(browser, stack, robot, "console-phone-light", PHONE, "light", (0.9, 0.55))
            take(browser, stack, robot, "console-phone-dark", PHONE, "dark", (-1.65, -0.55))
            take_timeline(browser, stack, robot)
    finally:
        robot.close()
        stack.close()
    take_rules()


def furnish(browser: Browser, stack: Stack) -> None:
    """Two places, a mission between them, and a zone that is in nobody's way."""
    context = browser.new_context()
    page = ConsolePage(context.new_page(), stack.url)
    page.open_flat(TOKEN)
    wait_until(lambda: _post(page, "/api/goals/check", GATE)["ok"], 20, "map and robot are known")
    known = lambda: context.request.get(f"{page.origin}/api/places").json()["map"]  # noqa: E731
    wait_until(known, 20, "whose places these are")
    corners = [[0.3, -1.9], [1.2, -1.9], [1.2, -1.35], [0.3, -1.35]]
    _post(page, "/api/zones", {"name": "Wet floor", "kind": "keep_out", "corners": corners})
    places = [
        _post(page, "/api/places", {"name": name, "pose": at})["id"]
        for name, at in (("Gate", GATE), ("Shelf 4", SHELF))
    ]
    waypoints = [{"place": place, "tasks": [{"kind": "wait", "seconds": 5.0}]} for place in places]
    _post(page, "/api/missions", {"name": "Round", "waypoints": waypoints, "rounds": 3})
    context.close()


def take_timeline(browser: Browser, stack: Stack, robot: Robot) -> None:
    """Picture what has happened by then, and a process that has just died."""
    context = browser.new_context(viewport={"width": 1440, "height": 900}, color_scheme="light")
    page = ConsolePage(context.new_page(), stack.url)
    page.open(TOKEN)
    page.await_scene()
    _post(page, "/api/stop", {"reason": "somebody in the way"})
    page.release_stop()
    os.kill(stack.pid_of("controller"), signal.SIGKILL)
    wait_until(lambda: robot.check(0.9, 0.55).reachable, 20, "the controller again")
    page.page.keyboard.press("e")
    expect(page.get("timeline-fault").first).to_contain_text("Started again")
    page.page.get_by_text("1 h", exact=True).click()
    for _ in range(4):
        page.page.get_by_role("button", name="Closer").click()
    page.page.mouse.move(700, 880)
    _save(page, "console-timeline-light")
    context.close()


def _post(page: ConsolePage, path: str, body: object) -> Any:
    answer = page.post(path, body)
    assert answer.ok, answer.text()
    return answer.json() if answer.text() else None


def take_rules() -> None:
    """Picture the rules: the table, the form with its live readings, and a phone."""
    stack = Stack.simulated(recipe=RULES_RECIPE)
    try:
        with chromium() as browser:
            rules = _open_rules(browser, stack, DESKTOP, "light")
            rules.edit(STUCK)
            rules.get("cooldown").fill("45")
            rules.get("editor-back").click()
            expect(rules.get("rule-change")).to_be_visible()
            _save(rules.page, "console-rules-light")
            rules.page.page.context.close()

            rules = _open_rules(browser, stack, DESKTOP, "dark")
            rules.edit(STUCK)
            expect(rules.get("leaf-now")).to_be_visible()
            _save(rules.page, "console-rules-dark")
            rules.page.page.context.close()

            rules = _open_rules(browser, stack, PHONE, "light")
            _save(rules.page, "console-rules-phone")
            rules.page.page.context.close()
    finally:
        stack.close()


def _open_rules(browser: Browser, stack: Stack, size: tuple[int, int], theme: Theme) -> RulesPage:
    width, height = size
    context = browser.new_context(
        viewport={"width": width, "height": height}, color_scheme=theme, has_touch=size == PHONE
    )
    context.set_default_timeout(30_000)
    page = ConsolePage(context.new_page(), stack.url)
    page.open(TOKEN)
    return RulesPage.of(page, "tab-rules" if size == PHONE else "rules")


def take(
    browser: Browser,
    stack: Stack,
    robot: Robot,
    name: str,
    size: tuple[int, int],
    theme: Theme,
    goal: tuple[float, float],
) -> None:
    """Picture a page while the robot is half-way to a goal (m, map frame)."""
    width, height = size
    context = browser.new_context(
        viewport={"width": width, "height": height}, color_scheme=theme, has_touch=size == PHONE
    )
    page = ConsolePage(context.new_page(), stack.url)
    page.open(TOKEN)
    floor = page.await_scene()
    began = robot.truth
    page.pick(page.pixel(floor, *goal), page.pixel(floor, goal[0], goal[1] + 0.5))
    page.get("goal-go").click()
    expect(page.get("goal-status")).to_contain_text(re.compile("left"), timeout=10_000)
    wait_until(lambda: robot.distance_to(*began[:2]) > 1.2, 30, "the robot half-way")
    page.page.mouse.move(width / 2, height - 60)
    _save(page, name)
    wait_until(lambda: robot.distance_to(*goal) < 0.10, 60, "arrival")
    page.post("/api/logout", None)  # whoever goes without a word keeps control for a while
    context.close()


def _save(page: ConsolePage, name: str) -> None:
    file = FOLDER / f"{name}.png"
    Image.open(io.BytesIO(page.page.screenshot())).convert("RGB").save(file, optimize=True)
    assert file.stat().st_size < LARGEST, f"{file} has {file.stat().st_size} bytes"


if __name__ == "__main__":
    main()
