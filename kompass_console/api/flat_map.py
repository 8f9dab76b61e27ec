"""The map for pages that draw it flat, by themselves: its picture, and what moves on it."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import APIRouter, Query, Response, WebSocket
from starlette.concurrency import run_in_threadpool

from kompass_console.api.access import CurrentConsole, LoggedIn, console_of
from kompass_console.api.sockets import Pace, admitted, telling, texts
from kompass_console.scene.scene import Scene
from kompass_console.schema.models import Theme
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/map", include_in_schema=False)

_PERIOD = 0.1  # s between two messages
_SILENCE = 20  # periods without news after which the page is told that there are none
_PINGS = (5.0, 30)  # a second, and at once


@router.get("/{version}")
async def picture(version: int, theme: Theme, _: LoggedIn, console: CurrentConsole) -> Response:
    """Picture of the map that the robot has now, in a theme's colours."""
    drawn = await run_in_threadpool(console.scene.map_picture, version, theme)
    if drawn is None:
        raise ConsoleError(
            404, "This map is not there any more.", "Wait for the one that has taken its place."
        )
    return Response(drawn, media_type="image/png" if drawn.startswith(b"\x89PNG") else "image/webp")


@router.websocket("/live")
async def live(websocket: WebSocket, view: Annotated[str, Query(max_length=40)] = "") -> None:
    """See `FlatNews` in the schema; `view` says which further topics are told, too. What the page
    says is not listened to."""
    async with admitted(websocket) as session:
        if session is None:
            return
        await websocket.accept()
        console = console_of(websocket)
        own = view if console.views.get(view, session) is not None else ""
        async with telling(_push(websocket, console.scene, own)):
            async for _ in texts(websocket, Pace(*_PINGS)):
                pass


async def _push(websocket: WebSocket, scene: Scene, view_id: str) -> None:
    with scene.flat_map(view_id) as flat:
        silent = _SILENCE
        while True:
            news = flat.news()
            silent = 0 if news.model_fields_set else silent + 1
            if silent == 0 or silent >= _SILENCE:
                silent = 0
                await websocket.send_text(news.model_dump_json(exclude_unset=True))
            await asyncio.sleep(_PERIOD)
