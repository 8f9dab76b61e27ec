"""What websockets have in common: who is let in, and what they may say."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections.abc import AsyncIterator, Coroutine
from typing import Any

from fastapi import WebSocket, WebSocketDisconnect

from kompass_console.api.access import console_of, session_of
from kompass_console.schema.roles import Role
from kompass_console.web.auth import LoginSession
from kompass_console.web.errors import ConsoleError
from kompass_console.web.open_sockets import NOT_LOGGED_IN, TooManySockets

NOT_ALLOWED = 4403  # close codes
TOO_MUCH = 1008
TOO_MANY = 1013

# Bytes by the path's beginning. The scene's is a camera; the probe answers in words to what is a
# little too long; on the others anything is let pass unheard that is no burden to throw away.
_LARGEST_MESSAGES = (
    ("/scene/", 4_000),
    ("/api/rules/probe", 400_000),
    ("/api/", 120_000),
)
_LARGEST_ELSEWHERE = 125


def largest_message(path: str) -> int:
    """Bytes that one message from a page may have; the server refuses more by its header."""
    sizes = (size for beginning, size in _LARGEST_MESSAGES if path.startswith(beginning))
    return next(sizes, _LARGEST_ELSEWHERE)


def compressed(path: str) -> bool:
    """Whether large messages to a page are packed: the scene's, whose walls are many numbers. It
    holds no secret, whose guesses could be told by how well they pack."""
    return path.startswith("/scene/")


class Pace:
    """How often somebody may speak: so many at once, and then so many a second.

    Parameters
    ----------
    rate
        Messages a second in the long run.
    burst
        Messages at once; a page that was held up sends what has gathered.
    """

    def __init__(self, rate: float, burst: int) -> None:
        self._rate = rate
        self._burst = float(burst)
        self._left = self._burst
        self._then = time.monotonic()

    def allows(self) -> bool:
        """Whether one more is all right now."""
        now = time.monotonic()
        self._left = min(self._burst, self._left + (now - self._then) * self._rate)
        self._then = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


@contextlib.asynccontextmanager
async def admitted(
    websocket: WebSocket, role: Role = Role.VIEWER
) -> AsyncIterator[LoginSession | None]:
    """The session of somebody who may do what `role` may; None when the socket was closed.

    Accept it inside. It is closed when the session ends while the block lasts.
    """
    try:
        session = session_of(websocket)
    except ConsoleError as error:
        await websocket.close(NOT_LOGGED_IN, error.title)
        yield None
        return
    if not session.role.covers(role):
        await websocket.close(NOT_ALLOWED, f"You are logged in as {session.role}.")
        yield None
        return
    with contextlib.ExitStack() as open_socket:
        try:
            open_socket.enter_context(console_of(websocket).sockets.open(websocket, session))
        except TooManySockets as error:
            await websocket.close(TOO_MANY, str(error))
            yield None
            return
        yield session


async def texts(websocket: WebSocket, pace: Pace) -> AsyncIterator[str]:
    """What the page says, until it has gone or says too much. Binary messages are not for us."""
    while True:
        message = await websocket.receive()
        if message["type"] == "websocket.disconnect":
            return
        if not pace.allows():
            await websocket.close(TOO_MUCH, "This page sends more messages than it may.")
            return
        text = message.get("text")
        if text is not None:
            yield text


@contextlib.asynccontextmanager
async def telling(work: Coroutine[Any, Any, None]) -> AsyncIterator[None]:
    """Tell the page things beside listening to it; ends with the block, or when it has gone."""
    task = asyncio.create_task(work)
    try:
        yield
    except WebSocketDisconnect:
        pass  # it went while it was being answered
    finally:
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError):
            await task
