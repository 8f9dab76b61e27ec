"""What is wrong with data that a model refused, as a sentence about it needs it."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from pydantic import ValidationError

# In the words of these sentences, not in those of the library: what a field has too much or too
# little of is said by its bounds.
_TEXTS = {
    "missing": "it is missing",
    "extra_forbidden": "there is no such field",
    "string_too_short": "it must have at least {at_least} character{s}",
    "string_too_long": "it must have at most {at_most} character{s}",
    "string_pattern_mismatch": "it is not of the form {pattern}",
    "too_short": "it must have at least {at_least} item{s}",
    "too_long": "it must have at most {at_most} item{s}",
}


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
    return invalid_of(error.errors()[0])


def invalid_of(item: Mapping[str, Any]) -> Invalid:
    """One of what is wrong, of those that the library lists."""
    context = item.get("ctx", {})
    # A check that looks at several fields says which of them it means.
    inner = context.get("field")
    where = ".".join(map(str, (*item["loc"], *([] if inner is None else [inner]))))
    text = item["msg"].removeprefix("Value error, ")
    if item["type"] in _TEXTS:
        least, most = context.get("min_length"), context.get("max_length")
        bound = most if item["type"].endswith("too_long") else least
        counted = {"at_least": least, "at_most": most, "s": "" if bound == 1 else "s"}
        text = _TEXTS[item["type"]].format(**context, **counted)
    elif text.startswith("Input should "):
        text = f"it should {text.removeprefix('Input should ')}"
    return Invalid(where, item["input"], text)
