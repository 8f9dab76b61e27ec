"""A page that drives by hand, without a browser."""

from __future__ import annotations

import contextlib
import json
import threading
import time
from typing import Any, Self

import httpx
from websockets import Origin
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.stack import TOKEN

PERIOD = 0.05  # s, as the page does it


class HandPage:
    """Logs in, and says twenty times a second what the hand does; logs out with its block.

    Parameters
    ----------
    url
        Of the console.
    """

    def __init__(self, url: str) -> None:
        self._client = httpx.Client(base_url=url, headers={"Origin": url}, timeout=patient(10.0))
        answer = self._client.post("/api/login", json={"token": TOKEN, "user": "ava"})
        assert answer.status_code == 200, answer.text
        cookie = "; ".join(f"{name}={value}" for name, value in self._client.cookies.items())
        self._socket = connect(
            f"{url.replace('http', 'ws', 1)}/api/hand",
            origin=Origin(url),
            additional_headers={"Cookie": cookie},
            close_timeout=1.0,
        )
        self._twist: dict[str, float] = {}
        self._speaks = threading.Event()
        self._speaking = threading.Lock()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._renew)
        self.last = 0.0  # when it said something last; monotonic s

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
        self._socket.close()
        # Who logs out leaves control to the next page at once; so does a console that is dead.
        with contextlib.suppress(httpx.HTTPError):
            self._client.post("/api/logout")
        self._client.close()

    def take(self) -> None:
        """Take the wheel, and show that nothing is held."""

        def yours() -> bool:
            self._say("take")
            return bool(json.loads(self._socket.recv(timeout=patient(5.0)))["yours"])

        wait_until(yours, 10, "the wheel")
        self.hold()
        time.sleep(10 * PERIOD)

    def hold(self, **twist: float) -> None:
        """Hold the stick so, until told otherwise."""
        self._twist = twist
        self._speaks.set()

    def fall_silent(self) -> None:
        """Say nothing any more, and keep the connection."""
        with self._speaking:
            self._speaks.clear()

    def _renew(self) -> None:
        while not self._ended.wait(PERIOD):
            with self._speaking:
                if not self._speaks.is_set():
                    continue
                try:
                    self._say("drive", t=time.monotonic(), **self._twist)
                except ConnectionClosed:
                    return  # the console is dead

    def _say(self, kind: str, **more: Any) -> None:
        self._socket.send(json.dumps({"type": kind} | more))
        self.last = time.monotonic()
