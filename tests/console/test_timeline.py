"""The timeline over the console: who may look, note, acknowledge; and what is noted by itself."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from kompass_console.schema.roles import Role
from tests.console.conftest import Served, running_stack
from tests.console.rules_client import Json, await_monitor
from tests.console.test_link import listening, until
from tests.console.test_places import monitor_in, refused
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

CHANGES: list[tuple[str, Json]] = [
    ("/api/timeline/notes", {"title": "Wheel changed"}),
    ("/api/timeline/alarms/acknowledge", {"alarm": "bell", "since": 1.0}),
    ("/api/timeline/alarms/shelve", {"alarm": "bell", "seconds": 60.0}),
]


@pytest.fixture(scope="module")
def stack() -> Iterator[object]:
    with running_stack() as process:
        yield process


@pytest.fixture(scope="module")
def robot(
    console: Served, stack: object, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Served]:
    """The console beside a monitor and a stack."""
    folder: Path = tmp_path_factory.mktemp("robot")
    with monitor_in(folder), console.client(Role.VIEWER) as client:
        await_monitor(client)
        yield console


@pytest.fixture
def ava(robot: Served) -> Iterator[httpx.Client]:
    with robot.client(Role.OPERATOR, user="ava") as client:
        yield client


def page(client: httpx.Client, **query: str | float) -> Json:
    answer = client.get("/api/timeline", params=query)
    assert answer.status_code == 200, answer.text
    found: Json = answer.json()
    return found


def titles(client: httpx.Client, kind: str) -> list[str]:
    return [f"{each['who']}: {each['title']}" for each in page(client, kinds=kind)["entries"]]


@pytest.mark.parametrize(("path", "body"), CHANGES, ids=lambda one: str(one)[:40])
def test_a_viewer_looks_and_changes_nothing(robot: Served, path: str, body: Json) -> None:
    with robot.client(Role.VIEWER) as viewer:
        assert "Monitor started" in [each["title"] for each in page(viewer)["entries"]]
        assert viewer.post(path, json=body).status_code == 403
    with robot.client(None) as stranger:
        assert stranger.get("/api/timeline").status_code == 401
        assert stranger.get("/api/timeline/export").status_code == 401


def test_a_note_is_there_when_it_is_answered_and_pages_hear_of_it(
    robot: Served, ava: httpx.Client
) -> None:
    with listening(robot, ava) as socket:
        before = until(socket, lambda state: state["timeline"]["available"])["timeline"]["changes"]
        note = {"title": " Wheel\nchanged "}
        assert ava.post("/api/timeline/notes", json=note).status_code == 204
        assert titles(ava, "person")[0] == "ava: Wheel changed"
        until(socket, lambda state: state["timeline"]["changes"] > before)
    assert ava.post("/api/timeline/notes", json={"title": "  "}).status_code == 422


def test_what_people_do_is_noted_by_itself(robot: Served, ava: httpx.Client) -> None:
    pressed = lambda: ava.post("/api/stop", json={"reason": ""}).is_success  # noqa: E731
    wait_until(pressed, 20.0, "the console has found the drive manager")
    assert ava.post("/api/stop/release").status_code == 200
    wait_until(lambda: "ava: Released STOP" in titles(ava, "person"), 5.0, "the note")


def test_an_alarm_that_does_not_stand_cannot_be_acknowledged(ava: httpx.Client) -> None:
    path = "/api/timeline/alarms/acknowledge"
    answer = ava.post(path, json={"alarm": "no such", "since": 1.0})
    refused(answer, 409, "stands no more")
    shelved = ava.post("/api/timeline/alarms/shelve", json={"alarm": "x", "seconds": 1e9})
    assert shelved.status_code == 422


def test_all_of_it_is_taken_along_a_line_each(robot: Served, ava: httpx.Client) -> None:
    for number in range(3):
        assert ava.post("/api/timeline/notes", json={"title": f"note {number}"}).is_success
    answer = ava.get("/api/timeline/export")
    said = robot.audited()[-1]
    assert (said["who"], said["what"], said["outcome"]) == ("ava", "export timeline", "begun")
    assert answer.headers["content-disposition"].endswith('.jsonl"')
    lines = [json.loads(line) for line in answer.text.splitlines()]
    assert [each["number"] for each in lines] == list(range(len(lines), 0, -1))
    assert {"note 0", "note 1", "note 2"} <= {each["title"] for each in lines}


def test_it_is_asked_for_in_parts_and_by_what_is_wanted(ava: httpx.Client) -> None:
    for number in range(3):
        assert ava.post("/api/timeline/notes", json={"title": f"part {number}"}).is_success
    first = page(ava, text="PART", count=2)
    assert [each["title"] for each in first["entries"]] == ["part 2", "part 1"]
    assert first["more"]
    rest = page(ava, text="part", before=first["entries"][-1]["number"])
    assert [each["title"] for each in rest["entries"]] == ["part 0"]
    counted = page(ava, text="part", count=0, since=1.0, until=9e9, slots=10)["slots"]
    assert [(each["kind"], each["count"]) for each in counted] == [("person", 3)]
    assert ava.get("/api/timeline", params={"kinds": "gossip"}).status_code == 422
    assert ava.get("/api/timeline", params={"count": 501}).status_code == 422
