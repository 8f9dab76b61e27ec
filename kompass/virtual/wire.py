"""Messages on their way: what arrives is what DDS would deliver, and is made as late as possible.

Serializing a message and making another of the bytes costs four times as much as all else that the
virtual bus does about it. So a message whose fields hold exactly what they would hold at the other
end is copied instead; all others take the long way.
"""

from __future__ import annotations

import array
import struct
from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

import numpy as np
from rclpy.serialization import deserialize_message, serialize_message
from rosidl_parser.definition import (  # type: ignore[import-untyped]
    AbstractGenericString,
    AbstractSequence,
    Array,
    BasicType,
    BoundedSequence,
    NamespacedType,
    UnboundedString,
)

from kompass.message_types import ros_class, type_name
from kompass.rclpy_ext.partial_decoder import partial_decoder, picker
from kompass.rclpy_ext.unreadable import read_message

Copy = Callable[[Any], Any]

_CODES = {
    "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
    "int64": "q", "uint64": "Q", "float": "f", "double": "d",
}  # fmt: skip
_SINGLE = struct.Struct("f")


class _Odd(Exception):
    """A field holds something else than would arrive."""


class Packet:
    """A message under way, or what was published as bytes."""

    __slots__ = ("_data", "_message")

    def __init__(self, message: Any = None, data: bytes | None = None) -> None:
        self._message, self._data = message, data

    @classmethod
    def of(cls, message: Any) -> Packet:
        """Take a message as it is in this moment."""
        kind: Any = type(message)
        copy = copier(kind)
        if copy is not None:
            try:
                return cls(copy(message))
            except _Odd:
                pass  # rclpy says what becomes of it
        return cls(data=serialize_message(message))

    @property
    def copied(self) -> Any:
        """The message as it was sent, which all readers share; None where there are bytes only."""
        return self._message

    @property
    def data(self) -> bytes:
        """As it is on the network (CDR)."""
        if self._data is None:
            self._data = serialize_message(self._message)
        return self._data

    def message(self, kind: Any) -> Any:
        """A message of its own for a reader."""
        if self._message is None:
            return deserialize_message(self.data, kind)
        copy = copier(kind)
        assert copy is not None, "it was copied once already"
        return copy(self._message)


def fields_of(kind: Any, paths: Iterable[tuple[str, ...]]) -> Callable[[Packet], Any]:
    """Make a function that reads some fields of a message under way.

    The function raises Unreadable for what was published as bytes that are no such message.

    Raises
    ------
    ValueError
        When messages of the type cannot be read in part.
    """
    chosen = tuple(paths)
    decode = partial_decoder(type_name(kind), chosen, to_the_end=True)
    pick = picker(chosen)
    if decode is None:
        raise ValueError(f"{kind.__name__} cannot be read in part")

    def read(packet: Packet) -> Any:
        if packet.copied is not None:
            return pick(packet.copied)
        try:
            return decode(packet.data)
        except (ValueError, struct.error):  # serialised otherwise than we know
            return read_message(packet.data, kind)

    return read


@cache
def copier(kind: Any) -> Copy | None:
    """Copy messages of a type field by field; None for types with fields of rare kinds.

    The function raises when the long way would change a value.
    """
    sample = kind()
    known: dict[str, Any] = {"kind": kind, "new": kind.__new__, "odd": _odd}
    lines = ["def copy(m):", " if m.__class__ is not kind: odd()", " c = new(kind)"]
    for number, (name, slot) in enumerate(
        zip(kind.get_fields_and_field_types(), kind.SLOT_TYPES, strict=True)
    ):
        copied = _copied(slot, f"f{number}", known, getattr(sample, name))
        if copied is None:
            return None
        lines += [f" v = m._{name}", f" c._{name} = {copied}"]
    known["checks"] = sample._check_fields
    lines += [" c._check_fields = checks", " return c"]
    # As dataclasses make their methods: one function without a loop is several times as fast.
    exec("\n".join(lines), known)
    copy: Copy = known["copy"]
    return copy


def _copied(slot: Any, own: str, known: dict[str, Any], sample: Any = None) -> str | None:
    """An expression for a copy of ``v``; what it names beside is put into ``known``."""
    if isinstance(slot, NamespacedType):
        # Goals of actions and the like have no public name, and are there in each message.
        kind: Any = type(sample) if sample is not None else ros_class(_name(slot))
        copy = copier(kind)
        if copy is None:
            return None
        known[own] = copy
        return f"{own}(v)"
    if isinstance(slot, UnboundedString):
        return "v if v.__class__ is str and v.isascii() and '\\0' not in v else odd()"
    if isinstance(slot, AbstractGenericString):
        return None
    if isinstance(slot, BasicType):
        return _scalar(slot.typename, known)
    return _several(slot, own, known)


def _scalar(name: str, known: dict[str, Any]) -> str | None:
    if name == "double":
        known["real"] = _real
        return "v if v.__class__ is float else real(v)"
    if name == "float":
        known["single"] = _single
        return "single(v)"
    if name == "boolean":
        return "v if v.__class__ is bool else odd()"
    if name == "octet":
        return "v if v.__class__ is bytes and len(v) == 1 else odd()"
    if name in _CODES:
        limits = np.iinfo(name)
        return f"v if v.__class__ is int and {limits.min} <= v <= {limits.max} else odd()"
    return None


def _several(slot: Any, own: str, known: dict[str, Any]) -> str | None:
    if isinstance(slot, Array):
        length = f"len(v) == {slot.size}"
    elif isinstance(slot, BoundedSequence):
        length = f"len(v) <= {slot.maximum_size}"
    elif isinstance(slot, AbstractSequence):
        length = "True"
    else:
        return None
    code = _CODES.get(getattr(slot.value_type, "typename", ""))
    if code is None:
        item = _copied(slot.value_type, own, known)
        return (
            None
            if item is None
            else f"[{item} for v in v] if v.__class__ is list and {length} else odd()"
        )
    if isinstance(slot, Array):
        known["ndarray"], known[f"{own}_type"] = np.ndarray, np.dtype(code)
        return (
            f"v.copy() if v.__class__ is ndarray and v.dtype == {own}_type "
            f"and v.shape == ({slot.size},) else odd()"
        )
    known["array"] = array.array
    return f"v[:] if v.__class__ is array and v.typecode == {code!r} and {length} else odd()"


def _name(slot: NamespacedType) -> str:
    return "/".join(slot.namespaced_name())


def _odd() -> Any:
    raise _Odd


def _real(value: Any) -> float:
    if not isinstance(value, float):  # numpy's are
        raise _Odd
    return float(value)


def _single(value: Any) -> float:
    if not isinstance(value, float):
        raise _Odd
    try:
        return float(_SINGLE.unpack(_SINGLE.pack(value))[0])
    except OverflowError:
        raise _Odd from None
