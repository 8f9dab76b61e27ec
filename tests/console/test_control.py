"""Two people, one robot: who drives, who asks, what happens to who has gone."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from websockets.sync.client import ClientConnection

from kompass_console.schema.roles import Role
from tests.console.conftest import Served, running_stack, serving
from tests.console.rules_client import Json, opened, until

pytestmark = pytest.mark.ros
POSE = {"x": -0.75, "y": 0.6}


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory, domain: int) -> Iterator[Served]:
    with running_stack(), serving(tmp_path_factory.mktemp("control") / "audit", domain) as served:
        with served.client(Role.VIEWER) as client, opened(served, "/api/state", client) as socket:
            until(socket, lambda m: m["type"] == "state" and m["drive"] and m["pose"], 20.0)
        yield served


class Page:
    """Somebody with a page open."""

    def __init__(self, client: httpx.Client, socket: ClientConnection) -> None:
        self.client, self._socket = client, socket
        self.key = client.get("/api/session").json()["key"]

    def control(self, **expected: object) -> Json:
        """What is told of control once it is so."""

        def fits(message: Json) -> bool:
            found = message.get("control", {})
            return bool(found) and all(found[name] == value for name, value in expected.items())

        return dict(until(self._socket, fits, 20.0)["control"])

    def drives(self) -> httpx.Response:
        """Something that sets the robot in motion, or tells it where it is."""
        return self.client.post("/api/goals", json=POSE)

    def post(self, what: str, **body: object) -> httpx.Response:
        return self.client.post(f"/api/control/{what}", json=body)


@contextlib.contextmanager
def page(robot: Served, user: str, role: Role = Role.OPERATOR) -> Iterator[Page]:
    with robot.client(role, user) as client, opened(robot, "/api/state", client) as socket:
        yield Page(client, socket)
        client.post("/api/logout")


def driven(answer: httpx.Response) -> None:
    assert answer.status_code == 200, answer.text


def refused(answer: httpx.Response, title: str) -> str:
    assert answer.status_code == 409, answer.text
    detail = answer.json()["detail"]
    assert title in detail["title"]
    return str(detail["remedy"])


def test_a_program_without_a_page_is_told_that_it_cannot_hold_control(robot: Served) -> None:
    with robot.client(Role.ENGINEER, "script") as script:
        for what, body in (("take", {"reason": "a look"}), ("ask", {})):
            answer = script.post(f"/api/control/{what}", json=body)
            assert "Open the page" in refused(answer, "You have no page of this console open")
        driven(script.post("/api/goals", json=POSE))  # nobody has it
        with page(robot, "ava") as ava:
            ava.control(holder="")


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        (b'{"reason": "%s"}' % (b"x" * 5000), "x" * 199 + "\N{HORIZONTAL ELLIPSIS}"),
        (b'{"reason": 5}', '{"reason": 5}'),
        (b'{"foo": 1}', '{"foo": 1}'),
        (b"\xff nonsense", "\N{REPLACEMENT CHARACTER} nonsense"),
        (b"", ""),
    ],
    ids=["long", "number", "unknown", "no json", "empty"],
)
def test_nothing_in_its_body_keeps_stop_from_stopping(
    robot: Served, body: bytes, reason: str
) -> None:
    with page(robot, "ava") as ava:
        assert ava.client.post("/api/stop", content=body).json()["accepted"]
        assert ava.client.post("/api/stop/release").json()["accepted"]
    pressed = [line for line in robot.audited() if line["what"] == "stop"][-1]
    assert (pressed["who"], pressed["outcome"]) == ("ava", "accepted")
    assert pressed.get("reason", "") == reason


def test_who_drives_first_has_control_and_gives_it_to_who_asks(robot: Served) -> None:
    with page(robot, "ava") as ava, page(robot, "ben") as ben, page(robot, "cleo") as cleo:
        driven(ava.drives())
        assert ben.control(holder="ava")["holder_key"] == ava.key
        remedy = refused(ben.drives(), "ava has control of the robot.")
        assert "Ask for it" in remedy
        assert ben.client.post("/api/stop").status_code == 200  # everybody's
        assert ben.client.post("/api/stop/release").status_code == 200
        assert ben.client.post("/api/goals/cancel").status_code == 202
        assert ben.post("ask").status_code == 204
        assert ava.control(asked_by="ben")["asked_key"] == ben.key
        refused(cleo.post("ask"), "ben has asked for control already")
        refused(ben.post("take", reason="mine"), "ava has been asked and may still answer.")
        assert ava.post("keep").status_code == 204
        ben.control(asked_by="")
        assert ben.post("ask").status_code == 204
        assert ava.post("give").status_code == 204
        ben.control(holder="ben")
        driven(ben.drives())
        refused(ava.drives(), "ben has control of the robot.")
    lines = [(line["who"], line["what"], line["outcome"]) for line in robot.audited()]
    assert ("ava", "take control", "nobody had it") in lines
    assert ("ben", "send goal", "ava has control of the robot.") in lines
    assert ("ava", "keep control", "done") in lines
    assert ("ava", "give control", "done") in lines


def test_an_engineer_takes_it_with_a_reason_that_is_told_and_written_down(robot: Served) -> None:
    with page(robot, "ava") as ava, page(robot, "eve", Role.ENGINEER) as eve:
        driven(ava.drives())
        refused(eve.post("take"), "nobody said why")
        assert eve.post("take", reason="x" * 201).status_code == 422
        assert eve.post("take", reason="it turns wrong").status_code == 204
        told = ava.control(holder="eve")
        assert (told["taken_from"], told["reason"]) == ("ava", "it turns wrong")
        assert told["taken_key"] == ava.key
    line = next(line for line in robot.audited() if line.get("after") == "eve")
    assert (line["before"], line["reason"]) == ("ava", "it turns wrong")


def test_who_logs_out_or_has_gone_holds_nobody_up(robot: Served) -> None:
    with page(robot, "ben") as ben:
        with page(robot, "ava") as ava:
            driven(ava.drives())
            refused(ben.drives(), "ava has control")
            ben.control(holder="ava")
        ben.control(holder="")
        with robot.client(Role.OPERATOR, "ava") as client:
            with opened(robot, "/api/state", client) as socket:
                driven(Page(client, socket).drives())
                ben.control(holder="ava")
            refused(ben.drives(), "ava has control")  # the page may be loaded again
            ben.control(holder="")
            driven(ben.drives())


def test_requests_without_a_page_drive_while_nobody_has_control_and_hold_nothing(
    robot: Served,
) -> None:
    with page(robot, "ava") as ava, robot.client(Role.OPERATOR, "script") as script:
        driven(script.post("/api/goals", json=POSE))
        driven(ava.drives())
        refused(script.post("/api/goals", json=POSE), "ava has control")


def test_a_viewer_has_no_part_in_it(robot: Served) -> None:
    with robot.client(Role.VIEWER) as viewer, robot.client() as stranger:
        for what in ("ask", "take", "give", "keep"):
            assert viewer.post(f"/api/control/{what}", json={}).status_code == 403
            assert stranger.post(f"/api/control/{what}", json={}).status_code == 401


def test_a_new_console_begins_with_nobody_in_control(tmp_path: Path, domain: int) -> None:
    with serving(tmp_path / "audit", domain) as served, page(served, "ava") as ava:
        assert ava.control()["holder"] == ""
