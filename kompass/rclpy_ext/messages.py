"""Between ROS messages and plain data."""

from __future__ import annotations

import array
import enum
import importlib
from typing import Any

import numpy as np


def to_plain(value: Any) -> Any:
    """A message, or a part of one, as JSON-ready data."""
    fields = getattr(value, "get_fields_and_field_types", None)
    if fields is not None:
        return {name: to_plain(getattr(value, name)) for name in fields()}
    if isinstance(value, list | tuple | array.array | np.ndarray):
        return [to_plain(item) for item in value]
    if isinstance(value, enum.Enum):
        return value.value
    if isinstance(value, bytes):
        return list(value)
    return value.item() if isinstance(value, np.generic) else value


def fill(message: Any, data: dict[str, Any]) -> Any:
    """Set fields of a message from plain data or messages; returns the message.

    Raises
    ------
    AttributeError
        When there is no such field.
    AssertionError, TypeError, ValueError
        When a value does not fit its field; rclpy says which.
    """
    types = message.get_fields_and_field_types()
    for name, value in data.items():
        if name not in types:
            raise AttributeError(
                f"{type(message).__name__} has no field '{name}'; it has: {', '.join(types)}"
            )
        setattr(message, name, _fitted(getattr(message, name), types[name], value))
    return message


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


def _fitted(now: Any, kind: str, value: Any) -> Any:
    if isinstance(value, dict) and hasattr(now, "get_fields_and_field_types"):
        return fill(type(now)(), value)
    if isinstance(value, list) and value and isinstance(value[0], dict):
        package, name = (
            kind.removeprefix("sequence<").rstrip(">").split("[")[0].split(",")[0].split("/")
        )
        item = getattr(importlib.import_module(f"{package}.msg"), name)
        return [fill(item(), entry) for entry in value]
    if isinstance(now, float) and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    return value


def ros_class(name: str) -> type[Any]:
    """The class of ``package/msg/Name`` (or srv, action).

    Raises
    ------
    ValueError
        When the package is not installed or has no such type.
    """
    package, kind, bare = name.split("/")
    try:
        return getattr(importlib.import_module(f"{package}.{kind}"), bare)  # type: ignore[no-any-return]
    except (ImportError, AttributeError):
        raise ValueError(f"there is no {name} here; install the package '{package}'") from None
