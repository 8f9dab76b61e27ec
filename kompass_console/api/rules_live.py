"""The rules' websocket: how they are doing, and what fires, for as long as the page is there."""

from __future__ import annotations

from fastapi import APIRouter, WebSocket

from kompass_console.api.access import console_of
from kompass_console.api.sockets import admitted, telling, texts
from kompass_console.web.rules_feed import RulesListener

router = APIRouter()


@router.websocket("/api/rules/live")
async def rules_live(websocket: WebSocket) -> None:
    """See `RulesLive` in the schema. What the page says is not listened to."""
    if await admitted(websocket) is None:
        return
    with console_of(websocket).rules_feed.listen() as listener:
        async with telling(_push(websocket, listener)):
            async for _ in texts(websocket):
                pass


async def _push(websocket: WebSocket, listener: RulesListener) -> None:
    while True:
        await websocket.send_text(await listener.get())
