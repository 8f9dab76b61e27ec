"""STOP. Anybody who is logged in may press it; it waits for nothing here.

Whoever is not may press it, too, unless the console was told otherwise: somebody whose session has
ended stands before the same robot. That way only stops, and leaves the way of the others free.
"""

from __future__ import annotations

import functools
from collections.abc import Awaitable, Callable

from fastapi import APIRouter, Request
from pydantic import ValidationError

from kompass.rclpy_ext.reply import NoAnswer
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator, session_cookie
from kompass_console.link.drive import STOP_ASKED_AGAIN, DriveAnswer
from kompass_console.schema.models import (
    OpenStop,
    StopAnswer,
    StopRequest,
    StopSeen,
    cut_reason,
)
from kompass_console.web.audit import OPEN_STOP
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/stop", tags=["stop"])

_BY_HAND = (
    f"It is asked for again until it is, for {STOP_ASKED_AGAIN:.0f} s. "
    "Do not wait for that: use the emergency stop on the robot itself."
)


_REASON = {"$ref": f"#/components/schemas/{StopRequest.__name__}"}


@router.post(
    "",
    openapi_extra={
        "requestBody": {"required": False, "content": {"application/json": {"schema": _REASON}}}
    },
)
async def stop(request: Request, session: LoggedIn, console: CurrentConsole) -> StopAnswer:
    """Latch STOP in the drive manager. That the robot stands still is told by the state.

    Nothing that the body holds keeps it from that: one that cannot be read is the reason, as it
    came.
    """
    reason = _reason(await request.body())
    written = functools.partial(
        console.audit.record, session, "stop", reason=reason, before=_stopped(console)
    )
    return await _answered(console.link.drive.stop(session.user, reason, _late(written)), written)


@router.post("/release")
async def release(session: Operator, console: CurrentConsole) -> StopAnswer:
    """Let the robot move again."""
    before = _stopped(console)
    try:
        answer = await console.link.drive.release(session.user)
    except NoAnswer as error:
        console.audit.record(session, "release stop", error.why, before=before)
        raise ConsoleError(
            503,
            f"STOP is not released: {error.why}.",
            "Look at the drive manager's health; the robot stays stopped.",
        ) from error
    outcome = "accepted" if answer.accepted else answer.message
    console.audit.record(session, "release stop", outcome, before=before)
    return StopAnswer(accepted=answer.accepted, message=answer.message)


@router.get("/without-login")
def open_stop(console: CurrentConsole) -> OpenStop:
    """Whether STOP takes no log-in here, and what became of it."""
    if not console.settings.stop_without_login:
        return OpenStop(offered=False, seen=None)
    drive = console.link.drive.info()
    if drive is None or not drive.available:
        return OpenStop(offered=True, seen=None)
    seen = StopSeen(stopped=drive.stopped, standstill=drive.stopped and drive.standstill)
    return OpenStop(offered=True, seen=seen)


@router.post("/without-login")
async def stop_without_login(request: Request, console: CurrentConsole) -> StopAnswer:
    """Latch STOP for somebody who is not logged in. There is no release on this way."""
    session = console.auth.session(request.cookies.get(session_cookie(request)))
    written = functools.partial(console.audit.record, session, OPEN_STOP, before=_stopped(console))
    if not console.settings.stop_without_login:
        written("refused: STOP takes a log-in here")
        raise ConsoleError(
            403,
            "STOP takes a log-in on this console: nothing was stopped.",
            "Use the emergency stop on the robot itself, or log in.",
        )
    address = request.client.host if request.client is not None else "?"
    who = f"somebody at {address}" if session is None else session.user
    pressed = console.open_stop.ask(lambda: console.link.drive.stop(who, "", _late(written)))
    return await _answered(pressed, written)


def _reason(body: bytes) -> str:
    if not body:
        return ""
    try:
        return StopRequest.model_validate_json(body).reason
    except ValidationError:
        return cut_reason(body.decode(errors="replace"))


async def _answered(pressed: Awaitable[DriveAnswer], written: Callable[[str], None]) -> StopAnswer:
    try:
        answer = await pressed
    except NoAnswer as error:
        written(error.why)
        raise ConsoleError(503, f"STOP is not confirmed: {error.why}.", _BY_HAND) from error
    written("accepted" if answer.accepted else answer.message)
    return StopAnswer(accepted=answer.accepted, message=answer.message)


def _late(written: Callable[[str], None]) -> Callable[[DriveAnswer, float], None]:
    """Writes down an answer that came after all."""

    def confirmed(answer: DriveAnswer, after: float) -> None:
        said = "accepted" if answer.accepted else answer.message
        written(f"{said}, {after:.1f} s after it was pressed")

    return confirmed


def _stopped(console: Console) -> str:
    """How the robot was before, for the audit log."""
    drive = console.link.drive.info()
    if drive is None or not drive.available:
        return "unknown"
    motion = "standing" if drive.standstill else "moving"
    return f"stopped by {drive.stopped_by}, {motion}" if drive.stopped else motion
