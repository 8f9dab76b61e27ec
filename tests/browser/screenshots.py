"""Takes the pictures of the documentation: ``scripts/screenshots``."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Literal

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

Theme = Literal["light", "dark"]


def main() -> None:
    stack = Stack.simulated()
    robot = Robot(stack.domain)
    try:
        robot.ready()
        with chromium() as browser:
            take(browser, stack, robot, "console-light", DESKTOP, "light", (0.9, 0.55))
            take(browser, stack, robot, "console-dark", DESKTOP, "dark", (-1.65, -0.55))
            take(browser, stack, robot, "console-phone-light", PHONE, "light", (0.9, 0.55))
            take(browser, stack, robot, "console-phone-dark", PHONE, "dark", (-1.65, -0.55))
    finally:
        robot.close()
        stack.close()
    take_rules()


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
    context.close()


def _save(page: ConsolePage, name: str) -> None:
    file = FOLDER / f"{name}.png"
    Image.open(io.BytesIO(page.page.screenshot())).convert("RGB").save(file, optimize=True)
    assert file.stat().st_size < LARGEST, f"{file} has {file.stat().st_size} bytes"


if __name__ == "__main__":
    main()
