"""How much a request may carry. What is too large is refused before any of it is parsed."""

from __future__ import annotations

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from kompass_console.web.errors import ConsoleError

LARGEST_TABLE = 2_000_000  # bytes; a rule is about 1 kB. The monitor takes no more either.

_LARGEST = 64_000  # bytes of any other request
# Routes that read a table out of their body by themselves.
WITH_TABLE = ("/api/rules/check", "/api/rules/apply", "/api/backtests", "/api/drills")


class BodyLimit:
    """ASGI middleware."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        limit = LARGEST_TABLE if scope["path"] in WITH_TABLE else _LARGEST
        announced = Headers(scope=scope).get("content-length", "")
        size = int(announced) if announced.isascii() and announced.isdigit() else 0
        got = 0

        async def receive_limited() -> Message:
            nonlocal got
            if size > limit:
                raise _too_large(size, limit)
            message = await receive()
            got += len(message.get("body", b""))
            if got > limit:
                raise _too_large(got, limit)
            return message

        await self._app(scope, receive_limited, send)


def _too_large(size: int, limit: int) -> ConsoleError:
    return ConsoleError(
        413,
        f"The request is too large: {size / 1e6:.2f} MB, and {limit / 1e6:.2f} MB can be taken.",
        "Send less: a table with fewer rules, or a shorter text.",
    )
