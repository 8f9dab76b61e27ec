"""Tables on their way through the console: read beside the event loop, and handed on as
they came. The monitor judges them; a console that judged too would only disagree one day."""

from __future__ import annotations

import asyncio
import json
from typing import Any, TypeVar

from fastapi import Request, Response
from pydantic import BaseModel, ValidationError

from kompass_console.schema.models import ErrorDetail
from kompass_console.web.errors import ConsoleError

_Envelope = TypeVar("_Envelope", bound=BaseModel)


def body_of(model: type[BaseModel]) -> dict[str, Any]:
    """What the schema says of a route that reads its body by `read_table`."""
    reference = {"$ref": f"#/components/schemas/{model.__name__}"}
    return {
        "requestBody": {"required": True, "content": {"application/json": {"schema": reference}}}
    }


async def read_table(request: Request, rest: type[_Envelope]) -> tuple[str, _Envelope]:
    """The table of a request as JSON text, and what else its body says.

    Raises ConsoleError 422 for a body that is no JSON object with a table.
    """
    return await asyncio.to_thread(_split, await request.body(), rest)


def _split(raw: bytes, rest: type[_Envelope]) -> tuple[str, _Envelope]:
    try:
        body = json.loads(raw)
    except (ValueError, RecursionError) as error:
        raise _unreadable(f"it is not JSON: {error}") from None
    if not isinstance(body, dict) or not isinstance(body.get("table"), dict):
        raise _unreadable("it has no table")
    table = body.pop("table")
    try:
        checked = rest.model_validate(body)
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"])
        raise _unreadable(f"{field}: {first['msg']}") from None
    return json.dumps(table), checked


def _unreadable(why: str) -> ConsoleError:
    return ConsoleError(
        422, f"The request cannot be read: {why}.", "Reload the page and try again."
    )


def passed_on(answer: str) -> Response:
    """An answer of the monitor, which is JSON of the rulebook's models already."""
    return Response(answer, media_type="application/json")


def refusal(status: int, title: str, remedy: str, key: str, answer: str) -> Response:
    """An error with what the monitor said of it under `key`; null when it said nothing."""
    detail = ErrorDetail(title=title, remedy=remedy).model_dump_json()
    body = f'{{"detail":{detail},"{key}":{answer or "null"}}}'
    return Response(body, status, media_type="application/json")
