"""The settings of every component, from their models."""

from __future__ import annotations

import enum
import re
import types
import typing
from typing import Any, Literal, Union, get_args, get_origin

import numpy as np
from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from docs.hooks.markup import attributes, code, prose, summary, table
from kompass.components import (
    Component,
    Controller,
    DriveManager,
    LocalMapper,
    MapServer,
    MotionServer,
    Planner,
)
from kompass.components.controller.follower_settings import FollowerSettings
from kompass.robot import RobotFrames

COMPONENTS: tuple[type[Component], ...] = (
    Planner,
    Controller,
    LocalMapper,
    DriveManager,
    MapServer,
    MotionServer,
)
NO_EFFECT = "without effect"

INTRODUCTION = """# Settings

Settings of a component are given in the recipe (`Planner(config=PlannerConfig(clearance=0.2))`),
in a YAML, TOML or JSON file (`config_file=…`; the section named like the node, and `/**` for
all), by a rule (`update_parameters`), or over ROS 2 (`/<node>/update_config_parameter`). In
rules and services a dot leads into a nested setting: `map_params.resolution`. A name that does
not exist is an error, and so is a value out of bounds; nothing is changed then.

Settings marked *no effect* are read from files written for other stacks, and change nothing.
"""


def settings_page() -> str:
    """Components with their topics, actions and settings; the nested settings after them."""
    parts = [INTRODUCTION]
    nested: dict[str, type[BaseModel]] = {}
    for kind in COMPONENTS:
        parts += [f"## {kind.__name__}\n", prose(summary(kind)) + "\n", _facts(kind)]
        parts += [fields_table(kind.config_class, nested)]
    parts.append("## Nested settings\n")
    done: set[str] = set()
    nested.setdefault(RobotFrames.__name__, RobotFrames)
    while waiting := sorted(set(nested) - done):
        name = waiting[0]
        done.add(name)
        parts += [f"### {name}\n", prose(summary(nested[name])) + "\n"]
        parts.append(fields_table(nested[name], nested))
    return "\n".join(parts)


def fields_table(model: type[BaseModel], nested: dict[str, type[BaseModel]]) -> str:
    """One row for each field; models that are met are put into ``nested``."""
    told = meanings(model)
    rows = []
    for name, field in model.model_fields.items():
        kind = type_text(field.annotation, nested)
        bounds = bounds_of(field)
        text = prose(told.get(name, ""))
        unit, text = split_unit(text)
        if NO_EFFECT in text:
            text = text.replace(NO_EFFECT, "*no effect*")
        rows.append((code(name), kind, default_text(field), bounds, unit, text))
    return table(("setting", "type", "default", "bounds", "unit", "what it is"), rows)


def meanings(model: type[BaseModel]) -> dict[str, str]:
    """What each field is: its description, or else what the model's docstring says.

    The section of an algorithm describes only what happens without a setting; what the setting
    is stands in the docstrings of the algorithm's parameters.
    """
    described = {name: field.description or "" for name, field in model.model_fields.items()}
    if not issubclass(model, FollowerSettings):
        return attributes(model) | {name: text for name, text in described.items() if text}
    told: dict[str, str] = {}
    for kind in reversed(model.follower.params_class.__mro__):
        told |= attributes(kind)
    return {name: f"{unit_first(told.get(name, ''))}; {text}" for name, text in described.items()}


def unit_first(text: str) -> str:
    """A docstring's text without its full stop, and its last word in front if that is a [unit]."""
    match = re.fullmatch(r"(.*?)\s*\[([^\]]+)\]", text.rstrip("."))
    if match is None:
        return text.rstrip(".")
    return "; ".join(part for part in (match[2], match[1]) if part)


UNITS = ("Hz", "rad", "m/s²", "m/s", "m", "s", "degrees", "rad/s", "rad/s²")


def split_unit(text: str) -> tuple[str, str]:
    """The unit with which a description begins, and the rest of it."""
    for unit in sorted(UNITS, key=len, reverse=True):
        if text == unit:
            return unit, ""
        for mark in ("; ", ", ", " "):
            if text.startswith(unit + mark):
                return unit, text[len(unit + mark) :]
    return "", text


def type_text(kind: Any, nested: dict[str, type[BaseModel]]) -> str:
    """A type as one would say it; enumerations with their values."""
    origin = get_origin(kind)
    if origin is typing.Annotated:
        return type_text(get_args(kind)[0], nested)
    if origin in (Union, types.UnionType):
        return " or ".join(type_text(one, nested) for one in get_args(kind))
    if origin is Literal:
        return ", ".join(code(value) for value in get_args(kind))
    if origin in (list, tuple):
        inner = [one for one in get_args(kind) if one is not Ellipsis]
        return "list of " + ", ".join(dict.fromkeys(type_text(one, nested) for one in inner))
    if np.ndarray in (origin, kind):
        return "list of numbers"
    if kind is type(None):
        return "none"
    if isinstance(kind, type) and issubclass(kind, enum.Enum):
        return ", ".join(code(member.value) for member in kind)
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        nested[kind.__name__] = kind
        return f"[{kind.__name__}](#{kind.__name__.lower()})"
    names = {float: "number", int: "whole number", bool: "true or false", str: "text"}
    return names.get(kind, getattr(kind, "__name__", str(kind)))


def default_text(field: FieldInfo) -> str:
    """The default of a field; nothing for one that must be given, or is a section of its own."""
    value = field.get_default(call_default_factory=True, validated_data={})
    if value is PydanticUndefined or isinstance(value, BaseModel):
        return ""
    if isinstance(value, enum.Enum):
        return code(value.value)
    if isinstance(value, np.ndarray):
        return code(value.tolist())
    if value is None:
        return ""
    if isinstance(value, tuple):
        return code(list(value))
    return code(str(value).lower() if isinstance(value, bool) else repr(value).replace("'", '"'))


def bounds_of(field: FieldInfo) -> str:
    """What the field's constraints say."""
    signs = {Ge: ("≥", "ge"), Gt: (">", "gt"), Le: ("≤", "le"), Lt: ("<", "lt")}
    found = []
    for rule in field.metadata:
        for kind, (sign, name) in signs.items():
            if isinstance(rule, kind):
                found.append(f"{sign} {getattr(rule, name):g}")
    return ", ".join(found)


def _facts(kind: type[Component]) -> str:
    topics = [
        (
            direction,
            code(key),
            ", ".join(code(f"/{topic.name}") for topic in usual.get(key, ())) or "–",
            ", ".join(allowed.types),
        )
        for direction, taken, usual in (
            ("input", kind.allowed_inputs, kind.default_inputs),
            ("output", kind.allowed_outputs, kind.default_outputs),
        )
        for key, allowed in taken.items()
    ]
    runs = ", ".join(one.value for one in kind.allowed_run_types)
    actions = ", ".join(code(name) for name in kind("x").available_actions)
    return (
        table(("direction", "key", "default topic", "message types"), topics)
        + f"\nRun types: {runs}. Actions that rules may call: {actions}.\n"
    )
