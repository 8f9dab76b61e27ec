"""Between ROS messages and plain data."""

from __future__ import annotations

import array
import enum
from collections.abc import Mapping
from typing import Any

import numpy as np

from kompass.field_types import field_types
from kompass.message_types import message_class
from kompass.rules.checks.catalog import FieldType
from kompass.rules.checks.field_values import (
    Misfit,
    length_misfit,
    scalar_misfit,
    wrong_type,
)

_TOLD = 100  # characters of a value that is refused
_ROWS = (list, tuple, array.array, np.ndarray, bytes, bytearray)
# The type codes and dtypes of what rclpy makes of lists of numbers: these hold nothing else.
_CODES = {
    "float": "f",
    "double": "d",
    **{f"int{8 * size}": code for size, code in ((1, "b"), (2, "h"), (4, "i"), (8, "q"))},
    **{f"uint{8 * size}": code for size, code in ((1, "B"), (2, "H"), (4, "I"), (8, "Q"))},
}


def to_plain(value: Any) -> Any:
    """A message, or a part of one, as JSON-ready data; a byte of a message becomes a number."""
    fields = getattr(value, "get_fields_and_field_types", None)
    if fields is not None:
        return {name: part_to_plain(getattr(value, name)) for name in fields()}
    if isinstance(value, Mapping):
        return {key: to_plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | array.array | np.ndarray):
        return [to_plain(item) for item in value]
    if isinstance(value, enum.Enum):
        return value.value
    if isinstance(value, bytes):
        return list(value)
    return value.item() if isinstance(value, np.generic) else value


def part_to_plain(value: Any) -> Any:
    """What was read from messages, as JSON-ready data: there, one byte stands for a number."""
    if isinstance(value, bytes) and len(value) == 1:
        return value[0]
    if isinstance(value, list | tuple):
        return [part_to_plain(item) for item in value]
    if isinstance(value, Mapping):
        return {key: part_to_plain(item) for key, item in value.items()}
    return to_plain(value)


def fill(message: Any, data: Mapping[str, Any]) -> Any:
    """Set fields of a message from plain data, or from parts of messages; returns the message.

    A whole number goes into a field of floating point, and the other way round when it is whole; a
    byte is a number from 0 to 255, or ``bytes`` of length 1. Parts of the right message type are
    taken as they are.

    Raises
    ------
    AttributeError
        When there is no such field.
    ValueError
        When a field cannot hold a value: names the field, the value and what the field holds.
    """
    return _filled(message, data, "", inside=False)


def checked(message: Any) -> Any:
    """A message that somebody made, made again of values that its fields can hold.

    rclpy itself looks at none: what does not fit would be sent as something else.

    Raises
    ------
    ValueError
        When a field cannot hold its value: names the field, the value and what the field holds.
    """
    return _checked(message, "")


def copy_fields(source: Any, target: Any) -> Any:
    """Set the fields that two messages have in common, by name and type; returns the target.

    Raises
    ------
    TypeError
        When there are none.
    """
    there, wanted = source.get_fields_and_field_types(), target.get_fields_and_field_types()
    common = [name for name, kind in wanted.items() if there.get(name) == kind]
    if not common:
        raise TypeError(
            f"a {type(source).__name__} has no field of a {type(target).__name__}; "
            f"those are {', '.join(wanted)}; give the action an event_parser"
        )
    for name in common:
        setattr(target, name, getattr(source, name))
    return target


def _filled(message: Any, data: Mapping[str, Any], where: str, *, inside: bool) -> Any:
    types = field_types(type(message))
    for name, value in data.items():
        if name not in types:
            whose = f"{where}: " if where else ""
            raise AttributeError(
                f"{whose}{type(message).__name__} has no field '{name}'; it has: {', '.join(types)}"
            )
        at = f"{where}.{name}" if where else name
        setattr(message, name, _fitted(types[name], value, at, inside=inside))
    return message


def _checked(message: Any, where: str) -> Any:
    data = {name: getattr(message, name) for name in field_types(type(message))}
    return _filled(type(message)(), data, where, inside=True)


def _fitted(found: FieldType, value: Any, where: str, *, inside: bool) -> Any:
    """A value as rclpy wants it in a field; ``inside``: look into messages, too."""
    if found.kind == "message":
        return _message(found, value, where, inside=inside)
    if found.kind == "list":
        return _row(found, value, where, inside=inside)
    if isinstance(value, np.generic):
        value = value.item()
    elif isinstance(value, bytes) and len(value) == 1 and found.primitive == "octet":
        value = value[0]
    misfit = scalar_misfit(found, value)
    if misfit is not None:
        raise _refused(misfit, value, where)
    if found.primitive == "octet":
        return bytes((int(value),))
    if found.kind == "int":
        return int(value)
    return float(value) if found.kind == "float" else value


def _message(found: FieldType, value: Any, where: str, *, inside: bool) -> Any:
    kind = message_class(found.name)
    assert kind is not None, f"{found.name} is part of a message that is installed"
    if isinstance(value, Mapping):
        return _filled(kind(), value, where, inside=inside)
    if isinstance(value, kind):
        return _checked(value, where) if inside else value
    raise _refused(wrong_type(found), value, where)


def _row(found: FieldType, value: Any, where: str, *, inside: bool) -> Any:
    if not isinstance(value, _ROWS) or (isinstance(value, np.ndarray) and value.ndim != 1):
        raise _refused(wrong_type(found), value, where)
    misfit = length_misfit(found, len(value))
    if misfit is not None:
        raise _refused(misfit, value, where)
    element = found.element
    assert element is not None
    code = _CODES.get(element.primitive)
    if isinstance(value, array.array) and value.typecode == code:
        return value
    if isinstance(value, np.ndarray) and value.dtype == np.dtype(code or "O"):
        return value
    return [
        _fitted(element, item, f"{where}[{index}]", inside=inside)
        for index, item in enumerate(value)
    ]


def _refused(misfit: Misfit, value: Any, where: str) -> ValueError:
    known = hasattr(value, "get_fields_and_field_types")
    told = f"a {type(value).__name__}" if known else repr(value)
    told = told if len(told) <= _TOLD else f"{told[: _TOLD - 1]}…"
    return ValueError(f"{where} = {told}: it is {misfit.text}; {misfit.remedy}")
