"""Functions of a user that are called with messages, whatever parameters they have."""

import inspect
from collections.abc import Callable

from kompass.components.base.ports import Input

# What each parameter is given.
GIVEN: dict[str, Callable[[Input], object]] = {
    "msg": lambda port: port.message,
    "topic": lambda port: port.topic,
    "output": lambda port: port.get_output(),
}


def message_callback(owner: str, function: Callable[..., object]) -> Callable[[Input], None]:
    """Make what calls a function with those of ``msg``, ``topic`` and ``output`` that it takes.

    A function of one required parameter of another name is called with the message.

    Raises
    ------
    TypeError
        When it is not a function, or needs something else.
    """
    if not callable(function):
        raise TypeError(f"{owner}: {function!r} is not a function")
    signature = inspect.signature(function)
    parameters = signature.parameters.values()
    name = getattr(function, "__name__", type(function).__name__)
    if inspect.iscoroutinefunction(function):
        raise TypeError(f"{owner}: {name} is an 'async def', which nobody awaits; make it a 'def'")
    if any(one.kind is one.VAR_KEYWORD for one in parameters):
        taken = list(GIVEN)
    else:
        taken = [one.name for one in parameters if one.name in GIVEN]
    needed = [
        one
        for one in parameters
        if one.default is one.empty and one.kind not in (one.VAR_KEYWORD, one.VAR_POSITIONAL)
    ]
    positional = [one for one in needed if one.kind is not one.KEYWORD_ONLY]
    if len(needed) == len(positional) == 1 and needed[0].name not in GIVEN:
        return lambda port: _ignore(function(port.message))
    others = [one.name for one in needed if one.name not in GIVEN]
    if others:
        raise TypeError(
            f"{owner}: {name}{signature} needs {', '.join(others)}; "
            f"a callback is given {', '.join(GIVEN)}"
        )
    return lambda port: _ignore(function(**{name: GIVEN[name](port) for name in taken}))


def _ignore(_result: object) -> None:
    """A callback has nothing to return."""
