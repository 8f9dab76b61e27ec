"""Whoever drives by hand learns that there is nothing left to drive."""

from __future__ import annotations

import json

import pytest

from kompass_console.schema.roles import Role
from tests.console.conftest import Served, running_stack
from tests.console.rules_client import opened, until
from tests.console.test_by_hand import Page, page
from tests.support.processes import held, wait_until

pytestmark = pytest.mark.ros


def test_a_drive_manager_that_goes_takes_the_wheel_with_it_and_the_page_is_told(
    console: Served,
) -> None:
    with page(console, "ava") as ava:
        with running_stack():
            until(ava.states, lambda m: m["type"] == "state" and m["drive"] and m["pose"], 20.0)
            ava.take()
            ava.moving()
        wait_until(lambda: _lost(ava), 40, "that the wheel is lost")
        ava.say("ask")  # the socket is there still
        ava.answer(yours=False)
    outcomes = [line["outcome"] for line in console.audited() if line["what"] == "lose the wheel"]
    assert outcomes == ["the drive manager has gone"]


def test_who_asked_for_the_wheel_has_control_before_the_drive_manager_has_answered(
    console: Served,
) -> None:
    with running_stack() as stack, page(console, "ava") as ava, page(console, "ben") as ben:
        ava.take_when_free()  # of this drive manager, not of the one before
        ben.say("ask")
        assert ben.answer(message="ava has been asked.")
        with held(stack.pid):
            ava.say("give")
            ava.answer(yours=False, message="")
            ben.say("take")
            told = ben.answer(yours=False)["message"]
    assert told.startswith("You do not have the wheel: ")  # and not that ava has control


def test_who_loses_control_while_the_drive_manager_is_asked_does_not_get_the_wheel(
    console: Served,
) -> None:
    with (
        running_stack() as stack,
        page(console, "ava") as ava,
        console.client(Role.ENGINEER, user="eve") as eve,
        opened(console, "/api/state", eve),
    ):
        ava.take_when_free()
        ava.say("give")
        ava.robot(driver="")
        for what in ("take", "give"):
            assert eve.post(f"/api/control/{what}", json={"reason": "a look"}).status_code == 204
        until(ava.states, lambda m: m["type"] == "state" and not m["control"]["holder"])
        with held(stack.pid):
            ava.say("take")
            until(ava.states, lambda m: m["type"] == "state" and m["control"]["holder"] == "ava")
            taken = eve.post("/api/control/take", json={"reason": "somebody stands there"})
            assert taken.status_code == 204
        answer = until(ava.socket, lambda m: m["yours"] or m["message"])
        assert not answer["yours"]
        assert "eve has control" in answer["message"]
        ava.robot(driver="")
        eve.post("/api/logout")


def _lost(page: Page) -> bool:
    """Whether a page that goes on driving has been told that there is no use in it."""
    page.drive(0.2)
    try:
        answer = json.loads(page.socket.recv(timeout=0.05))
    except TimeoutError:
        return False
    assert answer["message"] == "The wheel was lost: the drive manager has gone. Take it again."
    return True
