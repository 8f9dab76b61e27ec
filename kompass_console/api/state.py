"""The state websocket: hello, then the newest state for as long as the page is there."""

from __future__ import annotations

import asyncio
import contextlib

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from pydantic import ValidationError

from kompass_console import __version__
from kompass_console.api.access import console_of, session_of
from kompass_console.api.models import Hello, Ping, Pong, SessionInfo
from kompass_console.errors import ConsoleError
from kompass_console.state_feed import Listener

router = APIRouter()

NOT_LOGGED_IN = 4401  # close code


@router.websocket("/api/state")
async def state(websocket: WebSocket) -> None:
    """See `StateMessage` in the schema."""
    try:
        session = session_of(websocket)
    except ConsoleError as error:
        await websocket.close(NOT_LOGGED_IN, error.title)
        return
    await websocket.accept()
    hello = Hello(session=SessionInfo(user=session.user, role=session.role), version=__version__)
    with console_of(websocket).feed.listen() as listener, contextlib.suppress(WebSocketDisconnect):
        await websocket.send_text(hello.model_dump_json())
        pushing = asyncio.create_task(_push(websocket, listener))
        try:
            while True:
                await _answer(websocket, await websocket.receive_text())
        finally:
            pushing.cancel()
            with contextlib.suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError):
                await pushing


async def _push(websocket: WebSocket, listener: Listener) -> None:
    while True:
        await websocket.send_text(await listener.get())


async def _answer(websocket: WebSocket, text: str) -> None:
    try:
        ping = Ping.model_validate_json(text)
    except ValidationError:
        return  # the socket is for reading; what else it says is not for us
    await websocket.send_text(Pong(t=ping.t).model_dump_json())
