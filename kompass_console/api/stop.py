"""STOP. Anybody who is logged in may press it; it waits for nothing here."""

from __future__ import annotations

from fastapi import APIRouter

from kompass.rclpy_ext.reply import NoAnswer
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator
from kompass_console.link.drive import STOP_ASKED_AGAIN, DriveAnswer
from kompass_console.schema.models import StopAnswer, StopRequest
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/stop", tags=["stop"])

_BY_HAND = (
    f"It is asked for again until it is, for {STOP_ASKED_AGAIN:.0f} s. "
    "Do not wait for that: use the emergency stop on the robot itself."
)


@router.post("")
async def stop(
    session: LoggedIn, console: CurrentConsole, body: StopRequest | None = None
) -> StopAnswer:
    """Latch STOP in the drive manager. That the robot stands still is told by the state."""
    reason = body.reason if body is not None else ""
    before = _stopped(console)

    def confirmed_late(answer: DriveAnswer, after: float) -> None:
        said = "accepted" if answer.accepted else answer.message
        outcome = f"{said}, {after:.1f} s after it was pressed"
        console.audit.record(session, "stop", outcome, reason=reason, before=before)

    try:
        answer = await console.link.drive.stop(session.user, reason, confirmed_late)
    except NoAnswer as error:
        console.audit.record(session, "stop", error.why, reason=reason, before=before)
        raise ConsoleError(503, f"STOP is not confirmed: {error.why}.", _BY_HAND) from error
    outcome = "accepted" if answer.accepted else answer.message
    console.audit.record(session, "stop", outcome, reason=reason, before=before)
    return StopAnswer(accepted=answer.accepted, message=answer.message)


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


def _stopped(console: Console) -> str:
    """How the robot was before, for the audit log."""
    drive = console.link.drive.info()
    if drive is None or not drive.available:
        return "unknown"
    motion = "standing" if drive.standstill else "moving"
    return f"stopped by {drive.stopped_by}, {motion}" if drive.stopped else motion
