"""What rules may call and change of a component, read from its class and its settings."""

from __future__ import annotations

import enum
import inspect
import types
import typing
from collections.abc import Callable, Iterator
from typing import Any

import annotated_types
from kompass_interfaces.action import PlanPath
from pydantic import BaseModel, JsonValue
from pydantic.fields import FieldInfo

from kompass.components.base.actions import ActionSpec
from kompass.components.base.component import Component
from kompass.message_types import type_name
from kompass.rclpy_ext.topic import Topic
from kompass.rules.checks.catalog import (
    ArgumentSpec,
    ComponentSpec,
    MethodSpec,
    ParameterSpec,
    ValueKind,
)
from kompass.rules.schema.model import topic_key
from kompass.settings import ignored_of

_KINDS: dict[Any, ValueKind] = {
    bool: "bool",
    int: "int",
    float: "float",
    str: "text",
    list: "list",
    tuple: "list",
    set: "list",
    dict: "object",
}
_OPEN = (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)


def component_spec(component: Component) -> ComponentSpec:
    """A component of the recipe, as rules see it."""
    kind = type(component)
    return ComponentSpec(
        name=component.node_name,
        kind=kind.__name__,
        methods={name: _method(kind, spec) for name, spec in component.action_specs.items()},
        parameters={spec.name: spec for spec in _parameters(component.config, "")},
        ignored=dict(_ignored(component.config, "")),
        gate=kind.stops_robot,
        hears=_topics(component, component.inputs_keys, component.get_in_topic),
        speaks=_topics(component, component.outputs_keys, component.get_out_topic),
        serves=frozenset({component.main_action_name} if component.main_action_type else ()),
        takes_goals=component.main_action_type is PlanPath,
    )


def _topics(
    component: Component,
    keys: list[str],
    topic_of: Callable[[str], Topic | list[Topic] | None],
) -> frozenset[str]:
    given = (topic_of(key) for key in keys)
    listed = [each if isinstance(each, list) else [each] for each in given if each is not None]
    return frozenset(topic_key(topic.name) for topics in listed for topic in topics)


def _method(kind: type, spec: ActionSpec) -> MethodSpec:
    function = getattr(kind, spec.name)
    parameters = list(inspect.signature(function).parameters.values())[1:]
    try:
        hints = typing.get_type_hints(function)
    except (NameError, TypeError):
        hints = {}  # names that only the type checker sees
    arguments = [
        ArgumentSpec(
            name=parameter.name,
            kind=_kind(hints.get(parameter.name))[0],
            element=_element(hints.get(parameter.name)),
            message=_message(hints.get(parameter.name)),
            required=parameter.default is inspect.Parameter.empty,
            default=None if parameter.default is parameter.empty else _json(parameter.default),
        )
        for parameter in parameters
        if parameter.kind not in _OPEN
    ]
    return MethodSpec(
        spec.name,
        tuple(arguments),
        text=str(spec.description),
        open=any(parameter.kind == inspect.Parameter.VAR_KEYWORD for parameter in parameters),
        recipe_only=spec.recipe_only,
    )


def _parameters(settings: BaseModel, prefix: str) -> Iterator[ParameterSpec]:
    for name, field in type(settings).model_fields.items():
        value = getattr(settings, name)
        if isinstance(value, BaseModel):
            yield ParameterSpec(f"{prefix}{name}", "object", text=field.description or "")
            yield from _parameters(value, f"{prefix}{name}.")
            continue
        kind, optional = _kind(field.annotation)
        low, high = _bounds(field)
        yield ParameterSpec(
            name=f"{prefix}{name}",
            kind=kind,
            value=_json(value),
            text=field.description or "",
            minimum=low,
            maximum=high,
            optional=optional,
            element=_element(field.annotation),
        )


def _ignored(settings: BaseModel, prefix: str) -> Iterator[tuple[str, str]]:
    for name, why in ignored_of(type(settings)).items():
        yield f"{prefix}{name}", why
    for name in type(settings).model_fields:
        value = getattr(settings, name)
        if isinstance(value, BaseModel):
            yield from _ignored(value, f"{prefix}{name}.")


def _kind(annotation: Any) -> tuple[ValueKind, bool]:
    """Sort of value that an annotation stands for, and whether it may be None."""
    if typing.get_origin(annotation) is typing.Annotated:
        return _kind(typing.get_args(annotation)[0])
    if typing.get_origin(annotation) in (typing.Union, types.UnionType):
        members = typing.get_args(annotation)
        kinds = {_kind(member)[0] for member in members if member is not types.NoneType}
        return (kinds.pop() if len(kinds) == 1 else "any"), types.NoneType in members
    if annotation in (None, Any, inspect.Parameter.empty):
        return "any", True
    if hasattr(annotation, "get_fields_and_field_types"):
        return "object", False  # a message, whose fields are given by name
    return _KINDS.get(typing.get_origin(annotation) or annotation, "any"), False


def _element(annotation: Any) -> ValueKind:
    """Sort of the items of a list; ``any`` where they may be of several, or null."""
    if typing.get_origin(annotation) is typing.Annotated:
        return _element(typing.get_args(annotation)[0])
    items = set(typing.get_args(annotation)) - {Ellipsis}
    if typing.get_origin(annotation) not in (list, tuple, set) or len(items) != 1:
        return "any"
    kind, optional = _kind(items.pop())
    return "any" if optional else kind


def _message(annotation: Any) -> str:
    """``package/msg/Name`` of a message class; empty for anything else."""
    is_message = hasattr(annotation, "get_fields_and_field_types")
    return type_name(annotation) if is_message else ""


def _bounds(field: FieldInfo) -> tuple[float | None, float | None]:
    low = high = None
    for item in field.metadata:
        if isinstance(item, annotated_types.Ge | annotated_types.Interval):
            low = item.ge if isinstance(item.ge, int | float) else low
        if isinstance(item, annotated_types.Le | annotated_types.Interval):
            high = item.le if isinstance(item.le, int | float) else high
    return low, high


def _json(value: Any) -> JsonValue:
    """A default or a setting, as far as JSON has it; what has no JSON is told as text."""
    if isinstance(value, enum.Enum):
        return _json(value.value)
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if abs(value) != float("inf") and value == value else str(value)
    if isinstance(value, list | tuple | set):
        return [_json(item) for item in value]
    if isinstance(value, dict):
        return {str(key): _json(item) for key, item in value.items()}
    return str(value)
