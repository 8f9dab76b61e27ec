"""What a value read from a message is, and how two of them compare.

Comparison is three-valued: ``None`` means that no verdict is possible, because there is no value
(field missing, NaN) or because the kinds do not match (text against a number, a number against a
bool). A rule can therefore never be made true by data that it does not understand.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Any, Final, Literal, TypeAlias

from kompass.rules.schema.model import Scalar

Verdict: TypeAlias = bool | None
Kind = Literal["number", "bool", "text", "list", "other", "none"]


class _Missing:
    """The field is not there, or there was no message yet."""

    def __repr__(self) -> str:
        return "missing"

    def __copy__(self) -> "_Missing":
        return self

    def __deepcopy__(self, memo: object) -> "_Missing":
        return self


MISSING: Final = _Missing()
_PLAIN = frozenset({float, int, bool, str, list, _Missing})


def plain(value: Any) -> Any:
    """Return NumPy scalars as Python scalars and arrays of any sort as lists; the rest as it is."""
    if type(value) in _PLAIN:
        return value
    if value is None:
        return MISSING
    tolist = getattr(value, "tolist", None)  # array.array, numpy arrays and numpy scalars
    if tolist is not None:
        return tolist()
    if isinstance(value, (tuple, bytes, bytearray)):
        return list(value)
    return value


def of_field(value: Any) -> Any:
    """Return what a field of a message holds as :func:`plain` does, and a byte as a number.

    A field of type ``byte`` is ``bytes`` of length 1 in rclpy, and a list of them a list of such.
    """
    kind = type(value)
    if kind is bytes and len(value) == 1:
        return value[0]
    if kind is list and value and type(value[0]) is bytes:
        return [item[0] for item in value]
    return plain(value)


def kind_of(value: Any) -> Kind:
    """Return the kind of a value from :func:`plain`; NaN and a missing value are ``none``."""
    kind = type(value)
    if kind is float:
        return "number" if value == value else "none"
    if kind is int:
        return "number"
    if kind is bool:
        return "bool"
    if kind is str:
        return "text"
    if kind is list:
        return "list"
    return "none" if kind is _Missing else "other"


def same(a: Any, b: Any) -> bool:
    """Whether two values are indistinguishable; NaN is the same as NaN, and 1 is not True."""
    if kind_of(a) != kind_of(b):
        return False
    if isinstance(a, list):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, float) and a != a:
        return isinstance(b, float)
    return bool(a == b)


def equals(value: Any, reference: Any, tolerance: float = 0.0) -> Verdict:
    """Three-valued equality; numbers within ``tolerance`` are equal, lists element by element."""
    kind = kind_of(value)
    if kind == "none" or kind != kind_of(reference):
        return None
    if kind == "number":
        if tolerance:
            return bool(reference - tolerance <= value <= reference + tolerance)
        return bool(value == reference)
    if kind == "list":
        return len(value) == len(reference) and all(
            equals(a, b, tolerance) is True for a, b in zip(value, reference, strict=True)
        )
    return bool(value == reference)


def member(value: Any, options: Iterable[Scalar]) -> Verdict:
    """Whether a scalar is one of the options; unknown when none of them is of its kind."""
    verdict: Verdict = None
    for option in options:
        found = equals(value, option)
        if found:
            return True
        if found is False:
            verdict = False
    return verdict


def holds(value: Any, wanted: Scalar) -> Verdict:
    """Whether a list has an equal element, or a text the wanted text in it."""
    kind = kind_of(value)
    if kind == "text":
        return wanted in value if isinstance(wanted, str) else None
    if kind == "list":
        return any(equals(item, wanted) for item in value)
    return None


def order(operator: str, value: Any, reference: Any) -> Verdict:
    """``<``, ``<=``, ``>``, ``>=`` between two numbers or two texts; unknown between others."""
    kind = kind_of(value)
    if kind not in ("number", "text") or kind != kind_of(reference):
        return None
    if operator == "<":
        return bool(value < reference)
    if operator == "<=":
        return bool(value <= reference)
    if operator == ">":
        return bool(value > reference)
    return bool(value >= reference)


def compare(operator: str, value: Any, reference: Any, tolerance: float = 0.0) -> Verdict:
    """Evaluate one comparison.

    Parameters
    ----------
    operator
        One of the operators of :class:`kompass.rules.schema.conditions.Compare`.
    value
        From :func:`plain`, or ``MISSING``.
    reference
        The literal of the rule: a scalar, or a list for the operators that take several.
    tolerance
        For ``==`` and ``!=``, in the unit of the field.

    Returns
    -------
    bool or None
        ``None`` when the comparison has no answer.
    """
    if operator in ("<", "<=", ">", ">="):
        return order(operator, value, reference)
    negative = operator == "!=" or operator.startswith("not_")
    verdict = _positive(operator.removeprefix("not_"), value, reference, tolerance)
    return verdict if verdict is None or not negative else not verdict


def _positive(operator: str, value: Any, reference: Any, tolerance: float) -> Verdict:
    if operator in ("==", "!="):
        return equals(value, reference, tolerance)
    if operator == "between":
        low = order(">=", value, reference[0])
        return low if not low else order("<=", value, reference[1])
    if operator == "in":
        if isinstance(reference, str):
            return value in reference if kind_of(value) == "text" else None
        return member(value, reference)
    wanted: Sequence[Scalar] = reference if isinstance(reference, list) else [reference]
    found = [holds(value, item) for item in wanted]
    if None in found:
        return None
    return any(found) if operator == "contains_any" else all(found)


def finite_numbers(value: Any) -> list[float]:
    """Return the finite numbers of a list; bools count as 0 and 1."""
    return [float(v) for v in value if isinstance(v, (int, float)) and math.isfinite(v)]
