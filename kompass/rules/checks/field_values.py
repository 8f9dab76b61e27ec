"""What a field of a message can hold: judged the same when a rule is read and when it fires.

The middleware itself checks nothing: a number that does not fit is cut off, a text of another type
becomes 0, and a byte that was given as a number is whatever was in memory.
"""

import math
from collections.abc import Mapping
from typing import Any, Final, Literal, NamedTuple

from kompass.rules.checks.catalog import FieldKind, FieldType
from kompass.rules.schema.model import Scalar

# Kinds of the primitives of IDL, as message definitions of ROS name them in generated code.
PRIMITIVES: Final[Mapping[str, FieldKind]] = {
    "boolean": "bool",
    "octet": "int",
    "char": "int",
    "float": "float",
    "double": "float",
    "long double": "float",
    "string": "text",
    "wstring": "text",
    **{f"{sign}int{bits}": "int" for sign in ("", "u") for bits in (8, 16, 32, 64)},
}
# What people who write .msg files call them.
_NAMES = {"boolean": "bool", "octet": "byte", "float": "float32", "double": "float64"}
_RANGES = {
    "octet": (0, 255),
    "char": (0, 255),
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
}
# The first number that is rounded to infinity, halfway past the last; and that last one, in words.
_FLOATS = {
    "float": (2**128 - 2**103, "3.4028235e38"),
    "double": (2**1024 - 2**970, "1.7976931348623157e308"),
}
# Comparisons that are true only when the field holds what they name.
_SEEK = ("==", "in", "contains", "contains_any", "contains_all")
_WORDS = {"bool": "a bool", "int": "an integer", "float": "a number", "text": "a text"}


class Misfit(NamedTuple):
    """Why a field cannot hold a value.

    Attributes
    ----------
    text
        What the field is: ``an integer (uint8: 0 to 255)``.
    remedy
        What to give instead.
    """

    text: str
    remedy: str
    code: Literal["wrong-type", "out-of-range"] = "wrong-type"


def type_text(found: FieldType) -> str:
    """What a field holds, in words; as exact as it is known."""
    if found.kind == "message":
        return f"a message ({found.name})"
    if found.kind == "list":
        element = found.element
        of = element.name or _NAMES.get(element.primitive, element.primitive) if element else ""
        of = of or f"{element.kind if element else 'unknown'}s"
        return f"a list of {_count(found)}{of}"
    name = _NAMES.get(found.primitive, found.primitive)
    if found.primitive in _RANGES:
        low, high = _RANGES[found.primitive]
        name += f": {low} to {high}"
    elif found.bound is not None:
        name += f" of at most {found.bound} characters"
    return f"{_WORDS[found.kind]} ({name})" if name else _WORDS[found.kind]


def _count(found: FieldType) -> str:
    if found.size is not None:
        return f"exactly {found.size} "
    return "" if found.bound is None else f"at most {found.bound} "


def scalar_misfit(found: FieldType, value: Any) -> Misfit | None:
    """Why a field that holds one value cannot hold this bool, int, float or str; None if it can.

    A whole number may be written with a point (2.0), and floating point takes the nearest number
    that it has. NaN and infinity are numbers of floating point; JSON has none, so that only
    messages bring them.
    """
    if found.kind == "text" and isinstance(value, str):
        return _text_misfit(found, value)
    if found.kind == "bool" and isinstance(value, bool):
        return None
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if found.kind == "float" and number:
        return _float_misfit(found, value)
    if found.kind == "int" and number and (isinstance(value, int) or value.is_integer()):
        low, high = _RANGES.get(found.primitive, (value, value))
        if low <= value <= high:
            return None
        remedy = f"give a whole number from {low} to {high}"
        return Misfit(type_text(found), remedy, "out-of-range")
    return wrong_type(found)


def length_misfit(found: FieldType, length: int) -> Misfit | None:
    """Why a list cannot have so many items; None if it can."""
    if found.size is not None and length != found.size:
        return Misfit(type_text(found), f"give {found.size} items, not {length}", "out-of-range")
    if found.size is None and found.bound is not None and length > found.bound:
        remedy = f"give at most {found.bound} items, not {length}"
        return Misfit(type_text(found), remedy, "out-of-range")
    return None


def sought_in_vain(
    found: FieldType, operator: str, value: Scalar | tuple[Scalar, ...]
) -> tuple[Scalar | int, Misfit] | None:
    """What a comparison seeks although its field never holds it, and why; None if it may be there.

    Parameters
    ----------
    found
        Type of the field; of a list, each of the values must fit an item.
    operator
        Of the comparison; of those that do not look for a value nothing is said.
    value
        What the field is compared with.
    """
    if operator not in _SEEK:
        return None
    literals = value if isinstance(value, tuple) else (value,)
    wanted = found
    if found.kind == "list":
        misfit = length_misfit(found, len(literals)) if operator == "==" else None
        if misfit is not None:
            return len(literals), misfit
        if found.element is None:
            return None
        wanted = found.element
    for literal in literals:
        misfit = scalar_misfit(wanted, literal)
        if misfit is not None:
            return literal, misfit
    return None


def foregone(
    found: FieldType, operator: str, value: Scalar | tuple[Scalar, ...]
) -> tuple[bool, str] | None:
    """Whether a comparison of an integer is always true or always false, and what it holds.

    None when it depends on the value, and for the operators of :func:`sought_in_vain`.
    """
    if found.kind != "int" or found.primitive not in _RANGES:
        return None
    low, high = _RANGES[found.primitive]
    numbers = value if isinstance(value, tuple) else (value,)
    if operator in ("!=", "not_in"):
        never = all(scalar_misfit(found, each) is not None for each in numbers)
        return (True, type_text(found)) if never else None
    if not all(isinstance(each, (int, float)) for each in numbers):
        return None
    first, last = float(numbers[0]), float(numbers[-1])
    always, never = {
        "<": (high < first, low >= first),
        "<=": (high <= first, low > first),
        ">": (low > first, high <= first),
        ">=": (low >= first, high < first),
        "between": (first <= low and high <= last, high < first or last < low),
    }.get(operator, (False, False))
    return (always, type_text(found)) if always or never else None


def wrong_type(found: FieldType) -> Misfit:
    """That a field holds another sort of value."""
    return Misfit(type_text(found), f"give {_WORDS.get(found.kind) or type_text(found)}")


def _float_misfit(found: FieldType, value: float) -> Misfit | None:
    if found.primitive not in _FLOATS:
        return None
    beyond, most = _FLOATS[found.primitive]
    if abs(value) < beyond or (isinstance(value, float) and not math.isfinite(value)):
        return None
    remedy = f"give a number from -{most} to {most}"
    return Misfit(type_text(found), remedy, "out-of-range")


def _text_misfit(found: FieldType, value: str) -> Misfit | None:
    wide = found.primitive == "wstring"
    try:
        encoded = value.encode("utf-16-le" if wide else "utf-8")
    except UnicodeEncodeError:
        return Misfit(type_text(found), "leave half of a surrogate pair out: it is no character")
    if found.primitive and "\0" in value:
        return Misfit(type_text(found), "leave the NUL out: a text ends there")
    # A bound counts what is sent: bytes of a text, pairs of bytes of a wide one.
    length = len(encoded) // 2 if wide else len(encoded)
    if found.bound is not None and length > found.bound:
        remedy = f"give at most {found.bound} characters, not {length} (as they are sent)"
        return Misfit(type_text(found), remedy, "out-of-range")
    return None
