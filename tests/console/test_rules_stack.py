"""The console's API on a running stack: what a page does when rules are edited for real."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import httpx
import pytest
from std_msgs.msg import Int32
from websockets.sync.client import ClientConnection, connect

from tests.console.rules_client import Json, until
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.rules import compare, rule
from tests.support.stack import Stack

pytestmark = pytest.mark.ros
LAB = Path(__file__).parents[1] / "recipes" / "rules_lab.py"


@pytest.fixture(scope="module")
def stack(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stack]:
    folder = str(tmp_path_factory.mktemp("lab"))
    with closing(Stack.active(LAB, LAB_FOLDER=folder)) as running:
        yield running


@pytest.fixture(scope="module")
def robot(stack: Stack) -> Iterator[Robot]:
    with closing(Robot(stack.domain)) as client:
        yield client


@contextlib.contextmanager
def logged_in(stack: Stack, label: str) -> Iterator[httpx.Client]:
    """A page of whoever opened the address that the stack printed under a label."""
    stack.wait_for_line(label, 10)
    found = re.search(rf"{label}:\s+\S+#token=(\S+)", stack.output)
    assert found
    with httpx.Client(base_url=stack.url, headers={"Origin": stack.url}, timeout=20.0) as client:
        wait_until(lambda: _answers(client), 20.0, "the console answers")
        assert client.post("/api/login", json={"token": found[1]}).is_success
        wait_until(lambda: client.get("/api/rules").is_success, 20.0, "the monitor answers")
        yield client


def _answers(client: httpx.Client) -> bool:
    try:
        return client.get("/api/session").status_code in (200, 401)
    except httpx.TransportError:
        return False


@pytest.fixture
def operator(stack: Stack) -> Iterator[httpx.Client]:
    with logged_in(stack, "Console") as client:
        yield client


@contextlib.contextmanager
def socket_of(stack: Stack, client: httpx.Client, path: str) -> Iterator[ClientConnection]:
    cookie = "; ".join(f"{name}={value}" for name, value in client.cookies.items())
    url = stack.url.replace("http", "ws") + path
    with connect(url, origin=stack.url, additional_headers={"Cookie": cookie}) as socket:
        yield socket


def apply(client: httpx.Client, *added: Json, **more: Any) -> httpx.Response:
    """Apply the table in force with rules added or replaced."""
    view = client.get("/api/rules").json()
    new = {each["id"]: each for each in (*view["table"]["rules"], *added)}
    body = {"table": {"rules": list(new.values())}, "expected_revision": view["revision"], **more}
    return client.post("/api/rules/apply", json=body)


def test_a_rule_is_tried_applied_fires_and_is_explained(
    stack: Stack, robot: Robot, operator: httpx.Client
) -> None:
    publisher = robot.node.create_publisher(Int32, "/level", 10)
    condition = compare("level", ">", 5)
    with socket_of(stack, operator, "/api/rules/probe") as socket:
        socket.send(json.dumps({"condition": condition}))
        until(socket, lambda m: m["leaves"])

        def judged(reading: Json) -> bool:
            # The probe may not know this publisher yet, though that knows the probe.
            publisher.publish(Int32(data=3))
            return reading["verdict"] is False

        tried = until(socket, judged)
        assert tried["leaves"][0]["value"] == 3
    report = apply(operator, rule("high", condition, cooldown=100.0), reason="try", probation=0.0)
    assert report.status_code == 200, report.text
    with socket_of(stack, operator, "/api/rules/live") as socket:
        until(socket, lambda m: m["revision"] == report.json()["revision"])

        def fired(state: Json) -> bool:
            publisher.publish(Int32(data=9))
            return bool(state["firings"])

        phases: list[str] = []
        while "done" not in phases:
            phases += [step["phase"] for step in until(socket, fired)["firings"]]
    assert phases == ["fired", "action", "done"]
    wait_until(lambda: _entries(operator), 5, "the journal's entry")
    entry = _entries(operator)[0]
    explained = operator.get(
        "/api/rules/high/explain", params={"run_id": entry["run_id"], "epoch": entry["epoch"]}
    ).json()
    assert explained["firing"]["leaves"][0]["value"] == 9
    assert explained["revision"] == report.json()["revision"]


def _monitor_listens(robot: Robot, topic: str) -> bool:
    found = robot.node.get_subscriptions_info_by_topic(topic)
    return any(each.node_name == "monitor" for each in found)


def _entries(client: httpx.Client) -> list[Json]:
    found = client.get("/api/firings", params={"rule_id": "high"}).json()["firings"]
    return [entry for entry in found if entry["kind"] == "firing"]


def test_only_an_engineer_protects_a_rule(stack: Stack, operator: httpx.Client) -> None:
    guarded = rule("guarded", compare("level", ">", 100), protected=True)
    refused = apply(operator, guarded)
    assert refused.status_code == 422, refused.text
    findings = refused.json()["report"]["findings"]
    assert "guarded" in [each["rule_id"] for each in findings if each["level"] == "error"]
    with logged_in(stack, "Engineer") as engineer:
        assert apply(engineer, guarded, probation=0.0).status_code == 200
    weakened = rule("guarded", compare("level", ">", 100), enabled=False, protected=True)
    assert apply(operator, weakened).status_code == 422


def test_what_nobody_keeps_is_taken_back_and_the_page_is_told(
    stack: Stack, operator: httpx.Client
) -> None:
    before = operator.get("/api/rules").json()
    tried = apply(operator, rule("brief", compare("level", ">", 7)), probation=0.5)
    with socket_of(stack, operator, "/api/rules/live") as socket:
        told = until(socket, lambda m: m["notice"] and m["revision"] != tried.json()["revision"])
    assert told["probation_left"] == 0.0
    assert operator.get("/api/rules").json()["table"] == before["table"]


def test_the_next_answer_agrees_with_the_robot_after_a_kill(
    stack: Stack, operator: httpx.Client
) -> None:
    kept = apply(operator, rule("kept", compare("level", ">", 8)), probation=0.0).json()
    doubtful = apply(operator, rule("doubtful", compare("level", ">", 9)), probation=60.0).json()
    os.kill(stack.pid_of("monitor"), signal.SIGKILL)
    killed = stack.pid_of("console")
    os.kill(killed, signal.SIGKILL)
    wait_until(lambda: stack.pid_of("console") != killed, 10, "another console")
    wait_until(lambda: _answers(operator), 20.0, "it answers, and knows who is logged in")
    wait_until(lambda: operator.get("/api/rules").is_success, 20.0, "the monitor answers")
    # What was confirmed stays, what was on probation does not, and an edit of before is told so.
    view = operator.get("/api/rules").json()
    assert view["table"]["rules"][-1]["id"] == "kept"
    late = {"table": {"rules": []}, "expected_revision": doubtful["revision"]}
    assert operator.post("/api/rules/apply", json=late).status_code == 409
    assert view["confirmed"] >= kept["revision"]
    with socket_of(stack, operator, "/api/rules/live") as socket:
        told = until(socket, lambda m: m["available"])
    assert (told["revision"], told["confirmed"]) == (view["revision"], view["confirmed"])
