"""What websockets have in common."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Coroutine
from typing import Any

from fastapi import WebSocket, WebSocketDisconnect

from kompass_console.api.access import session_of
from kompass_console.schema.roles import Role
from kompass_console.web.auth import LoginSession
from kompass_console.web.errors import ConsoleError

NOT_LOGGED_IN = 4401  # close codes
NOT_ALLOWED = 4403


async def admitted(websocket: WebSocket, role: Role = Role.VIEWER) -> LoginSession | None:
    """Accept the socket of somebody who may do what `role` may; None when it was closed."""
    try:
        session = session_of(websocket)
    except ConsoleError as error:
        await websocket.close(NOT_LOGGED_IN, error.title)
        return None
    if not session.role.covers(role):
        await websocket.close(NOT_ALLOWED, f"You are logged in as {session.role}.")
        return None
    await websocket.accept()
    return session


async def texts(websocket: WebSocket) -> AsyncIterator[str]:
    """What the page says, until it has gone. Binary messages are not for us."""
    while True:
        message = await websocket.receive()
        if message["type"] == "websocket.disconnect":
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
