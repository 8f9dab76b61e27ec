"""Log in, see who is logged in, log out."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from kompass_console.api.access import CurrentConsole, LoggedIn, session_cookie
from kompass_console.schema.models import Login, SessionInfo
from kompass_console.web.auth import SESSION_LIFETIME
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api", tags=["session"])


@router.post("/login")
def log_in(
    login: Login, request: Request, response: Response, console: CurrentConsole
) -> SessionInfo:
    """Exchange a role's token for a session cookie."""
    address = request.client.host if request.client is not None else "?"
    wait = console.limiter.wait(address)
    if wait > 0.0:
        raise ConsoleError(
            429,
            "Too many wrong tokens came from your address.",
            f"Wait {wait:.0f} s, then log in with the token that the console printed.",
            {"Retry-After": str(int(wait) + 1)},
        )
    session = console.auth.log_in(login.token, login.user)
    if session is None:
        console.limiter.failed(address)
        console.audit.record(None, "log in", "wrong token", who=login.user or "")
        raise ConsoleError(
            403,
            "This token is not one of this console's.",
            "Copy the token that the console printed when it started.",
        )
    console.audit.record(session, "log in", "ok")
    response.set_cookie(
        session_cookie(request),
        console.auth.cookie(session),
        max_age=int(SESSION_LIFETIME),
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
    console.auth.log_out(session)
    console.audit.record(session, "log out", "ok")
    response.delete_cookie(session_cookie(request), path="/")
