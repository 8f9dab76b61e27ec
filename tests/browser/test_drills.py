"""A person proposes a rule, drills it against those in force, and watches a drive that differs."""

import re
from collections.abc import Iterator
from contextlib import closing

import numpy as np
import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import UNCOVERED, ConsolePage
from tests.browser.rules_page import RulesPage
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.stack import RECIPE, TOKEN, Stack

# The palette's colours of both lines, as viser's tone mapping brings them to the screen.
LINES = ((0, 96, 196), (191, 101, 4))

# Drives are made at low priority, with what the robot, the console and the browser leave them; on a
# busy machine that is little.
pytestmark = [pytest.mark.browser, pytest.mark.slow, pytest.mark.timeout(900)]


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
    rules.choose(condition.get_by_test_id("add-condition"), "When a value compares …")
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
    expect(progress).to_contain_text(
        re.compile("[1-7] of 8 drives, about .* left"), timeout=patient(60) * 1000
    )
    expect(rules.get("apply-ends-drill")).to_be_visible()
    rules.page.keep("drill-progress")

    # It goes on while somebody looks elsewhere, and is there again.
    rules.get("rules-tab-firings").click()
    rules.get("rules-tab-table").click()
    rules.get("draft-review").click()
    expect(progress).to_contain_text("of 8 drives")

    sentence = rules.get("drill-sentence")
    expect(sentence).to_be_visible(timeout=patient(120) * 1000)
    expect(sentence).to_contain_text(re.compile(r"^Recovers in none|^Recovers in 0|instead of"))
    expect(sentence).to_have_attribute("data-verdict", re.compile("worse|may be chance"))
    expect(rules.get("drill-chance")).to_be_visible()
    first = rules.page.page.locator("[data-testid^=drive-1-]").first
    expect(first).to_contain_text("worse")
    expect(first).to_contain_text("STOP by rule Shy")  # by name, before anything is opened
    first.get_by_role("button").first.click()

    # There is no scene to play in on this page, so it is played on a map.
    for key in ("End", "Home"):
        rules.get("drive-moment").press(key)
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
    expect(rules.get("drive-clock")).to_have_text(re.compile(r"^(\d+\.\d) s of \1 s$"))
    for place in ("drive-map", "side-proposed"):
        expect(rules.get(place).locator("[data-kind=firing]")).to_have_count(1)
        expect(rules.get(place).locator("[data-kind=stop]")).to_have_count(1)
    expect(rules.get("side-proposed")).to_contain_text(re.compile("STOP|stop"))
    rules.page.keep("drill-player")
    watch_in_the_scene(rules.page)


def watch_in_the_scene(page: ConsolePage) -> None:
    """Loaded again, and drawn in three dimensions, it finds the drill, and plays a drive of it."""
    page.page.set_viewport_size({"width": 1280, "height": 720})  # there is less to draw
    page.let_scene_in()
    rules = RulesPage.of(page)
    rules.review()
    page.page.locator("[data-testid^=drive-1-]").first.get_by_role("button").first.click()
    expect(rules.get("drive-play")).to_be_visible()
    expect(rules.get("drive-map")).to_have_count(0)
    assert lines(page) == (0, 0)
    rules.get("drive-play").click()
    expect(rules.get("played-band")).to_contain_text("the robot itself is not shown")
    wait_until(lambda: min(lines(page)) > 50, 30, "both robots drive, each with its line")
    # The whole way is there as a thin line; it becomes a thick one as far as the robot has come.
    rules.get("drive-moment").press("Home")
    seen: list[int] = []

    def at_rest() -> bool:
        seen.append(lines(page)[1])
        return len(seen) > 3 and len(set(seen[-4:])) == 1

    wait_until(at_rest, 30, "they are where they began")
    rules.get("drive-moment").press("End")
    wait_until(lambda: lines(page)[1] > 1.5 * seen[-1] + 20, 30, "the end of both")
    page.keep("drill-scene")

    # No place of the drill's world is taken for one of the robot's; STOP is where it always is.
    expect(rules.get("goal-tool")).to_be_disabled()
    assert rules.get("stop-button").evaluate(UNCOVERED)
    page.page.keyboard.press("Escape")
    expect(rules.get("played-band")).to_be_hidden()
    wait_until(lambda: lines(page) == (0, 0), 15, "nothing is left of the drill")
    page.await_scene()  # a press means the robot's floor again

    # Whoever leaves the drive sees the robot.
    rules.get("drive-play").click()
    wait_until(lambda: sum(lines(page)) > 50, 30, "it plays again")
    rules.get("rules-close").click()
    wait_until(lambda: lines(page) == (0, 0), 15, "the robot")
    expect(rules.get("played-band")).to_have_count(0)


def lines(page: ConsolePage) -> tuple[int, int]:
    """Pixels of the scene in the colour of the proposed rules' line, and of the line of those in
    force."""
    box = page.get("scene-frame").bounding_box()
    assert box is not None
    below = int(box["y"]) + 150  # the band has both colours, too
    left, right = int(box["x"]), int(box["x"] + box["width"])
    seen = page.picture()[below : int(box["y"] + box["height"]), left:right].astype(int)
    proposed, in_force = (
        int((np.abs(seen - np.array(colour)).max(axis=2) < 14).sum()) for colour in LINES
    )
    return proposed, in_force


def test_a_drill_is_cancelled_by_hand_on_a_phone_and_a_short_one_says_what_it_left_out(
    new_page: OpenPage, stack: Stack
) -> None:
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

    # Four drives cannot meet them all, which is told beside what they come to.
    rules.choose(rules.get("drill-count"), "4")
    rules.get("drill-start").tap()
    note = rules.get("drill-note")
    expect(note).to_have_text(
        re.compile(r"^4 of \d+ faults were drawn .*\.$"), timeout=patient(180) * 1000
    )
    note.scroll_into_view_if_needed()
    rules.page.keep("drill-note-phone")

    # What came of it is there for who only looks.
    found = re.search(r"To watch:\s+\S+#token=(\S+)", stack.output)
    assert found
    watching = RulesPage.opened(new_page(1280, 800), found[1])
    watching.get("drill-link").click()
    expect(watching.get("drill-sentence")).to_be_visible()
    expect(watching.get("drill")).to_contain_text("any fault; 4 drives under each table")
    expect(watching.get("drill-start")).to_have_count(0)
    watching.page.keep("drill-viewer")
