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

    An ``__init__`` is told of by the name of the class that is made, not of the one that defines
    it, which may be nobody's business.

    Raises
    ------
    TypeError
        When the decorated function is called with such a keyword, or with too few or too many
        arguments.
    """
    signature = inspect.signature(function)
    parameters = signature.parameters.values()
    known = [
        each.name
        for each in parameters
        if each.kind in (each.POSITIONAL_OR_KEYWORD, each.KEYWORD_ONLY) and each.name != "self"
    ]
    makes = function.__qualname__.endswith(".__init__")

    @functools.wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        name = type(args[0]).__name__ if makes and args else function.__qualname__
        for keyword in kwargs:
            if keyword not in known:
                close = difflib.get_close_matches(keyword, known, n=1)
                remedy = f"did you mean '{close[0]}'?" if close else f"known are {', '.join(known)}"
                raise TypeError(f"{name}() has no argument '{keyword}'; {remedy}")
        try:
            signature.bind(*args, **kwargs)
        except TypeError as error:
            raise TypeError(f"{name}(): {error}; it takes {', '.join(known)}") from None
        return function(*args, **kwargs)

    return call
