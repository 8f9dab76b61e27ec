"""The rules' routes: who may, what is handed on, and what is said when it cannot be done."""

from __future__ import annotations

import json
import logging
import signal
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kompass_console.api.app import create_app, openapi
from kompass_console.schema.roles import Role
from kompass_console.web.body_limit import LARGEST_TABLE
from tests.console.conftest import Served, cookie_of, serving
from tests.console.fake_monitor import DISK_FULL
from tests.console.rules_client import Json, await_monitor, running_monitor, table
from tests.support.domains import next_domain
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

READS = [
    "/api/rules",
    "/api/rules?revision=1",
    "/api/rules/near/explain",
    "/api/rules/history?before=9&count=2",
    "/api/rules/diff?from=1&to=1",
    "/api/rules/schema",
    "/api/rules/export?format=json",
    "/api/rules/export?format=yaml",
    "/api/rules/export?format=python",
    "/api/firings?count=5&rule_id=near",
    "/api/graph",
]
WRITES: list[tuple[str, str, Json]] = [
    ("POST", "/api/rules/apply", {"table": table(), "expected_revision": 1}),
    ("POST", "/api/rules/rollback", {"expected_revision": 1}),
    ("POST", "/api/rules/confirm", {"revision": 1}),
    ("POST", "/api/rules/near/reset", {}),
    ("POST", "/api/backtests", {"table": table()}),
    ("DELETE", "/api/backtests/x", {}),
    ("POST", "/api/recordings", {"seconds": 30, "name": "mine"}),
]


@pytest.fixture(scope="module")
def monitor() -> Iterator[subprocess.Popen[bytes]]:
    with running_monitor() as process:
        yield process


@pytest.fixture(scope="module")
def monitored(console: Served, monitor: subprocess.Popen[bytes]) -> Served:
    """The console beside a monitor."""
    with console.client(Role.VIEWER) as client:
        await_monitor(client)
    return console


@pytest.fixture
def operator(monitored: Served) -> Iterator[httpx.Client]:
    with monitored.client(Role.OPERATOR, user="ava") as client:
        yield client


def in_force(client: httpx.Client) -> int:
    return int(client.get("/api/rules").json()["revision"])


def edited(client: httpx.Client, **more: Any) -> Json:
    """A request to apply one change to what is in force."""
    changed = table()
    changed["rules"][0]["event"]["cooldown"] = 20.0
    return {"table": changed, "expected_revision": in_force(client), **more}


@pytest.mark.parametrize("path", READS)
def test_a_viewer_reads_everything(monitored: Served, path: str) -> None:
    with monitored.client(Role.VIEWER) as client:
        answer = client.get(path)
    assert answer.status_code == 200, answer.text


@pytest.mark.parametrize(("method", "path", "body"), WRITES)
def test_a_viewer_changes_nothing(monitored: Served, method: str, path: str, body: Json) -> None:
    with monitored.client(Role.VIEWER, user="vic") as client:
        before = in_force(client)
        answer = client.request(method, path, json=body)
        assert answer.status_code == 403
        assert "operator" in answer.json()["detail"]["title"]
        assert in_force(client) == before
    last = monitored.audited()[-1]
    assert (last["who"], last["what"]) == ("vic", f"{method} {path}")
    assert last["outcome"].startswith("refused")


@pytest.mark.parametrize(("method", "path", "body"), WRITES)
def test_nobody_writes_without_a_login_or_from_another_page(
    monitored: Served, method: str, path: str, body: Json
) -> None:
    with monitored.client() as client:
        assert client.request(method, path, json=body).status_code == 401
    with monitored.client(Role.ENGINEER) as client:
        headers = {"Origin": "http://evil.example"}
        assert client.request(method, path, json=body, headers=headers).status_code == 403


@pytest.mark.parametrize("path", [*READS, "/api/rules/export", "/api/backtests/x"])
def test_nobody_reads_without_a_login(monitored: Served, path: str) -> None:
    with monitored.client() as client:
        assert client.get(path).status_code == 401


def test_an_edit_goes_into_force_is_kept_and_taken_back(
    monitored: Served, operator: httpx.Client
) -> None:
    before = in_force(operator)
    checked = operator.post("/api/rules/check", json={"table": table()}).json()
    assert checked["ok"]
    applied = operator.post("/api/rules/apply", json=edited(operator, probation=30.0))
    assert applied.status_code == 200, applied.text
    report = applied.json()
    assert (report["previous"], report["probation"]) == (before, 30.0)
    view = operator.get("/api/rules").json()
    assert view["table"]["rules"][0]["event"]["cooldown"] == 20.0
    assert operator.post("/api/rules/confirm", json={"revision": report["revision"]}).is_success
    back = operator.post("/api/rules/rollback", json={"expected_revision": report["revision"]})
    assert back.status_code == 200
    assert operator.get("/api/rules").json()["table"] == table()
    told = [(e["what"], e["outcome"]) for e in monitored.audited() if e["who"] == "ava"]
    tried, kept = report["revision"], back.json()["revision"]
    assert told[-3:] == [
        (
            "apply rules",
            f"Revision {tried} is in force; confirm it within 30 s, or it is taken back.",
        ),
        ("confirm rules", "done"),
        ("roll back rules", f"Revision {kept} is in force."),
    ]


def test_a_firing_of_the_past_is_explained(operator: httpx.Client) -> None:
    firings: list[Json] = []

    def kept() -> bool:
        firings[:] = operator.get("/api/firings?rule_id=silent").json()["firings"]
        return any(each["kind"] == "firing" for each in firings)

    wait_until(kept, 10.0, "the journal has a firing")
    run = next(each for each in firings if each["kind"] == "firing")
    path = f"/api/rules/silent/explain?run_id={run['run_id']}&epoch={run['epoch']}"
    view = operator.get(path).json()
    assert (view["rule_id"], view["revision"]) == ("silent", run["revision"])
    unknown = operator.get("/api/rules/silent/explain?run_id=4000")
    assert unknown.status_code == 404
    assert "no run 4000" in unknown.json()["detail"]["title"]


def test_without_a_probation_the_monitors_own_holds(operator: httpx.Client) -> None:
    report = operator.post("/api/rules/apply", json=edited(operator)).json()
    assert report["probation"] == 60.0


def test_who_was_too_late_gets_both_changes(monitored: Served, operator: httpx.Client) -> None:
    begun = in_force(operator)
    body = edited(operator)
    with monitored.client(Role.ENGINEER, user="ben") as faster:
        assert faster.post("/api/rules/apply", json=body).is_success
    body["table"]["rules"][0]["event"]["cooldown"] = 30.0
    answer = operator.post("/api/rules/apply", json=body)
    assert answer.status_code == 409
    assert set(answer.json()["detail"]) == {"title", "remedy"}
    conflict = answer.json()["conflict"]
    assert conflict["author"] == "ben"
    assert conflict["yours"]["changes"][0]["rule_id"] == "near"
    assert monitored.audited()[-1]["outcome"] == answer.json()["detail"]["title"]
    late = operator.post("/api/rules/rollback", json={"expected_revision": begun})
    assert late.status_code == 409
    assert late.json()["conflict"]["revision"] == in_force(operator)


def test_a_refused_table_comes_back_with_its_findings(operator: httpx.Client) -> None:
    before = in_force(operator)
    body = {"table": {"rules": []}, "expected_revision": before}
    answer = operator.post("/api/rules/apply", json=body)
    assert answer.status_code == 422
    assert answer.json()["report"]["findings"][0]["code"] == "protected"
    assert "'The battery says nothing' is protected" in answer.json()["detail"]["title"]
    assert in_force(operator) == before


def test_a_disk_that_is_full_is_told_and_the_old_table_stays(operator: httpx.Client) -> None:
    before = in_force(operator)
    answer = operator.post("/api/rules/apply", json=edited(operator, reason=DISK_FULL))
    assert answer.status_code == 507
    assert answer.json()["detail"]["title"] == (
        f"The disk is full; the rules of revision {before} stay in force."
    )
    assert in_force(operator) == before


def test_the_role_reaches_the_guard_rails(monitored: Served) -> None:
    with monitored.client(Role.VIEWER) as client:
        body = {"table": {"rules": table()["rules"][1:]}}
        report = client.post("/api/rules/check", json=body).json()
    assert [finding["code"] for finding in report["findings"]] == ["role"]


@pytest.mark.parametrize(
    ("method", "path", "status"),
    [
        ("GET", "/api/rules?revision=4000", 404),
        ("GET", "/api/rules/export?revision=4000", 404),
        ("GET", "/api/rules/nobody/explain", 404),
        ("POST", "/api/rules/nobody/reset", 404),
        ("GET", "/api/rules?revision=-1", 422),
        ("GET", "/api/rules/diff", 422),
        ("GET", "/api/rules/diff?from=1&to=99999999999", 422),
        ("GET", "/api/firings?count=100000", 422),
        ("GET", "/api/firings?before=99999999999999999999", 422),
        ("GET", "/api/rules/export?format=xml", 422),
        ("GET", "/api/backtests/nothing", 404),
    ],
)
def test_what_is_not_there_is_explained(
    operator: httpx.Client, method: str, path: str, status: int
) -> None:
    answer = operator.request(method, path)
    assert answer.status_code == status
    assert set(answer.json()["detail"]) == {"title", "remedy"}


def test_exported_rules_are_files_that_say_the_same(operator: httpx.Client) -> None:
    answer = operator.get("/api/rules/export?format=json&revision=1")
    assert 'filename="rules-1.json"' in answer.headers["content-disposition"]
    assert json.loads(answer.text) == table()
    assert "near" in operator.get("/api/rules/export?format=yaml").text
    assert operator.get("/api/rules/export?format=python").text.count("near") > 0


def test_a_recording_is_kept_and_a_name_that_is_taken_is_refused(operator: httpx.Client) -> None:
    kept = operator.post("/api/recordings", json={"seconds": 30, "name": "mine"})
    assert kept.json()["path"] == "/recordings/mine.mcap"
    taken = operator.post("/api/recordings", json={"name": "taken"})
    assert taken.status_code == 409
    assert "taken" in taken.json()["detail"]["title"]


def test_what_is_too_large_is_refused_before_it_is_read(operator: httpx.Client) -> None:
    huge = b'{"table": {"rules": ["' + b"x" * LARGEST_TABLE
    whole = operator.post("/api/rules/check", content=huge)
    pieces = operator.post("/api/rules/check", content=iter([huge[:1000], huge[1000:]]))
    elsewhere = operator.post("/api/stop", content=b" " * 100_000)
    for answer in (whole, pieces, elsewhere):
        assert answer.status_code == 413
        assert "too large" in answer.json()["detail"]["title"]


def with_table() -> list[str]:
    """Paths of all requests that carry a table."""
    schema = openapi(create_app(None))
    models = schema["components"]["schemas"]
    found = []
    for path, methods in schema["paths"].items():
        body = methods.get("post", {}).get("requestBody", {"content": {}})["content"]
        model = body.get("application/json", {}).get("schema", {}).get("$ref", "").split("/")[-1]
        if "table" in models.get(model, {}).get("properties", {}):
            found.append(path)
    return found


@pytest.mark.parametrize("path", with_table())
def test_a_table_of_a_hundred_rules_is_not_too_large(operator: httpx.Client, path: str) -> None:
    answer = operator.post(path, json={"table": {"rules": [], "name": "x" * 100_000}})
    assert answer.status_code != 413, answer.text


def test_who_leaves_before_a_request_is_whole_leaves_no_error_behind(
    monitored: Served, operator: httpx.Client, caplog: pytest.LogCaptureFixture
) -> None:
    log = logging.getLogger("uvicorn.error")
    log.addHandler(caplog.handler)
    try:
        with socket.create_connection(("127.0.0.1", monitored.port)) as leaving:
            head = (
                f"POST /api/rules/apply HTTP/1.1\r\nHost: 127.0.0.1:{monitored.port}\r\n"
                f"Origin: {monitored.origin}\r\nCookie: {cookie_of(operator)}\r\n"
                "Content-Length: 500\r\n\r\n"
            )
            leaving.sendall(head.encode() + b'{"table":')
            leaving.shutdown(socket.SHUT_WR)
            while leaving.recv(4096):
                pass
        assert operator.get("/api/rules").status_code == 200  # by then it has been noticed
        assert [record for record in caplog.records if record.levelno >= logging.ERROR] == []
    finally:
        log.removeHandler(caplog.handler)


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"null",
        b"[]",
        b'{"table": []}',
        b"[" * 50_000,
        b'{"table": {}, "expected_revision": -1}',
        b'{"table": {}, "expected_revision": 1, "probation": NaN}',
        b'{"table": {}, "expected_revision": 1, "nonsense": 1}',
        b'{"table": {}, "expected_revision": 1, "reason": "\\ud800"}',
        b"\xff\xfe",
    ],
)
def test_what_cannot_be_read_is_said_in_a_sentence(operator: httpx.Client, body: bytes) -> None:
    answer = operator.post("/api/rules/apply", content=body)
    assert answer.status_code == 422, answer.text
    assert set(answer.json()["detail"]) == {"title", "remedy"}


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=8,
)


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(body=anything, path=st.sampled_from([path for _, path, _ in WRITES if "{" not in path]))
def test_no_body_brings_the_console_down(operator: httpx.Client, body: Any, path: str) -> None:
    answer = operator.post(path, content=json.dumps(body))
    assert answer.status_code in (200, 201, 202, 405, 409, 422)


def test_a_monitor_that_is_not_there_is_named_with_a_remedy(tmp_path: Path) -> None:
    with (
        serving(tmp_path / "audit", next_domain()) as alone,
        alone.client(Role.ENGINEER) as client,
    ):
        for path in READS:
            if path != "/api/rules/schema":
                assert_unreachable(client.get(path))
        for method, path, body in WRITES:
            if method == "POST":
                assert_unreachable(client.request(method, path, json=body))
        assert alone.audited()[-1]["outcome"].startswith("The robot's rules cannot be reached")


def assert_unreachable(answer: httpx.Response) -> None:
    assert answer.status_code == 503, answer.text
    detail = answer.json()["detail"]
    assert "cannot be reached" in detail["title"]
    assert "monitor" in detail["title"] + detail["remedy"]


def test_a_monitor_that_is_killed_is_told_and_the_next_ones_word_is_taken(
    monitored: Served, monitor: subprocess.Popen[bytes], operator: httpx.Client
) -> None:
    """The last test of the module: its monitor does not outlive it."""
    applied = operator.post("/api/rules/apply", json=edited(operator))
    assert applied.status_code == 200
    monitor.send_signal(signal.SIGSTOP)  # there, and silent
    assert_unreachable(operator.get("/api/rules"))
    monitor.kill()
    with running_monitor():
        wait_until(lambda: operator.get("/api/rules").is_success, 20.0, "the next monitor")
        assert in_force(operator) == 1
        body = {"table": table(), "expected_revision": applied.json()["revision"]}
        answer = operator.post("/api/rules/apply", json=body)
        assert answer.status_code == 422
        assert "there is no such revision, 1 is in force" in answer.json()["detail"]["title"]
