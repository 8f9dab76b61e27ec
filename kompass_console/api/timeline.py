"""What has happened: looked at, taken along, noted; alarms acknowledged and shelved."""

from __future__ import annotations

import time
from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Query, Response
from fastapi.responses import StreamingResponse

from kompass.store.paths import safe_name
from kompass.timeline.change import Acknowledge, AddNote, Shelve, TimelineChange
from kompass.timeline.entry import Kind, Level
from kompass.timeline.query import MOST_ENTRIES, MOST_SLOTS, TimelinePage, TimelineQuery
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator
from kompass_console.api.monitor import kept, passed_on
from kompass_console.schema.timeline_models import AlarmSeen, AlarmShelve, NoteSave
from kompass_console.web.auth import LoginSession
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/timeline", tags=["timeline"])

_LOOK = "Look at the timeline as it is now, and try again."
_Time = Annotated[float, Query(ge=0.0, le=1e12)]


@router.get("", response_model=TimelinePage)
async def timeline(
    _: LoggedIn,
    console: CurrentConsole,
    before: Annotated[int, Query(ge=0, le=2**53)] = 0,
    count: Annotated[int, Query(ge=0, le=MOST_ENTRIES)] = 100,
    kinds: Annotated[list[Kind], Query()] = [],  # noqa: B006 - FastAPI copies it
    level: Level = "info",
    text: Annotated[str, Query(max_length=200)] = "",
    since: _Time = 0.0,
    until: _Time = 0.0,
    slots: Annotated[int, Query(ge=0, le=MOST_SLOTS)] = 0,
) -> Response:
    """Entries below `before` (0: from the newest), newest first, and how many there are in each of
    `slots` parts of the time between `since` and `until` (s since the epoch)."""
    query = TimelineQuery(
        before=before,
        count=count,
        kinds=tuple(kinds),
        level=level,
        text=text,
        since=since,
        until=until,
        slots=slots,
    )
    return passed_on(
        await kept(console, lambda monitor: monitor.timeline(query), "timeline", _LOOK)
    )


@router.get(
    "/export",
    response_class=StreamingResponse,
    responses={200: {"content": {"application/x-ndjson": {}}, "description": "One JSON a line"}},
)
async def export_timeline(
    session: LoggedIn, console: CurrentConsole, since: _Time = 0.0, until: _Time = 0.0
) -> StreamingResponse:
    """All entries of that time, newest first, one JSON a line."""
    first = await _page(console, TimelineQuery(count=MOST_ENTRIES, since=since, until=until))
    console.audit.record(session, "export timeline", "begun")
    robot = safe_name(console.settings.robot_name)
    name = f"timeline-{robot}-{time.strftime('%Y%m%dT%H%M%SZ', time.gmtime())}.jsonl"
    return StreamingResponse(
        _lines(console, first, since, until),
        media_type="application/x-ndjson",
        headers={"Content-Disposition": f'attachment; filename="{name}"'},
    )


@router.post("/notes", status_code=204)
async def add_note(body: NoteSave, session: Operator, console: CurrentConsole) -> None:
    """Write something down; on the robot's disk when this is answered."""
    change = AddNote(title=body.title, text=body.text)
    await _carry_out(console, session, "add note", change, note=body.title)


@router.post("/alarms/acknowledge", status_code=204)
async def acknowledge_alarm(body: AlarmSeen, session: Operator, console: CurrentConsole) -> None:
    """Say that somebody has seen an alarm that stands."""
    change = Acknowledge(alarm=body.alarm, since=body.since)
    await _carry_out(console, session, "acknowledge alarm", change, alarm=body.alarm)


@router.post("/alarms/shelve", status_code=204)
async def shelve_alarm(body: AlarmShelve, session: Operator, console: CurrentConsole) -> None:
    """Put an alarm away for some time, or show it again."""
    change = Shelve(alarm=body.alarm, seconds=body.seconds)
    details = {"alarm": body.alarm, "seconds": body.seconds}
    await _carry_out(console, session, "shelve alarm", change, **details)


async def _carry_out(
    console: Console, session: LoginSession, what: str, change: TimelineChange, **details: Any
) -> None:
    """Have the monitor do it, and leave a line of it, however it ends."""
    try:
        await kept(
            console,
            lambda monitor: monitor.change_timeline(change, author=session.user, role=session.role),
            "timeline",
            _LOOK,
        )
    except ConsoleError as error:
        console.audit.record(session, what, error.title, **details)
        raise
    console.audit.record(session, what, "done", **details)


async def _page(console: Console, query: TimelineQuery) -> TimelinePage:
    answer = await kept(console, lambda monitor: monitor.timeline(query), "timeline", _LOOK)
    return answer.parsed()


async def _lines(
    console: Console, page: TimelinePage, since: float, until: float
) -> AsyncIterator[str]:
    while True:
        for entry in page.entries:
            yield entry.model_dump_json() + "\n"
        if not page.more or not page.entries:
            return
        before = page.entries[-1].number
        query = TimelineQuery(before=before, count=MOST_ENTRIES, since=since, until=until)
        page = await _page(console, query)
