"""A camera for a page that looks at it: one picture at a time, the newest, and none is kept."""

from __future__ import annotations

import asyncio
import base64
import time
from typing import Annotated

from fastapi import APIRouter, Query, WebSocket

from kompass_console.api.access import console_of
from kompass_console.api.sockets import Pace, admitted, telling, texts
from kompass_console.link.on_demand.cameras import Cameras, CannotLook, Look, Picture
from kompass_console.schema.look_models import CameraNews, CameraSize

router = APIRouter()

_PERIOD = 0.05  # s between two looks whether there is a newer picture
_SILENCE = 1.0  # s without news after which the page is told how old its picture is
_UNSEEN = 10.0  # s until a page that has not said that it saw a picture is sent another
_ACKNOWLEDGED = (20.0, 60)  # a second, and at once


class _Seen:
    """Whether the page has what it was sent last."""

    def __init__(self) -> None:
        self.all = True


@router.websocket("/api/camera")
async def camera(
    websocket: WebSocket,
    topic: Annotated[str, Query(max_length=255)] = "",
    size: CameraSize = "small",
) -> None:
    """See `CameraNews` in the schema. The page answers each picture with any text, and is sent the
    next one then: so none waits for a slow one, here or on the way."""
    async with admitted(websocket) as session:
        if session is None:
            return
        await websocket.accept()
        seen = _Seen()
        cameras = console_of(websocket).link.on_demand.cameras
        async with telling(_show(websocket, cameras, topic, size, seen)):
            async for _ in texts(websocket, Pace(*_ACKNOWLEDGED)):
                seen.all = True


async def _show(
    websocket: WebSocket, cameras: Cameras, topic: str, size: CameraSize, seen: _Seen
) -> None:
    while True:
        try:
            with cameras.looking(topic, size) as look:
                await _tell(websocket, look, seen)
        except CannotLook as error:
            # It may come back: its driver is being restarted.
            await websocket.send_text(CameraNews(problem=str(error)).model_dump_json())
            await asyncio.sleep(_SILENCE)


async def _tell(websocket: WebSocket, look: Look, seen: _Seen) -> None:
    told, said = 0, 0.0
    while True:
        now = time.monotonic()
        newest = look.newest
        is_new = newest is not None and newest.number != told
        if (is_new and seen.all) or now - said > (_SILENCE if seen.all else _UNSEEN):
            seen.all = not (is_new and newest is not None and newest.encoded is not None)
            told, said = (0 if newest is None else newest.number), now
            await websocket.send_text(_news(newest, now, with_picture=is_new).model_dump_json())
        await asyncio.sleep(_PERIOD)


def _news(newest: Picture | None, now: float, *, with_picture: bool) -> CameraNews:
    if newest is None:
        return CameraNews()
    age, encoded = now - newest.received, newest.encoded
    if encoded is None or not with_picture:
        return CameraNews(number=newest.number, age=age, problem=newest.problem)
    data = base64.b64encode(encoded.data).decode()
    return CameraNews(
        number=newest.number,
        picture=f"data:{encoded.media_type};base64,{data}",
        width=encoded.width,
        height=encoded.height,
        age=age,
    )
