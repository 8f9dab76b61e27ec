"""What is wrong with data that a model refused, as a sentence about it needs it."""

from typing import Any, NamedTuple

from pydantic import ValidationError


class Invalid(NamedTuple):
    """One thing that is wrong.

    Attributes
    ----------
    where
        Fields that lead to it, with dots; empty for the whole.
    value
        That was refused.
    text
        Why.
    """

    where: str
    value: Any
    text: str


def first_invalid(error: ValidationError) -> Invalid:
    """The first of what is wrong; the others are seen once it has been mended."""
    first = error.errors()[0]
    # A check that looks at several fields says which of them it means.
    inner = first.get("ctx", {}).get("field")
    where = ".".join(map(str, (*first["loc"], *([] if inner is None else [inner]))))
    return Invalid(where, first["input"], first["msg"].removeprefix("Value error, "))
