"""The message definitions that are installed, in the terms in which rules are checked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from kompass.field_types import field_types
from kompass.message_types import message_class
from kompass.rclpy_ext.messages import part_to_plain
from kompass.rules.checks.catalog import FieldType

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
                there = at.size is None or -at.size <= step < at.size
                at = at.element if there else None
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


def _fields(type_name: str) -> Mapping[str, FieldType]:
    kind = message_class(type_name)
    return {} if kind is None else field_types(kind)


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
        and isinstance(value := part_to_plain(getattr(kind, name)), int)
        and not isinstance(value, bool)
    }
    named = {name: value for name, value in found.items() if name.startswith(field.upper() + "_")}
    if named:
        return named
    whole = [name for name, each in _fields(type_name).items() if each.kind == "int"]
    return found if whole == [field] else {}
