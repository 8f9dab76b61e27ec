"""Control of the robot: ask for it, take it, give it, keep it."""

from __future__ import annotations

from fastapi import APIRouter

from kompass_console.api.access import CurrentConsole, Operator
from kompass_console.schema.control_models import ControlReason

router = APIRouter(prefix="/api/control", tags=["control"])


@router.post("/ask", status_code=204)
async def ask_for_control(session: Operator, console: CurrentConsole) -> None:
    """Ask whoever has control for it; who asks while nobody has it gets it."""
    console.control.ask(session)


@router.post("/take", status_code=204)
async def take_control(body: ControlReason, session: Operator, console: CurrentConsole) -> None:
    """Take control from nobody, from oneself on another device, or, with a reason, from whoever did
    not answer. Engineers need not ask first."""
    console.control.take(session, body.reason)


@router.post("/give", status_code=204)
async def give_control(session: Operator, console: CurrentConsole) -> None:
    """Give control to whoever asks for it, or up."""
    console.control.give(session)


@router.post("/keep", status_code=204)
async def keep_control(session: Operator, console: CurrentConsole) -> None:
    """Answer that control is not given."""
    console.control.keep(session)
