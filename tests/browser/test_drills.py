"""A person proposes a rule, drills it against those in force, and watches a drive that differs."""

import re
from collections.abc import Iterator
from contextlib import closing

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.rules_page import RulesPage
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.stack import RECIPE, TOKEN, Stack

pytestmark = [pytest.mark.browser, pytest.mark.slow]


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    """The recipe of the demonstration, whose processes leave a processor or two for drives."""
    with closing(Stack.simulated(recipe=RECIPE)) as running:
        yield running


def propose(rules: RulesPage) -> None:
    """A rule that stops the robot where anything is near, as it is on most ways."""
    rules.get("rule-add").click()
    rules.get("rule-name").fill("Shy")
    condition = rules.get("event.condition")
    rules.choose(condition.get_by_test_id("topic-picker"), "/scan")
    rules.choose(condition.get_by_test_id("field-picker"), re.compile("nearest obstacle"))
    rules.choose(condition.get_by_test_id("operator"), re.compile("less than"))
    condition.get_by_test_id("literal").fill("0.25")
    rules.choose(rules.get("add-action"), "Stop the robot")
    rules.review()


def choose_fault(rules: RulesPage, name: str) -> None:
    # The field itself is but a letter wide; a finger hits the frame around it.
    rules.get("drill-faults").click(force=True)
    rules.page.page.get_by_role("option", name=name, exact=True).click()
    rules.page.page.keyboard.press("Escape")


def test_a_proposed_rule_is_drilled_and_a_drive_that_differs_is_played(
    new_page: OpenPage,
) -> None:
    rules = RulesPage.opened(new_page(1440, 900), TOKEN)
    propose(rules)
    expect(rules.get("drill")).to_contain_text("The robot that you see is left alone.")
    for fault in ("way blocked", "wheel blocked"):
        choose_fault(rules, fault)
    rules.choose(rules.get("drill-count"), "4")
    rules.get("drill-start").click()
    progress = rules.get("drill-progress")
    expect(progress).to_contain_text(re.compile("[1-7] of 8 drives, about .* left"), timeout=90_000)
    rules.page.keep("drill-progress")

    # It goes on while somebody looks elsewhere, and is there again.
    rules.get("rules-tab-firings").click()
    rules.get("rules-tab-table").click()
    rules.get("draft-review").click()
    expect(progress).to_contain_text("of 8 drives")

    sentence = rules.get("drill-sentence")
    expect(sentence).to_be_visible(timeout=patient(60) * 1000)
    expect(sentence).to_contain_text(re.compile(r"^Recovers in none|^Recovers in 0|instead of"))
    expect(sentence).to_have_attribute("data-verdict", re.compile("worse|may be chance"))
    expect(rules.get("drill-chance")).to_be_visible()
    first = rules.page.page.locator("[data-testid^=drive-1-]").first
    expect(first).to_contain_text("worse")
    first.get_by_role("button").first.click()

    expect(rules.get("drive-map")).to_be_visible()
    expect(rules.get("side-proposed")).to_contain_text("no goal")
    robot = rules.get("robot-in_force")
    began = robot.get_attribute("transform")
    rules.get("drive-play").click()
    wait_until(lambda: robot.get_attribute("transform") != began, 20, "the robot moves")
    rules.get("drive-play").click()
    clock = rules.get("drive-clock").inner_text()
    stood = robot.get_attribute("transform")
    rules.page.page.wait_for_timeout(300)
    assert (rules.get("drive-clock").inner_text(), robot.get_attribute("transform")) == (
        clock,
        stood,
    )
    # The head is taken to any moment, and at the end is told what became of both.
    moment = rules.get("drive-moment")
    end = float(moment.get_attribute("max") or "0")
    moment.fill(f"{int(end)}")
    expect(rules.get("drive-clock")).to_contain_text(re.compile(rf"^{int(end)}\.0 s of"))
    moment.press("End")
    for place in ("drive-map", "side-proposed"):
        expect(rules.get(place).locator("[data-kind=firing]")).to_have_count(1)
        expect(rules.get(place).locator("[data-kind=stop]")).to_have_count(1)
    expect(rules.get("side-proposed")).to_contain_text(re.compile("STOP|stop"))
    rules.page.keep("drill-player")


def test_a_drill_is_cancelled_by_hand_on_a_phone(new_page: OpenPage) -> None:
    rules = RulesPage.opened(new_page(1280, 800, has_touch=True), TOKEN)
    propose(rules)
    rules.page.page.set_viewport_size({"width": 390, "height": 844})
    rules.get("drill-start").tap()
    expect(rules.get("drill-progress")).to_be_visible()
    box = rules.get("drill-cancel").bounding_box()
    assert box is not None
    assert box["height"] >= 44
    rules.get("drill-cancel").tap()
    expect(rules.get("drill-canceled")).to_contain_text("cancelled it")
    expect(rules.get("drill-start")).to_be_enabled()
