"""A person reads, changes, tries, applies and takes back the rules of the running robot."""

import os
import re
import signal
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Route, expect
from std_msgs.msg import Int32

from kompass_console.audit.verify import verify
from tests.browser.conftest import OpenPage
from tests.browser.console_page import UNCOVERED, ConsolePage
from tests.browser.rules_page import RulesPage
from tests.ros.test_rules_live import say
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.rules import Rules, compare, rule
from tests.support.stack import TOKEN, Stack

pytestmark = pytest.mark.browser

RECIPE = Path(__file__).parents[2] / "recipes" / "03_events_and_actions.py"
STUCK = "stuck-unblock"


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    """Recipe 03, whose table has a rule "controller stuck → unblock"."""
    with closing(Stack.simulated(recipe=RECIPE)) as running:
        yield running


@pytest.fixture
def rules(new_page: OpenPage) -> RulesPage:
    """The rules of an operator's page, as they are opened."""
    return RulesPage.opened(new_page(1280, 800), TOKEN)


ON_BOTH = pytest.mark.parametrize(
    ("size", "button"),
    [((1280, 800), "rules"), ((390, 844), "tab-rules")],
    ids=["wide", "phone"],
)


def changed(page: ConsolePage, button: str) -> RulesPage:
    """Rules with one change that is not applied."""
    rules = RulesPage.opened(page, TOKEN, button)
    rules.edit(STUCK)
    rules.get("cooldown").fill("45")
    return rules


@ON_BOTH
def test_a_double_click_on_review_discards_nothing_and_discard_leads_back(
    new_page: OpenPage, size: tuple[int, int], button: str
) -> None:
    rules = changed(new_page(*size), button)
    rules.get("draft-review").dblclick()
    expect(rules.get("diff")).to_contain_text("cooldown 30 s → 45 s")
    expect(rules.get("draft-state")).to_contain_text("1 unsaved change")
    rules.get("draft-discard").click()
    expect(rules.rule(STUCK)).to_be_visible()
    expect(rules.get("draft-state")).to_contain_text("No unsaved changes")
    rules.get("draft-undo").click()
    expect(rules.get("draft-state")).to_contain_text("1 unsaved change")


@ON_BOTH
def test_apply_stays_where_it_is_while_the_review_is_still_being_filled(
    new_page: OpenPage, size: tuple[int, int], button: str
) -> None:
    """Whoever is about to press it, or chooses beside it, would press something else."""
    page = new_page(*size)
    held: list[Route] = []
    page.page.route("**/api/drills", lambda route: held.append(route))
    rules = changed(page, button)
    rules.review()
    expect(rules.get("drill-start")).to_be_disabled()
    probation = rules.get("apply-probation")
    probation.scroll_into_view_if_needed()
    before = probation.bounding_box()
    page.page.unroute("**/api/drills")
    page.page.route("**/api/drills", lambda route: route.abort())
    for route in held:
        route.abort()
    expect(rules.get("drill")).to_contain_text("does not answer")
    silent = probation.bounding_box()
    page.page.unroute("**/api/drills")
    expect(rules.get("drill-start")).to_be_enabled()
    after = probation.bounding_box()
    assert before is not None
    assert silent is not None
    assert after is not None
    assert abs(silent["y"] - before["y"]) < before["height"], (before, silent)
    assert abs(after["y"] - before["y"]) < before["height"], (before, after)


def test_a_cooldown_is_changed_reviewed_applied_and_kept(rules: RulesPage, stack: Stack) -> None:
    rules.edit(STUCK)
    rules.get("cooldown").fill("-5")
    expect(rules.get("rule-editor")).to_contain_text("It stays 30 s")
    expect(rules.get("draft-state")).to_contain_text("No unsaved changes")
    rules.page.keep("duration-refused")
    rules.get("cooldown").fill("2 min")
    expect(rules.get("draft-state")).to_contain_text("1 unsaved change")
    rules.get("hold").focus()
    expect(rules.get("cooldown")).to_have_value("2 min")
    rules.get("cooldown").fill("45")
    expect(rules.get("draft-state")).to_contain_text("1 unsaved change")
    rules.review()
    expect(rules.get("diff")).to_contain_text("cooldown 30 s → 45 s")
    expect(rules.get("effect")).to_contain_text("1 rule goes on as it was")
    revision = rules.apply("less often")
    expect(rules.get("probation-band")).to_contain_text(f"Revision {revision} is on probation")
    expect(rules.get("revision-badge")).to_contain_text("probation")
    rules.get("keep-it").click()
    expect(rules.get("revision-badge")).to_contain_text("confirmed")
    expect(rules.get("probation-band")).to_be_hidden()
    assert rules.in_force(STUCK)["event"]["cooldown"] == 45.0
    expect(rules.get("applied")).to_contain_text("It stays.")
    rules.get("rules-tab-table").click()
    expect(rules.rule(STUCK)).to_contain_text("cooldown 45 s")


def test_what_was_applied_and_taken_back_is_not_said_to_be_in_force(rules: RulesPage) -> None:
    before = rules.in_force(STUCK)["event"]["cooldown"]
    rules.edit(STUCK)
    rules.get("cooldown").fill("52")
    rules.review()
    revision = rules.apply("to see it")
    expect(rules.get("applied")).to_contain_text("unless you keep it")
    rules.get("take-back").click()
    expect(rules.get("applied")).to_contain_text(
        f"Revision {revision} was applied, and is no longer in force"
    )
    assert rules.in_force(STUCK)["event"]["cooldown"] == before


def test_a_rule_from_nothing_without_a_type_name_fires_is_explained_and_rolled_back(
    rules: RulesPage, robot: Robot
) -> None:
    before = rules.revision
    rules.get("rule-add").click()
    # Typed at once, it is its name, and no letter of it a shortcut of the page.
    expect(rules.get("rule-name")).to_be_focused()
    rules.page.page.keyboard.type("Too near: stop")
    expect(rules.get("rule-name")).to_have_value("Too near: stop")
    condition = rules.get("event.condition")
    rules.choose(condition.get_by_test_id("add-condition"), re.compile("Nearest obstacle"))
    condition.get_by_test_id("literal").fill("0.3")
    # Beside it stands what the robot makes of it right now.
    expect(condition.get_by_test_id("leaf-now")).to_contain_text(
        re.compile(r"now 0\.\d+ →\s+false")
    )
    rules.get("hold").fill("2")
    rules.choose(rules.get("add-action"), "Write a line to the log")
    rules.get("log-text").fill("too near")
    rules.choose(rules.get("add-action"), "Stop the robot")
    rules.choose(rules.get("severity"), "error")
    rules.review()
    rules.get("backtest-start").click()
    expect(rules.get("backtest-report")).to_contain_text("no longer")
    revision = rules.apply("shelves ahead")

    # A place 24 cm from a pillar.
    robot.click(-1.1, -0.39, taker="monitor")
    rules.get("rules-tab-firings").click()
    firing = rules.get("firing-too-near-stop").first
    expect(firing).to_contain_text("ok")
    robot.has_stopped()
    firing.click()
    expect(rules.get("firing-details")).to_contain_text(f"revision {revision}")
    leaf = rules.get("firing-details").get_by_test_id("leaf")
    expect(leaf).to_contain_text(re.compile(r"was 0\.[0-2]\d* →\s+true"))

    rules.get("firing-rollback").click()
    wait_until(lambda: rules.revision > revision, 5, "another revision")
    rules.get("rules-tab-table").click()
    expect(rules.rule("too-near-stop")).to_have_count(0)
    # The rule is gone, and the robot still stands for it: what made it fire then is a press away.
    rules.get("stop-why").click()
    expect(rules.get("firing-details")).to_contain_text(f"revision {revision}")
    expect(leaf).to_contain_text(re.compile(r"was 0\.[0-2]\d* →\s+true"))
    robot.release()
    rules.get("rules-tab-history").click()
    expect(rules.get(f"revision-{revision}")).to_contain_text("shelves ahead")
    assert before < revision
    # What was around a severe firing is kept, and found from there.
    rules.get("rules-tab-firings").click()
    rules.get("firing-too-near-stop").first.click()
    rules.get("firing-recording").click()
    kept = rules.get("recordings").locator("li[data-wanted]")
    expect(kept).to_contain_text("too-near-stop")
    with rules.page.page.expect_download() as download:
        kept.get_by_test_id("recording-download").click()
    assert download.value.path().read_bytes().startswith(b"\x89MCAP")
    expect(kept.get_by_test_id("recording-delete")).to_have_count(0)


def test_a_rule_that_is_true_already_says_so_before_it_stops_the_robot(
    rules: RulesPage, robot: Robot
) -> None:
    """Something is nearer than 20 m all the time; no rule in force looks at the scan."""
    rules.get("rule-add").click()
    rules.get("rule-name").fill("Walls: stop")
    condition = rules.get("event.condition")
    rules.choose(condition.get_by_test_id("add-condition"), "When a value compares …")
    rules.choose(condition.get_by_test_id("topic-picker"), "/scan")
    rules.choose(condition.get_by_test_id("field-picker"), re.compile("nearest obstacle"))
    rules.choose(condition.get_by_test_id("operator"), re.compile("less than"))
    condition.get_by_test_id("literal").fill("20")
    rules.get("hold").fill("2")
    rules.choose(rules.get("add-action"), "Stop the robot")
    rules.review()
    said = "is true now: it will fire in 2.0 s after Apply"
    expect(rules.get("true-now")).to_contain_text(f"'Walls: stop' {said}")
    expect(rules.get("acts-at-once")).to_contain_text("This may stop or move the robot")
    rules.get("backtest-start").click()
    expect(rules.get("backtest-report")).to_contain_text("1 new")
    rules.apply("to see it")
    rules.get("rules-tab-firings").click()
    expect(rules.get("firing-walls-stop").first).to_contain_text("ok")
    robot.has_stopped()
    rules.get("firing-walls-stop").first.click()
    rules.get("firing-rollback").click()
    rules.get("rules-tab-table").click()
    expect(rules.rule("walls-stop")).to_have_count(0)
    robot.release()


def test_a_rule_that_is_spent_says_so_wherever_it_is_shown_and_is_reset_there(
    rules: RulesPage, robot: Robot
) -> None:
    table = Rules(robot)
    spent = {"cooldown": 0.0, "once": True, "name": "Spent at once"}
    table.add(rule("spent", compare("spend", ">", 0), **spent), role="operator")

    def spend() -> None:
        say(robot, Int32, "/spend", 1)
        wait_until(lambda: table.status("spent").state == "used up", 10, "the one firing")

    used_up = re.compile(r"Used up at \d\d:\d\d; will not fire again until reset")
    try:
        spend()
        row = rules.rule("spent")
        expect(row.get_by_test_id("used-up")).to_contain_text(used_up)
        expect(rules.rule(STUCK).get_by_test_id("used-up")).to_have_count(0)
        row.get_by_test_id("rule-why").click()
        expect(rules.get("why").get_by_test_id("used-up")).to_contain_text(used_up)
        rules.get("why").get_by_test_id("used-up-reset").click()
        expect(rules.get("why").get_by_test_id("used-up")).to_have_count(0)
        # It fires again, and is spent again.
        spend()
        expect(rules.get("why").get_by_test_id("used-up")).to_contain_text(used_up)
        rules.get("rules-tab-table").click()
        rules.edit("spent")
        expect(rules.get("rule-editor").get_by_test_id("used-up")).to_contain_text(used_up)
        rules.get("rules-tab-table").click()
        rules.rule("spent").get_by_test_id("used-up-reset").click()
        expect(rules.rule("spent").get_by_test_id("used-up")).to_have_count(0)
    finally:
        table.remove("spent")


def test_a_draft_outlives_a_reload_and_is_taken_back_change_by_change(rules: RulesPage) -> None:
    rules.rule(STUCK).get_by_test_id("rule-toggle").click()
    rules.edit("click-to-goal")
    rules.get("rule-name").fill("A click")
    rules.page.page.reload()
    rules = RulesPage.of(rules.page)
    expect(rules.get("draft-state")).to_contain_text("2 unsaved changes")
    rules.rule(STUCK).get_by_test_id("rule-discard").click()
    expect(rules.get("draft-state")).to_contain_text("1 unsaved change")
    rules.get("draft-undo").click()
    expect(rules.get("draft-state")).to_contain_text("2 unsaved changes")
    rules.get("draft-discard").click()
    expect(rules.get("draft-state")).to_contain_text("No unsaved changes")


def test_two_who_edit_one_rule_see_both_changes_and_lose_nothing_typed(
    rules: RulesPage, new_page: OpenPage
) -> None:
    other = RulesPage.opened(new_page(1280, 800), TOKEN)
    other.edit(STUCK)
    other.get("cooldown").fill("77")
    stood = other.get("cooldown").bounding_box()
    rules.edit(STUCK)
    rules.get("cooldown").fill("12")
    rules.get("rule-name").fill("Stuck: get free")
    rules.review()
    revision = rules.apply("mine first")
    rules.get("keep-it").click()

    expect(other.get("overtaken-band")).to_contain_text(f"revision {revision}")
    # What is told meanwhile moves nothing of what somebody is about to press.
    assert other.get("cooldown").bounding_box() == stood
    expect(other.get("cooldown")).to_have_value(re.compile(r"^77( s)?$"))
    other.get("open-conflict").click()
    choice = other.get(f"conflict-{STUCK}")
    expect(choice.get_by_test_id("keep-mine")).to_contain_text("→ 77 s")
    expect(choice.get_by_test_id("keep-theirs")).to_contain_text("→ 12 s")
    expect(other.get("conflict-merge")).to_be_disabled()
    # Their name, and my cooldown: it is the one that both have touched.
    choice.get_by_test_id("keep-fields").click()
    expect(other.get("conflict-merge")).to_be_disabled()
    choice.get_by_test_id("field-event.cooldown").get_by_test_id("field-mine").click()
    other.get("conflict-merge").click()
    expect(other.get("diff")).to_contain_text("cooldown 12 s → 77 s")
    expect(other.get("diff")).not_to_contain_text("name")
    other.apply("after a talk")
    assert other.in_force(STUCK)["name"] == "Stuck: get free"
    other.get("take-back").click()
    wait_until(lambda: other.in_force(STUCK)["event"]["cooldown"] == 12.0, 5, "the way back")


def test_a_form_is_filled_by_keys_alone_and_leaves_the_keyboard_where_it_was(
    rules: RulesPage,
) -> None:
    keys = rules.page.page.keyboard
    edit = rules.rule(STUCK).get_by_test_id("rule-edit")
    edit.focus()
    keys.press("Enter")
    expect(rules.get("rule-editor")).to_be_visible()
    rules.get("rule-name").focus()
    keys.press("Tab")
    keys.press("Enter")  # opens the list of the kinds of conditions
    expect(rules.page.page.get_by_role("listbox")).to_be_visible()
    keys.press("Escape")
    expect(rules.page.page.get_by_role("listbox")).to_be_hidden()
    expect(rules.get("rule-editor")).to_be_visible()
    rules.get("editor-back").focus()
    keys.press("Escape")
    expect(edit).to_be_focused()
    rules.rule(STUCK).get_by_test_id("rule-menu").focus()
    keys.press("Enter")
    expect(rules.page.page.get_by_role("menu")).to_be_visible()
    keys.press("Escape")
    expect(rules.page.page.get_by_role("menu")).to_be_hidden()
    expect(rules.get("rule-table")).to_be_visible()
    rules.get("rules-close").focus()
    keys.press("Enter")
    expect(rules.get("rules")).to_be_focused()


def test_page_and_robot_agree_after_console_and_monitor_died_in_the_middle_of_an_edit(
    rules: RulesPage, stack: Stack
) -> None:
    rules.edit(STUCK)
    rules.get("cooldown").fill("33")
    before = rules.in_force(STUCK)["event"]["cooldown"]
    for process in ("monitor", "console"):
        _kill(stack, process)
        expect(rules.get("cooldown")).to_have_value(re.compile(r"^33( s)?$"))
        # The page may not have seen yet that somebody died; the robot answers for itself.
        wait_until(rules.answers, 20, f"the robot's rules after the death of the {process}")
        expect(rules.get("rules-stale")).to_be_hidden()
    assert rules.in_force(STUCK)["event"]["cooldown"] == before
    expect(rules.get("draft-state")).to_contain_text("1 unsaved change")
    rules.review()
    rules.apply("after the crash")
    assert rules.in_force(STUCK)["event"]["cooldown"] == 33.0
    rules.get("take-back").click()
    wait_until(lambda: rules.in_force(STUCK)["event"]["cooldown"] == before, 5, "the way back")


def test_a_viewer_reads_everything_and_can_change_nothing(new_page: OpenPage, stack: Stack) -> None:
    found = re.search(r"To watch:\s+\S+#token=(\S+)", stack.output)
    assert found
    rules = RulesPage.opened(new_page(1280, 800), found[1])
    expect(rules.get("viewer-note")).to_contain_text("log in as an operator")
    for button in ("rule-add", "rule-edit", "rule-toggle", "rule-menu", "draft-review"):
        expect(rules.get(button)).to_have_count(0)
    rules.rule(STUCK).get_by_test_id("rule-why").click()
    expect(rules.get("why-answer")).to_be_visible()
    rules.get("rules-tab-history").click()
    expect(rules.get("revision-1")).to_be_visible()
    expect(rules.get("roll-back")).to_have_count(0)
    table = rules.view["table"]
    revision = rules.revision
    for path, body in (
        ("/api/rules/apply", {"table": table, "expected_revision": revision}),
        ("/api/rules/rollback", {"revision": 1, "expected_revision": revision}),
        ("/api/rules/confirm", {"revision": revision}),
        (f"/api/rules/{STUCK}/reset", None),
    ):
        answer = rules.page.post(path, body)
        assert answer.status == 403, path
        assert "viewer" in answer.json()["detail"]["title"]
    assert rules.revision == revision


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (390, 844)], ids=["wide", "phone"])
def test_an_engineer_sees_who_did_what_and_everybody_when_that_is_not_written(
    new_page: OpenPage, stack: Stack, robot: Robot, width: int, height: int
) -> None:
    found = re.search(r"Engineer:\s+\S+#token=(\S+)", stack.output)
    assert found
    opener = "tab-rules" if width < 560 else "rules"
    operator = RulesPage.opened(new_page(width, height), TOKEN, opener)
    expect(operator.get("rules-tab-audit")).to_have_count(0)
    operator.page.post("/api/stop", {"reason": "a child on the floor"})
    operator.page.post("/api/stop/release", None)
    for _ in range(60):
        operator.page.post("/api/rules/confirm", {"revision": 4000})
    rules = RulesPage.opened(new_page(width, height), found[1], opener)
    rules.get("rules-tab-audit").click()
    lines = rules.get("audit").locator("tbody tr")
    expect(lines).to_have_count(50)
    rules.get("audit-older").click()
    expect(lines).not_to_have_count(50)
    rules.get("audit-filter").fill("a CHILD")
    expect(lines.first).to_contain_text("operator")
    expect(lines.first).to_contain_text("stop")
    expect(lines.first).to_contain_text("reason: a child on the floor")
    expect(lines.first).to_contain_text("127.0.0.1")
    rules.page.keep(f"audit-{width}")
    assert rules.page.page.evaluate("() => document.documentElement.scrollWidth") <= width
    with rules.page.page.expect_download() as download:
        rules.get("audit-export").click()
    assert verify(download.value.path()).broken == ""

    [folder] = stack.data_dir.glob("*/audit")
    folder.rename(folder.with_name("audit-elsewhere"))
    folder.write_text("no folder")
    try:
        operator.page.post("/api/stop", {"reason": "all the same"})
        wait_until(lambda: robot.newest["/drive_state"].stopped, 5, "the stop")
        operator.get("rules-close").click()
        expect(operator.get("audit-band")).to_contain_text("The audit log is not written")
    finally:
        folder.unlink()
        folder.with_name("audit-elsewhere").rename(folder)
    expect(operator.get("audit-band")).to_be_hidden()
    robot.release()


@pytest.mark.parametrize(("width", "height"), [(390, 844), (820, 1180)], ids=["phone", "tablet"])
def test_rules_are_a_tab_of_a_small_screen_and_stop_stays_free(
    new_page: OpenPage, width: int, height: int
) -> None:
    rules = RulesPage.opened(new_page(width, height, has_touch=True), TOKEN, "tab-rules")
    page = rules.page
    for button in ("rule-why", "rule-edit", "rule-toggle"):
        for each in rules.get(button).all():
            each.scroll_into_view_if_needed()
            box = each.bounding_box()
            assert box is not None
            assert min(box["width"], box["height"]) >= 44, button
            assert box["x"] + box["width"] <= width
    way_out = rules.get("rules-close").bounding_box()
    assert way_out is not None
    assert width - 8 <= way_out["x"] + way_out["width"] <= width
    _stop_is_free(page.get("stop-button"))
    rules.edit(STUCK)
    expect(rules.get("cooldown")).to_be_visible()
    _stop_is_free(page.get("stop-button"))
    assert page.page.evaluate("() => document.documentElement.scrollWidth") <= width
    page.get("stop-button").tap()
    expect(page.get("stop-band")).to_be_visible()
    assert page.get("stop-band").count() == 1
    page.keep(f"stopped-over-rules-{width}")
    page.release_stop()
    expect(page.get("stop-band")).to_be_hidden()


# Pairs of what is drawn in the header and lies over something else there.
OVERLAPS = """(header) => {
  const drawn = [...header.querySelectorAll("svg, strong, span")].filter(
    (each) => each.tagName === "svg" ||
      (each.children.length === 0 && each.closest(".visually-hidden") === null));
  const boxes = drawn.map((each) => each.getBoundingClientRect());
  const over = [];
  boxes.forEach((one, i) => boxes.slice(i + 1).forEach((other, j) => {
    const across = Math.min(one.right, other.right) - Math.max(one.left, other.left);
    if (one.width > 1 && other.width > 1 && across > 0.5)  // what is for screen readers is 1 px
      over.push([drawn[i].outerHTML, drawn[i + 1 + j].outerHTML]);
  }));
  return over;
}"""


def test_a_rule_that_stops_the_robot_is_written_on_a_phone(new_page: OpenPage) -> None:
    phone = new_page(390, 844, has_touch=True, is_mobile=True)
    rules = RulesPage.opened(phone, TOKEN, "tab-rules")
    rules.get("rule-add").tap()
    rules.get("rule-name").fill("Stop here")
    rules.get("add-action").tap()  # straight from the name: what is pressed keeps the focus
    phone.page.get_by_role("option", name="Stop the robot", exact=True).tap()
    expect(rules.get("actions[0]").get_by_role("combobox").first).to_have_value("Stop the robot")
    expect(rules.get("revision-badge")).to_contain_text("1")
    expect(rules.get("sim-rate")).to_be_visible()
    header = phone.page.get_by_role("banner")
    assert header.evaluate(OVERLAPS) == []
    assert header.evaluate("(element) => element.scrollWidth <= element.clientWidth")
    name = header.locator("strong")
    assert name.evaluate("(element) => element.scrollWidth <= element.clientWidth"), "cut"
    phone.keep("header-phone")


# As high as Mantine goes, over the whole page: a dialog, a drawer, a notification.
DIALOG = """() => {
  const dialog = document.createElement("div");
  dialog.style = "position: fixed; inset: 0; z-index: 9999; background: rgb(0 0 0 / 40%)";
  document.body.append(dialog);
}"""


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize(("width", "height"), [(1280, 800), (390, 844)], ids=["wide", "phone"])
def test_nothing_is_ever_laid_over_stop(
    new_page: OpenPage, width: int, height: int, theme: str
) -> None:
    phone = width < 560
    page = new_page(width, height, has_touch=phone, color_scheme=theme)
    rules = RulesPage.opened(page, TOKEN, "tab-rules" if phone else "rules")
    stop = page.get("stop-button")
    rules.get("rule-menu").last.click()
    expect(page.page.get_by_role("menu")).to_be_visible()
    assert stop.evaluate(UNCOVERED)
    page.page.keyboard.press("Escape")
    rules.edit(STUCK)
    lists = rules.get("rule-editor").locator("input[aria-haspopup=listbox]")
    assert lists.count() > 3
    for each in lists.all():
        each.evaluate("(element) => element.scrollIntoView({ block: 'end' })")
        each.click()
        expect(page.page.get_by_role("listbox")).to_be_visible()
        assert stop.evaluate(UNCOVERED), each.get_attribute("data-testid")
        page.page.keyboard.press("Escape")
    page.page.evaluate(DIALOG)
    assert stop.evaluate(UNCOVERED)


def test_the_space_bar_stops_wherever_it_is_no_text(rules: RulesPage, robot: Robot) -> None:
    page = rules.page
    keys = page.page.keyboard

    def stops_by(chord: str) -> None:
        with page.page.expect_request("**/api/stop"):
            keys.press(chord)

    rules.edit(STUCK)
    severity, listbox = rules.get("severity"), page.page.get_by_role("listbox")
    severity.focus()
    stops_by("Space")
    expect(listbox).to_be_hidden()
    severity.click()
    expect(listbox).to_be_visible()
    stops_by("Space")
    page.page.keyboard.press("Escape")
    rules.get("editor-back").focus()
    stops_by("Space")
    expect(rules.get("rule-editor")).to_be_visible()
    name = rules.get("rule-name")
    name.fill("A")
    name.press_sequentially(" name")
    expect(name).to_have_value("A name")
    stops_by("Control+Space")
    expect(name).to_have_value("A name")
    # A list that is searched takes text, too.
    rules.get("add-action").click()
    stops_by("Control+Space")
    expect(page.get("stop-button")).to_have_attribute("data-phase", "stopped")
    robot.has_stopped()
    robot.release()


def _kill(stack: Stack, process: str) -> None:
    """End a process without a word, and wait for the next one."""
    killed = stack.pid_of(process)
    os.kill(killed, signal.SIGKILL)
    wait_until(lambda: stack.pid_of(process) != killed, 10, f"another {process}")


def _stop_is_free(stop: Locator) -> None:
    """STOP, and nothing else, is what a finger hits in its middle."""
    assert stop.evaluate(
        """(element) => {
          const box = element.getBoundingClientRect();
          const x = box.left + box.width / 2, y = box.top + box.height / 2;
          return element.contains(document.elementFromPoint(x, y));
        }"""
    )
