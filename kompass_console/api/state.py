"""The state websocket: hello, then the newest state for as long as the page is there."""

from __future__ import annotations

from fastapi import APIRouter, WebSocket
from pydantic import ValidationError

from kompass_console import __version__
from kompass_console.api.access import console_of
from kompass_console.api.sockets import admitted, telling, texts
from kompass_console.schema.models import Hello, Ping, Pong, SessionInfo
from kompass_console.web.state_feed import Listener

router = APIRouter()


@router.websocket("/api/state")
async def state(websocket: WebSocket) -> None:
    """See `StateMessage` in the schema."""
    session = await admitted(websocket)
    if session is None:
        return
    hello = Hello(session=SessionInfo(user=session.user, role=session.role), version=__version__)
    with console_of(websocket).feed.listen() as listener:
        async with telling(_push(websocket, hello, listener)):
            async for text in texts(websocket):
                await _answer(websocket, text)


async def _push(websocket: WebSocket, hello: Hello, listener: Listener) -> None:
    await websocket.send_text(hello.model_dump_json())
    while True:
        await websocket.send_text(await listener.get())


async def _answer(websocket: WebSocket, text: str) -> None:
    try:
        ping = Ping.model_validate_json(text)
    except ValidationError:
        return  # the socket is for reading; what else it says is not for us
    await websocket.send_text(Pong(t=ping.t).model_dump_json())
