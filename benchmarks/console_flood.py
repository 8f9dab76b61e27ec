"""What one viewer who floods a scene, and many idle connections, cost the console and others.

    .venv/bin/python benchmarks/console_flood.py [SECONDS]

A viewer sends messages of 7.9 MB on a scene's socket, and connects again whenever it is closed;
then 300 connections are held open that say nothing. Another page is open all the time, and tells
the time between two states (0.1 s when nothing is in the way); STOP is pressed once a second, of
the embedded robot, whose drive manager answers it.
"""

import contextlib
import logging
import multiprocessing
import os
import socket
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path

import httpx
import msgspec
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

sys.path.insert(0, str(Path(__file__).parents[1]))
from benchmarks.common import percentile, pss
from kompass_console.schema.roles import Role
from kompass_console.server import run_console
from kompass_console.settings import ConsoleSettings
from tests.console.conftest import TOKENS, Served, cookie_of
from tests.console.rules_client import opened
from tests.support.stack import Stack

IDLE = 300
LARGE = msgspec.msgpack.encode(
    {"type": "ViewerCameraMessage", "wxyz": b"x" * 7_900_000}  # which ends viser's handler
)


class Onlooker:
    """Another page, and somebody who presses STOP."""

    def __init__(self, console: Served, client: httpx.Client) -> None:
        self._console, self._client = console, client
        self._ending = threading.Event()
        self.gaps: list[float] = []
        self.stops: list[float] = []
        self._threads = [threading.Thread(target=t) for t in (self._watch, self._press)]

    def __enter__(self) -> "Onlooker":
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.set()
        for thread in self._threads:
            thread.join()

    def _watch(self) -> None:
        with opened(self._console, "/api/state", self._client) as page:
            page.recv()
            then = time.perf_counter()
            while not self._ending.is_set():
                page.recv(timeout=30.0)
                now = time.perf_counter()
                self.gaps.append(now - then)
                then = now

    def _press(self) -> None:
        while not self._ending.wait(1.0):
            began = time.perf_counter()
            self._client.post("/api/stop", json={}, timeout=30.0).raise_for_status()
            self.stops.append(time.perf_counter() - began)


def flood(console: Served, seconds: float) -> str:
    """Send large messages, all the time."""
    sent = closed = 0
    until = time.monotonic() + seconds
    with console.client(Role.VIEWER) as client:
        view = client.post("/api/views").json()["id"]
        while time.monotonic() < until:
            try:
                with connect(
                    f"ws://127.0.0.1:{console.port}/scene/{view}",
                    origin=console.origin,
                    additional_headers={"Cookie": cookie_of(client)},
                    subprotocols=["viser-v1.1.1"],
                    compression=None,
                    close_timeout=0.5,
                ) as scene:
                    while time.monotonic() < until:
                        scene.send(LARGE)
                        sent += 1
            except (WebSocketException, OSError):
                closed += 1
    return f"{sent} messages of 7.9 MB in {seconds:.0f} s, closed {closed} times"


def idle(console: Served, seconds: float) -> str:
    """Hold connections open."""
    with contextlib.ExitStack() as held:
        for _ in range(IDLE):
            held.enter_context(socket.create_connection(("127.0.0.1", console.port)))
        time.sleep(seconds)
    return f"{IDLE} idle connections for {seconds:.0f} s"


def measure(console: Served, pid: int, attack: Callable[[Served, float], str], s: float) -> None:
    most = before = pss(pid)
    with console.client(Role.OPERATOR) as client, Onlooker(console, client) as others:
        attacking = threading.Thread(target=lambda: done.append(attack(console, s)))
        done: list[str] = []
        attacking.start()
        while attacking.is_alive():
            most = max(most, pss(pid))
            attacking.join(0.1)
    print(
        f"{done[0]}: memory {before:.0f} → {pss(pid):.0f} MiB (at most {most:.0f}); another "
        f"page's states every {percentile(others.gaps, 0.95) * 1e3:.0f} ms (p95), "
        f"STOP answered in {percentile(others.stops, 0.95) * 1e3:.0f} ms (p95)"
    )


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 6.0
    # Who is cut off in the middle of a message is told so at length.
    logging.getLogger("websockets.client").setLevel(logging.CRITICAL)
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with tempfile.TemporaryDirectory() as folder, contextlib.closing(Stack.simulated()) as stack:
        listening = socket.create_server(("127.0.0.1", 0), backlog=512)
        audit = Path(folder) / "audit"
        settings = ConsoleSettings(access_tokens=TOKENS, audit_folder=audit, domain_id=stack.domain)
        process = multiprocessing.get_context("fork").Process(
            target=run_console, args=(listening, settings)
        )
        process.start()
        assert process.pid is not None
        console = Served(listening, audit)
        try:
            with console.client() as client:
                while client.get("/api/session", timeout=30.0).status_code != 401:
                    time.sleep(0.1)
            time.sleep(1.0)  # what starts up later than the web server
            for attack in (flood, idle):
                measure(console, process.pid, attack, seconds)
        finally:
            process.terminate()
            process.join(10.0)


if __name__ == "__main__":
    main()
