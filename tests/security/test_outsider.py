"""Whoever has no token cannot get in, break anything, or keep others from pressing STOP."""

from __future__ import annotations

import base64
import contextlib
import ipaddress
import json
import logging
import os
import random
import re
import shutil
import socket
import ssl
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from pydantic import ValidationError
from websockets import Origin
from websockets.sync.client import connect

from kompass_console.cli_error import CliError
from kompass_console.schema.roles import Role
from kompass_console.settings import ConnectionLimits, ConsoleSettings
from kompass_console.stack import ConsoleListener, Door
from kompass_console.web.auth import LoginLimiter
from tests.console.conftest import TOKENS, Served, cookie_of, serving
from tests.console.rules_client import opened, until
from tests.support.patience import patient
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

GIVEN = "a token that somebody gave"
LOOPBACK = "127.0.0.1"


def raw(console: Served, sent: bytes = b"", receive_buffer: int | None = None) -> socket.socket:
    """A connection that has sent so much."""
    connection = socket.socket()
    if receive_buffer is not None:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
    connection.settimeout(patient(10.0))
    connection.connect((LOOPBACK, console.port))
    connection.sendall(sent)
    return connection


def answer_to(console: Served, sent: bytes) -> bytes:
    """All that is answered until the console closes the connection."""
    said = b""
    with raw(console, sent) as connection, contextlib.suppress(ConnectionResetError):
        while piece := connection.recv(65_536):
            said += piece
    return said


def request(target: str = "/", *headers: str, method: str = "GET", body: str = "") -> bytes:
    """An HTTP request that asks for the connection to be closed."""
    lines = [f"{method} {target} HTTP/1.1", "Connection: close", *headers]
    if not any(header.lower().startswith("host:") for header in headers):
        lines.append("Host: localhost")
    if body:
        lines.append(f"Content-Length: {len(body.encode('utf-8', 'surrogatepass'))}")
    return "\r\n".join([*lines, "", body]).encode("utf-8", "surrogatepass")


def status_of(answer: bytes) -> int:
    return int(answer.split(b" ", 2)[1])


def is_closed(connection: socket.socket) -> bool:
    """Whether the console has let go of a connection on which it says nothing."""
    connection.setblocking(False)
    try:
        return connection.recv(65_536) == b""
    except BlockingIOError:
        return False
    except ConnectionResetError:
        return True


def is_cut_off(connection: socket.socket, frame: bytes) -> bool:
    """Whether the console ends a connection on which a frame comes a million times."""
    try:
        for _ in range(10_000):
            connection.sendall(frame * 100)
    except (BrokenPipeError, ConnectionResetError):
        return True
    return False


def stop_is_answered(console: Served) -> bool:
    """Whether somebody who comes now can log in and press STOP."""
    with console.client(Role.VIEWER) as client:
        # No drive manager runs here: the press is let through, and said not to be confirmed.
        return client.post("/api/stop", json={}).status_code == 503


def wrong_token(client: httpx.Client, came_from: str) -> httpx.Response:
    return client.post(
        "/api/login", json={"token": "a wrong guess"}, headers={"X-Forwarded-For": came_from}
    )


# -- requests that are none ------------------------------------------------------------------


@pytest.mark.parametrize(
    "target",
    [
        "/%00",
        "/assets/%00.js",
        "/" + "x" * 900,
        "/" + "x" * 5000,
        "/" + "x/" * 3000,
        "/%0d%0aSet-Cookie:%20a=b",
        "/%e2%80%ae",
        "/%ff%fe",
        "/scene/%00/",
        "/api/views/%00",
    ],
)
def test_an_address_that_is_none_is_answered_in_a_sentence(
    console: Served, target: str, caplog: pytest.LogCaptureFixture
) -> None:
    answer = answer_to(console, request(target))
    assert status_of(answer) in (400, 401, 404, 405), answer
    detail = json.loads(answer.partition(b"\r\n\r\n")[2])["detail"]
    assert set(detail) == {"title", "remedy"}
    assert len(detail["title"]) < 200
    assert "Traceback" not in caplog.text


@pytest.mark.parametrize(
    "host",
    ["localhost:99999", "localhost:x", "[::1", "[nonsense]", "[::1]]", "a@localhost", "1.2.3.4.5"],
)
def test_a_host_that_is_none_is_not_answered(console: Served, host: str) -> None:
    assert status_of(answer_to(console, request("/api/session", f"Host: {host}"))) == 421


def cookies() -> Iterator[str]:
    """What somebody without a token may put in a cookie."""
    for value in ("[" * 5000, '["a","operator","b",1e400]', "{}", "null", '["a"]', "\x00"):
        body = base64.urlsafe_b64encode(value.encode()).decode().rstrip("=")
        yield f"{body}.{body}"
    yield "x" * 10_000
    yield "." * 100


@pytest.mark.parametrize("cookie", list(cookies()), ids=range(8))
def test_a_forged_cookie_is_refused_whatever_is_in_it(console: Served, cookie: str) -> None:
    named = f"Cookie: kompass_session_{console.port}={cookie}"
    host = f"Host: localhost:{console.port}"
    assert status_of(answer_to(console, request("/api/session", host, named))) == 401


def test_nothing_that_a_stranger_sends_is_an_error_of_ours(
    console: Served, caplog: pytest.LogCaptureFixture
) -> None:
    chance = random.Random(10)
    paths = [
        "/",
        "/api/login",
        "/api/session",
        "/api/stop",
        "/api/stop/without-login",
        "/api/views/x",
        "/scene/x/",
        "/x",
    ]
    bodies = [
        "", "{", "null", "[]", '{"token": 1}', '{"token": "\\ud800"}', '{"\\ud800": 1}',
        '{"token": "' + "x" * 5000 + '"}', "[" * 3000, '{"token": 1e999, "user": NaN}', "\x00",
        '{"token": "a wrong guess", "user": "\\u0000\\u202e"}',
    ]  # fmt: skip
    headers = [
        "Content-Type: application/json", "Content-Type: multipart/form-data",
        "Content-Encoding: gzip", "Range: bytes=9-1,0-0,-5", "Range: bytes=0-18446744073709551616",
        "If-Modified-Since: never", "If-None-Match: \xff", "Cookie: =;;=\xff", "Accept: \x01",
        "X-Forwarded-For: ,,,", "X-Forwarded-Proto: gopher", "Upgrade: h2c", "Expect: 100-continue",
        "Transfer-Encoding: chunked", "Upgrade: websocket", "Sec-WebSocket-Key: x",
    ]  # fmt: skip
    for _ in range(400):
        sent = request(
            chance.choice(paths) + chance.choice(["", "?", "?a=%00", "%2f..%2f", "//", "#"]),
            f"Origin: http://localhost:{console.port}",
            f"Host: localhost:{console.port}",
            *chance.sample(headers, 3),
            method=chance.choice(["GET", "HEAD", "POST", "PATCH", "DELETE", "OPTIONS", "BREW"]),
            body=chance.choice(bodies),
        )
        with raw(console, sent) as connection:
            connection.shutdown(socket.SHUT_WR)
            go_on = b"HTTP/1.1 100 Continue\r\n\r\n"  # to whoever expects it, before the answer
            said = connection.recv(65_536).removeprefix(go_on) or connection.recv(65_536)
        assert not said or status_of(said) in (*range(200, 500), 503), (sent, said)
    broken = [record for record in caplog.records if record.levelno >= logging.ERROR]
    assert not broken, broken


def test_what_a_stranger_calls_himself_is_written_down_in_one_short_line(
    tmp_path: Path, domain: int, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO, "kompass_console")
    name = "eve\x9b31m\u202e\u2028\n" + "x" * 300
    # A console of its own: after twenty strangers of one address it only counts them.
    with serving(tmp_path / "audit", domain) as own, own.client() as client:
        client.post("/api/login", json={"token": "a wrong guess", "user": name})
        (who,) = (line["who"] for line in own.audited() if line["what"] == "log in")
    assert who.startswith("eve")
    assert who.isprintable()
    assert len(who) <= 40
    assert all(record.getMessage().isprintable() for record in caplog.records)


# -- guessing --------------------------------------------------------------------------------


def test_nobody_chooses_the_address_that_his_guesses_are_counted_for(
    tmp_path: Path, domain: int
) -> None:
    with serving(tmp_path / "audit", domain) as own, own.client() as client:
        answers = [wrong_token(client, f"10.0.0.{n}").status_code for n in range(12)]
        assert answers[-1] == 429
        assert (
            client.post(
                "/api/login",
                json={"token": "a wrong guess"},
                headers={"X-Forwarded-Proto": "https"},
            ).headers.get("strict-transport-security")
            is None
        )


def test_a_proxy_that_is_named_is_believed(tmp_path: Path, domain: int) -> None:
    with (
        serving(tmp_path / "audit", domain, trusted_proxies=(LOOPBACK,)) as own,
        own.client() as client,
    ):
        answers = [wrong_token(client, "10.0.0.1").status_code for _ in range(12)]
        assert answers[-1] == 429
        assert wrong_token(client, "10.0.0.2").status_code == 403
        # Only what the proxy itself has added counts, and not what its client says before it.
        assert wrong_token(client, "10.0.0.9, 10.0.0.1").status_code == 429
        over_tls = client.post(
            "/api/login",
            json={"token": TOKENS[Role.VIEWER]},
            headers={"X-Forwarded-For": "10.0.0.3", "X-Forwarded-Proto": "https"},
        )
        assert "secure" in over_tls.headers["set-cookie"].lower()


@pytest.mark.parametrize("proxy", ["*", "proxy.example", "10.0.0.0/8", ""])
def test_only_addresses_are_believed(proxy: str) -> None:
    with pytest.raises(ValidationError, match="trusted_proxies"):
        ConsoleSettings(access_tokens=TOKENS, trusted_proxies=(proxy,))


def test_guesses_from_everywhere_slow_everybody_down_and_keep_nobody_out(
    tmp_path: Path, domain: int
) -> None:
    with (
        serving(tmp_path / "audit", domain, trusted_proxies=(LOOPBACK,)) as own,
        own.client() as client,
    ):
        for number in range(70):
            assert wrong_token(client, f"10.0.{number}.1").status_code == 403
        begun = time.monotonic()
        right = client.post(
            "/api/login",
            json={"token": TOKENS[Role.OPERATOR]},
            headers={"X-Forwarded-For": "10.9.9.9"},
        )
        assert right.status_code == 200
        assert time.monotonic() - begun > 0.2  # (70 - 60) / 60 of two seconds


def test_the_slow_down_has_a_bound_and_an_end() -> None:
    now = [0.0]
    limiter = LoginLimiter(now=lambda: now[0], limit_of_all=60, longest_delay=2.0)
    for number in range(5000):
        limiter.failed(f"10.{number // 250}.{number % 250}.1")
    assert limiter.delay() == 2.0
    assert limiter.wait("10.99.99.99") == 0.0
    now[0] = 61.0
    assert limiter.delay() == 0.0


def test_a_network_of_one_customer_counts_as_one_address() -> None:
    limiter = LoginLimiter(limit=3)
    for number in range(3):
        limiter.failed(f"2001:db8:0:1::{number:x}")
    assert limiter.wait("2001:db8:0:1:ffff::1") > 0.0
    assert limiter.wait("2001:db8:0:2::1") == 0.0
    for _ in range(3):
        limiter.failed("::ffff:10.0.0.1")
    assert limiter.wait("10.0.0.1") > 0.0


# -- connections -----------------------------------------------------------------------------

HASTY = ConnectionLimits(
    total=40, of_one_address=30, header_time=1.0, body_time=1.0, keep_alive=1.0, unread_time=1.0
)
POST = b"POST /api/login HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\n"


@pytest.fixture(scope="module")
def hasty(tmp_path_factory: pytest.TempPathFactory, domain: int) -> Iterator[Served]:
    """A console that waits a second only."""
    folder = tmp_path_factory.mktemp("hasty")
    with serving(folder / "audit", domain, limits=HASTY) as served:
        yield served


@pytest.mark.parametrize(
    "begun",
    [
        b"",
        b"G",
        b"GET / HTTP/1.1\r\nHost: localhost\r\n",
        POST + b"Content-Length: 50\r\n\r\n{",
        POST + b"Transfer-Encoding: chunked\r\n\r\n1\r\n{\r\n",
        b"GET /api/session HTTP/1.1\r\nHost: localhost\r\n\r\n",
        b"GET /api/session HTTP/1.1\r\nHost: localhost\r\n\r\nGET / HT",
        b"GET /api/state HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n"
        b"Connection: Upgrade\r\n\r\n",
    ],
    ids=["nothing", "a letter", "headers", "body", "chunks", "kept alive", "the next", "websocket"],
)
def test_a_connection_that_is_waited_for_is_closed(hasty: Served, begun: bytes) -> None:
    with raw(hasty, begun) as connection:
        wait_until(lambda: is_closed(connection), 5.0, "the console lets go")


@pytest.mark.parametrize("begun", [b"GET / HTTP/1.1\r\nX: ", POST + b"Content-Length: 500\r\n\r\n"])
def test_a_request_that_trickles_is_closed(hasty: Served, begun: bytes) -> None:
    with raw(hasty, begun) as connection:

        def trickle() -> bool:
            with contextlib.suppress(BlockingIOError):
                try:
                    connection.send(b"x")
                except (BrokenPipeError, ConnectionResetError):
                    return True
            return is_closed(connection)

        wait_until(trickle, 5.0, "the console lets go")


def test_stop_is_answered_however_many_connections_are_held(tmp_path: Path, domain: int) -> None:
    limits = ConnectionLimits(total=40, of_one_address=30)
    with (
        serving(tmp_path / "audit", domain, limits=limits) as own,
        contextlib.ExitStack() as held,
    ):
        for begun in (b"", b"GET / HTTP/1.1\r\n", POST + b"Content-Length: 50\r\n\r\n{"):
            connections = [held.enter_context(raw(own, begun)) for _ in range(50)]
            assert stop_is_answered(own)
            wait_until(
                lambda those=connections: sum(map(is_closed, those)) >= 20,  # type: ignore[misc]
                5.0,
                "the oldest have gone",
            )


def test_a_request_that_comes_amid_a_burst_of_connections_is_answered(
    tmp_path: Path, domain: int
) -> None:
    limits = ConnectionLimits(total=40, of_one_address=30)
    with serving(tmp_path / "audit", domain, limits=limits) as own:
        for _ in range(20):
            with contextlib.ExitStack() as held:
                asking = held.enter_context(raw(own, request("/api/session")))
                for _ in range(100):
                    held.enter_context(raw(own))
                assert status_of(asking.recv(65_536)) == 401


def test_who_is_being_served_is_not_dropped_for_others(tmp_path: Path, domain: int) -> None:
    limits = ConnectionLimits(total=10, of_one_address=10)
    with (
        serving(tmp_path / "audit", domain, limits=limits) as own,
        own.client(Role.OPERATOR) as client,
        opened(own, "/api/state", client) as page,
        contextlib.ExitStack() as held,
    ):
        for _ in range(30):
            held.enter_context(raw(own))
        for _ in range(15):
            until(page, lambda m: m["type"] == "state")


def test_when_all_are_being_served_a_newcomer_is_told(tmp_path: Path, domain: int) -> None:
    limits = ConnectionLimits(total=3, of_one_address=3)
    with (
        serving(tmp_path / "audit", domain, limits=limits) as own,
        own.client(Role.OPERATOR) as client,
        opened(own, "/api/state", client),
        opened(own, "/api/state", client),
        opened(own, "/api/state", client),
    ):
        answer = answer_to(own, b"")
        assert status_of(answer) == 503
        assert json.loads(answer.partition(b"\r\n\r\n")[2])["detail"]["remedy"]


def handshake(console: Served, path: str, cookie: str) -> bytes:
    return (
        f"GET {path} HTTP/1.1\r\nHost: {LOOPBACK}:{console.port}\r\nOrigin: {console.origin}\r\n"
        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}\r\n"
        f"Cookie: {cookie}\r\n\r\n"
    ).encode()


def test_a_page_that_never_reads_is_dropped(hasty: Served) -> None:
    with hasty.client(Role.VIEWER) as client, hasty.client(Role.VIEWER) as other:
        deaf = raw(hasty, handshake(hasty, "/api/state", cookie_of(client)), receive_buffer=2048)
        with deaf, opened(hasty, "/api/state", other) as page:
            until(page, lambda m: m.get("viewers") == 2)
            until(page, lambda m: m.get("viewers") == 1, 40.0)


def test_who_asks_and_does_not_listen_is_dropped(hasty: Served) -> None:
    """Each ping on a websocket is answered, whether the answer is read or not."""
    ping = b"\x89\xfd\x00\x00\x00\x00" + b"x" * 125
    with (
        hasty.client(Role.VIEWER) as client,
        raw(hasty, handshake(hasty, "/api/state", cookie_of(client)), 2048) as deaf,
    ):
        assert is_cut_off(deaf, ping)


def test_a_message_of_very_many_pieces_is_not_gathered(hasty: Served) -> None:
    first, more = b"\x01\x80\x00\x00\x00\x00", b"\x00\x80\x00\x00\x00\x00"
    with (
        hasty.client(Role.VIEWER) as client,
        raw(hasty, handshake(hasty, "/api/state", cookie_of(client))) as connection,
    ):
        connection.recv(1000)
        connection.sendall(first)
        assert is_cut_off(connection, more)


# -- what can be overheard -------------------------------------------------------------------


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A certificate of this machine's own, and its key."""
    openssl = shutil.which("openssl")
    if openssl is None:
        pytest.skip("openssl, which makes the certificate, is not installed")
    folder = tmp_path_factory.mktemp("tls")
    certificate, key = folder / "certificate.pem", folder / "key.pem"
    made = [openssl, "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2"]
    made += ["-subj", "/CN=localhost", "-addext", f"subjectAltName=IP:{LOOPBACK},DNS:localhost"]
    made += ["-keyout", str(key), "-out", str(certificate)]
    subprocess.run(made, check=True, capture_output=True)
    return certificate, key


@pytest.mark.parametrize("path", ["/scene/x", "/api/state", "/nowhere"])
@pytest.mark.parametrize(
    "header",
    [
        b"Sec-WebSocket-Extensions: permessage-deflate; \xe9=1",
        b"Sec-WebSocket-Protocol: \xe9",
        b"Sec-WebSocket-Key: \xff\xfe",
    ],
)
def test_a_websocket_header_that_is_no_text_is_refused_and_no_error_of_the_console_s(
    console: Served, caplog: pytest.LogCaptureFixture, path: str, header: bytes
) -> None:
    usual = {
        b"Sec-WebSocket-Key": b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        b"Sec-WebSocket-Version": b"Sec-WebSocket-Version: 13",
    }
    usual[header.partition(b":")[0]] = header
    asked = [
        f"GET {path} HTTP/1.1\r\nHost: {LOOPBACK}:{console.port}".encode(),
        f"Origin: {console.origin}".encode(),
        *(b"Connection: Upgrade", b"Upgrade: websocket"),
        *usual.values(),
    ]
    answer = answer_to(console, b"\r\n".join(asked) + b"\r\n\r\n")
    assert answer.startswith(b"HTTP/1.1 400 ")
    assert not [record for record in caplog.records if record.levelno >= logging.ERROR]


def test_with_a_certificate_nothing_is_said_in_the_clear(
    tmp_path: Path, domain: int, pair: tuple[Path, Path]
) -> None:
    certificate, key = pair
    limits = ConnectionLimits(header_time=1.0)
    with serving(
        tmp_path / "audit", domain, tls_cert=certificate, tls_key=key, limits=limits
    ) as own:
        with own.client() as client:
            answer = client.post("/api/login", json={"token": TOKENS[Role.VIEWER]})
            assert "secure" in answer.headers["set-cookie"].lower()
            assert "max-age" in answer.headers["strict-transport-security"]
            assert client.get("/api/session").json()["role"] == "viewer"
            # A browser would keep to https for whatever else answers to this name.
            local = client.get("/api/session", headers={"Host": f"localhost:{own.port}"})
            assert "strict-transport-security" not in local.headers
            with connect(
                f"wss://{LOOPBACK}:{own.port}/api/state",
                origin=Origin(own.origin),
                additional_headers={"Cookie": cookie_of(client)},
                ssl=ssl.create_default_context(cafile=certificate),
            ) as page:
                until(page, lambda m: m["type"] == "state")
        assert b"HTTP" not in answer_to(own, request("/api/session"))
        with raw(own) as silent:
            wait_until(lambda: is_closed(silent), 5.0, "an unfinished handshake is given up")


def test_without_tls_nothing_is_said_that_only_tls_can_keep(console: Served) -> None:
    with console.client() as client:
        answer = client.post("/api/login", json={"token": TOKENS[Role.VIEWER]})
    assert "secure" not in answer.headers["set-cookie"].lower()
    assert "strict-transport-security" not in answer.headers


@pytest.mark.parametrize(("host", "warned"), [("0.0.0.0", True), (LOOPBACK, False)])
def test_who_opens_the_console_to_a_network_is_told_what_is_overheard(
    host: str, warned: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    listener = ConsoleListener(host, 0, False, "ava", GIVEN, "here")
    with listener.socket:
        listener.announce()
    assert ("Without TLS" in capsys.readouterr().out) is warned


def test_the_printed_address_is_one_that_others_on_the_network_can_open(
    capsys: pytest.CaptureFixture[str],
) -> None:
    listener = ConsoleListener("0.0.0.0", 0, False, "ava", GIVEN, "here")
    with listener.socket:
        listener.announce()
        hosts = set(re.findall(r"http://([^/:]+):", capsys.readouterr().out))
        [host] = hosts
        socket.create_connection((host, listener.port), timeout=5).close()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as anywhere:
            on_a_network = anywhere.connect_ex(("192.0.2.1", 9)) == 0
        assert ipaddress.ip_address(host).is_loopback is not on_a_network


def test_with_tls_the_address_says_so_and_nothing_is_warned_of(
    pair: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    listener = ConsoleListener("0.0.0.0", 0, False, "ava", GIVEN, "here", Door(*pair))
    with listener.socket:
        listener.announce()
    said = capsys.readouterr().out
    assert "https://" in said
    assert "Without TLS" not in said


def test_a_door_that_cannot_work_is_refused_in_a_line(
    tmp_path: Path, pair: tuple[Path, Path]
) -> None:
    certificate, key = pair
    nonsense = tmp_path / "nonsense.pem"
    nonsense.write_text("nonsense")
    for wrong, words in (
        ({"tls_cert": certificate}, "--tls-key"),
        ({"tls_key": key}, "--tls-cert"),
        ({"tls_cert": certificate, "tls_key": tmp_path / "none.pem"}, "No such file"),
        ({"tls_cert": nonsense, "tls_key": key}, "no certificate"),
        ({"trusted_proxies": ["proxy.example"]}, "not an address"),
    ):
        with pytest.raises(CliError, match=words) as refused:
            Door(**wrong)
        assert refused.value.code == 2
