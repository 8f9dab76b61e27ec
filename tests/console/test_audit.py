"""What people do through the console is in the audit log, whatever the disk does."""

from __future__ import annotations

import fcntl
import json
import re
import shutil
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx
import pytest
from fastapi.routing import APIRoute
from starlette.routing import BaseRoute
from websockets.sync.client import connect
from websockets.typing import Origin

from kompass_console.api.app import create_app
from kompass_console.api.audited import LOOKS_ONLY
from kompass_console.audit.log import LOCK, AuditLog
from kompass_console.audit.read import lines_after
from kompass_console.audit.verify import verify
from kompass_console.schema.roles import Role
from kompass_console.web.audit import Asking, AuditTrail, asking
from kompass_console.web.auth import LoginSession
from tests.console.conftest import Served, cookie_of, serving
from tests.support.disk import SmallDisk, small_disk
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros
__all__ = ["small_disk"]


def all_routes(routes: list[BaseRoute]) -> Iterator[APIRoute]:
    """Every HTTP route of the application, those of included routers too."""
    for route in routes:
        if isinstance(route, APIRoute):
            yield route
        else:
            inner = getattr(route, "original_router", None)
            yield from all_routes(inner.routes if inner is not None else [])


ROUTES = list(all_routes(create_app(None).routes))
WRITES = [
    (method, route)
    for route in ROUTES
    for method in sorted((route.methods or set()) - {"GET", "HEAD"})
    if route.name not in LOOKS_ONLY
]
DOWNLOADS = ["/api/recordings/dock", "/api/audit/export"]


def filled(route: APIRoute) -> str:
    return re.sub(r"\{[^}]*\}", "dock", route.path)


def test_what_leaves_no_line_changes_nothing_but_what_a_page_shows() -> None:
    checks = {"check", "check_pose", "check_rules"}
    shown = {"create_view", "change_view", "clear_preview", "measure", "sketch_zone"} | checks
    assert shown == LOOKS_ONLY
    assert {route.name for route in ROUTES} >= LOOKS_ONLY
    assert len(WRITES) >= 14  # or the walk over the routes has gone wrong


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory, domain: int) -> Iterator[Served]:
    """A console with one recording at hand, and no stack."""
    folder = tmp_path_factory.mktemp("robot")
    (folder / "recordings" / "saved").mkdir(parents=True)
    (folder / "recordings" / "saved" / "dock.mcap").write_bytes(b"\x89MCAP")
    with serving(folder / "audit", domain, folder / "recordings") as served:
        yield served


@pytest.mark.parametrize(
    ("method", "route"), WRITES, ids=[f"{method} {route.path}" for method, route in WRITES]
)
def test_every_write_leaves_a_line_with_who_from_where_and_how_it_ended(
    recorded: Served, method: str, route: APIRoute
) -> None:
    for body in (None, {"token": "a wrong token", "user": "eve"}, {"x": 1.0, "y": 2.0}):
        with recorded.client(Role.ENGINEER, user="ava") as client:
            before = len(recorded.audited())
            client.request(method, filled(route), json=body)
        lines = recorded.audited()[before + 1 :]
        assert len(lines) == 1, (body, lines)
        [line] = lines
        assert line["from"] == "127.0.0.1"
        assert line["outcome"]
        if route.path == "/api/login":
            assert line["who"] in ("?", "eve", "ava")
        else:
            assert (line["who"], line["role"], len(line["session"])) == ("ava", "engineer", 8)


@pytest.mark.parametrize("path", DOWNLOADS)
def test_every_download_leaves_a_line(recorded: Served, path: str) -> None:
    (recorded.audit_folder.parent / "recordings" / "saved" / "dock.mcap").write_bytes(b"\x89MCAP")
    with recorded.client(Role.ENGINEER, user="ava") as client:
        before = len(recorded.audited())
        answer = client.get(path)
        assert answer.headers["content-disposition"].startswith("attachment")
    [line] = recorded.audited()[before + 1 :]
    assert (line["who"], line["outcome"]) == ("ava", "begun")


def test_no_route_hands_out_a_file_that_is_not_tested_here() -> None:
    # That of the timeline needs a monitor: test_timeline.
    names = {
        *("download_recording", "export_audit_log", "export_rules", "export_timeline"),
        *("page", "asset"),
    }
    found = {
        route.name
        for route in ROUTES
        if "FileResponse" in str(route.response_class)
        or "StreamingResponse" in str(route.response_class)
        or "PlainTextResponse" in str(route.response_class)
        or route.name in ("page", "asset")
    }
    assert found == names


def test_refusals_are_told_whoever_is_refused(recorded: Served) -> None:
    before = len(recorded.audited())
    with recorded.client(Role.ENGINEER, user="ava") as client:
        client.get("/", headers={"Host": "evil.example"})
        client.post("/api/stop", headers={"Origin": "http://evil.example"})
    with recorded.client() as stranger:
        stranger.post("/api/stop")
        stranger.post("/api/login", json={"token": "no such token", "user": "mal\x1b[2Jlory" * 30})
    with recorded.client(Role.VIEWER, user="vic") as client:
        client.post("/api/goals/cancel")
        client.get("/api/audit")
    # The first is of our own look at the log.
    told = [(line["who"], line["what"], line["outcome"]) for line in recorded.audited()[before:]]
    wrong_name = told[5][0]
    assert len(wrong_name) <= 40
    assert wrong_name.isprintable()
    assert wrong_name.startswith("mal [2Jlory")
    other_page = "The request came from http://evil.example, not from this console."
    assert told[1:] == [
        ("ava", "log in", "ok"),
        ("?", "GET /", "refused: This console does not answer to the name 'evil.example'."),
        ("ava", "POST /api/stop", f"refused: {other_page}"),
        ("?", "POST /api/stop", "refused: You are not logged in to this console."),
        (wrong_name, "log in", "wrong token"),
        ("vic", "log in", "ok"),
        ("vic", "POST /api/goals/cancel", f"refused: {_takes('an operator')}"),
        ("vic", "GET /api/audit", f"refused: {_takes('an engineer')}"),
    ]


def _takes(role: str) -> str:
    return f"You are logged in as viewer, and this takes {role}."


def test_engineers_read_it_and_take_it_along_whole(recorded: Served, tmp_path: Path) -> None:
    with recorded.client(Role.ENGINEER, user="ada") as client:
        for reason in ("", "", "", "a child on the floor"):
            client.post("/api/stop", json={"reason": reason})
        recorded.audited()
        page = client.get("/api/audit", params={"count": 3, "text": "A CHILD"}).json()
        assert page["problem"] == ""
        [line] = page["lines"]
        assert (line["who"], line["what"], line["address"]) == ("ada", "stop", "127.0.0.1")
        assert line["details"]["before"] == "unknown"
        newest = client.get("/api/audit", params={"count": 2}).json()
        assert newest["more"]
        last = newest["lines"][-1]["seq"]
        older = client.get("/api/audit", params={"count": 2, "before": last}).json()
        assert older["lines"][0]["seq"] == last - 1
        exported = tmp_path / "export.jsonl"
        exported.write_bytes(client.get("/api/audit/export").content)
    assert verify(exported).broken == ""
    assert verify(exported).lines > 5
    assert verify(recorded.audit_folder).broken == ""
    for role in (Role.VIEWER, Role.OPERATOR):
        with recorded.client(role) as client:
            for path in ("/api/audit", "/api/audit/export"):
                assert client.get(path).status_code == 403


def test_whoever_looks_sees_what_was_done_just_before_however_busy_the_disk(
    recorded: Served,
) -> None:
    with recorded.client(Role.ENGINEER, user="ada") as client, ThreadPoolExecutor(1) as other:
        client.post("/api/stop", json={"reason": ""})
        recorded.audited()
        with (recorded.audit_folder / LOCK).open("w") as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            client.post("/api/stop", json={"reason": "a child on the stairs"})
            looked = other.submit(client.get, "/api/audit", params={"text": "on the stairs"})
            with pytest.raises(TimeoutError):
                looked.result(0.1)
        assert [line["what"] for line in looked.result(10).json()["lines"]] == ["stop"]


def test_whoever_looks_is_not_kept_waiting_by_a_disk_that_hangs(recorded: Served) -> None:
    with recorded.client(Role.ENGINEER, user="ada") as client:
        client.post("/api/stop", json={"reason": ""})
        recorded.audited()
        with (recorded.audit_folder / LOCK).open("w") as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            client.post("/api/stop", json={"reason": "a child on the stairs"})
            assert client.get("/api/audit").json()["lines"]


SESSION = LoginSession("ava", Role.OPERATOR, "0123456789abcdef", 0.0)


def test_strangers_cannot_push_everything_else_out(tmp_path: Path) -> None:
    clock = [0.0]
    log = AuditLog(tmp_path / "audit")
    trail = AuditTrail(log, now=lambda: clock[0])
    for address in range(50):
        asking.set(Asking(f"10.0.0.{address}"))
        for _ in range(1000):
            trail.record(None, "log in", "wrong token")
    asking.set(None)
    trail.record(SESSION, "stop", "accepted")
    clock[0] = 61.0
    trail.record(SESSION, "release stop", "accepted")
    log.close()
    lines = lines_after(tmp_path / "audit", 0)
    assert len(lines) == 60 + 3
    assert [line["what"] for line in lines[60:]] == ["stop", "audit log", "release stop"]
    assert lines[61]["outcome"] == "49940 more lines about strangers are left out"


@pytest.mark.parametrize("failing", ["full", "read-only", "removed"])
def test_a_full_disk_does_not_keep_anybody_from_stopping(
    small_disk: SmallDisk, domain: int, failing: str, caplog: pytest.LogCaptureFixture
) -> None:
    folder = small_disk.folder / "ava" / "audit"
    with serving(folder, domain) as served, served.client(Role.ENGINEER, user="ava") as client:
        served.audited()
        if failing == "full":
            small_disk.fill()
        elif failing == "read-only":
            small_disk.write_protect()
        else:
            shutil.rmtree(folder.parent)
            folder.parent.write_text("no folder any more")
        with ThreadPoolExecutor(20) as people:
            for answer in people.map(
                lambda number: client.post("/api/stop", json={"reason": f"number {number}"}),
                range(40),
            ):
                assert answer.status_code == 503  # for want of a drive manager, not of a disk
        wait_until(lambda: "lines wait" in told_to(client, served), 5, "that people are told")
        assert "the audit log is not written" in caplog.text
        if failing == "full":
            small_disk.make_room()
        elif failing == "read-only":
            small_disk.allow_writing()
        else:
            folder.parent.unlink()
        wait_until(lambda: "is not written" not in told_to(client, served), 10, "that it works")
        reasons = [line["reason"] for line in served.audited() if line["what"] == "stop"]
        assert sorted(reasons) == sorted(f"number {number}" for number in range(40))
        if failing == "removed":
            assert "are gone from" in told_to(client, served)
            assert verify(folder).notes[0].startswith("it begins with line")
        assert verify(folder).broken == ""


def told_to(client: httpx.Client, served: Served) -> str:
    """What the state, that every page shows, says of the audit log."""
    url = f"ws://127.0.0.1:{served.port}/api/state"
    headers = {"Cookie": cookie_of(client)}
    with connect(url, additional_headers=headers, origin=Origin(served.origin)) as socket:
        while True:
            said = json.loads(socket.recv(timeout=5))
            if said["type"] == "state":
                return str(said["audit_problem"])


def test_what_does_not_fit_into_memory_is_counted_and_told_later(small_disk: SmallDisk) -> None:
    folder = small_disk.folder / "audit"
    log = AuditLog(folder, waiting=10)
    trail = AuditTrail(log)
    small_disk.fill()
    for number in range(25):
        trail.record(SESSION, "stop", "accepted", number=number)
    wait_until(lambda: "15 are lost" in log.problem, 5, "the count")
    small_disk.make_room()
    wait_until(lambda: log.problem == "", 10, "that it works again")
    trail.record(SESSION, "stop", "accepted", number=25)
    log.close()
    lines = lines_after(folder, 0)
    kept = [line["number"] for line in lines if line["what"] == "stop"]
    assert kept == [*range(10), 25]
    assert lines[10]["outcome"].startswith("15 lines are lost")
    assert verify(folder).broken == ""


def test_without_any_folder_people_are_told() -> None:
    log = AuditLog(None)
    AuditTrail(log).record(SESSION, "stop", "accepted")
    assert "there is no folder for it" in log.problem
    log.close()
