"""The fields of a message class, in the terms in which rules are checked."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from rosidl_parser.definition import (  # type: ignore[import-untyped]
    AbstractGenericString,
    AbstractNestedType,
    AbstractWString,
    Array,
    BasicType,
    NamespacedType,
)

from kompass.rules.checks.catalog import FieldType
from kompass.rules.checks.field_values import PRIMITIVES

_FILLER = "structure_needs_at_least_one_member"  # of messages without fields


_KNOWN: dict[type[Any], Mapping[str, FieldType]] = {}


def field_types(kind: type[Any]) -> Mapping[str, FieldType]:
    """The types of the fields of a message, request or goal class, by name."""
    found = _KNOWN.get(kind)
    if found is None:
        names = kind.get_fields_and_field_types()
        # Without any fields it may tell only the type of the filler, or only its name.
        slots = dict(zip(names, kind.SLOT_TYPES, strict=True)) if names else {}
        made = {name: _of(slot) for name, slot in slots.items() if name != _FILLER}
        found = _KNOWN[kind] = MappingProxyType(made)
    return found


def _of(slot: Any) -> FieldType:
    if isinstance(slot, BasicType):
        return FieldType(PRIMITIVES[slot.typename], primitive=slot.typename)
    if isinstance(slot, AbstractGenericString):
        name = "wstring" if isinstance(slot, AbstractWString) else "string"
        bound = slot.maximum_size if slot.has_maximum_size() else None
        return FieldType("text", primitive=name, bound=bound)
    if isinstance(slot, AbstractNestedType):
        size = slot.size if isinstance(slot, Array) else None
        bound = slot.maximum_size if size is None and slot.has_maximum_size() else None
        return FieldType("list", element=_of(slot.value_type), size=size, bound=bound)
    assert isinstance(slot, NamespacedType), slot
    return FieldType("message", "/".join((*slot.namespaces, slot.name)))
