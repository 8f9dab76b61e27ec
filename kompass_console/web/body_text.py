"""Bodies whose texts are no texts are refused before a route reads them."""

from __future__ import annotations

import json

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from kompass.half_characters import REMEDY, WHY, Steps, half_characters, may_hold_half
from kompass_console.web.body_limit import WITH_TABLE
from kompass_console.web.errors import ConsoleError

# A table tells of each of its rules, and STOP takes all.
_READ_BY_THEMSELVES = ("/api/stop", "/api/stop/without-login", *WITH_TABLE)
_LONGEST_KEY = 40


class BodyText:
    """ASGI middleware, inside of :class:`kompass_console.web.body_limit.BodyLimit`.

    Python's JSON takes half of a surrogate pair for a character; it is found out where the text is
    written down, which is too late.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or scope["path"] in _READ_BY_THEMSELVES:
            await self._app(scope, receive, send)
            return
        body = bytearray()

        async def receive_text() -> Message:
            message = await receive()
            body.extend(message.get("body", b""))
            if not message.get("more_body", False) and may_hold_half(body):
                _look_through(bytes(body))
            return message

        await self._app(scope, receive_text, send)


def _look_through(body: bytes) -> None:
    try:
        data = json.loads(body)
    except (ValueError, RecursionError):
        return  # the route says so
    for steps, text in half_characters(data):
        raise half_character_error(steps, text)


def half_character_error(steps: Steps, text: str) -> ConsoleError:
    """The answer to a body with such a text, or such a key, at a place."""
    field = ".".join(str(step)[:_LONGEST_KEY] for step in steps)
    shown = ascii(text[:_LONGEST_KEY])
    return ConsoleError(
        422,
        f"The request's {field or 'body'} cannot be {shown}: {WHY}.",
        f"{REMEDY[0].upper()}{REMEDY[1:]}.",
    )
