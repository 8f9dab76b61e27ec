"""What is wrong with data that a model refused, as a sentence about it needs it."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from pydantic import ValidationError

# In the words of these sentences, not in those of the library: what a field has too much or too
# little of is said by its bounds.
_TEXTS = {
    "missing": "it is missing",
    "extra_forbidden": "there is no such field",
    "string_too_short": "it is too short: at least {min_length} characters are needed",
    "string_too_long": "it is too long: at most {max_length} characters are allowed",
    "string_pattern_mismatch": "it is not of the form {pattern}",
    "too_short": "there are too few: at least {min_length} are needed",
    "too_long": "there are too many: at most {max_length} are allowed",
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
        text = _TEXTS[item["type"]].format(**context)
    elif text.startswith("Input should "):
        text = f"it should {text.removeprefix('Input should ')}"
    return Invalid(where, item["input"], text)
