"""The rules' websocket: how they are doing, and what fires, for as long as the page is there."""

from __future__ import annotations

import asyncio
import contextlib

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from kompass_console.api.access import console_of, session_of
from kompass_console.api.state import NOT_LOGGED_IN
from kompass_console.errors import ConsoleError
from kompass_console.rules_feed import RulesListener

router = APIRouter()


@router.websocket("/api/rules/live")
async def rules_live(websocket: WebSocket) -> None:
    """See `RulesLive` in the schema. What the page says is not listened to."""
    try:
        session_of(websocket)
    except ConsoleError as error:
        await websocket.close(NOT_LOGGED_IN, error.title)
        return
    await websocket.accept()
    feed = console_of(websocket).rules_feed
    with feed.listen() as listener, contextlib.suppress(WebSocketDisconnect):
        pushing = asyncio.create_task(_push(websocket, listener))
        try:
            while True:
                await websocket.receive()
        except RuntimeError:
            pass  # the page has gone
        finally:
            pushing.cancel()
            with contextlib.suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError):
                await pushing


async def _push(websocket: WebSocket, listener: RulesListener) -> None:
    while True:
        await websocket.send_text(await listener.get())
