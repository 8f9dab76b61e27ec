"""A cooldown that is longer than it was, and a robot that is held up twice."""

import re
from collections.abc import Iterator
from contextlib import closing

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.rules_page import RulesPage
from tests.browser.test_own_drills import breaks
from tests.support.patience import patient
from tests.support.stack import RECIPE, TOKEN, Stack

# Drives are made at low priority, with what the robot, the console and the browser leave them; on a
# busy machine that is little.
pytestmark = [pytest.mark.browser, pytest.mark.slow, pytest.mark.timeout(900)]

WAIT = "recovery-wait"


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    """A robot that helps itself step by step, the last of which is to wait."""
    recipe = RECIPE.parent / "10_recovery.py"
    with closing(Stack.simulated(recipe=recipe)) as running:
        yield running


def test_a_longer_cooldown_that_lets_a_robot_give_up_is_found_before_it_is_applied(
    new_page: OpenPage,
) -> None:
    rules = RulesPage.opened(new_page(1440, 900), TOKEN)
    rules.edit(WAIT)
    rules.get("cooldown").fill("30 s")
    rules.review()
    rules.choose(rules.get("apply-probation"), "no probation: it stays")
    rules.apply("it waits once in a while")
    rules.get("rules-tab-table").click()

    rules.edit(WAIT)
    rules.get("cooldown").fill("45 s")
    rules.review()
    rules.get("drill-which").get_by_text("One of my own").click()
    rules.choose(rules.get("scenario-world"), "apartment")
    rules.get("scenario-map").click(position={"x": 200, "y": 150})
    rules.get("goal-1-x").fill("8.2")
    rules.get("goal-1-y").fill("3.6")
    breaks(rules, 0, "boxed in", "10", "40")
    breaks(rules, 1, "boxed in", "66", "35")
    rules.get("scenario-limit").fill("200")
    rules.choose(rules.get("drill-count"), "1")
    rules.get("drill-start").click()
    sentence = rules.get("drill-sentence")
    expect(sentence).to_be_visible(timeout=patient(120) * 1000)
    expect(sentence).to_have_text("Recovers in 0 of 1 instead of 1.")

    drive = rules.get("drive-my own")
    expect(drive).to_contain_text("recovered and arrived → gave up and said why")
    expect(drive).to_contain_text(re.compile("wait for the way to come free” fired once instead"))
    drive.get_by_role("button").first.click()
    rules.get("drive-moment").press("End")
    waited = {"proposed": 1, "in_force": 2}
    for side, times in waited.items():
        happened = rules.get(f"side-{side}").locator(f"[data-kind=firing][title*='{WAIT}']")
        expect(happened).to_have_count(times)
    rules.page.keep("drill-cooldown")
