"""The monitor's side of a request: tables on their way to it, and its answers on their way back.

Tables are read beside the event loop, and answers are handed on as they came. The monitor judges
them; a console that judged too would only disagree one day.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from typing import Any, TypeVar

from fastapi import Request, Response
from pydantic import BaseModel, ValidationError

from kompass.half_characters import half_characters, may_hold_half
from kompass.invalid import first_invalid
from kompass.monitor.client import Json, MonitorClient, Refused
from kompass.rclpy_ext.reply import NoAnswer, Reply
from kompass_console.schema.models import ErrorDetail
from kompass_console.web.body_text import half_character_error
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

_Envelope = TypeVar("_Envelope", bound=BaseModel)
_T = TypeVar("_T")

_WAIT = (
    "Wait a few seconds and try again; if it stays so, look at the health of the monitor. "
    "The rules in force are not changed by this."
)


async def ask(console: Console, question: Callable[[MonitorClient], Reply[_T]]) -> _T:
    """The monitor's answer.

    Raises
    ------
    ConsoleError
        503 when there is none.
    Refused
        When the monitor does not do it.
    """
    try:
        return await question(console.link.monitor.client).answer()
    except NoAnswer as error:
        raise no_monitor(error) from error


async def asked(
    console: Console, question: Callable[[MonitorClient], Reply[_T]], status: int, remedy: str
) -> _T:
    """The monitor's answer, when it is a success.

    Raises
    ------
    ConsoleError
        503 when there is none, else ``status`` with the monitor's sentence.
    """
    try:
        return await ask(console, question)
    except Refused as error:
        raise ConsoleError(status, sentence(str(error)), remedy) from error


async def kept(
    console: Console, question: Callable[[MonitorClient], Reply[_T]], what: str, remedy: str
) -> _T:
    """The monitor's answer to a change of what it keeps for people: ``what``, in the plural.

    Raises
    ------
    ConsoleError
        503 when there is no answer; 409 when it refuses, with its own remedy or else ``remedy``.
    """
    try:
        return await question(console.link.monitor.client).answer()
    except NoAnswer as error:
        raise ConsoleError(
            503,
            f"The robot's {what} cannot be reached: {error.why}.",
            "Wait a few seconds and try again; if it stays so, look at the health of the monitor.",
        ) from error
    except Refused as error:
        why, _, own = str(error).partition("; ")
        raise ConsoleError(409, sentence(why), sentence(own or remedy)) from error


def no_monitor(error: NoAnswer) -> ConsoleError:
    """The answer when nobody who keeps rules answers."""
    return ConsoleError(503, f"The robot's rules cannot be reached: {error.why}.", _WAIT)


def sentence(message: str) -> str:
    """A message as a sentence; an empty one is replaced by one that says so."""
    message = " ".join(message.split()) or "the monitor refused it and gave no reason"
    return message[0].upper() + message[1:] + ("" if message[-1] in ".!?" else ".")


def body_of(model: type[BaseModel]) -> dict[str, Any]:
    """What the schema says of a route that reads its body by `read_table`."""
    reference = {"$ref": f"#/components/schemas/{model.__name__}"}
    return {
        "requestBody": {"required": True, "content": {"application/json": {"schema": reference}}}
    }


async def read_table(
    request: Request, rest: type[_Envelope], remedy: str = "Reload the page and try again."
) -> tuple[str, _Envelope]:
    """The table of a request as JSON text, and what else its body says.

    ``remedy`` is told of what else it says, where that is wrong.

    Raises
    ------
    ConsoleError
        422 for a body that is no JSON object with a table.
    """
    return await asyncio.to_thread(_split, await request.body(), rest, remedy)


def _split(raw: bytes, rest: type[_Envelope], remedy: str) -> tuple[str, _Envelope]:
    try:
        body = json.loads(raw)
    except (ValueError, RecursionError) as error:
        raise _unreadable(f"it is not JSON: {error}") from None
    if not isinstance(body, dict) or not isinstance(body.get("table"), dict):
        raise _unreadable("it has no table")
    table = body.pop("table")
    broken = next(half_characters(body), None) if may_hold_half(raw) else None
    if broken is not None:
        raise half_character_error(*broken)
    try:
        checked = rest.model_validate(body)
    except ValidationError as error:
        invalid = first_invalid(error)
        why = f"{invalid.where}: {invalid.text}" if invalid.where else invalid.text
        raise ConsoleError(422, f"The request cannot be read: {why}.", remedy) from None
    return json.dumps(table), checked


def _unreadable(why: str) -> ConsoleError:
    return ConsoleError(
        422, f"The request cannot be read: {why}.", "Reload the page and try again."
    )


def passed_on(answer: Json[Any]) -> Response:
    """An answer of the monitor, which is JSON of the rulebook's models already."""
    return Response(answer.text, media_type="application/json")


def refusal(status: int, title: str, remedy: str, key: str, answer: Json[Any] | None) -> Response:
    """An error with what the monitor said of it under `key`; null when it said nothing."""
    detail = ErrorDetail(title=title, remedy=remedy).model_dump_json()
    said = "null" if answer is None else answer.text
    return Response(f'{{"detail":{detail},"{key}":{said}}}', status, media_type="application/json")
