"""Notices on their way to real servers: signed, tried again, and in nobody's way."""

from __future__ import annotations

import asyncio
import logging
import shutil
import socket
import ssl
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from kompass_console.webhooks import post as posting
from kompass_console.webhooks.notice import Notice
from kompass_console.webhooks.post import NotTaken, post, signature
from kompass_console.webhooks.sender import WAITING, Webhooks
from kompass_console.webhooks.settings import Webhook
from tests.console.test_state_feed import build
from tests.webhooks.receiver import receiving

SECRET = "a secret of the engineer"
STOPPED = Notice("stop", "Stopped by ava", "It stays.")


async def until(condition: Callable[[], object], what: str) -> None:
    """Wait for a condition without keeping the loop from its work."""
    deadline = time.monotonic() + 30.0
    while not condition():
        assert time.monotonic() < deadline, f"waited in vain for {what}"
        await asyncio.sleep(0.01)


def with_webhooks(
    use: Callable[[Webhooks], object], *urls: str, pauses: tuple[float, ...] = (0.0, 0.0)
) -> None:
    """Run webhooks for as long as `use` takes."""

    async def running() -> None:
        hooks = [Webhook(url=url, secret=SECRET) for url in urls]
        webhooks = Webhooks(hooks, "test robot", pauses=pauses)
        task = asyncio.create_task(webhooks.run(lambda: build(0, 0)))
        await asyncio.sleep(0)
        try:
            await use(webhooks)  # type: ignore[misc]
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)

    asyncio.run(running())


def test_a_notice_says_what_which_robot_and_when_and_is_signed() -> None:
    with receiving() as receiver:

        async def tell(webhooks: Webhooks) -> None:
            webhooks.tell(STOPPED)
            await until(lambda: receiver.bodies, "the notice")

        with_webhooks(tell, receiver.url)
        [told], [head] = receiver.told, receiver.heads
    assert abs(told.pop("time") - time.time()) < 60.0
    assert len(told.pop("id")) == 32
    assert told == {
        "version": 1,
        "robot": "test robot",
        "kind": "stop",
        "title": "Stopped by ava",
        "body": "It stays.",
        "urgent": True,
    }
    assert head["path"] == "/told?key=secret-of-the-path"
    assert head["Content-Type"] == "application/json"
    expected = signature(SECRET, head["Kompass-Timestamp"], receiver.bodies[0])
    assert head["Kompass-Signature"] == expected


def test_a_server_that_answers_500_is_asked_again_with_the_same_id_and_told_of_once(
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level(logging.WARNING)
    with receiving() as receiver:
        receiver.status = 500

        async def tell(webhooks: Webhooks) -> None:
            webhooks.tell(STOPPED)
            webhooks.tell(Notice("battery", "Battery low"))
            await until(lambda: len(receiver.bodies) == 6, "three tries of two notices")
            assert webhooks.problem == (
                f"The webhook http://127.0.0.1:{receiver.port} takes no notices: it answers 500."
            )
            receiver.status = 204
            webhooks.tell(Notice("goal", "Goal given up"))
            await until(lambda: webhooks.problem == "", "that it works again")

        with_webhooks(tell, receiver.url)
        assert len({told["id"] for told in receiver.told[:3]}) == 1
        kinds = [told["kind"] for told in receiver.told]
        assert kinds == [*(["stop"] * 3), *(["battery"] * 3), "goal"]
    said = [record.getMessage() for record in caplog.records]
    assert len(said) == 2
    assert "told of once" in said[0]
    assert said[1].endswith("takes notices again; 2 got lost.")
    assert not any("secret" in each for each in said)


@pytest.mark.parametrize("status", [301, 307, 400, 404])
def test_an_answer_that_means_no_is_not_asked_again_nor_followed(status: int) -> None:
    with receiving() as elsewhere, receiving() as receiver:
        receiver.status = status
        receiver.headers = {"Location": elsewhere.url}

        async def tell(webhooks: Webhooks) -> None:
            webhooks.tell(STOPPED)
            await until(lambda: webhooks.problem, "the problem")
            webhooks.tell(Notice("goal", "Goal given up"))
            await until(lambda: len(receiver.bodies) == 2, "the next notice")

        with_webhooks(tell, receiver.url)
        assert [told["kind"] for told in receiver.told] == ["stop", "goal"]
        assert elsewhere.bodies == []


def test_one_that_hangs_or_is_dead_keeps_nobody_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(posting, "TIMEOUT", 0.2)
    with socket.create_server(("127.0.0.1", 0)) as free:
        dead = f"http://127.0.0.1:{free.getsockname()[1]}/"
    with receiving() as hanging, receiving() as well:
        hanging.hangs.set()

        async def tell(webhooks: Webhooks) -> None:
            began = time.monotonic()
            for number in range(3 * WAITING):
                webhooks.tell(Notice("goal", f"Goal {number} given up"))
            assert time.monotonic() - began < 5.0
            await until(lambda: len(well.bodies) == WAITING, "what there was room for")
            assert well.told[-1]["title"] == f"Goal {3 * WAITING - 1} given up"
            await until(lambda: "no answer came" in webhooks.problem, "that one hangs")
            await until(lambda: "cannot be reached" in webhooks.problem, "that one is dead")

        with_webhooks(tell, hanging.url, dead, well.url)


def test_https_takes_a_certificate_that_this_machine_believes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    openssl = shutil.which("openssl")
    if openssl is None:
        pytest.skip("openssl, which makes the certificate, is not installed")
    key, certificate = tmp_path / "key.pem", tmp_path / "certificate.pem"
    made = [openssl, "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2"]
    made += ["-subj", "/CN=127.0.0.1", "-addext", "subjectAltName=IP:127.0.0.1"]
    made += ["-keyout", str(key), "-out", str(certificate)]
    subprocess.run(made, check=True, capture_output=True)
    tls = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    tls.load_cert_chain(certificate, key)
    with receiving(tls) as receiver:
        hook = Webhook(url=receiver.url)
        with pytest.raises(NotTaken, match="its certificate is not valid"):
            asyncio.run(post(hook, b"{}"))
        assert receiver.bodies == []
        monkeypatch.setenv("SSL_CERT_FILE", str(certificate))
        asyncio.run(post(hook, b"{}"))
        assert receiver.bodies == [b"{}"]
        assert "Kompass-Signature" not in receiver.heads[0]  # without a secret


def test_what_says_no_http_or_more_than_it_may_is_not_believed() -> None:
    async def against(said: bytes) -> str:
        async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            await reader.readuntil(b"\r\n\r\n")
            writer.write(said)
            writer.close()

        async with await asyncio.start_server(answer, "127.0.0.1", 0) as server:
            port = server.sockets[0].getsockname()[1]
            with pytest.raises(NotTaken) as refused:
                await post(Webhook(url=f"http://127.0.0.1:{port}/"), b"{}")
            return str(refused.value)

    for said in (b"SSH-2.0-OpenSSH\r\n\r\n", b"", b"HTTP/1.1 200 OK\r\nX: " + b"x" * 100_000):
        why = asyncio.run(against(said))
        assert "no HTTP" in why or "cannot be reached" in why, (said[:20], why)


def test_a_name_that_leads_elsewhere_is_told_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a name leads is looked at each time: it may be another address by then."""
    with receiving() as receiver:

        async def led_to(address: str, url: str) -> str:
            async def look_up(*_: object, **__: object) -> list[tuple[object, ...]]:
                return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (address, receiver.port))]

            loop = asyncio.get_running_loop()
            monkeypatch.setattr(loop, "getaddrinfo", look_up)
            with pytest.raises(NotTaken) as refused:
                await post(Webhook(url=url), b"{}")
            assert not refused.value.again
            return str(refused.value)

        port = receiver.port
        why = asyncio.run(led_to("93.184.215.14", f"http://near.example:{port}/"))
        assert "use https" in why
        why = asyncio.run(led_to("169.254.169.254", f"https://cloud.example:{port}/"))
        assert "no address that notices go to" in why
        assert receiver.bodies == []


def test_without_webhooks_nothing_is_looked_at() -> None:
    def look() -> object:
        raise AssertionError("nobody wants to know")

    asyncio.run(Webhooks([], "robot").run(look))  # type: ignore[arg-type]
