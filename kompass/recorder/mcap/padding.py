"""The bytes of a serialised message that mean nothing, made the same every time.

CDR aligns each primitive to its size. What is left between two of them is whatever lay in memory,
so that the same message serialised twice may differ. Nobody who reads it can tell; only who
compares bytes does.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from functools import cache
from typing import Any

from rosidl_parser.definition import (  # type: ignore[import-untyped]
    AbstractNestedType,
    Array,
    BasicType,
    BoundedString,
    NamespacedType,
    UnboundedString,
)

from kompass.message_types import ros_class

_ENCAPSULATION = 4  # bytes before the message, from which alignment counts
_WIDTHS = {
    "boolean": 1, "octet": 1, "int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "int32": 4,
    "uint32": 4, "int64": 8, "uint64": 8, "float": 4, "double": 8,
}  # fmt: skip
_LENGTH = struct.Struct("<I").unpack_from

# Clears what is before a field, and returns where the next one begins.
_Step = Callable[[bytearray, int], int]


class UnknownLayout(ValueError):
    """A type has a field whose layout is not known here; the message names both."""


def without_padding(type_name: str, data: bytes) -> bytes:
    """A message as it was serialised (CDR, little endian), with zeros where nothing is.

    Raises
    ------
    UnknownLayout
        When the type has a field of a rare kind.
    struct.error, ValueError
        When it is no such message.
    """
    made = bytearray(data)
    at = _message(type_name)(made, _ENCAPSULATION)
    made[at:] = bytes(len(made) - at)
    made[2:_ENCAPSULATION] = bytes(2)  # the options, which plain CDR has none of
    return bytes(made)


@cache
def _message(type_name: str) -> _Step:
    kind = ros_class(type_name)
    names = list(kind.get_fields_and_field_types())
    steps = [
        _step(slot, f"{type_name}.{name}")
        for name, slot in zip(names, kind.SLOT_TYPES, strict=True)
    ]
    if not steps:
        return _nothing
    if len(steps) == 1:
        return steps[0]

    def step(data: bytearray, at: int) -> int:
        for each in steps:
            at = each(data, at)
        return at

    return step


def _step(slot: Any, where: str) -> _Step:
    if isinstance(slot, BasicType) and slot.typename in _WIDTHS:
        return _primitives(_WIDTHS[slot.typename], 1)
    if isinstance(slot, UnboundedString | BoundedString):
        return _text
    if isinstance(slot, NamespacedType):
        return _message("/".join((*slot.namespaces, slot.name)))
    if isinstance(slot, AbstractNestedType):
        return _several(slot, where)
    raise UnknownLayout(f"{where}: the layout of {slot} is not known")


def _several(slot: AbstractNestedType, where: str) -> _Step:
    size = slot.size if isinstance(slot, Array) else None
    item = slot.value_type
    if isinstance(item, BasicType) and item.typename in _WIDTHS:
        width = _WIDTHS[item.typename]
        if size is not None:
            return _primitives(width, size)

        def row(data: bytearray, at: int) -> int:
            at = _aligned(data, at, 4)
            count = _LENGTH(data, at)[0]
            at += 4
            return _aligned(data, at, width) + count * width if count else at

        return row
    inner = _step(item, where)

    def rows(data: bytearray, at: int) -> int:
        count = size
        if count is None:
            at = _aligned(data, at, 4)
            count = _LENGTH(data, at)[0]
            at += 4
        for _ in range(count):
            at = inner(data, at)
            if at > len(data):
                raise ValueError("it is cut short")
        return at

    return rows


def _primitives(width: int, count: int) -> _Step:
    def step(data: bytearray, at: int) -> int:
        return _aligned(data, at, width) + width * count

    return step


def _nothing(data: bytearray, at: int) -> int:
    """A message without fields is a byte long."""
    data[at : at + 1] = bytes(1)
    return at + 1


def _text(data: bytearray, at: int) -> int:
    at = _aligned(data, at, 4)
    return at + 4 + int(_LENGTH(data, at)[0])


def _aligned(data: bytearray, at: int, width: int) -> int:
    gap = -(at - _ENCAPSULATION) % width
    if gap:
        data[at : at + gap] = bytes(gap)
    return at + gap
