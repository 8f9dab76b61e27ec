"""The gate every request passes before any route sees it: Host, Origin and response headers.

Host: a page of another site can point its own name at this machine (DNS rebinding) and would
then count as same-origin; it cannot do so with a literal address or with a name we do not know.
Origin: every websocket and every write must come from the page this console served.
"""

from __future__ import annotations

import ipaddress
import json
import socket
from collections.abc import Iterable

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from kompass_console.schema.plain import plain
from kompass_console.web.addresses import host_name

PAGE_POLICY = (
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "connect-src 'self'; frame-src 'self'; object-src 'none'; base-uri 'none'; "
    "form-action 'self'; frame-ancestors 'none'"
)

_LONGEST_PATH = 1000  # characters
_LONGEST_HOST = 200  # of what is said back
_ONLY_TLS = f"max-age={180 * 24 * 3600}"
_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


class WebGuard:
    """ASGI middleware.

    Parameters
    ----------
    allow_hosts
        Names accepted in Host besides the machine's own.
    """

    def __init__(self, app: ASGIApp, *, allow_hosts: Iterable[str] = ()) -> None:
        self._app = app
        own = socket.gethostname().lower()
        self._names = {"localhost", own, f"{own}.local", *(name.lower() for name in allow_hosts)}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        refusal = self._refusal(scope, headers)
        if refusal is not None:
            await _refuse(scope, send, *refusal)
            return

        # A browser keeps to https for all ports of a name: not for localhost, where others are.
        over_tls = scope["scheme"] == "https" and host_name(headers["host"]) != "localhost"

        async def send_guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                _add_headers(MutableHeaders(scope=message), over_tls=over_tls)
            await send(message)

        await self._app(scope, receive, send_guarded)

    def _refusal(self, scope: Scope, headers: Headers) -> tuple[int, str, str] | None:
        path = scope["path"]
        if len(path) > _LONGEST_PATH or not path.isprintable():
            return 400, "This is not an address of this console.", "Open the address /."
        host = headers.get("host", "")
        if not self._knows(host):
            return (
                421,
                f"This console does not answer to the name {plain(host, _LONGEST_HOST)!r}.",
                "Use the machine's address, or start the console with this name allowed.",
            )
        if scope["type"] == "http" and scope["method"] in _SAFE_METHODS:
            return None
        origin = headers.get("origin")
        if origin is None or origin.partition("://")[2].lower() != host.lower():
            return (
                403,
                f"The request came from {plain(origin or 'an unknown page', _LONGEST_HOST)}, "
                "not from this console.",
                "Open the console's own address and try again there.",
            )
        return None

    def _knows(self, host: str) -> bool:
        name = host_name(host)
        if name is None:
            return False
        if name in self._names:
            return True
        try:
            ipaddress.ip_address(name)
        except ValueError:
            return False
        return True


def _add_headers(headers: MutableHeaders, *, over_tls: bool) -> None:
    if over_tls:
        headers["Strict-Transport-Security"] = _ONLY_TLS
    headers.setdefault("Content-Security-Policy", PAGE_POLICY)
    headers["X-Content-Type-Options"] = "nosniff"
    headers["Referrer-Policy"] = "no-referrer"
    headers["Cross-Origin-Opener-Policy"] = "same-origin"
    headers["Cross-Origin-Resource-Policy"] = "same-origin"
    headers.setdefault("Cache-Control", "no-store")


async def _refuse(scope: Scope, send: Send, status: int, title: str, remedy: str) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 4403, "reason": title})
        return
    body = json.dumps({"detail": {"title": title, "remedy": remedy}}).encode()
    headers = [
        (b"content-type", b"application/json"),
        (b"content-length", str(len(body)).encode()),
        (b"cache-control", b"no-store"),
    ]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
