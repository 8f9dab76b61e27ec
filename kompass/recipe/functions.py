"""Functions of a recipe: what they take, whose they are, and how they are called by name."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any

from kompass.components.base.component import Component

Function = Callable[..., Any]


def name_of(function: Function) -> str:
    """What a function calls itself; of an object that can be called, its class."""
    while isinstance(function, functools.partial):
        function = function.func
    return str(getattr(function, "__name__", type(function).__name__))


def component_of(function: Function) -> Component | None:
    """The component whose method it is, also behind ``functools.partial``."""
    while isinstance(function, functools.partial):
        function = function.func
    owner = getattr(function, "__self__", None)
    return owner if isinstance(owner, Component) else None


def signature_of(function: Function, where: str) -> inspect.Signature:
    """What a function takes; ``where`` begins the sentence of the error.

    Raises
    ------
    TypeError
        When it does not tell, as some that are written in C, or is a generator, which does nothing
        when it is called.
    """
    called = function if inspect.isroutine(function) else getattr(function, "__call__", function)  # noqa: B004
    for one in (function, called):
        if inspect.isgeneratorfunction(one) or inspect.isasyncgenfunction(one):
            raise TypeError(
                f"{where}: {name_of(function)} is a generator, and calling it does nothing; "
                "write it without yield"
            )
    try:
        return inspect.signature(function)
    except ValueError:
        raise TypeError(
            f"{where}: {name_of(function)} does not tell what it takes; wrap it in a function of "
            "yours"
        ) from None


def needed(signature: inspect.Signature, given: Collection[str]) -> list[str]:
    """Names of the parameters that must be given, and are not."""
    return [
        one.name
        for one in signature.parameters.values()
        if one.default is one.empty
        and one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD)
        and one.name not in given
    ]


@dataclass(frozen=True)
class ByName:
    """A function with parameters that Python takes by position only, called by name.

    What ``*values`` collects is given as ``**{"*values": [...]}``, as no parameter can be called.
    """

    function: Function

    def __call__(self, **given: Any) -> Any:
        """Call the function."""
        parameters = inspect.signature(self.function).parameters.values()
        more = next((one for one in parameters if one.kind is one.VAR_POSITIONAL), None)
        rest = given.pop(f"*{more.name}", []) if more is not None else []
        by_position = []
        for one in parameters:
            ahead = rest and one.kind is one.POSITIONAL_OR_KEYWORD
            if (ahead or one.kind is one.POSITIONAL_ONLY) and one.name in given:
                by_position.append(given.pop(one.name))
        return self.function(*by_position, *rest, **given)


def by_name(function: Function) -> Function:
    """A function that takes by name whatever ``function`` takes."""
    kinds = {one.kind for one in inspect.signature(function).parameters.values()}
    needed = kinds & {inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.VAR_POSITIONAL}
    return ByName(function) if needed else function
