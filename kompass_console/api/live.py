"""What pages are told for as long as they are there: the robot's state, and what its rules do."""

from __future__ import annotations

from fastapi import APIRouter, WebSocket
from pydantic import ValidationError

from kompass_console.api.access import console_of, info_of
from kompass_console.api.sockets import Pace, admitted, telling, texts
from kompass_console.schema.models import Hello, Ping, Pong
from kompass_console.version import VERSION
from kompass_console.web.rules_feed import RulesListener
from kompass_console.web.state_feed import StateListener

router = APIRouter()

_LONGEST_PING = 200  # characters
_PINGS = (5.0, 30)  # a second, and at once


@router.websocket("/api/state")
async def state(websocket: WebSocket) -> None:
    """Hello, then the newest state; see `StateMessage` in the schema."""
    async with admitted(websocket) as session:
        if session is None:
            return
        await websocket.accept()
        hello = Hello(session=info_of(session), version=VERSION)
        with console_of(websocket).feed.listen() as listener:
            async with telling(_push_state(websocket, hello, listener)):
                async for text in texts(websocket, Pace(*_PINGS)):
                    await _answer(websocket, text)


@router.websocket("/api/rules/live")
async def rules_live(websocket: WebSocket) -> None:
    """See `RulesLive` in the schema. What the page says is not listened to."""
    async with admitted(websocket) as session:
        if session is None:
            return
        await websocket.accept()
        with console_of(websocket).rules_feed.listen() as listener:
            async with telling(_push_rules(websocket, listener)):
                async for _ in texts(websocket, Pace(*_PINGS)):
                    pass


async def _push_state(websocket: WebSocket, hello: Hello, listener: StateListener) -> None:
    await websocket.send_text(hello.model_dump_json())
    while True:
        await websocket.send_text(await listener.get())


async def _push_rules(websocket: WebSocket, listener: RulesListener) -> None:
    while True:
        await websocket.send_text(await listener.get())


async def _answer(websocket: WebSocket, text: str) -> None:
    if len(text) > _LONGEST_PING:
        return
    try:
        ping = Ping.model_validate_json(text)
    except ValidationError:
        return  # the socket is for reading; what else it says is not for us
    await websocket.send_text(Pong(t=ping.t).model_dump_json())
