"""Every field of a rule, from the models that read it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, get_args, get_origin

from pydantic import BaseModel

from docs.hooks.markup import attributes, code, prose, summary, table
from docs.hooks.settings import bounds_of, default_text, type_text
from kompass.rules.schema import actions, conditions, events, signals
from kompass.rules.schema import table as tables

INTRODUCTION = """# Rule schema

A table of rules is one JSON or YAML document: `{"rules": […]}`, or the list of rules alone.
Unknown fields and values out of bounds are refused. `kompass-console rules schema` prints the
same as JSON Schema, for editors that complete while one types. [Rules by
example](../rules-by-example.md) shows each in use.
"""
ARGUMENTS = """## Values from messages

In the arguments of an action (`kwargs`, `parameters`, `config`, `message`, `request`, `goal`) a
text that begins with `$` is taken from a message: `"$msg"` is the message that made the rule
fire, `"$msg.point.x"` and `"$msg.poses[0].position"` parts of it, `"$topic[/odom].pose.pose"` a
part of the newest message of another topic. `"$$"` at the start stands for one dollar sign. Keys
with dots are nested: `{"point.x": 1}` is `{"point": {"x": 1}}`.
"""
CONDITIONS = tuple(get_args(get_args(conditions.Condition)[0]))
ACTIONS = tuple(get_args(get_args(actions.Action)[0]))
MODES = tuple(get_args(get_args(events.Mode)[0]))
UNIONS = {
    frozenset(CONDITIONS): "a [condition](#conditions)",
    frozenset(ACTIONS): "an [action](#actions)",
    frozenset(MODES): "a [mode](#modes)",
}


def rule_schema_page() -> str:
    """Table, rule, event, then the kinds of conditions, modes and actions."""
    parts = [INTRODUCTION]
    for model in (tables.Table, tables.Rule, events.Event, events.MaxRate, signals.Signal):
        parts += _section(model, "##", model.__name__)
    for title, text, kinds in (
        ("Conditions", "What must be true. `kind` tells which it is.", CONDITIONS),
        ("Modes", "What a trigger does while the actions of the last one still run.", MODES),
        ("Actions", "What is done. `kind` tells which it is.", ACTIONS),
    ):
        parts.append(f"## {title}\n\n{text}\n")
        for model in kinds:
            parts += _section(model, "###", model.model_fields["kind"].default)
    return "\n".join([*parts, ARGUMENTS])


def _section(model: type[BaseModel], level: str, title: str) -> list[str]:
    told = attributes(model)
    for base in model.__mro__[1:]:
        told = {**attributes(base), **told}
    rows = []
    for name, field in model.model_fields.items():
        if name == "kind":
            continue
        kind = _kind(field.annotation)
        needed = "required" if field.is_required() else _default(model, name, default_text(field))
        rows.append((code(name), kind, needed, bounds_of(field), told.get(name, "")))
    lines = [f"{level} {title}\n", prose(summary(model)) + "\n"]
    body = _rest(model)
    if body:
        lines.append(body + "\n")
    if rows:
        lines.append(table(("field", "type", "default", "bounds", "what it is"), rows))
    return lines


def _kind(annotation: Any) -> str:
    members = set(_members(annotation))
    for union, text in UNIONS.items():
        if union <= members:
            if get_origin(annotation) is tuple:
                return f"list of {text.split(' ', 1)[1]}"
            return f"{text} or none" if type(None) in members else text
    if annotation is tables.Severity:
        return ", ".join(code(one.name.lower()) for one in tables.Severity)
    met: dict[str, type[BaseModel]] = {}
    return type_text(annotation, met)


def _members(annotation: Any) -> Iterator[Any]:
    """The types that a nested annotation is made of."""
    if isinstance(annotation, type) and not get_args(annotation):
        yield annotation
    for inner in get_args(annotation):
        yield from _members(inner)


def _default(model: type[BaseModel], name: str, text: str) -> str:
    value = model.model_fields[name].default
    if isinstance(value, tables.Severity):
        return code(value.name.lower())
    if isinstance(value, events.Single):
        return code("{kind: single}")
    return text or "none"


def _rest(model: type[BaseModel]) -> str:
    """What the docstring says between its first line and its list of fields."""
    blocks = (model.__doc__ or "").strip().split("\n\n")[1:]
    kept = []
    for block in blocks:
        if block.strip().startswith("Attributes"):
            break
        kept.append(" ".join(block.split()))
    return prose("\n\n".join(kept))
