"""A person makes up a drive of their own, and sees what no back-test can tell of a rule."""

import re
from collections.abc import Iterator
from contextlib import closing
from functools import partial
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Route, expect

from tests.browser.conftest import OpenPage
from tests.browser.rules_page import RulesPage
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import RECIPE, TOKEN, Stack

# Drives are made at low priority, with what the robot, the console and the browser leave them; on a
# busy machine that is little.
pytestmark = [pytest.mark.browser, pytest.mark.slow, pytest.mark.timeout(900)]


@pytest.fixture(scope="module")
def stack(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stack]:
    """A robot that drives by its local map, and has no rule for the day that is lost."""
    whole = (RECIPE.parent / "04_cross_component_healing.py").read_text(encoding="utf-8")
    healed = re.search(r"    events_actions=\{.*?\n    \},\n", whole, re.DOTALL)
    assert healed is not None
    recipe = tmp_path_factory.mktemp("recipe") / "by_map.py"
    recipe.write_text(whole.replace(healed.group(), ""), encoding="utf-8")
    with closing(Stack.simulated(recipe=recipe)) as running:
        yield running


def propose_the_fallback(rules: RulesPage) -> None:
    """Where the mapper is not well, drive by the scan: what a back-test has nothing against."""
    rules.get("rule-add").click()
    rules.get("rule-name").fill("Drive by the scan")
    condition = rules.get("event.condition")
    rules.choose(condition.get_by_test_id("add-condition"), "Mapper is not well")
    rules.get("hold").fill("0.5")
    rules.choose(rules.get("add-action"), "Controller: set parameters")
    rules.choose(rules.get("add-argument"), "use_direct_sensor")
    rules.choose(rules.get("argument-use_direct_sensor").get_by_role("combobox"), "true")
    rules.review()


def breaks(rules: RulesPage, number: int, kind: str, at: str, length: str, what: str = "") -> None:
    """One thing more that breaks, at a time and for a while; an empty length is to the end."""
    rules.get("scenario-add-fault").click()
    row = rules.get(f"scenario-fault-{number}")
    rules.choose(row.get_by_test_id("fault-kind"), kind)
    if what:
        give(rules, row.get_by_test_id("fault-parameter"), what)
    row.get_by_test_id("fault-at").fill(at)
    if length:
        row.get_by_test_id("fault-duration").fill(length)
    else:
        rules.choose(row.get_by_test_id("fault-ends"), "to the end")


def give(rules: RulesPage, field: Locator, what: str) -> None:
    """A parameter: one of some words, or a figure."""
    if field.get_attribute("role") == "combobox" or field.get_attribute("aria-haspopup"):
        rules.choose(field, what)
    else:
        field.fill(what)


def test_a_fallback_that_drives_into_glass_is_found_before_it_is_applied(
    new_page: OpenPage, tmp_path: Path
) -> None:
    rules = RulesPage.opened(new_page(1440, 900), TOKEN)
    propose_the_fallback(rules)
    rules.get("drill-which").get_by_text("One of my own").click()
    expect(rules.get("drill")).to_contain_text("Say where the robot is to go")
    expect(rules.get("drill-start")).to_be_disabled()

    # A press on the map is a goal, and figures say it to the centimetre.
    rules.get("scenario-map").click(position={"x": 200, "y": 150})
    expect(rules.get("scenario-goal-0")).to_be_visible()
    rules.get("goal-1-x").fill("2")
    rules.get("goal-1-y").fill("0.5")
    breaks(rules, 0, "hang", "10", "", "mapper")
    breaks(rules, 1, "way blocked", "10.5 s", "13.5 s")
    breaks(rules, 2, "glass", "10.6", "13", "1")
    rules.get("scenario-limit").fill("60")
    rules.page.keep("drill-own")
    rules.choose(rules.get("drill-count"), "1")
    rules.get("drill-start").click()
    sentence = rules.get("drill-sentence")
    expect(sentence).to_be_visible(timeout=patient(120) * 1000)
    expect(sentence).to_have_text(re.compile(r"^Recovers in 0 of 1 instead of 1; .* new contact"))
    expect(sentence).to_have_attribute("data-verdict", "worse")

    first = rules.get("drive-my own")
    expect(first).to_contain_text("hang mapper at 10.0 s, way blocked at 10.5 s for 13.5 s")
    expect(first).to_contain_text("“Drive by the scan” fired once instead of never")
    first.get_by_role("button").first.click()
    rules.get("drive-moment").press("End")
    expect(rules.get("side-proposed").locator("[data-kind=contact]").first).to_be_visible()
    expect(rules.get("side-in_force").locator("[data-kind=contact]")).to_have_count(0)
    rules.page.keep("drill-glass")

    # What is worth keeping becomes a file, and a file is a drive of one's own again.
    with rules.page.page.expect_download() as downloading:
        first.get_by_test_id("drive-file").click()
    kept = tmp_path / "glass.yaml"
    downloading.value.save_as(kept)
    rules.get("drill-which").get_by_text("Drives drawn by chance").click()
    expect(rules.get("drill-earlier")).to_be_visible()
    expect(rules.get("drill-start")).to_have_text("Drill")
    rules.get("drill-which").get_by_text("One of my own").click()
    expect(rules.get("drill-earlier")).to_be_hidden()
    expect(rules.get("scenario-fault-2")).to_be_visible()  # nothing made up is lost by a look
    rules.get("goal-1-x").fill("-9")
    expect(rules.get("scenario-wrong")).to_contain_text("Goal 1 lies off the floor")
    rules.page.page.locator("input[type=file]").set_input_files(kept)
    expect(rules.get("scenario-fault-2").get_by_test_id("fault-parameter")).to_have_value("1")
    expect(rules.get("goal-1-x")).to_have_value("2 m")

    # What it took the place of comes back, and is still there when the page is loaded again.
    expect(rules.get("scenario-replaced")).to_contain_text("glass.yaml took the place")
    rules.get("scenario-replaced").get_by_text("Take that back").click()
    expect(rules.get("goal-1-x")).to_have_value("-9 m")
    rules.get("goal-1-y").fill("9999")
    expect(rules.get("scenario")).to_contain_text("At most 1000. It stays 0.5.")
    rules.page.page.reload()
    rules = RulesPage.of(rules.page)
    rules.review()
    expect(rules.get("goal-1-x")).to_have_value("-9 m")
    expect(rules.get("goal-1-y")).to_have_value("0.5 m")


def is_at(robot: Robot, x: float) -> bool:
    """Whether the robot has come to a place along x."""
    return abs(float(robot.newest["/simulator/ground_truth"].pose.pose.position.x) - x) < 0.1


def test_what_happened_yesterday_becomes_a_drive_of_ones_own_or_a_stretch_of_it(
    new_page: OpenPage, robot: Robot
) -> None:
    rules = RulesPage.opened(new_page(1440, 900), TOKEN)
    for x in (-1.0, -1.8):
        sent = rules.page.post("/api/goals", {"x": x, "y": -0.5})
        assert sent.ok, sent.text()
        wait_until(partial(is_at, robot, x), 30, "the robot at its goal")
    kept = rules.page.post("/api/recordings", {"seconds": 0, "name": "yesterday"})
    assert kept.ok, kept.text()
    propose_the_fallback(rules)
    rules.get("drill-which").get_by_text("One of my own").click()
    rules.choose(rules.get("scenario-recording"), "yesterday")
    expect(rules.get("scenario-remarks")).to_contain_text("2 goals", timeout=patient(20) * 1000)
    second = rules.get("goal-2-at")
    expect(second).to_be_visible()
    rules.get("stretch-begin").fill(second.input_value())
    rules.get("stretch-take").click()
    expect(rules.get("scenario-remarks")).to_contain_text("1 goal,")
    expect(rules.get("goal-1-x")).to_have_value("-1.8 m")
    rules.get("stretch-begin").fill("1 s")
    rules.get("stretch-end").fill("1.5 s")
    rules.get("stretch-take").click()
    expect(rules.get("scenario-problem")).to_contain_text("no goal was sent in that stretch")
    expect(rules.get("goal-1-x")).to_have_value("-1.8 m")
    rules.page.keep("drill-stretch")


def test_a_rule_that_holds_a_parked_robot_for_good_is_found_before_it_is_applied(
    new_page: OpenPage,
) -> None:
    """Where its world has the robot start, the nearest wall is 0.41 m away."""
    rules = RulesPage.opened(new_page(1440, 900), TOKEN)
    rules.get("rule-add").click()
    rules.get("rule-name").fill("Too near")
    condition = rules.get("event.condition")
    rules.choose(
        condition.get_by_test_id("add-condition"),
        "Nearest obstacle is closer than … (/scan)",
    )
    condition.get_by_test_id("literal").fill("0.5")
    rules.get("hold").fill("2")
    rules.choose(rules.get("add-action"), "Stop the robot")
    rules.review()
    rules.get("drill-which").get_by_text("One of my own").click()
    rules.get("scenario-map").click(position={"x": 200, "y": 150})
    rules.get("goal-1-x").fill("2")
    rules.get("goal-1-y").fill("0.5")
    rules.get("goal-1-at").fill("8 s")
    rules.get("scenario-limit").fill("60")
    rules.choose(rules.get("drill-count"), "1")
    # What an earlier drill has shown is no answer to this one, however long it takes to begin.
    held: list[Route] = []
    rules.page.page.route(
        "**/api/drills",
        lambda route: held.append(route) if route.request.method == "POST" else route.continue_(),
    )
    sentence = rules.get("drill-sentence")
    rules.get("drill-start").click()
    try:
        expect(rules.get("drill-start")).to_have_attribute("data-loading", "true")
        expect(sentence).to_be_hidden()
    finally:
        held.pop().continue_()
    expect(sentence).to_be_visible(timeout=patient(120) * 1000)
    expect(sentence).to_have_attribute("data-verdict", re.compile("worse|may be chance"))
    drive = rules.get("drive-my own")
    expect(drive).to_contain_text("STOP by rule Too near")
    drive.get_by_role("button").first.click()
    rules.get("drive-moment").fill("5")
    expect(rules.get("side-proposed").locator("[data-kind=stop]")).to_have_count(1)
    expect(rules.get("side-in_force").locator("[data-kind=stop]")).to_have_count(0)
    rules.page.keep("drill-parked")


def test_a_drill_that_somebody_else_begins_is_seen_where_the_page_is_open(
    new_page: OpenPage,
) -> None:
    rules = RulesPage.opened(new_page(1440, 900), TOKEN)
    rules.get("rule-add").click()
    rules.get("rule-name").fill("Careful")
    rules.choose(rules.get("event.condition").get_by_test_id("add-condition"), "Mapper is not well")
    rules.choose(rules.get("add-action"), "Stop the robot")
    rules.review()
    expect(rules.get("drill-progress")).to_have_count(0)
    table = rules.view["table"]
    begun = rules.page.page.context.request.post(
        f"{rules.page.origin}/api/drills",
        data={"table": table, "drives": 50},
        headers={"Origin": rules.page.origin},
    )
    assert begun.ok, begun.text()
    expect(rules.get("drill-progress")).to_be_visible()
    expect(rules.get("drill-others")).to_contain_text("began this drill")
    rules.get("drill-cancel").click()
    expect(rules.get("drill-canceled")).to_be_visible()
