"""Whoever may only watch can neither fill the console nor take anything from others."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import json
import math
import os
import stat
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import msgspec
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.extensions.permessage_deflate import ClientPerMessageDeflateFactory
from websockets.sync.client import ClientConnection, connect

from kompass_console.scene.client_messages import allowed
from kompass_console.schema.roles import Role
from kompass_console.settings import ConnectionLimits
from kompass_console.web.auth import Authenticator
from kompass_console.web.session_records import MOST_REVOKED, MOST_SEEN, SessionRecords
from tests.console.conftest import TOKENS, Served, cookie_of, serving
from tests.console.rules_client import closed_with, opened, until
from tests.console.scene_client import SceneClient, camera_message, drawn
from tests.support.patience import patient
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

HOUR = 3600.0
# Whoever is still sending when the console has closed may not come to read why.
TOO_LARGE = (1009, 1006)


@contextlib.contextmanager
def scene(
    console: Served, client: httpx.Client, view: str | None = None, packing: bool = True
) -> Iterator[SceneClient]:
    """A page's scene that is drawn."""
    page = SceneClient(console.port, view or new_view(client), cookie_of(client), packing)
    with drawn(page):
        yield page


def new_view(client: httpx.Client) -> str:
    return str(client.post("/api/views").json()["id"])


def scene_closed_with(page: SceneClient) -> int:
    """Wait until the console closes a scene, which reads by itself; its code."""
    wait_until(lambda: page.socket.close_code is not None, 10.0, "the scene is closed")
    return int(page.socket.close_code or 0)


# -- what a page may say ---------------------------------------------------------------------


@pytest.mark.parametrize("packing", [True, False], ids=["packed", "plain"])
@pytest.mark.parametrize("kind", ["ViewerCameraMessage", "GetRenderResponseMessage"])
def test_a_large_scene_message_is_refused_by_its_size_alone(
    console: Served, kind: str, packing: bool
) -> None:
    with console.client(Role.VIEWER) as client, scene(console, client, packing=packing) as page:
        large = {"type": kind, "payload": b"x" * 7_900_000, "render_uuid": "x"}
        with contextlib.suppress(ConnectionClosed):
            page.send(**large)
        assert scene_closed_with(page) in TOO_LARGE


def test_a_window_that_nothing_can_be_packed_with_is_not_agreed_to(console: Served) -> None:
    with (
        console.client(Role.VIEWER) as client,
        connect(
            f"ws://127.0.0.1:{console.port}/scene/{new_view(client)}",
            origin=console.origin,
            additional_headers={"Cookie": cookie_of(client)},
            subprotocols=["viser-v1.1.1"],
            extensions=[ClientPerMessageDeflateFactory(server_max_window_bits=8)],
            compression=None,
        ) as page,
    ):
        agreed = page.response
        assert agreed is not None
        assert "Sec-WebSocket-Extensions" not in agreed.headers
        page.send(msgspec.msgpack.encode(camera_message()))
        assert page.recv(timeout=patient(5.0)), "the scene comes as it is"


@pytest.mark.parametrize("path", ["/api/state", "/api/rules/live", "/api/map/live", "/api/camera"])
def test_no_other_socket_takes_a_large_message(console: Served, path: str) -> None:
    with console.client(Role.VIEWER) as client, opened(console, path, client) as socket:
        with contextlib.suppress(ConnectionClosed):
            socket.send("x" * 1_000_000)
        assert closed_with(socket) in TOO_LARGE


def test_the_camera_of_viser_s_own_client_is_taken() -> None:
    whole_numbers = camera_message(position=(3, 3, 3), look_at=(0, 0, 0))
    assert allowed(msgspec.msgpack.encode(whole_numbers))


@pytest.mark.parametrize(
    "wrong",
    [
        {"wxyz": [1.0, 0.0, 0.0]},
        {"wxyz": [0.0, 0.0, 0.0, 0.0]},
        {"wxyz": [1.0] * 5},
        {"position": "far away"},
        {"position": [math.nan, 0.0, 1.0]},
        {"position": [math.inf, 0.0, 1.0]},
        {"position": [1e300, 0.0, 1.0]},
        {"position": [0.0, 0.0, 0.0], "look_at": [0.0, 0.0, 0.0]},
        {"position": [[1.0, 2.0, 3.0]] * 3},
        {"up_direction": [0.0, 0.0, 0.0]},
        {"fov": 0.0},
        {"fov": math.nan},
        {"near": -1.0},
        {"far": math.inf},
        {"image_height": 0},
        {"image_width": -900},
        {"image_width": 10**9},
        {"image_width": True},
        {"render_uuid": "more"},
        {"type": ["ViewerCameraMessage"]},
    ],
)
def test_a_camera_of_the_wrong_shape_never_reaches_viser(wrong: dict[str, Any]) -> None:
    assert not allowed(msgspec.msgpack.encode({**camera_message(), **wrong}))


def test_a_camera_with_something_missing_never_reaches_viser() -> None:
    for field in camera_message():
        rest = {name: value for name, value in camera_message().items() if name != field}
        assert not allowed(msgspec.msgpack.encode(rest))


def test_a_wrong_camera_costs_a_scene_nothing(console: Served) -> None:
    with console.client(Role.VIEWER) as client:
        view = new_view(client)
        with scene(console, client, view) as page:
            page.send(**{**camera_message(), "position": [1.0]})
            page.send(type="ViewerCameraMessage")
            # What viser's handler still says, and what it still hears.
            for theme, dark in (("dark", True), ("light", False)):
                client.patch(f"/api/views/{view}", json={"theme": theme})
                wait_until(lambda dark=dark: page.dark is dark, 5.0, "the scene goes on")  # type: ignore[misc]
            page.look(position=(1.0, -5.0, 4.0), look_at=(1.0, 0.0, 0.0))
            check = {"view": view, "start": [0.5, 0.5]}
            wait_until(
                lambda: abs(client.post("/api/goals/check", json=check).json()["x"] - 1.0) < 1e-3,
                5.0,
                "the right camera is taken",
            )


def test_a_flood_of_cameras_ends_its_own_scene_and_no_other(console: Served) -> None:
    with console.client(Role.VIEWER) as client, console.client(Role.OPERATOR) as other:
        view = new_view(other)
        with scene(console, other, view) as theirs, scene(console, client) as mine:
            with contextlib.suppress(ConnectionClosed):
                for _ in range(3000):
                    mine.look()
            assert scene_closed_with(mine) is not None
            other.patch(f"/api/views/{view}", json={"theme": "dark"})
            wait_until(lambda: theirs.dark, 5.0, "the other scene goes on")


@pytest.mark.parametrize("path", ["/api/state", "/api/rules/live", "/api/map/live", "/api/camera"])
def test_who_chatters_on_a_socket_is_closed(console: Served, path: str) -> None:
    with console.client(Role.VIEWER) as client, opened(console, path, client) as socket:
        with contextlib.suppress(ConnectionClosed):
            for number in range(500):
                socket.send(json.dumps({"type": "ping", "t": number}))
        assert closed_with(socket) == 1008


# -- sockets and sessions --------------------------------------------------------------------


@contextlib.contextmanager
def a_page(
    console: Served, client: httpx.Client
) -> Iterator[tuple[list[ClientConnection], SceneClient]]:
    """Every kind of socket of an operator's page."""
    with contextlib.ExitStack() as stack:
        sockets = [
            stack.enter_context(opened(console, path, client))
            for path in (
                "/api/state",
                "/api/rules/live",
                "/api/rules/probe",
                "/api/map/live",
                "/api/camera",
            )
        ]
        yield sockets, stack.enter_context(scene(console, client))


def test_log_out_closes_what_the_session_has_open_and_nothing_else(console: Served) -> None:
    with (
        console.client(Role.OPERATOR) as client,
        console.client(Role.OPERATOR) as other,
        opened(console, "/api/state", other) as theirs,
        a_page(console, client) as (sockets, page),
    ):
        client.post("/api/logout")
        assert [closed_with(socket) for socket in sockets] == [4401] * len(sockets)
        assert scene_closed_with(page) == 4401
        until(theirs, lambda m: m["type"] == "state")


def test_a_session_that_ends_takes_its_open_sockets_along(tmp_path: Path, domain: int) -> None:
    with (
        serving(tmp_path / "audit", domain, session_lifetime=patient(1.5)) as own,
        own.client(Role.OPERATOR) as client,
        a_page(own, client) as (sockets, page),
    ):
        assert [closed_with(socket) for socket in sockets] == [4401] * len(sockets)
        assert scene_closed_with(page) == 4401
        assert client.get("/api/session").status_code == 401


def test_log_in_as_somebody_else_ends_what_the_browser_was_before(console: Served) -> None:
    with console.client(Role.OPERATOR) as client:
        before = cookie_of(client)
        with opened(console, "/api/state", client) as socket:
            client.post("/api/login", json={"token": TOKENS[Role.VIEWER]})
            assert closed_with(socket) == 4401
        assert client.get("/api/session").json()["role"] == "viewer"
        client.cookies.clear()
        assert client.get("/api/session", headers={"Cookie": before}).status_code == 401


def test_log_in_once_more_disturbs_no_other_page_of_the_browser(console: Served) -> None:
    with console.client(Role.OPERATOR, user="ava") as client:
        view = new_view(client)
        with opened(console, "/api/state", client) as socket:
            client.post("/api/login", json={"token": TOKENS[Role.OPERATOR], "user": "ava"})
            assert client.patch(f"/api/views/{view}", json={"top": True}).status_code == 200
            for _ in range(15):
                until(socket, lambda m: m["type"] == "state")


def test_a_session_has_only_so_many_sockets_and_viewers_leave_room(
    tmp_path: Path, domain: int
) -> None:
    limits = ConnectionLimits(sockets_of_session=2, sockets_of_viewers=3)
    with (
        serving(tmp_path / "audit", domain, limits=limits) as own,
        own.client(Role.VIEWER) as one,
        own.client(Role.VIEWER) as other,
        own.client(Role.OPERATOR) as operator,
        contextlib.ExitStack() as stack,
    ):
        for client in (one, one, other):
            stack.enter_context(opened(own, "/api/state", client))
        for client in (one, other):
            with pytest.raises(InvalidStatus), opened(own, "/api/state", client):
                pass
        with opened(own, "/api/state", operator) as socket:
            until(socket, lambda m: m["type"] == "state")


# -- log-out and idleness over a restart -----------------------------------------------------


def test_a_logged_out_cookie_is_refused_after_a_restart_and_others_are_not(
    tmp_path: Path, domain: int
) -> None:
    file = tmp_path / "sessions.json"
    with (
        serving(tmp_path / "audit", domain, sessions_file=file) as first,
        first.client(Role.OPERATOR) as leaving,
        first.client(Role.OPERATOR) as staying,
    ):
        gone, kept = (next(iter(c.cookies.values())) for c in (leaving, staying))
        assert leaving.post("/api/logout").status_code == 204
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    with (
        serving(tmp_path / "audit", domain, sessions_file=file) as second,
        second.client() as client,
    ):
        for value, status in ((gone, 401), (kept, 200)):
            cookie = {"Cookie": f"kompass_session_{second.port}={value}"}
            assert client.get("/api/session", headers=cookie).status_code == status


def test_who_logged_out_is_remembered_up_to_a_bound_beyond_which_age_decides(
    tmp_path: Path,
) -> None:
    records = SessionRecords(None, 0.0)
    for number in range(MOST_REVOKED + 1):
        records.revoke(Role.VIEWER, str(number), float(number))
    assert records.is_revoked(Role.VIEWER, "0", 0.0)  # pushed out, and refused all the same
    assert records.is_revoked(Role.VIEWER, "5", 5.0)
    assert not records.is_revoked(Role.OPERATOR, "of another role", 0.0)
    assert not records.is_revoked(Role.VIEWER, "a new one", MOST_REVOKED + 1.0)
    for number in range(MOST_SEEN + 1):
        records.saw(Role.VIEWER, str(number), 1.0)
    assert records.last_seen(Role.VIEWER, "0") is None
    assert records.last_seen(Role.VIEWER, str(MOST_SEEN)) == 1.0


def test_two_consoles_of_a_robot_keep_each_other_s_log_outs(tmp_path: Path) -> None:
    file = tmp_path / "sessions.json"
    one, other = SessionRecords(file, 0.0), SessionRecords(file, 0.0)
    one.revoke(Role.VIEWER, "a", 1.0)
    other.revoke(Role.OPERATOR, "b", 2.0)
    after = SessionRecords(file, 3.0)
    assert after.is_revoked(Role.VIEWER, "a", 1.0)
    assert after.is_revoked(Role.OPERATOR, "b", 2.0)


def test_a_disk_that_takes_its_time_holds_nobody_up(tmp_path: Path) -> None:
    records = SessionRecords(tmp_path / "sessions.json", 0.0)
    folder = os.open(tmp_path, os.O_RDONLY)
    fcntl.flock(folder, fcntl.LOCK_EX)  # as if another console were writing, and never done
    leaving = threading.Thread(target=records.revoke, args=(Role.VIEWER, "a", 1.0))
    try:
        leaving.start()
        wait_until(lambda: records.is_revoked(Role.VIEWER, "a", 1.0), 5.0, "an answer")
        records.saw(Role.OPERATOR, "b", 2.0)
        assert leaving.is_alive()
    finally:
        os.close(folder)
        leaving.join(patient(5.0))
    assert SessionRecords(tmp_path / "sessions.json", 3.0).is_revoked(Role.VIEWER, "a", 1.0)


@pytest.mark.parametrize("damage", ["", "{", '{"revoked": {"king": {}}}', "\x00" * 100])
def test_when_nobody_knows_who_logged_out_all_log_in_again(
    tmp_path: Path, damage: str, caplog: pytest.LogCaptureFixture
) -> None:
    file = tmp_path / "sessions.json"
    now = [1000.0]
    auth = Authenticator(TOKENS, SessionRecords(file, now[0]), now=lambda: now[0])
    session = auth.log_in(TOKENS[Role.OPERATOR], "ava")
    assert session is not None
    file.write_text(damage)
    now[0] += 10.0
    after = Authenticator(TOKENS, SessionRecords(file, now[0]), now=lambda: now[0])
    assert after.session(auth.cookie(session)) is None
    assert "log in again" in caplog.text
    now[0] += 1.0
    fresh = after.log_in(TOKENS[Role.OPERATOR], "ava")
    assert fresh is not None
    assert after.session(after.cookie(fresh)) == fresh


def test_a_full_disk_is_told_and_keeps_nobody_from_logging_out(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    blocked = tmp_path / "a file"
    blocked.touch()
    records = SessionRecords(blocked / "sessions.json", 0.0)
    records.revoke(Role.VIEWER, "a", 1.0)
    assert records.is_revoked(Role.VIEWER, "a", 1.0)
    assert "not written" in caplog.text


def test_who_logs_out_on_a_full_disk_stays_out_over_restarts_and_so_does_everybody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    file = tmp_path / "sessions.json"
    now = [1000.0]
    auth = Authenticator(TOKENS, SessionRecords(file, now[0]), now=lambda: now[0])
    ava, ben = (auth.log_in(TOKENS[Role.OPERATOR], name) for name in ("ava", "ben"))
    assert ava is not None
    assert ben is not None

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr("kompass_console.web.session_records.replace_file", full)
        auth.log_out(ava)
    assert auth.session(auth.cookie(ava)) is None
    assert auth.session(auth.cookie(ben)) == ben
    assert "everybody has to log in again" in caplog.text
    now[0] += 10.0
    after = Authenticator(TOKENS, SessionRecords(file, now[0]), now=lambda: now[0])
    assert after.session(auth.cookie(ava)) is None
    assert after.session(auth.cookie(ben)) is None


def test_a_session_that_is_not_used_ends_and_a_page_that_is_open_uses_it(tmp_path: Path) -> None:
    file = tmp_path / "sessions.json"
    now = [1000.0]

    def started() -> Authenticator:
        records = SessionRecords(file, now[0])
        return Authenticator(TOKENS, records, idle_limit=12 * HOUR, now=lambda: now[0])

    auth = started()
    used, unused = (auth.log_in(TOKENS[Role.VIEWER], name) for name in ("ava", "ben"))
    assert used is not None
    assert unused is not None
    for _ in range(3):
        now[0] += 5 * HOUR
        assert auth.is_open(used)  # as is asked for each open socket
    assert auth.session(auth.cookie(unused)) is None
    auth.save()
    after = started()
    now[0] += 11 * HOUR
    assert after.session(auth.cookie(used)) == used
    now[0] += 13 * HOUR
    assert after.session(auth.cookie(used)) is None


# -- views -----------------------------------------------------------------------------------


def test_no_number_of_views_takes_anybody_else_s_away(console: Served) -> None:
    with (
        console.client(Role.OPERATOR) as operator,
        console.client(Role.VIEWER) as viewer,
        console.client(Role.VIEWER) as greedy,
    ):
        theirs, mine = new_view(operator), new_view(viewer)
        first = new_view(greedy)
        for _ in range(450):
            newest = new_view(greedy)
        for client, view, status in (
            (operator, theirs, 200),
            (viewer, mine, 200),
            (greedy, newest, 200),
            (greedy, first, 404),
        ):
            answer = client.patch(f"/api/views/{view}", json={"top": True})
            assert answer.status_code == status, answer.text


def test_a_view_is_unknown_to_everybody_but_who_made_it(console: Served) -> None:
    with console.client(Role.OPERATOR) as owner, console.client(Role.ENGINEER) as other:
        view = new_view(owner)
        check = {"view": view, "start": [0.5, 0.5]}
        assert other.patch(f"/api/views/{view}", json={"top": True}).status_code == 404
        assert other.delete(f"/api/views/{view}/preview").status_code == 404
        assert other.get(f"/scene/{view}/").status_code == 404
        assert other.post("/api/goals/check", json=check).status_code == 404
        with pytest.raises(InvalidStatus):
            SceneClient(console.port, view, cookie_of(other))


def test_views_go_with_their_session(console: Served) -> None:
    with console.client(Role.VIEWER) as client:
        view = new_view(client)
        cookie = cookie_of(client)
        client.post("/api/logout")
        client.post("/api/login", json={"token": TOKENS[Role.VIEWER]})
        assert cookie_of(client) != cookie
        assert client.get(f"/scene/{view}/").status_code == 404
