"""Actions with an argument that a function of the recipe makes from the message."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from kompass.recipe.functions import ByName
from kompass.rules.schema.actions import Action as RuleAction

# What a parser can make of actions that are no call of a function.
_MADE = {
    "call_service": ("srv_request_msg", "request"),
    "send_goal": ("action_request_msg", "request_msg"),
    "publish": ("msg",),
}


@dataclass
class Parser:
    """A function of the recipe that makes an argument of an action from the message.

    Attributes
    ----------
    function
        Called with the message as ``msg`` and ``trigger``, and with ``extra``.
    output
        Name of the argument; None when the function returns several by name.
    """

    function: Callable[..., Any]
    output: str | None
    extra: dict[str, Any] = field(default_factory=dict)

    def make(self, message: Any) -> Any:
        """What the function makes of a message; to be awaited when it is an ``async def``."""
        return self.function(msg=message, trigger=message, **self.extra)

    def arguments(self, made: Any) -> Mapping[str, Any]:
        """What it has made, as arguments of the action.

        Raises
        ------
        TypeError
            When there is no name for it.
        """
        if self.output is not None:
            return {self.output: made}
        if not isinstance(made, Mapping):
            raise TypeError(
                f"the event_parser returned {made!r}; give it an output_mapping, or return the "
                "arguments by name"
            )
        return made


@dataclass(frozen=True)
class Parsed:
    """An action of a kind that is data, with an argument from a parser."""

    action: RuleAction
    parser: Parser


@dataclass(frozen=True)
class ParsedCall:
    """A function of the recipe that takes what another one makes of the message."""

    method: Callable[..., Any]
    parser: Parser

    def __call__(self, msg: Any, **kwargs: Any) -> Any:
        """Call both; what is returned is to be awaited when the first is an ``async def``."""
        taken = takes(None, self.method)
        extra = {k: v for k, v in self.parser.extra.items() if taken is None or k in taken}
        kwargs = {**extra, **kwargs}
        made = self.parser.make(msg)
        if inspect.isawaitable(made):
            return self._awaiting(made, kwargs)
        return self.method(**{**kwargs, **self.parser.arguments(made)})

    async def _awaiting(self, made: Any, kwargs: dict[str, Any]) -> Any:
        result = self.method(**{**kwargs, **self.parser.arguments(await made)})
        return await result if inspect.isawaitable(result) else result


def takes(action: RuleAction | None, method: Callable[..., Any] | None) -> Collection[str] | None:
    """What a parser may make of an action, or of a function; None when that is anything."""
    if method is None:
        return _MADE.get(action.kind, ()) if action is not None else ()
    own = method.function if isinstance(method, ByName) else method
    parameters = inspect.signature(own).parameters.values()
    if any(one.kind is one.VAR_KEYWORD for one in parameters):
        return None
    return [one.name for one in parameters if one.kind is not one.VAR_POSITIONAL]
