"""Log in by token or by name, see who is logged in, log out here or everywhere."""

from __future__ import annotations

import asyncio

from fastapi import APIRouter, Request, Response
from fastapi.concurrency import run_in_threadpool

from kompass_console.accounts.accounts import AccountRefused
from kompass_console.api.access import CurrentConsole, LoggedIn, info_of, session_cookie
from kompass_console.schema.models import Login, LoginWays, SessionInfo
from kompass_console.web.auth import LoginSession
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api", tags=["session"])


@router.post("/login")
async def log_in(
    login: Login, request: Request, response: Response, console: CurrentConsole
) -> SessionInfo:
    """Exchange a role's token, or a name and its password, for a session cookie."""
    address = request.client.host if request.client is not None else "?"
    _refuse_if_failing(console, address)
    if (delay := console.limiter.delay()) > 0.0:
        await asyncio.sleep(delay)
        _refuse_if_failing(console, address)
    before = console.auth.session(request.cookies.get(session_cookie(request)))
    if login.token is not None:
        session = console.auth.log_in(login.token, login.user, before)
        wrong, title = "wrong token", "This token is not one of this console's."
        remedy = "Copy the token that the console printed when it started."
    else:
        name, password = login.user or "", login.password or ""
        async with console.passwords:
            _refuse_if_failing(console, address)  # others of this address may have failed meanwhile
            session = await run_in_threadpool(console.auth.log_in_by_name, name, password, before)
        wrong, title = "wrong name or password", "This name and this password do not fit."
        remedy = "Try again; on the robot, 'kompass-console users passwd' gives a new password."
    if session is None:
        console.limiter.failed(address)
        console.audit.record(None, "log in", wrong, who=login.user or "")
        raise ConsoleError(403, title, remedy)
    console.audit.record(session, "log in", "ok")
    if before is not None and before.id != session.id:
        # The page goes on as somebody else: nothing of who it was before stays open.
        await run_in_threadpool(_end, console, before)
    _keep(session, request, response, console)
    return info_of(session)


@router.get("/login")
def ways_in(console: CurrentConsole) -> LoginWays:
    """How one may log in: what the page asks for."""
    return LoginWays(accounts=console.auth.has_accounts, tokens=console.auth.has_tokens)


@router.get("/session")
def current_session(session: LoggedIn) -> SessionInfo:
    """Who is logged in."""
    return info_of(session)


@router.post("/logout", status_code=204)
def log_out(
    session: LoggedIn, request: Request, response: Response, console: CurrentConsole
) -> None:
    """End this session; its cookie is refused from now on."""
    _end(console, session)
    console.audit.record(session, "log out", "ok")
    response.delete_cookie(session_cookie(request), path="/")


@router.post("/logout/others", status_code=204)
def log_out_others(
    session: LoggedIn, request: Request, response: Response, console: CurrentConsole
) -> None:
    """End all other sessions of this account, on whatever device; their cookies are refused."""
    try:
        mine = console.auth.end_others(session)
    except AccountRefused as error:
        console.audit.record(session, "log out others", str(error))
        raise ConsoleError(
            409,
            f"Other sessions go on: {error}.",
            "Start the console again, or give it another token, and all sessions by tokens end.",
        ) from error
    console.sockets.renew(mine)
    _keep(mine, request, response, console)
    console.audit.record(session, "log out others", "ok")


def _keep(session: LoginSession, request: Request, response: Response, console: Console) -> None:
    response.set_cookie(
        session_cookie(request),
        console.auth.cookie(session),
        max_age=int(console.auth.lifetime),
        httponly=True,
        samesite="strict",
        secure=request.url.scheme == "https",
        path="/",
    )


def _end(console: Console, session: LoginSession) -> None:
    """Refuse a session from now on, and close and drop what it has."""
    console.control.left(session)
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
            "Too many wrong log-ins came from your address.",
            f"Wait {wait:.0f} s, then try again.",
            {"Retry-After": str(int(wait) + 1)},
        )
