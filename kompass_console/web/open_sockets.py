"""Open websockets by session: bounded, and closed when their session ends."""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass

from starlette.websockets import WebSocket, WebSocketDisconnect

from kompass_console.schema.roles import Role
from kompass_console.settings import ConnectionLimits
from kompass_console.web.auth import Authenticator, LoginSession

NOT_LOGGED_IN = 4401  # close code

_REMEMBERED = 1000  # sessions
_PERIOD = 1.0  # s between two looks at who may still listen
_SAVE_PERIOD = 600.0  # s between two times at which it is written down who was seen


class TooManySockets(Exception):
    """This session, or all viewers together, have as many websockets as they may."""


@dataclass(eq=False, slots=True)
class _Open:
    websocket: WebSocket
    session: LoginSession


class OpenSockets:
    """All websockets that were let in; looks after them on the web server's loop."""

    def __init__(self, auth: Authenticator, limits: ConnectionLimits) -> None:
        self._auth = auth
        self._limits = limits
        self._open: set[_Open] = set()
        self._seen: OrderedDict[str, float] = OrderedDict()  # by session, when its last one closed
        self._closing: set[asyncio.Task[None]] = set()
        self._loop: asyncio.AbstractEventLoop | None = None

    @contextlib.contextmanager
    def open(self, websocket: WebSocket, session: LoginSession) -> Iterator[None]:
        """Look after a websocket for as long as the block lasts.

        Raises
        ------
        TooManySockets
            When it would be one too many.
        """
        mine = sum(each.session.id == session.id for each in self._open)
        viewers = sum(each.session.role is Role.VIEWER for each in self._open)
        if mine >= self._limits.sockets_of_session:
            raise TooManySockets(f"You have {mine} connections open already; close other pages.")
        if session.role is Role.VIEWER and viewers >= self._limits.sockets_of_viewers:
            raise TooManySockets("As many viewers watch as can be served; try again later.")
        opened = _Open(websocket, session)
        self._open.add(opened)
        try:
            yield
        finally:
            self._open.discard(opened)
            self._seen[opened.session.id] = time.monotonic()
            self._seen.move_to_end(opened.session.id)
            if len(self._seen) > _REMEMBERED:
                self._seen.popitem(last=False)

    def last_seen(self, session_id: str) -> float:
        """When a session had a websocket open last (monotonic s); any thread."""
        if any(each.session.id == session_id for each in tuple(self._open)):
            return time.monotonic()
        return self._seen.get(session_id, -math.inf)

    def end(self, session: LoginSession) -> None:
        """Close all websockets of a session. Any thread."""
        loop = self._loop
        if loop is not None and not loop.is_closed():
            with contextlib.suppress(RuntimeError):  # closed between the question and the call
                loop.call_soon_threadsafe(self._close_those_of, session.id)

    def renew(self, session: LoginSession) -> None:
        """Have the websockets of a session go on under its new cookie. Any thread."""
        for each in list(self._open):
            if each.session.id == session.id:
                each.session = session

    async def run(self) -> None:
        """Look again and again at who may still listen, until cancelled."""
        self._loop = asyncio.get_running_loop()
        written = self._loop.time()
        while True:
            await asyncio.sleep(_PERIOD)
            sessions = {each.session.id: each.session for each in self._open}
            for session_id, session in sessions.items():
                if not self._auth.is_open(session):
                    self._close_those_of(session_id)
            if self._loop.time() - written > _SAVE_PERIOD:
                await asyncio.to_thread(self._auth.save)
                written = self._loop.time()

    def _close_those_of(self, session_id: str) -> None:
        for each in [each for each in self._open if each.session.id == session_id]:
            closing = asyncio.ensure_future(_close(each.websocket))
            self._closing.add(closing)
            closing.add_done_callback(self._closing.discard)


async def _close(websocket: WebSocket) -> None:
    # It may have gone meanwhile; and whoever does not read is dropped by the gate.
    with contextlib.suppress(WebSocketDisconnect, RuntimeError, OSError):
        await websocket.close(NOT_LOGGED_IN, "Your session has ended.")
