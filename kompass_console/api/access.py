"""What routes ask of a request: which console, and who is asking."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, cast

from fastapi import Depends
from starlette.requests import HTTPConnection

from kompass_console.schema.models import SessionInfo
from kompass_console.schema.roles import Role
from kompass_console.web.auth import LoginSession
from kompass_console.web.console import Console
from kompass_console.web.control import key_of
from kompass_console.web.errors import ConsoleError


def console_of(connection: HTTPConnection) -> Console:
    """The console this request is for."""
    return cast(Console, connection.app.state.console)


def session_cookie(connection: HTTPConnection) -> str:
    """Name of the cookie. Browsers do not tell ports apart, and two consoles may share a host."""
    return f"kompass_session_{connection.url.port or connection.url.scheme}"


def session_of(connection: HTTPConnection) -> LoginSession:
    """Who is asking.

    Raises
    ------
    ConsoleError
        401 when nobody is logged in.
    """
    session = console_of(connection).auth.session(
        connection.cookies.get(session_cookie(connection))
    )
    if session is None:
        raise ConsoleError(
            401,
            "You are not logged in to this console.",
            "Log in by name, or with the token that the console printed when it started.",
        )
    return session


def info_of(session: LoginSession) -> SessionInfo:
    """What a page is told of who uses it."""
    return SessionInfo(
        user=session.user,
        key=key_of(session.id),
        role=session.role,
        account=session.account is not None,
    )


def at_least(role: Role) -> Callable[[HTTPConnection], LoginSession]:
    """A dependency: the session, when its role may do what `role` may; else 403."""

    def check(connection: HTTPConnection) -> LoginSession:
        session = session_of(connection)
        if not session.role.covers(role):
            raise ConsoleError(
                403,
                f"You are logged in as {session.role}, and this takes {_article(role)} {role}.",
                f"Log in as {_article(role)} {role}, or ask one to do it.",
            )
        return session

    return check


def _article(role: Role) -> str:
    return "an" if role[0] in "aeiou" else "a"


CurrentConsole = Annotated[Console, Depends(console_of)]
LoggedIn = Annotated[LoginSession, Depends(session_of)]
Operator = Annotated[LoginSession, Depends(at_least(Role.OPERATOR))]
Engineer = Annotated[LoginSession, Depends(at_least(Role.ENGINEER))]
