"""The message definitions that are installed, in the terms in which rules are checked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Any

from kompass.rclpy_ext.messages import ros_class
from kompass.rules.checks.catalog import FieldKind, FieldType

_SCALARS: dict[str, FieldKind] = {
    "boolean": "bool",
    "float": "float",
    "double": "float",
    "long double": "float",
    "octet": "int",
    "char": "int",
    "string": "text",
    "wstring": "text",
    **{f"{sign}int{bits}": "int" for sign in ("", "u") for bits in (8, 16, 32, 64)},
}
_PARTS = {"_Request": "Request", "_Response": "Response", "_Goal": "Goal", "_Result": "Result"}
Path = tuple[str | int, ...]


class MessageTypes:
    """Looks types up by name: ``package/msg/Name``, ``package/srv/Name_Request`` and so on."""

    def field_type(self, type_name: str, path: Path) -> FieldType | None:
        """The type at a path of a message type; None if there is no such path or type."""
        at = None if message_class(type_name) is None else FieldType("message", type_name)
        for step in path:
            if at is None:
                return None
            if isinstance(step, int):
                at = at.element
            else:
                at = _fields(at.name).get(step) if at.kind == "message" else None
        return at

    def fields(self, type_name: str) -> Iterable[str]:
        """Names of the fields of a message type; empty if it is not known."""
        return _fields(type_name)

    def walk(self, type_name: str, depth: int = 6) -> Iterator[tuple[Path, FieldType]]:
        """All fields of a type, the inner ones after the outer; lists are not entered.

        Parameters
        ----------
        depth
            How many messages within messages are entered.
        """
        yield from _walk(type_name, (), depth)


def _walk(type_name: str, at: Path, depth: int) -> Iterator[tuple[Path, FieldType]]:
    for name, found in _fields(type_name).items():
        path = (*at, name)
        yield path, found
        if found.kind == "message" and depth > 1:
            yield from _walk(found.name, path, depth - 1)


@lru_cache(maxsize=2000)
def message_class(type_name: str) -> type[Any] | None:
    """The class of a message, request or goal; None if it is not installed."""
    part = next((suffix for suffix in _PARTS if type_name.endswith(suffix)), "")
    try:
        found = ros_class(type_name.removesuffix(part))
    except ValueError:
        return None
    if part:
        found = getattr(found, _PARTS[part], type(None))
    return found if hasattr(found, "get_fields_and_field_types") else None


@lru_cache(maxsize=2000)
def _fields(type_name: str) -> dict[str, FieldType]:
    kind = message_class(type_name)
    if kind is None:
        return {}
    types = kind.get_fields_and_field_types()
    return {
        name: _parse(text)
        for name, text in types.items()
        if name != "structure_needs_at_least_one_member"
    }


def _parse(text: str) -> FieldType:
    """The type that ROS writes as ``sequence<geometry_msgs/Point, 4>`` or ``double[36]``."""
    if text.startswith("sequence<"):
        inner = text.removeprefix("sequence<").removesuffix(">")
        return FieldType("list", element=_parse(inner.split(",")[0].strip()))
    if text.endswith("]"):
        return FieldType("list", element=_parse(text.rpartition("[")[0]))
    scalar = _SCALARS.get(text.partition("<")[0])
    if scalar is not None:
        return FieldType(scalar)
    package, _, name = text.partition("/")
    return FieldType("message", f"{package}/msg/{name}")


def constants(type_name: str, field: str) -> dict[str, int]:
    """Values by name of the constants of a message that go with one of its fields.

    ROS does not say which belong together: those named like the field, or all when there is only
    one integer that they could belong to.
    """
    kind = message_class(type_name)
    if kind is None:
        return {}
    found = {
        name: value
        for name in dir(kind)
        if name.isupper()
        and isinstance(value := getattr(kind, name), int)
        and not isinstance(value, bool)
    }
    named = {name: value for name, value in found.items() if name.startswith(field.upper() + "_")}
    if named:
        return named
    whole = [name for name, each in _fields(type_name).items() if each.kind == "int"]
    return found if whole == [field] else {}
