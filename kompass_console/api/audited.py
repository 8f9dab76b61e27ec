"""Sees to it that no write, no download and no refusal is without a line in the audit log.

Routes write their own lines, for they know what was before and after. Whatever a route leaves out,
and what is refused before any route, gets a plain one here: method, path, and how it ended.
"""

from __future__ import annotations

import json
from typing import Any

from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from kompass_console.api.access import session_of
from kompass_console.web.audit import Asking, AuditTrail, asking
from kompass_console.web.auth import LoginSession
from kompass_console.web.errors import ConsoleError

# These change nothing but what a page itself shows, many times a minute.
LOOKS_ONLY = frozenset(
    {
        "create_view",
        "change_view",
        "clear_preview",
        "check",
        "check_pose",
        "check_rules",
        "measure",
        "sketch_zone",
    }
)

_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
_REFUSED = frozenset({401, 403, 413, 421, 429})
_ALWAYS_TOLD = frozenset({403, 421})  # whatever was asked for; 401 is how every page begins
_NOT_ALLOWED = 4403  # close code of a websocket
_LONGEST_BODY = 4_000  # bytes of an error's body that are looked at


class AuditRequests:
    """ASGI middleware, around all others."""

    def __init__(self, app: ASGIApp, *, audit: AuditTrail) -> None:
        self._app = app
        self._audit = audit

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        client = scope.get("client")
        request = Asking(str(client[0]) if client else "?")
        answer = _Answer()

        async def send_seen(message: Message) -> None:
            answer.see(message)
            await send(message)

        token = asking.set(request)
        try:
            await self._app(scope, receive, send_seen)
        finally:
            if not request.written and answer.counts(scope):
                self._record(scope, answer)
            asking.reset(token)

    def _record(self, scope: Scope, answer: _Answer) -> None:
        what = f"{scope.get('method', 'WEBSOCKET')} {scope['path']}"
        headers = Headers(scope=scope)
        details: dict[str, Any] = {"status": answer.status}
        if answer.status in _ALWAYS_TOLD:
            details |= {"host": headers.get("host", ""), "origin": headers.get("origin", "")}
        self._audit.record(_who(scope), what, answer.outcome, **details)


class _Answer:
    """What the answer to a request was."""

    def __init__(self) -> None:
        self.status = 500  # unless one is given
        self._download = False
        self._accepted = False
        self._title = ""

    def see(self, message: Message) -> None:
        kind = message["type"]
        if kind == "http.response.start":
            self.status = message["status"]
            said = Headers(raw=message.get("headers", [])).get("content-disposition", "")
            self._download = said.startswith("attachment")
        elif kind == "http.response.body" and self.status >= 400:
            self._title = self._title or _title_of(message.get("body", b""))
        elif kind == "websocket.accept":
            self._accepted, self.status = True, 101
        elif kind == "websocket.close" and not self._accepted:
            self.status = 403 if message.get("code") == _NOT_ALLOWED else 401
            self._title = message.get("reason") or ""

    def counts(self, scope: Scope) -> bool:
        """Whether it is worth a line."""
        if self.status in _ALWAYS_TOLD:
            return True
        if scope["type"] == "websocket" or scope["method"] in _SAFE_METHODS:
            return self._download
        endpoint = getattr(scope.get("endpoint"), "__name__", "")
        return endpoint not in LOOKS_ONLY or self.status in _REFUSED

    @property
    def outcome(self) -> str:
        if self.status < 400:
            return "done"
        word = "refused" if self.status in _REFUSED else "failed"
        return f"{word}: {self._title}" if self._title else word


def _title_of(body: bytes) -> str:
    if len(body) > _LONGEST_BODY:
        return ""
    try:
        return str(json.loads(body)["detail"]["title"])
    except (ValueError, TypeError, KeyError):
        return ""


def _who(scope: Scope) -> LoginSession | None:
    try:
        return session_of(HTTPConnection(scope))
    except ConsoleError:
        return None
