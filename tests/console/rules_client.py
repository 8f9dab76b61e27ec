"""What the tests of the rules' routes and sockets have in common."""

from __future__ import annotations

import contextlib
import json
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from typing import Any

import httpx
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from tests.console.conftest import Served, cookie_of, running
from tests.console.fake_monitor import TABLE
from tests.support.patience import patient
from tests.support.processes import wait_until

Json = dict[str, Any]


@contextlib.contextmanager
def running_monitor() -> Iterator[subprocess.Popen[bytes]]:
    """A monitor with an empty store, on a robot that has nothing else."""
    with (
        tempfile.TemporaryDirectory() as folder,
        running("tests.console.fake_monitor", folder) as process,
    ):
        yield process


def table() -> Json:
    """The monitor's table, to be edited."""
    return TABLE.model_dump(mode="json")


def await_monitor(client: httpx.Client) -> Json:
    """Wait until the monitor answers; its table in force."""
    wait_until(lambda: client.get("/api/rules").status_code == 200, 20.0, "the monitor's answer")
    view: Json = client.get("/api/rules").json()
    return view


@contextlib.contextmanager
def opened(console: Served, path: str, client: httpx.Client) -> Iterator[ClientConnection]:
    """A websocket of a page that is logged in as the client is."""
    with connect(
        f"ws://127.0.0.1:{console.port}{path}",
        origin=console.origin,
        additional_headers={"Cookie": cookie_of(client)},
        close_timeout=1.0,
    ) as socket:
        yield socket


def closed_with(socket: ClientConnection) -> int:
    """Read until the console closes; its code."""
    with contextlib.suppress(ConnectionClosed):
        while True:
            socket.recv(timeout=patient(10.0))
    assert socket.close_code is not None
    return int(socket.close_code)


def until(socket: ClientConnection, good: Callable[[Json], object], timeout: float = 8.0) -> Json:
    """The first message for which `good` holds."""
    deadline = time.monotonic() + patient(timeout)
    message: Json = {}
    while time.monotonic() < deadline:
        message = json.loads(socket.recv(timeout=max(deadline - time.monotonic(), 0.01)))
        if good(message):
            return message
    raise AssertionError(f"not within {patient(timeout):g} s; the last message was {message}")
