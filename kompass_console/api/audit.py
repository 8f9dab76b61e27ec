"""The audit log, for engineers: looked at, and taken along."""

from __future__ import annotations

import asyncio
import time
from typing import Annotated, Any

from fastapi import APIRouter, Query
from fastapi.responses import StreamingResponse

from kompass.store.paths import safe_name
from kompass_console.api.access import CurrentConsole, Engineer
from kompass_console.audit.files import log_files
from kompass_console.audit.read import newest, whole_log
from kompass_console.schema.audit_models import AuditLine, AuditPage
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/audit", tags=["audit"])

SETTLED = 1.0  # s that a slow disk is given
_COMMON = ("seq", "time", "who", "role", "session", "what", "outcome")


@router.get("")
async def audit_log(
    _: Engineer,
    console: CurrentConsole,
    before: Annotated[int, Query(ge=0, le=2**63 - 1)] = 0,
    count: Annotated[int, Query(ge=1, le=1000)] = 100,
    text: Annotated[str, Query(max_length=200)] = "",
) -> AuditPage:
    """Lines below `before` (0: from the newest), newest first; only those that hold `text`."""
    log = console.audit.log
    if log.folder is None:
        return AuditPage(lines=[], more=False, problem=log.problem)
    try:
        # Whoever looks sees what was done before, their own last press included.
        await asyncio.to_thread(log.settle, SETTLED)
        found, more = await asyncio.to_thread(
            newest, log.folder, before=before, count=count, text=text
        )
    except OSError as error:
        raise _unreadable(console, error) from error
    return AuditPage(lines=[_line(each) for each in found], more=more, problem=log.problem)


@router.get(
    "/export",
    response_class=StreamingResponse,
    responses={200: {"content": {"application/x-ndjson": {}}, "description": "One JSON a line"}},
)
async def export_audit_log(session: Engineer, console: CurrentConsole) -> StreamingResponse:
    """The whole log as it is on disk; `kompass-console audit verify FILE` checks it."""
    folder = console.audit.log.folder
    try:
        files = [] if folder is None else await asyncio.to_thread(log_files, folder)
    except OSError as error:
        raise _unreadable(console, error) from error
    console.audit.record(session, "export audit log", "begun")
    robot = safe_name(console.settings.robot_name)
    name = f"audit-{robot}-{time.strftime('%Y%m%dT%H%M%SZ', time.gmtime())}.jsonl"
    return StreamingResponse(
        whole_log(files),
        media_type="application/x-ndjson",
        headers={"Content-Disposition": f'attachment; filename="{name}"'},
    )


def _line(said: dict[str, Any]) -> AuditLine:
    """A line on disk as the page is told it."""
    common = {key: said.get(key, "") for key in _COMMON}
    details = {key: value for key, value in said.items() if key not in {*_COMMON, "from", "prev"}}
    return AuditLine.model_validate({**common, "address": said.get("from", ""), "details": details})


def _unreadable(console: Console, error: OSError) -> ConsoleError:
    return ConsoleError(
        503,
        f"The audit log cannot be read: {error.strerror}.",
        f"Look at {console.audit.log.folder} on the robot.",
    )
