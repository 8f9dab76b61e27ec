"""Read a few fields out of a serialised message, and leave the rest alone.

A rule looks at one or two fields of a message, and a component at the pose and the twist of an
``Odometry``; making all of one costs a hundred times what the engine then needs for it. The layout
is that of plain CDR, little endian: each primitive aligned to its size, strings and sequences
preceded by their length.
"""

from __future__ import annotations

import array
import struct
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from operator import attrgetter
from types import SimpleNamespace
from typing import Any, NamedTuple, TypeAlias

from rosidl_parser.definition import (  # type: ignore[import-untyped]
    AbstractNestedType,
    AbstractSequence,
    AbstractString,
    Array,
    BasicType,
    NamespacedType,
)

from kompass.message_types import ros_class

Path: TypeAlias = tuple[str | int, ...]
Decode: TypeAlias = Callable[[bytes], Any]

_ENCAPSULATION = 4  # bytes before the message, from which alignment counts
_PLAIN_LITTLE_ENDIAN = b"\x00\x01"
_FORMATS = {
    "boolean": "?",
    "octet": "c",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float": "f",
    "double": "d",
}
_LENGTH = struct.Struct("<I").unpack_from


class _Unknown(Exception):
    """A type whose layout is not known here."""


class _Fixed(NamedTuple):
    """One primitive, or an array of ``size`` of them; ``size`` 0 for one."""

    code: str
    size: int
    name: tuple[str, ...]


class _Text(NamedTuple):
    name: tuple[str, ...]


class _Row(NamedTuple):
    """A sequence of primitives."""

    code: str
    name: tuple[str, ...]


class _Rows(NamedTuple):
    """A sequence, or an array of ``size``, of what is itself of any length."""

    size: int | None
    item: tuple[_Field, ...]
    name: tuple[str, ...]


_Field: TypeAlias = _Fixed | _Text | _Row | _Rows
_Values: TypeAlias = dict[tuple[str, ...], Any]
_Step: TypeAlias = Callable[[bytes, int, _Values], int]


def partial_decoder(
    type_name: str, paths: Iterable[Path], *, to_the_end: bool = False
) -> Decode | None:
    """Make a function that reads these fields into an object with the same attributes.

    Parameters
    ----------
    to_the_end
        Look whether all of the message is there, also what lies behind the last field.

    Returns None where a whole message is called for: a path leads to a message or into a sequence
    of messages, or the layout of the type is not known here. The function raises ``struct.error``
    or ``ValueError`` for bytes that are no such message.
    """
    try:
        fields = _fields(type_name)
    except _Unknown:
        return None
    wanted = set()
    leaves = {field.name for field in fields if not isinstance(field, _Rows)}
    for path in paths:
        name = tuple(part for part in path if isinstance(part, str))
        # Indices may follow a field that is a row of primitives, and nothing else.
        if path[: len(name)] != name or name not in leaves:
            return None
        wanted.add(name)
    steps = _steps(fields, wanted, to_the_end=to_the_end)
    build = _builder(wanted)

    def decode(data: bytes) -> Any:
        if data[:2] != _PLAIN_LITTLE_ENDIAN:
            raise ValueError("it is not serialised as plain CDR, little endian")
        values: _Values = {}
        at = _ENCAPSULATION
        for step in steps:
            at = step(data, at, values)
        if at > len(data):
            raise ValueError("it is cut short")
        return build(values)

    return decode


def picker(paths: Iterable[Path]) -> Callable[[Any], Any]:
    """Make a function that gives of a message what the function of `partial_decoder` reads.

    Rows of primitives are those of the message, and no copies.
    """
    wanted = {tuple(part for part in path if isinstance(part, str)) for path in paths}
    parts = [(name, attrgetter(".".join(name))) for name in wanted]
    build = _builder(wanted)

    def pick(message: Any) -> Any:
        return build({name: get(message) for name, get in parts})

    return pick


@cache
def _fields(type_name: str) -> tuple[_Field, ...]:
    """The primitives of a message in the order of their bytes, with the names that lead there."""
    kind = ros_class(type_name)
    names = list(kind.get_fields_and_field_types())
    if not names:
        return (_Fixed("B", 0, ("structure_needs_at_least_one_member",)),)
    found: list[_Field] = []
    for name, slot in zip(names, kind.SLOT_TYPES, strict=True):
        found += _of(slot, (name,))
    return tuple(found)


def _of(slot: Any, name: tuple[str, ...]) -> list[_Field]:
    if isinstance(slot, BasicType):
        return [_Fixed(_code(slot), 0, name)]
    if isinstance(slot, AbstractString):
        return [_Text(name)]
    if isinstance(slot, NamespacedType):
        return [field._replace(name=name + field.name) for field in _fields(_name(slot))]
    if isinstance(slot, AbstractNestedType):
        count = slot.size if isinstance(slot, Array) else None
        item = slot.value_type
        if isinstance(item, BasicType):
            code = _code(item)
            return [_Row(code, name) if count is None else _Fixed(code, count, name)]
        if isinstance(slot, AbstractSequence | Array):
            return [_Rows(count, tuple(_of(item, ())), name)]
    raise _Unknown


def _name(slot: Any) -> str:
    return "/".join((*slot.namespaces, slot.name))


def _code(slot: Any) -> str:
    code = _FORMATS.get(slot.typename)
    if code is None:
        raise _Unknown
    return code


# -- reading ----------------------------------------------------------------------------------


def _steps(
    fields: Sequence[_Field], wanted: set[tuple[str, ...]], *, to_the_end: bool
) -> list[_Step]:
    """Steps over the fields, up to the last that is wanted, or that there is."""
    last = max((i for i, field in enumerate(fields) if field.name in wanted), default=-1)
    if to_the_end:
        last = len(fields) - 1
    made: list[_Step] = []
    run: list[_Fixed] = []
    for field in fields[: last + 1]:
        if isinstance(field, _Fixed):
            run.append(field)
            continue
        if run:
            made.append(_run(run, wanted))
            run = []
        made.append(_variable(field, wanted))
    if run:
        made.append(_run(run, wanted))
    return made


def _run(fields: Sequence[_Fixed], wanted: set[tuple[str, ...]]) -> _Step:
    """A step over fields of fixed size: where they lie hangs on the alignment of the first."""
    layouts = [_layout(fields, wanted, begin) for begin in range(8)]

    def step(data: bytes, at: int, values: _Values) -> int:
        size, reads = layouts[(at - _ENCAPSULATION) & 7]
        for offset, unpack, code, name in reads:
            found = unpack(data, at + offset)
            values[name] = found[0] if code is None else _row(code, found)
        return at + size

    return step


def _layout(
    fields: Sequence[_Fixed], wanted: set[tuple[str, ...]], begin: int
) -> tuple[int, list[tuple[int, Callable[..., Any], str | None, tuple[str, ...]]]]:
    at = begin
    reads = []
    for field in fields:
        width = struct.calcsize(field.code)
        at += -at % width
        if field.name in wanted:
            unpack = struct.Struct(f"<{field.size or 1}{field.code}").unpack_from
            code = field.code if field.size else None
            reads.append((at - begin, unpack, code, field.name))
        at += width * (field.size or 1)
    return at - begin, reads


def _row(code: str, found: Sequence[Any]) -> Any:
    return list(found) if code in "?c" else array.array(code, found)


def _variable(field: _Text | _Row | _Rows, wanted: set[tuple[str, ...]]) -> _Step:
    name = field.name if field.name in wanted else None
    if isinstance(field, _Text):

        def text(data: bytes, at: int, values: _Values) -> int:
            begin, size = _length(data, at)
            if name is not None:
                values[name] = data[begin : begin + size - 1].decode()
            return begin + size

        return text
    if isinstance(field, _Row):
        return _row_step(field.code, name)
    return _rows_step(field)


def _row_step(code: str, name: tuple[str, ...] | None) -> _Step:
    width = struct.calcsize(code)

    def row(data: bytes, at: int, values: _Values) -> int:
        at, count = _length(data, at)
        if count:
            at += -(at - _ENCAPSULATION) % width
        end = at + count * width
        if end > len(data):
            raise ValueError("it is cut short")
        if name is not None:
            if code in "?c":
                values[name] = list(struct.unpack_from(f"<{count}{code}", data, at))
            else:
                found = values[name] = array.array(code)
                found.frombytes(data[at:end])
        return end

    return row


def _rows_step(field: _Rows) -> _Step:
    """A step over a sequence of messages or texts, of which nothing is wanted."""
    none: set[tuple[str, ...]] = set()
    inner: list[_Step] = []
    run: list[_Fixed] = []
    for each in field.item:
        if isinstance(each, _Fixed):
            run.append(each)
            continue
        if run:
            inner.append(_run(run, none))
            run = []
        inner.append(_variable(each, none))
    if run:
        inner.append(_run(run, none))

    def rows(data: bytes, at: int, values: _Values) -> int:
        count = field.size
        if count is None:
            at, count = _length(data, at)
        for _ in range(count):
            for step in inner:
                at = step(data, at, values)
            if at > len(data):
                raise ValueError("it is cut short")
        return at

    return rows


def _length(data: bytes, at: int) -> tuple[int, int]:
    at += -(at - _ENCAPSULATION) % 4
    return at + 4, _LENGTH(data, at)[0]


def _builder(names: set[tuple[str, ...]], prefix: tuple[str, ...] = ()) -> Callable[[_Values], Any]:
    """Make the function that hangs values into a tree of attributes."""
    depth = len(prefix)
    own = [(name[depth], name) for name in names if len(name) == depth + 1]
    parts = {name[depth] for name in names if len(name) > depth + 1}
    inner = [
        (
            part,
            _builder(
                {n for n in names if n[depth] == part and len(n) > depth + 1}, (*prefix, part)
            ),
        )
        for part in parts
    ]

    def build(values: _Values) -> Any:
        made = SimpleNamespace()
        attributes = made.__dict__
        for attribute, name in own:
            attributes[attribute] = values[name]
        for part, make in inner:
            attributes[part] = make(values)
        return made

    return build
