"""A page that looks at further layers or at a camera, without a browser."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import httpx
from websockets.sync.client import ClientConnection, connect

from tests.console.conftest import Served, cookie_of
from tests.support.patience import patient

News = dict[str, Any]


@contextmanager
def socket_of(console: Served, client: httpx.Client, path: str) -> Iterator[ClientConnection]:
    """One of a logged-in page's websockets."""
    with connect(
        f"ws://127.0.0.1:{console.port}{path}",
        origin=console.origin,
        additional_headers={"Cookie": cookie_of(client)},
        close_timeout=1.0,
        max_size=None,
    ) as socket:
        yield socket


class FlatPage:
    """A page with a flat map, and what it was told of further topics."""

    def __init__(self, client: httpx.Client, view: str, socket: ClientConnection) -> None:
        self._client, self._view, self._socket = client, view, socket
        self.extras: dict[str, News] = {}

    def show(self, *topics: str) -> None:
        """Switch these further layers on, and all others off."""
        answer = self._client.patch(f"/api/views/{self._view}", json={"extras": topics})
        assert answer.status_code == 200, answer.text

    def until(self, good: Callable[[dict[str, News]], object], timeout: float = 8.0) -> None:
        """Wait until what it was told fits."""
        deadline = time.monotonic() + patient(timeout)
        while not good(self.extras):
            assert time.monotonic() < deadline, f"this is drawn: {self.extras}"
            news = json.loads(self._socket.recv(timeout=patient(3.0)))
            told = self.extras | news.get("extras", {})
            self.extras = {topic: shape for topic, shape in told.items() if shape is not None}


@contextmanager
def flat_page(console: Served, client: httpx.Client) -> Iterator[FlatPage]:
    view = str(client.post("/api/views").json()["id"])
    with socket_of(console, client, f"/api/map/live?view={view}") as socket:
        yield FlatPage(client, view, socket)
