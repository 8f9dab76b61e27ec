"""What people and robots call things is shown and logged as one short line, whatever it is."""

from __future__ import annotations

import asyncio
import json
from typing import Any

import pytest
import rclpy
from automatika_ros_sugar.msg import ComponentStatus
from kompass_interfaces.msg import DriveState
from rclpy.context import Context
from rclpy.qos import DurabilityPolicy, QoSProfile

from kompass.rulebook.schema.status import RuleStatus
from kompass_console.link.rules.watch import RulesWatch
from kompass_console.schema.plain import LONGEST_TEXT, plain, plain_json
from kompass_console.schema.roles import Role
from kompass_console.schema.rule_models import RollbackRequest
from kompass_console.web.rules_feed import RulesFeed
from tests.console.conftest import Served
from tests.console.rules_client import opened, until

pytestmark = pytest.mark.ros

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
NASTY = "eve\n\x1b[31m\x9b\u202e\u2028\u200b " + "x" * 5000


def is_fit(text: str) -> bool:
    return text.isprintable() and len(text) <= LONGEST_TEXT


def test_a_text_becomes_one_short_line_and_a_good_one_stays_as_it_is() -> None:
    assert is_fit(plain(NASTY))
    assert plain("x" * 41, 40) == "x" * 39 + "…"
    for good in ("", "Ava", "Küche 2 → Tür", "机器人", "a 🤖", "stopped: 3 m/s²"):
        assert plain(good) == good


def test_what_comes_as_data_is_bounded_in_every_part() -> None:
    deep: Any = NASTY
    for _ in range(500):
        deep = [deep, {NASTY: 1.5}]
    told = plain_json({"deep": deep, "long": [NASTY] * 5000, "fine": [1, True, None, "a"]})
    assert isinstance(told, dict)
    assert told["fine"] == [1, True, None, "a"]
    text = json.dumps(told, ensure_ascii=False)
    assert text.isprintable()
    assert len(text) < 300_000


def test_what_a_robot_says_is_shown_in_short_lines(console: Served) -> None:
    context = Context()
    rclpy.init(args=[], context=context)
    node = rclpy.create_node("talker", context=context)
    try:
        drive = node.create_publisher(DriveState, "/drive_state", LATCHED)
        drive.publish(DriveState(stopped=True, stopped_by=NASTY, reason=NASTY, limited_by=NASTY))
        health = node.create_publisher(ComponentStatus, "/talker/status", LATCHED)
        status = ComponentStatus(status=3, msg=NASTY)
        status.src_topics = [NASTY] * 300

        def heard(message: dict[str, Any]) -> bool:
            health.publish(status)  # again and again, as components do
            told = message.get("components")
            return bool(message.get("drive") and told and told[0]["status"] != "silent")

        with console.client(Role.VIEWER) as client, opened(console, "/api/state", client) as page:
            state = until(page, heard, 15.0)
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)
    said = [state["drive"][key] for key in ("stopped_by", "reason", "limited_by")]
    component = state["components"][0]
    said += [component["message"], *component["sources"]]
    assert all(is_fit(text) and text.startswith("eve") for text in said), said
    assert len(component["sources"]) <= 50


async def first_message(watch: RulesWatch) -> str:
    feed = RulesFeed()
    running = asyncio.create_task(feed.run(watch, "ava"))
    await asyncio.sleep(0)  # it has begun
    text, _ = feed.message(0)
    running.cancel()
    return text


def test_what_the_monitor_says_of_rules_is_shown_in_short_lines(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    watch = RulesWatch(lambda: None, lambda: None)
    statuses = [RuleStatus(rule_id="a", state="ready", text=NASTY).model_dump(mode="json")]
    for said in (json.dumps(statuses), json.dumps(statuses, ensure_ascii=False)):
        monkeypatch.setattr(watch, "statuses", lambda said=said: said)
        text = asyncio.run(first_message(watch))
        status = json.loads(text)["statuses"][0]
        assert (status["rule_id"], status["state"]) == ("a", "ready")
        assert is_fit(status["text"])


def test_a_reason_is_one_line(console: Served) -> None:
    with console.client(Role.OPERATOR) as client:
        client.post("/api/stop", json={"reason": "a child\n\x1b[2J\u202eon the floor"})
    written = console.audited()[-1]
    assert written["reason"] == "a child [2J on the floor"
    reason = RollbackRequest(expected_revision=1, reason="back\nto\x07 before").reason
    assert reason == "back to before"
