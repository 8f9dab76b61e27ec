"""Who may reach what over HTTP, from where, and what a refusal says."""

import socket
from pathlib import Path

import pytest

from kompass_console.schema.roles import Role
from tests.console.conftest import Served, serving

pytestmark = pytest.mark.ros

WRITES = [
    ("POST", "/api/views"),
    ("POST", "/api/goals"),
    ("POST", "/api/goals/check"),
    ("POST", "/api/goals/cancel"),
    ("POST", "/api/localisation"),
    ("POST", "/api/localisation/check"),
    ("POST", "/api/stop"),
    ("POST", "/api/stop/release"),
    ("PATCH", "/api/views/x"),
    ("DELETE", "/api/views/x/preview"),
    ("POST", "/api/measure"),
    ("POST", "/api/logout"),
]


def test_no_answer_waits_for_the_acknowledgement_of_its_first_half(console: Served) -> None:
    """What it would cost is measured in benchmarks/small_answers.py."""
    assert console.listening.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY) == 1


@pytest.mark.parametrize(
    ("method", "path"),
    [
        *WRITES,
        ("GET", "/api/session"),
        ("GET", "/api/openapi.json"),
        ("GET", "/scene/x/"),
        ("GET", "/api/map/1"),
    ],
)
def test_nothing_answers_without_a_login(console: Served, method: str, path: str) -> None:
    with console.client() as client:
        answer = client.request(method, path, json={"x": 1.0, "y": 1.0})
    assert answer.status_code == 401
    assert answer.json()["detail"]["remedy"].startswith("Log in")


@pytest.mark.parametrize("origin", [None, "http://evil.example", "null", "http://127.0.0.1:1"])
@pytest.mark.parametrize(("method", "path"), WRITES)
def test_no_other_page_can_write(
    console: Served, method: str, path: str, origin: str | None
) -> None:
    with console.client(Role.ENGINEER) as client:
        del client.headers["Origin"]
        headers = {} if origin is None else {"Origin": origin}
        assert client.request(method, path, json={}, headers=headers).status_code == 403


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", ""])
def test_a_name_that_is_not_ours_is_not_answered(console: Served, host: str) -> None:
    with console.client(Role.ENGINEER) as client:
        assert client.get("/", headers={"Host": host}).status_code == 421


@pytest.mark.parametrize("host", ["localhost:80", "127.0.0.1", "[::1]:8642", "192.168.1.7:8642"])
def test_loopback_names_and_addresses_are_answered(console: Served, host: str) -> None:
    with console.client() as client:
        assert client.get("/api/session", headers={"Host": host}).status_code == 401


def test_a_viewer_watches_and_does_not_drive(console: Served) -> None:
    with console.client(Role.VIEWER) as client:
        assert client.post("/api/views").status_code == 200
        for path in ("/api/goals", "/api/goals/cancel", "/api/stop/release"):
            answer = client.post(path, json={"x": 0.0, "y": 0.0})
            assert answer.status_code == 403
            assert "operator" in answer.json()["detail"]["title"]


def test_a_viewer_may_press_stop(console: Served) -> None:
    with console.client(Role.VIEWER) as client:
        answer = client.post("/api/stop", json={})
    # No drive manager runs here: the press is let through, and said not to be confirmed.
    assert answer.status_code == 503
    assert answer.json()["detail"]["title"].startswith("STOP is not confirmed")
    assert "emergency stop" in answer.json()["detail"]["remedy"]


def test_the_cookie_is_out_of_reach_of_scripts_and_other_sites(console: Served) -> None:
    with console.client() as client:
        token = "operator-token-for-tests"
        answer = client.post("/api/login", json={"token": token, "user": "ava"})
    key = answer.json()["key"]
    assert answer.json() == {"user": "ava", "key": key, "role": "operator", "account": False}
    cookie = answer.headers["set-cookie"].lower()
    assert "httponly" in cookie
    assert "samesite=strict" in cookie


def test_a_logged_out_cookie_is_refused_even_if_somebody_kept_it(console: Served) -> None:
    with console.client(Role.OPERATOR) as client:
        kept = dict(client.cookies)
        assert client.post("/api/logout").status_code == 204
    with console.client() as client:
        client.cookies.update(kept)
        assert client.get("/api/session").status_code == 401


def test_guessing_tokens_is_slowed_down_and_told(tmp_path: Path, domain: int) -> None:
    with serving(tmp_path / "audit", domain) as own, own.client() as client:
        answers = [
            client.post("/api/login", json={"token": f"guess number {i}"}) for i in range(12)
        ]
    assert answers[0].status_code == 403
    assert answers[-1].status_code == 429
    assert int(answers[-1].headers["retry-after"]) > 0


def test_every_answer_carries_the_page_policy(console: Served) -> None:
    with console.client() as client:
        headers = client.get("/api/session").headers
    assert "frame-ancestors 'none'" in headers["content-security-policy"]
    assert "script-src" not in headers["content-security-policy"]
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["cache-control"] == "no-store"


def test_the_built_page_is_served_and_nothing_beside_it(console: Served) -> None:
    with console.client() as client:
        for path in ("/../settings.py", "/%2e%2e/settings.py", "/assets/../../settings.py"):
            assert client.get(path).status_code in (404, 503)


def test_invalid_requests_are_explained(console: Served) -> None:
    with console.client(Role.OPERATOR) as client:
        for body in (
            {"x": "far", "y": 0},
            {"x": 0},
            {"x": 0, "y": 0, "speed": 9},
            {"x": 1e9, "y": 0},
        ):
            answer = client.post("/api/goals", json=body)
            assert answer.status_code == 422
            assert set(answer.json()["detail"]) == {"title", "remedy"}


def test_writes_are_audited_with_who_and_outcome(console: Served) -> None:
    with console.client(Role.OPERATOR, user="ava") as client:
        client.post("/api/stop", json={"reason": "a child on the floor"})
    stop = [e for e in console.audited() if e["what"] == "stop" and e["who"] == "ava"][-1]
    assert stop["role"] == "operator"
    assert stop["reason"] == "a child on the floor"
    assert stop["outcome"] == "no drive manager is there"


def test_the_console_comes_up_with_nothing_to_show_and_says_what_is_missing(
    console: Served,
) -> None:
    with console.client(Role.OPERATOR) as client:
        answer = client.post("/api/goals/check", json={"x": 1.0, "y": 2.0})
        assert answer.json()["reason"] == "no_planner"
        refused = client.post("/api/goals", json={"x": 1.0, "y": 2.0})
    assert refused.status_code == 409
    assert refused.json()["detail"]["title"] == answer.json()["message"]


def test_two_consoles_on_one_host_do_not_log_each_other_out(console: Served) -> None:
    with console.client(Role.OPERATOR) as client:
        names = [cookie.name for cookie in client.cookies.jar]
    assert names == [f"kompass_session_{console.port}"]


def test_a_console_elsewhere_says_that_the_recordings_are_on_the_robot(console: Served) -> None:
    with console.client(Role.ENGINEER) as client:
        assert client.get("/api/recordings").json()["here"] is False
        refused = client.get("/api/recordings/dock")
        assert refused.status_code == 409
        assert "on the robot" in refused.json()["detail"]["title"]
