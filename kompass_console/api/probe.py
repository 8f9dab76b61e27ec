"""The probe's websocket: how a condition that is being written would be judged right now."""

from __future__ import annotations

from fastapi import APIRouter, WebSocket

router = APIRouter()


@router.websocket("/api/rules/probe")
async def probe(websocket: WebSocket) -> None:
    """See `ProbeRequest` and `ProbeReading` in the schema."""
    raise NotImplementedError
