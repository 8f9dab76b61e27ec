"""What the robot's nodes log, as far as the console remembers."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from kompass_console.api.access import CurrentConsole, LoggedIn
from kompass_console.link.log_ring import LogQuery
from kompass_console.schema.log_models import LogLevel, LogPage

router = APIRouter(prefix="/api/log", tags=["log"])

_Words = Annotated[str, Query(max_length=200)]


@router.get("")
def robot_log(
    _: LoggedIn,
    console: CurrentConsole,
    after: Annotated[int, Query(ge=0, le=2**53)] = 0,
    count: Annotated[int, Query(ge=1, le=500)] = 200,
    level: LogLevel = "debug",
    node: _Words = "",
    text: _Words = "",
) -> LogPage:
    """Lines above `after`, newest first: at least so bad, of that logger and those below it, with
    these words."""
    query = LogQuery(after=after, count=count, level=level, node=node, text=text)
    return console.link.log.page(query)
