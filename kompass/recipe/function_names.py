"""Names for the functions of a recipe: rules and history refer to them, and people read them.

A function is called what it calls itself. Where several would be called the same, what tells them
apart is added: the values that a closure holds, the object whose method it is, the rate at which
it is asked, the line where it stands. None of it depends on the order of the recipe, as far as
that can be, and nothing on the run: what was stored yesterday means the same function today.
"""

from __future__ import annotations

import enum
import functools
import inspect
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from types import MethodType
from typing import Any

from kompass.recipe.functions import Function, name_of

_SHORT = 40  # characters of a value that are shown
_LONG = 200  # and of all that is added


@dataclass(frozen=True, eq=False)
class Use:
    """A function as an event or an action uses it.

    Attributes
    ----------
    given
        The arguments of a condition; those of an action are in its rule.
    rate
        How often a condition is asked [Hz]; None for an action.
    """

    function: Function
    given: Mapping[str, Any] = field(default_factory=dict)
    rate: float | None = None

    def is_same(self, other: Use) -> bool:
        """Whether it does the same as another one."""
        if (self.given, self.rate) != (other.given, other.rate):
            return False
        return _is_same(self.function, other.function)


class FunctionNames:
    """Names for these uses; the same use has the same name.

    Parameters
    ----------
    uses
        All of a recipe.
    """

    def __init__(self, uses: Iterable[Use]) -> None:
        self._named: list[tuple[Use, str]] = []
        alike: dict[str, list[list[Use]]] = {}  # the uses of each function, by its name
        for use in uses:
            functions = alike.setdefault(name_of(use.function), [])
            known = next((f for f in functions if _is_same(f[0].function, use.function)), None)
            if known is None:
                functions.append([use])
            elif not any(use.is_same(other) for other in known):
                known.append(use)
        for name, functions in alike.items():
            told = _told_apart(
                [", ".join(_held(each[0].function)) for each in functions],
                [_line(each[0].function) for each in functions],
            )
            for function, uses_of_it in zip(told, functions, strict=True):
                self._name(name, function, uses_of_it)

    def of(self, use: Use) -> str:
        """The name of a use.

        Raises
        ------
        KeyError
            When it is none of them.
        """
        for known, name in self._named:
            if known.is_same(use):
                return name
        raise KeyError(name_of(use.function))

    def _name(self, name: str, function: str, uses: list[Use]) -> None:
        conditions = [use for use in uses if use.rate is not None]
        told = _told_apart(
            [", ".join(f"{key}={_shown(v)}" for key, v in use.given.items()) for use in conditions],
            [f"{use.rate:g} Hz" for use in conditions],
        )
        added = {id(use): text for use, text in zip(conditions, told, strict=True)}
        for use in uses:
            more = ", ".join(filter(None, (function, added.get(id(use), ""))))
            self._named.append((use, f"{name} ({more[:_LONG]})" if more else name))


def _told_apart(*ways: list[str]) -> list[str]:
    """What tells things apart: the first way that does, more of them where needed, or a number."""
    said = [""] * len(ways[0])
    for way in ways:
        for text in {text for text in said if said.count(text) > 1}:
            alike = [index for index, each in enumerate(said) if each == text]
            if len({way[index] for index in alike}) > 1:
                for index in alike:
                    said[index] = ", ".join(filter(None, (text, way[index])))
    numbers = [said[:index].count(text) + 1 for index, text in enumerate(said)]
    return [
        ", ".join(filter(None, (text, f"no. {number}"))) if number > 1 else text
        for text, number in zip(said, numbers, strict=True)
    ]


def _held(function: Function) -> Iterator[str]:
    """Walk what a function was made with, as far as it can be read."""
    while isinstance(function, functools.partial):
        yield from (_shown(value) for value in function.args if _is_plain(value))
        yield from (f"{k}={_shown(v)}" for k, v in function.keywords.items() if _is_plain(v))
        function = function.func
    owner = getattr(function, "__self__", None)
    if isinstance(function, MethodType):
        own = getattr(owner, "name", None)
        yield own if isinstance(own, str) and own else type(owner).__name__
        function = function.__func__
    if not inspect.isfunction(function):
        return
    code, cells = function.__code__, function.__closure__ or ()
    for name, cell in zip(code.co_freevars, cells, strict=True):
        try:
            value = cell.cell_contents
        except ValueError:  # a variable that was never set
            continue
        if _is_plain(value):
            yield f"{name}={_shown(value)}"
    defaults = function.__defaults__ or ()
    names = code.co_varnames[: code.co_argcount][code.co_argcount - len(defaults) :]
    for name, value in (
        *zip(names, defaults, strict=True),
        *(function.__kwdefaults__ or {}).items(),
    ):
        if _is_plain(value):
            yield f"{name}={_shown(value)}"


def _line(function: Function) -> str:
    while isinstance(function, functools.partial):
        function = function.func
    code = getattr(inspect.unwrap(function), "__code__", None)
    return "" if code is None else f"line {code.co_firstlineno}"


def _is_plain(value: Any) -> bool:
    return isinstance(value, bool | int | float | str | enum.Enum)


def _shown(value: Any) -> str:
    text = str(value.value) if isinstance(value, enum.Enum) else repr(value)
    return text if len(text) <= _SHORT else f"{text[: _SHORT - 1]}…"


def _is_same(one: Function, other: Function) -> bool:
    if isinstance(one, MethodType) and isinstance(other, MethodType):
        return one.__self__ is other.__self__ and one.__func__ is other.__func__
    # Builtin methods are made anew each time that they are named.
    if inspect.isbuiltin(one) and inspect.isbuiltin(other):
        return bool(one == other)
    return one is other
