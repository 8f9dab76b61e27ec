"""Whoever hears the page, or works it by keys, meets nothing that axe knows to be in the way."""

import re
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import ConsolePage
from tests.support.stack import RECIPE, Stack

pytestmark = pytest.mark.browser

AXE = Path(__file__).parents[2] / "web" / "node_modules" / "axe-core" / "axe.min.js"
# Of the rules that axe does not apply by itself, the one that whoever speaks to the page needs.
RUN = """() => axe.run(document, {
  resultTypes: ["violations"],
  rules: { "label-content-name-mismatch": { enabled: true } },
}).then(({ violations }) => violations.map(({ id, nodes }) =>
  `${id}: ${nodes.map(({ html }) => html.slice(0, 200)).join(" | ")}`))"""
NO_SCENE = "<!doctype html><html lang='en'><title>scene</title><body></body></html>"
STUCK = "rule-stuck-unblock"


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    """Recipe 03, whose table has rules to look at."""
    with closing(Stack.simulated(recipe=RECIPE.with_name("03_events_and_actions.py"))) as running:
        yield running


class Judge:
    """Asks axe about each state of one page, and keeps what it finds."""

    def __init__(self, page: ConsolePage) -> None:
        self._page = page
        self.wrong: list[str] = []
        self._axe = AXE.read_text(encoding="utf-8")

    def __call__(self, state: str, shown: str) -> None:
        """Judge the page once an element is shown, by its test id."""
        expect(self._page.get(shown).first).to_be_visible()
        # What moves in is half transparent meanwhile, and half as well to be read.
        self._page.page.wait_for_function("() => document.getAnimations().length === 0")
        if not self._page.page.evaluate("() => 'axe' in window"):
            self._page.page.evaluate(self._axe)
        found: list[Any] = self._page.page.evaluate(RUN)
        self.wrong += [f"{state}: {each}" for each in found]


@pytest.mark.parametrize(
    ("width", "height", "theme"),
    [(1280, 800, "light"), (390, 844, "dark")],
    ids=["wide-light", "phone-dark"],
)
def test_axe_finds_nothing_wrong_in_any_state_of_the_page(
    new_page: OpenPage, stack: Stack, width: int, height: int, theme: str
) -> None:
    phone = width < 560
    # axe is evaluated in the page, which its own content policy would not let anybody do.
    page = new_page(width, height, color_scheme=theme, has_touch=phone, bypass_csp=True)
    # Without the scene, which has no words and would take all of the processor.
    page.page.route(
        "**/scene/**", lambda route: route.fulfill(body=NO_SCENE, content_type="text/html")
    )
    judge, get, keys = Judge(page), page.get, page.page.keyboard
    found = re.search(r"Engineer:\s+\S+#token=(\S+)", stack.output)
    assert found
    page.page.goto(f"{page.origin}/")
    judge("login", "login-token")
    get("login-token").fill(found[1])
    get("login-submit").click()
    expect(get("pose")).to_contain_text("m/s")
    judge("drive", "scene-frame")
    for opener, inside in (("layers", "layer-map"), ("user-menu", "logout")):
        get(opener).click()
        judge(opener, inside)
        keys.press("Escape")
        expect(get(inside)).to_be_hidden()
    get("user-menu").click()
    get("notify-item").click()
    page.page.get_by_label("Not during quiet hours").check()
    judge("notifications", "notify-sound")
    keys.press("Escape")
    expect(get("notify-sound")).to_be_hidden()
    if phone:
        get("user-menu").click()
    get("help-item" if phone else "help").click()
    judge("help", "help-panel")
    page.page.get_by_label("Close help").click()

    get("goal-tool").click()
    get("goal-type").click()
    get("coordinate-x").fill("0.55")
    get("coordinate-y").fill("0.55")
    judge("coordinates", "coordinate-check")
    get("coordinate-check").click()
    judge("goal card", "goal-go")
    get("goal-save-place").click()
    judge("name for a place", "place-save")
    get("place-name").fill("Dock")
    get("place-save").click()
    get("goal-cancel").click()
    get("goal-tool").click()
    get("locate-tool").click()
    get("locate-type").click()
    get("coordinate-x").fill("0.55")
    get("coordinate-y").fill("0.55")
    get("coordinate-check").click()
    judge("card of the robot's place", "locate-set")
    get("locate-cancel").click()
    get("locate-tool").click()
    if phone:
        for tab, inside in (
            ("tab-places", "place-add"),
            ("tab-health", "health-planner"),
            ("tab-data", "fit-row"),
        ):
            get(tab).click()
            judge(tab, inside)

    if phone:
        get("tab-places").click()
    get("place-menu").click()
    judge("menu of a place", "place-delete")
    keys.press("Escape")
    get("place-menu").click()
    get("place-edit").click()
    judge("place that is changed", "place-save")
    get("place-name").press("Escape")
    get("place-menu").click()
    get("place-delete").click()
    judge("place that was deleted", "place-undo")

    get("tab-rules" if phone else "rules").click()
    judge("rules", "rule-table")
    get("rule-menu").first.click()
    judge("menu of a rule", "rule-delete")
    keys.press("Escape")
    get(STUCK).get_by_test_id("rule-why").click()
    judge("why", "why-answer")
    get("rules-tab-table").click()
    get("rule-add").click()
    judge("new rule", "rule-editor")
    get("draft-discard").click()
    get("rules-tab-table").click()
    get(STUCK).get_by_test_id("rule-edit").click()
    judge("editor", "leaf-now")
    get("add-action").click()
    expect(page.page.get_by_role("listbox")).to_be_visible()
    judge("list", "add-action")
    keys.press("Escape")
    get("cooldown").fill("45")
    get("draft-review").click()
    judge("review and drill", "effect")
    get("draft-discard").click()
    for tab, inside in (
        ("history", "history"),
        ("firings", "firings"),
        ("timeline", "timeline-plot"),
        ("log", "log-text"),
        ("recordings", "recordings"),
        ("audit", "audit"),
    ):
        if tab == "log" and phone:  # no tab there: it is reached from Health
            get("tab-health").click()
            get("log-all").click()
        else:
            get(f"rules-tab-{tab}").click()
        judge(tab, inside)

    get("stop-button").click()
    expect(get("stop-button")).to_have_attribute("data-phase", "stopped")
    judge("stopped", "stop-band")
    assert judge.wrong == []
