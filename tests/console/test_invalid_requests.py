"""What a request has wrong is said in a sentence: the field, its value and the remedy."""

from __future__ import annotations

import json
from collections.abc import Iterator

import httpx
import pytest

from kompass_console.schema.roles import Role
from tests.console.conftest import serving
from tests.console.rules_client import Json

pytestmark = pytest.mark.ros
SCHEDULE = {"name": "night", "waypoints": [{"place": 1}]}


@pytest.fixture(scope="module")
def ava(tmp_path_factory: pytest.TempPathFactory, domain: int) -> Iterator[httpx.Client]:
    with (
        serving(tmp_path_factory.mktemp("console") / "audit", domain) as served,
        served.client(Role.ENGINEER, "ava") as client,
    ):
        yield client


@pytest.mark.parametrize(
    ("path", "body", "title", "remedy"),
    [
        ("goals/check", {"x": 1e7, "y": 1}, "x cannot be 10000000.0: it should be less", "Correct"),
        ("goals/check", {"y": 1}, "The request lacks x.", "Add it"),
        ("goals/check", {"x": True, "y": 1}, "x cannot be true", "Correct"),
        ("goals", {"place": 1, "version": True}, "version cannot be true", "Correct"),
        ("rules/rollback", {"expected_revision": 0}, "expected_revision cannot be 0", "Correct"),
        ("goals/check", {"x": 1, "y": 1, "yaw": 101}, "yaw cannot be 101", "Correct"),
        ("goals/check", {"place": 0, "version": 1}, "place cannot be 0: it should be", "Correct"),
        ("goals/check", {"view": "v", "start": [0.5, 7]}, "start.1 cannot be 7", "Correct"),
        ("goals", {}, "lacks x and y, or place and version.", "Add what is missing."),
        ("goals", {"x": 1, "y": 1, "Y": 1}, "has a field Y, and there is none", "Leave it out"),
        ("localisation/check", {"x": 1, "y": "here"}, 'y cannot be "here"', "Correct"),
        ("zones", {"name": "z"}, "The request lacks kind.", "Add it"),
        (
            "missions",
            {**SCHEDULE, "waypoints": []},
            "waypoints cannot be []: it must have at least 1 item",
            "Correct",
        ),
        ("recordings", {"name": "x\0"}, "a character that cannot be seen", "Correct"),
        ("recordings", {"name": "x" * 999}, "it must have at most 200 characters", "Correct"),
        (
            "missions",
            {**SCHEDULE, "schedule": {"at": "24:00"}},
            'schedule.at cannot be "24:00": it is no time of the day: write HH:MM',
            "Correct",
        ),
    ],
    ids=lambda one: str(one)[:40],
)
def test_it_names_what_was_sent_and_what_to_do(
    ava: httpx.Client, path: str, body: Json, title: str, remedy: str
) -> None:
    answer = ava.post(f"/api/{path}", json=body)
    assert answer.status_code == 422, answer.text
    detail = answer.json()["detail"]
    assert title in detail["title"]
    assert detail["remedy"].startswith(remedy)


@pytest.mark.parametrize("body", [b"", b"{", b"[1, "])
def test_a_body_that_is_none_is_said_to_be(ava: httpx.Client, body: bytes) -> None:
    headers = {"Content-Type": "application/json"}
    answer = ava.post("/api/goals/check", content=body, headers=headers)
    assert answer.status_code == 422, answer.text
    title = answer.json()["detail"]["title"]
    assert title.startswith("The request's body is no JSON" if body else "The request has no body")


AS_JSON = {"Content-Type": "application/json"}
HALF = "half of a surrogate pair, which is no character"


@pytest.mark.parametrize(
    ("path", "body", "field"),
    [
        ("login", {"user": "\ud800", "token": "x"}, "user"),
        ("places", {"name": "dock \udfff", "pose": {"x": 0, "y": 0, "yaw": 0}}, "name"),
        ("missions", {**SCHEDULE, "waypoints": [{"place": 1, "\ud800": 1}]}, "waypoints.0"),
        ("goals", "\ud800", "body"),
        ("rules/apply", {"table": {"rules": []}, "note": "\ud800"}, "note"),
    ],
)
def test_half_a_character_is_refused_before_anything_is_done(
    ava: httpx.Client, path: str, body: Json, field: str
) -> None:
    escaped = json.dumps(body).encode()
    raw = json.dumps(body, ensure_ascii=False).encode(errors="surrogatepass")
    for content in (escaped, raw):
        answer = ava.post(f"/api/{path}", content=content, headers=AS_JSON)
        assert answer.status_code == 422, answer.text
        detail = answer.json()["detail"]
        assert HALF in detail["title"]
        assert f"'s {field} cannot be" in detail["title"]
        assert "as UTF-8" in detail["remedy"]


def test_a_character_of_two_halves_is_one(ava: httpx.Client) -> None:
    """It is read, and the token refused."""
    answer = ava.post(
        "/api/login", content=b'{"user": "\\ud83d\\ude00", "token": "x"}', headers=AS_JSON
    )
    assert answer.status_code == 403, answer.text


def test_stop_takes_any_reason(ava: httpx.Client) -> None:
    answer = ava.post("/api/stop", content=b'{"reason": "\\ud800"}', headers=AS_JSON)
    assert answer.status_code == 503, "there is no drive manager here: it went that far"
