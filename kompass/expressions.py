"""Conditions as a recipe writes them: ``topic.msg.status == 1``, ``(a > 0.3) & ~b.is_true()``.

A field is checked against the message definition while the recipe is read, so a mistyped name or a
value of the wrong type is an error of that line and not of the night in which it would have fired.
"""

from __future__ import annotations

import array
import difflib
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from pydantic import ValidationError

from kompass.field_types import field_types
from kompass.invalid import first_invalid
from kompass.message_types import type_name
from kompass.rules.checks.catalog import FieldType
from kompass.rules.checks.field_values import sought_in_vain
from kompass.rules.schema.conditions import AllOf, AnyOf, Compare, Not, Received
from kompass.rules.schema.conditions import Condition as RuleCondition
from kompass.rules.schema.signals import Signal, path_text

_ARRAYS = (list, tuple, array.array, np.ndarray)


class Expression:
    """A condition over messages; combine with ``&``, ``|`` and ``~``.

    Parameters
    ----------
    condition
        The same as data.
    """

    def __init__(self, condition: RuleCondition) -> None:
        self.condition = condition

    def __and__(self, other: Any) -> Expression:
        return Expression(AllOf(conditions=(self.condition, condition_of(other))))

    def __or__(self, other: Any) -> Expression:
        return Expression(AnyOf(conditions=(self.condition, condition_of(other))))

    def __rand__(self, other: Any) -> Expression:
        return Expression(AllOf(conditions=(condition_of(other), self.condition)))

    def __ror__(self, other: Any) -> Expression:
        return Expression(AnyOf(conditions=(condition_of(other), self.condition)))

    def __invert__(self) -> Expression:
        return Expression(Not(condition=self.condition))

    def __bool__(self) -> bool:
        raise TypeError(
            "a condition has no truth while the recipe is read; "
            "combine conditions with & | ~ in brackets, not with and, or, not or a < b < c"
        )


class MessageField:
    """A value inside the messages of a topic. Any field name may follow, ``name`` and ``type`` too.

    Parameters
    ----------
    topic
        Name, without a leading slash.
    message
        Class of its messages.
    timeout
        Seconds for which a message counts; None for ever.
    path
        Names of fields and indices, from the message to the value.

    Raises
    ------
    AttributeError
        When the message has no such field; offers the nearest.
    """

    def __init__(
        self, topic: str, message: type[Any], timeout: float | None, path: tuple[str | int, ...]
    ) -> None:
        # Names that no ROS field can have: they end with an underscore.
        self._topic_, self._message_, self._timeout_, self._path_ = topic, message, timeout, path
        self._sample_ = _walk(message, path)

    def __getattribute__(self, name: str) -> Any:
        if name.startswith("_") or (
            name in _METHODS and not _has_field(object.__getattribute__(self, "_sample_"), name)
        ):
            return object.__getattribute__(self, name)
        return MessageField(self._topic_, self._message_, self._timeout_, (*self._path_, name))

    def __getitem__(self, index: int) -> MessageField:
        if not isinstance(index, int) or isinstance(index, bool):
            raise TypeError(f"{self!r}[{index!r}]: an index is a whole number")
        return MessageField(self._topic_, self._message_, self._timeout_, (*self._path_, index))

    def __eq__(self, other: object) -> Expression:  # type: ignore[override]
        return _compare(self, "==", other)

    def __ne__(self, other: object) -> Expression:  # type: ignore[override]
        return _compare(self, "!=", other)

    def __lt__(self, other: Any) -> Expression:
        return _compare(self, "<", other)

    def __le__(self, other: Any) -> Expression:
        return _compare(self, "<=", other)

    def __gt__(self, other: Any) -> Expression:
        return _compare(self, ">", other)

    def __ge__(self, other: Any) -> Expression:
        return _compare(self, ">=", other)

    __hash__ = None  # type: ignore[assignment]

    def __invert__(self) -> Expression:
        return _compare(self, "==", False)

    def __and__(self, other: Any) -> Expression:
        raise TypeError(f"{self!r} is a value; compare it, or write .is_true(), before & and |")

    __or__ = __rand__ = __ror__ = __and__

    def __bool__(self) -> bool:
        raise TypeError(f"{self!r} has no truth while the recipe is read; compare it")

    def is_true(self) -> Expression:
        """It is true."""
        return _compare(self, "==", True)

    def is_false(self) -> Expression:
        """It is false."""
        return _compare(self, "==", False)

    def is_in(self, options: Sequence[Any] | str) -> Expression:
        """It is one of the options."""
        return _compare(self, "in", options)

    def not_in(self, options: Sequence[Any] | str) -> Expression:
        """It is none of the options."""
        return _compare(self, "not_in", options)

    def between(self, low: float, high: float) -> Expression:
        """It lies between two numbers, or is one of them; ``ValueError`` if ``low`` is the higher.

        Both are in the unit of the field. The opposite is ``~field.between(low, high)``.
        """
        return _compare(self, "between", (low, high))

    def contains(self, item: Any) -> Expression:
        """It holds an element, a part of a text, or all of a list."""
        return _compare(self, "contains", item)

    def not_contains(self, item: Any) -> Expression:
        """It does not hold an element, a part of a text, or all of a list."""
        return _compare(self, "not_contains", item)

    def contains_any(self, items: Sequence[Any]) -> Expression:
        """It holds at least one of the items."""
        return _compare(self, "contains_any", items)

    def contains_all(self, items: Sequence[Any]) -> Expression:
        """It holds all of the items."""
        return _compare(self, "contains_all", items)

    def not_contains_any(self, items: Sequence[Any]) -> Expression:
        """It holds none of the items."""
        return _compare(self, "not_contains_any", items)

    def not_contains_all(self, items: Sequence[Any]) -> Expression:
        """It lacks at least one of the items."""
        return _compare(self, "not_contains_all", items)

    def __repr__(self) -> str:
        return f"/{self._topic_} {path_text(self._path_) or 'message'}"


_METHODS = {name for name in vars(MessageField) if not name.startswith("_")}


def signal_of(field: MessageField) -> Signal:
    """The signal that a field stands for."""
    return Signal(
        topic=field._topic_,
        type=type_name(field._message_),
        path=field._path_,
        timeout=field._timeout_,
    )


def reference_of(field: MessageField) -> str:
    """The text that stands for the field's newest value in the arguments of an action."""
    dot = "" if field._path_ and isinstance(field._path_[0], int) else "."
    return f"$topic[/{field._topic_}]{dot if field._path_ else ''}{path_text(field._path_)}"


def condition_of(value: Any) -> RuleCondition:
    """The condition of an expression as data; of a topic, that a message arrived.

    Raises
    ------
    TypeError
        For anything else.
    """
    if isinstance(value, Expression):
        return value.condition
    if isinstance(value, MessageField):
        raise TypeError(f"{value!r} is a value; compare it, or write .is_true()")
    if hasattr(value, "ros_msg_type"):
        return Received(
            signal=Signal(
                topic=value.name, type=type_name(value.ros_msg_type), timeout=value.data_timeout
            )
        )
    raise TypeError(f"{value!r} is no condition; give a comparison, a Topic or a function")


def _has_field(sample: Any, name: str) -> bool:
    return hasattr(sample, "get_fields_and_field_types") and (
        name in sample.get_fields_and_field_types()
    )


def _walk(message: type[Any], path: tuple[str | int, ...]) -> Any:
    """A sample value at a path; None below an empty array, whose items cannot be known."""
    value: Any = message()
    for position, step in enumerate(path):
        if isinstance(step, int):
            held = isinstance(value, _ARRAYS) and -len(value) <= step < len(value)
            value = value[step] if held else None
            continue
        if value is None:
            continue
        if not _has_field(value, step):
            where = path_text(path[:position]) or message.__name__
            known = sorted(getattr(value, "get_fields_and_field_types", dict)())
            close = difflib.get_close_matches(step, known, n=1)
            remedy = f"did you mean '{close[0]}'?" if close else f"it has: {', '.join(known)}"
            raise AttributeError(f"{where} has no field '{step}'; {remedy}")
        value = getattr(value, step)
    # An item of a fixed array is a NumPy scalar, and a byte is `bytes` of length 1.
    return _plain(value) if isinstance(value, np.generic | bytes) else value


def _type_of(message: type[Any], path: tuple[str | int, ...]) -> FieldType | None:
    """What the value at a path is declared as; None of a whole message, and below empty lists."""
    last = max((at for at, step in enumerate(path) if isinstance(step, str)), default=None)
    if last is None:
        return None
    holder = _walk(message, path[:last])
    found = field_types(type(holder)).get(str(path[last])) if holder is not None else None
    for _ in path[last + 1 :]:
        found = found and found.element
    return found if found is not None and found.kind != "message" else None


def _compare(field: MessageField, operator: str, value: Any) -> Expression:
    literal = _as_truth(field._sample_, operator, _literal(field._sample_, operator, value))
    problem = _mismatch(field._sample_, operator, literal)
    if problem:
        raise TypeError(f"{field!r} {operator} {value!r}: {problem}")
    for number in literal if isinstance(literal, tuple) else (literal,):
        if isinstance(number, float) and not math.isfinite(number):
            raise ValueError(f"{field!r} {operator} {number!r}: compare with a finite number")
    if operator == "between" and not literal[0] <= literal[1]:
        raise ValueError(f"{field!r} between {value!r}: give the lower number first")
    held = _type_of(field._message_, field._path_)
    vain = sought_in_vain(held, operator, literal) if held is not None else None
    if vain is not None:
        sought, misfit = vain
        raise ValueError(
            f"{field!r} {operator} {value!r}: it is {misfit.text}, and never {sought!r}; "
            f"{misfit.remedy}"
        )
    try:
        condition = Compare(signal=signal_of(field), operator=operator, value=literal)  # type: ignore[arg-type]
    except ValidationError as error:
        why = first_invalid(error).text
        raise TypeError(f"{field!r} {operator} {value!r}: {why}") from None
    return Expression(condition)


def _as_truth(sample: Any, operator: str, literal: Any) -> Any:
    """0 and 1 against a truth value, as other releases take them, are false and true."""
    if not isinstance(sample, bool) or operator not in ("==", "!=", "in", "not_in"):
        return literal
    if isinstance(literal, tuple):
        return tuple(_as_truth(sample, operator, item) for item in literal)
    return bool(literal) if isinstance(literal, int) and literal in (0, 1) else literal


def _literal(sample: Any, operator: str, value: Any) -> Any:
    """What a field is compared with, as data: one byte is a number, and all of a list a list."""
    whole = operator in ("==", "!=") and isinstance(sample, _ARRAYS)
    if isinstance(value, bytes | bytearray) and whole:
        return tuple(value)
    return _plain(value)


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, bytes | bytearray):
        return value[0] if len(value) == 1 else tuple(value)
    if isinstance(value, (*_ARRAYS, set, frozenset)):
        return tuple(_plain(item) for item in value)
    return value


def _mismatch(sample: Any, operator: str, literal: Any) -> str:
    """Why a field of that kind cannot be compared so; empty when it can."""
    if operator == "between":
        wrong = [bound for bound in literal if _kind(bound) != "number"]
        if wrong:
            return f"{wrong[0]!r} is no number"
    if sample is None:
        return ""  # an item of an array whose items are not known
    if hasattr(sample, "get_fields_and_field_types"):
        return f"it is a whole {type(sample).__name__}; name one of its fields"
    is_array = isinstance(sample, _ARRAYS)
    if operator == "between":
        if is_array:
            return "it is a list; name one of its items"
        return "" if _kind(sample) == "number" else f"it is a {_kind(sample)}, not a number"
    if operator.startswith(("contains", "not_contains")):
        if not is_array and not isinstance(sample, str):
            return "it is no list and no text"
        # Of lists of texts and messages nothing is known before there is one.
        numbers = isinstance(sample, array.array | np.ndarray)
        wanted = "number" if numbers else "text" if isinstance(sample, str) else ""
        items = literal if isinstance(literal, tuple) else (literal,)
        wrong = [item for item in items if wanted and _kind(item) != wanted]
        return f"{wrong[0]!r} is no {wanted}" if wrong else ""
    if operator in ("in", "not_in"):
        if isinstance(literal, str):
            return "" if isinstance(sample, str) else "give a list of options"
        wrong = [item for item in literal if _kind(item) != _kind(sample)]
        return f"{wrong[0]!r} is no {_kind(sample)}" if wrong else ""
    if is_array != isinstance(literal, tuple):
        return "compare a list with a list" if is_array else f"it is a {_kind(sample)}, not a list"
    if is_array:
        return ""
    if _kind(literal) != _kind(sample):
        return f"it is a {_kind(sample)}, and {literal!r} is a {_kind(literal)}"
    return ""


def _kind(value: Any) -> str:
    if isinstance(value, bool):
        return "truth value"
    if isinstance(value, int | float):
        return "number"
    return "text" if isinstance(value, str) else type(value).__name__
