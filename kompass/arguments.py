"""Functions that recipes call, and what they say to an argument that they do not have."""

import difflib
import functools
import inspect
from collections.abc import Callable
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


def named_arguments(function: Callable[P, R]) -> Callable[P, R]:
    """Offer the nearest argument when a keyword is none of the function's.

    Raises
    ------
    TypeError
        When the decorated function is called with such a keyword.
    """
    parameters = inspect.signature(function).parameters.values()
    known = [
        each.name
        for each in parameters
        if each.kind in (each.POSITIONAL_OR_KEYWORD, each.KEYWORD_ONLY) and each.name != "self"
    ]
    name = function.__qualname__.removesuffix(".__init__")

    @functools.wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        for keyword in kwargs:
            if keyword not in known:
                close = difflib.get_close_matches(keyword, known, n=1)
                remedy = f"did you mean '{close[0]}'?" if close else f"known are {', '.join(known)}"
                raise TypeError(f"{name}() has no argument '{keyword}'; {remedy}")
        return function(*args, **kwargs)

    return call
