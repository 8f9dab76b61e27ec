"""Log in, see who is logged in, log out."""

from __future__ import annotations

import asyncio

from fastapi import APIRouter, Request, Response
from fastapi.concurrency import run_in_threadpool

from kompass_console.api.access import CurrentConsole, LoggedIn, session_cookie
from kompass_console.schema.models import Login, SessionInfo
from kompass_console.web.auth import LoginSession
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api", tags=["session"])


@router.post("/login")
async def log_in(
    login: Login, request: Request, response: Response, console: CurrentConsole
) -> SessionInfo:
    """Exchange a role's token for a session cookie."""
    address = request.client.host if request.client is not None else "?"
    _refuse_if_failing(console, address)
    if (delay := console.limiter.delay()) > 0.0:
        await asyncio.sleep(delay)
        _refuse_if_failing(console, address)
    before = console.auth.session(request.cookies.get(session_cookie(request)))
    session = console.auth.log_in(login.token, login.user, before)
    if session is None:
        console.limiter.failed(address)
        console.audit.record(None, "log in", "wrong token", who=login.user or "")
        raise ConsoleError(
            403,
            "This token is not one of this console's.",
            "Copy the token that the console printed when it started.",
        )
    console.audit.record(session, "log in", "ok")
    if before is not None and before.id != session.id:
        # The page goes on as somebody else: nothing of who it was before stays open.
        await run_in_threadpool(_end, console, before)
    response.set_cookie(
        session_cookie(request),
        console.auth.cookie(session),
        max_age=int(console.auth.lifetime),
        httponly=True,
        samesite="strict",
        secure=request.url.scheme == "https",
        path="/",
    )
    return SessionInfo(user=session.user, role=session.role)


@router.get("/session")
def current_session(session: LoggedIn) -> SessionInfo:
    """Who is logged in."""
    return SessionInfo(user=session.user, role=session.role)


@router.post("/logout", status_code=204)
def log_out(
    session: LoggedIn, request: Request, response: Response, console: CurrentConsole
) -> None:
    """End this session; its cookie is refused from now on."""
    _end(console, session)
    console.audit.record(session, "log out", "ok")
    response.delete_cookie(session_cookie(request), path="/")


def _end(console: Console, session: LoginSession) -> None:
    """Refuse a session from now on, and close and drop what it has."""
    console.auth.log_out(session)
    console.sockets.end(session)
    console.views.end(session)
    console.drills.left(session.id)


def _refuse_if_failing(console: Console, address: str) -> None:
    """Let an address that has failed too often wait."""
    wait = console.limiter.wait(address)
    if wait > 0.0:
        raise ConsoleError(
            429,
            "Too many wrong tokens came from your address.",
            f"Wait {wait:.0f} s, then log in with the token that the console printed.",
            {"Retry-After": str(int(wait) + 1)},
        )
