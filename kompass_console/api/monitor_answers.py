"""Asking the monitor on behalf of a request, and saying why there is no answer."""

from __future__ import annotations

from typing import Any

from kompass_console.link.services import NoAnswer
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

_WAIT = (
    "Wait a few seconds and try again; if it stays so, look at the health of the monitor. "
    "The rules in force are not changed by this."
)


async def ask(console: Console, request: Any) -> Any:
    """The monitor's answer.

    Raises ConsoleError 503 when there is none.
    """
    try:
        return await console.link.monitor.ask(request)
    except NoAnswer as error:
        raise no_monitor(error) from error


def no_monitor(error: NoAnswer) -> ConsoleError:
    """The answer when nobody who keeps rules answers."""
    return ConsoleError(503, f"The robot's rules cannot be reached: {error.why}.", _WAIT)


async def asked(console: Console, request: Any, status: int, remedy: str) -> Any:
    """The monitor's answer, when it is a success.

    Raises ConsoleError 503 when there is none, else `status` with the monitor's sentence.
    """
    answer = await ask(console, request)
    if not answer.success:
        raise ConsoleError(status, sentence(answer.message), remedy)
    return answer


def sentence(message: str) -> str:
    """A message as a sentence; one that says nothing is said to."""
    message = " ".join(message.split()) or "the monitor refused it and gave no reason"
    return message[0].upper() + message[1:] + ("" if message[-1] in ".!?" else ".")
