"""Two people see who drives; one asks, is not answered, and takes over with a reason."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import OpenPage
from tests.browser.console_page import UNCOVERED, ConsolePage
from tests.browser.test_places import PHONE, opened
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.robot import Robot

pytestmark = pytest.mark.browser

GATE = {"x": 0.55, "y": -0.55}


def drives(page: ConsolePage) -> None:
    wait_until(lambda: page.post("/api/goals", GATE).ok, 20, "a goal that is sent")


def test_control_is_seen_asked_for_kept_given_and_taken(new_page: OpenPage, robot: Robot) -> None:
    desk, phone = opened(new_page, "ava"), opened(new_page, "ben", *PHONE, "dark")
    assert desk.get("control-badge").count() == 0  # nobody drives
    drives(desk)
    expect(desk.get("control-badge")).to_have_text("You have control")
    expect(phone.get("control-line")).to_have_text("ava has control")

    # Who has no control is told where to ask for it, and can stop the robot.
    refused = phone.post("/api/goals", GATE)
    assert refused.status == 409
    assert "Ask for it" in refused.text()
    assert phone.get("stop-button").evaluate(UNCOVERED)

    phone.get("control-badge").tap()
    phone.get("control-ask").tap()
    expect(phone.get("control-waits")).to_contain_text("ava has control, and may answer for")
    asked = desk.get("control-asked")
    expect(asked).to_contain_text("ben asks you for control.")
    desk.get("control-keep").click()
    expect(asked).to_be_hidden()
    expect(phone.get("control-waits")).to_be_hidden()
    phone.get("control-badge").tap()
    phone.get("control-ask").tap()
    desk.get("control-give").click()
    expect(phone.get("control-line")).to_be_hidden()
    expect(desk.get("control-badge")).to_have_text("ben has control")

    # Nobody answers on the phone: it may be taken, and the phone is told why.
    desk.get("control-badge").click()
    desk.get("control-ask").click()
    expect(desk.get("control-unanswered")).to_contain_text(
        "Nobody has answered.", timeout=patient(40) * 1000
    )
    desk.get("control-reason").fill("the phone lies in the hall")
    desk.get("control-take").click()
    expect(desk.get("control-badge")).to_have_text("You have control")
    lost = phone.get("control-lost")
    expect(lost).to_contain_text("ava has taken control from you.")
    expect(lost).to_contain_text("the phone lies in the hall")
    lost.get_by_role("button").tap()
    expect(lost).to_be_hidden()

    # Given up, it is the next one's who drives.
    desk.get("control-badge").click()
    desk.get("control-give-up").click()
    expect(desk.get("control-badge")).to_be_hidden()
    drives(phone)
    expect(desk.get("control-badge")).to_have_text("ben has control")

    # A goal that would be refused is not offered, and the card says whom to ask.
    assert phone.post("/api/places", {"name": "Bay", "pose": {"x": 0.55, "y": -0.55}}).ok
    desk.page.keyboard.press("p")
    desk.page.get_by_label("Go to Bay").click()
    expect(desk.get("goal-card")).to_contain_text("ben has control. Ask for it")
    expect(desk.get("goal-go")).to_be_disabled()
    desk.get("goal-cancel").click()
