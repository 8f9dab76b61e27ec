"""A person sees what has happened to the robot, looks closer, and takes note of alarms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import expect
from std_msgs.msg import Int32

from tests.browser.conftest import OpenPage
from tests.browser.console_page import UNCOVERED, ConsolePage
from tests.browser.test_places import opened
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.rules import compare, rule

pytestmark = pytest.mark.browser

PHONE = (390, 844)
BELL = {"kind": "raise_alarm", "alarm": "Bell <b>", "text": "Somebody is at the door."}


def table(page: ConsolePage) -> Any:
    answer = page.page.context.request.get(f"{page.origin}/api/rules")
    assert answer.ok
    return answer.json()


def hears_drive_manager(page: ConsolePage) -> bool:
    answer = page.page.context.request.get(f"{page.origin}/api/stop/without-login")
    return answer.json()["seen"] is not None


def put(page: ConsolePage, rules: list[Any], reason: str) -> int:
    """Put rules in force, for good; their revision."""
    now = table(page)
    body = {
        "table": {**now["table"], "rules": rules},
        "expected_revision": now["active"],
        "reason": reason,
        "probation": 0.0,
    }
    answer = page.post("/api/rules/apply", body)
    assert answer.ok, answer.text()
    return int(answer.json()["revision"])


def test_what_happened_is_on_one_axis_with_filter_zoom_and_ways_to_more(
    new_page: OpenPage, robot: Robot
) -> None:
    page = opened(new_page, "ava", 1400, 900)
    rings = rule("ring", compare("door", ">", 0), BELL, trigger="edge", severity="error")
    before = table(page)["table"]["rules"]
    revision = put(page, [*before, rings], "a bell at the door")
    wait_until(lambda: hears_drive_manager(page), 5, "the drive manager")
    answer = page.post("/api/stop", {"reason": "a child"})
    assert answer.ok, answer.text()
    expect(page.get("stop-band")).to_be_visible()
    page.release_stop()
    robot.wait_for_listeners("/door", "monitor")
    publisher = robot.node.create_publisher(Int32, "/door", 10)
    robot.wait_for_reliable_listener("/door", "monitor")
    publisher.publish(Int32(data=1))
    expect(page.get("alarm-band")).to_contain_text("Somebody is at the door.")

    page.page.keyboard.press("e")
    lines = page.get("timeline")
    expect(lines).to_contain_text(f"Revision {revision} in force · ava")
    expect(lines).to_contain_text("a bell at the door")
    expect(page.get("timeline-stop").first).to_contain_text("STOP · ava")
    expect(page.get("timeline-person").first).to_contain_text("Released STOP · ava")
    expect(page.get("timeline-alarm").first).to_contain_text("Bell <b>")
    page.keep("timeline")

    # Who has seen the alarm is told to everybody, and it is loud no more.
    expect(page.get("alarm-band")).to_have_attribute("data-tone", "failed")
    page.get("alarm-acknowledge").click()
    expect(page.get("alarm-band")).to_contain_text("Acknowledged by ava")
    expect(page.get("alarm-band")).to_have_attribute("data-tone", "notice")
    expect(page.get("timeline-alarm").first).to_contain_text("Acknowledged: Bell <b> · ava")
    page.get("alarm-shelve").click()
    page.get("alarm-shelve-3600").click()
    expect(page.get("alarm-band")).to_be_hidden()
    page.get("alarms-away-show").click()
    expect(page.get("alarm-band")).to_contain_text("Shelved by ava, for 60 min more")
    page.get("alarm-unshelve").click()
    expect(page.get("alarms-away")).to_be_hidden()

    # A note of one's own.
    page.get("timeline-note").fill("Left wheel changed")
    page.get("timeline-note-add").click()
    expect(page.get("timeline-person").first).to_contain_text("Left wheel changed · ava")

    # Only some of it: by kind, by words, by how bad.
    page.get("timeline-kind-person").click()
    expect(page.get("timeline-person")).to_have_count(0)
    page.get("timeline-kind-person").click()
    page.get("timeline-text").fill("LEFT WHEEL")
    expect(lines.locator("li")).to_have_count(1)
    page.get("timeline-text").fill("")
    page.page.get_by_role("combobox", name="How bad at least").click()
    page.page.get_by_role("option", name="errors only").click()
    expect(page.get("timeline-stop")).to_have_count(0)
    expect(page.get("timeline-alarm").first).to_contain_text("Bell <b>")
    page.page.get_by_role("combobox", name="How bad at least").click()
    page.page.get_by_role("option", name="everything").click()

    # Closer, by a drag over the first half, where nothing was; and back to now.
    box = page.get("timeline-plot").bounding_box()
    assert box is not None
    page.page.mouse.move(box["x"] + 2, box["y"] + 40)
    page.page.mouse.down()
    page.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 40, steps=4)
    page.keep("timeline-drag")
    page.page.mouse.up()
    expect(lines).to_contain_text("Nothing happened in this time.")
    page.page.get_by_text("1 h", exact=True).click()
    expect(page.get("timeline-stop").first).to_be_visible()
    page.get("timeline-plot").focus()
    page.page.keyboard.press("+")
    page.page.keyboard.press("ArrowRight")

    # From a firing to its Why, from an edit to its revision.
    page.page.get_by_text("1 h", exact=True).click()
    page.get("timeline-rule").filter(has_text="ring").first.click()
    expect(page.get("why")).to_contain_text("ring")
    page.get("rules-tab-timeline").click()
    page.get("timeline-edit").filter(has_text=f"Revision {revision} ").first.click()
    expect(page.get("history")).to_contain_text("a bell at the door")

    page.get("rules-tab-timeline").click()
    with page.page.expect_download() as download:
        page.get("timeline-export").click()
    taken = Path(download.value.path()).read_text(encoding="utf-8")
    assert "Left wheel changed" in taken
    put(page, before, "no bell")


def test_on_a_phone_the_timeline_is_read_and_stop_stays_free(new_page: OpenPage) -> None:
    page = opened(new_page, "ben", *PHONE, "dark")
    page.get("tab-rules").click()
    page.get("rules-tab-timeline").tap()
    expect(page.get("timeline")).to_contain_text("Monitor started")
    page.keep("timeline-phone")
    for part in ("rules-tab-timeline", "timeline-kind-robot", "stop-button"):
        assert page.get(part).evaluate(UNCOVERED), part
    width = page.page.evaluate("() => document.scrollingElement.scrollWidth")
    assert width <= PHONE[0]
