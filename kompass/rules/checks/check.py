"""Whether rules fit the messages they speak of: found when a rule is made, not when it runs.

The shell says what there is as a :class:`~kompass.rules.checks.catalog.Catalog`.
"""

import difflib
from collections.abc import Iterator

from pydantic import JsonValue

from kompass.rules.checks.catalog import Catalog, FieldType, StackCatalog
from kompass.rules.checks.check_calls import check_calls
from kompass.rules.checks.field_values import (
    length_misfit,
    scalar_misfit,
    sought_in_vain,
    wrong_type,
)
from kompass.rules.checks.problem import Problem
from kompass.rules.schema.actions import (
    Action,
    CallService,
    Method,
    Publish,
    SendGoal,
    arguments_of,
)
from kompass.rules.schema.arguments import ArgumentError, expand, is_reference, meant, references
from kompass.rules.schema.conditions import (
    CallableCondition,
    Changed,
    Compare,
    Condition,
    Rate,
    leaves,
    topic_of,
)
from kompass.rules.schema.describe import describe
from kompass.rules.schema.model import Scalar
from kompass.rules.schema.signals import Signal, path_text
from kompass.rules.schema.table import Rule, Table
from kompass.rules.schema.values import kind_of

FIELD = "unknown-field"


def check_table(table: Table, catalog: Catalog) -> list[Problem]:
    """Check all rules against what there is; disabled ones too.

    A :class:`~kompass.rules.checks.catalog.StackCatalog` has components, methods, parameters
    and functions checked as well.
    """
    return [problem for rule in table.rules for problem in check_rule(rule, catalog)]


def check_rule(rule: Rule, catalog: Catalog) -> list[Problem]:
    """Check one rule; an empty list if it fits."""
    problems = list(_condition(rule, "event.condition", rule.event.condition, catalog))
    if rule.event.clear is not None:
        problems.extend(_condition(rule, "event.clear", rule.event.clear, catalog))
    for index, action in enumerate(rule.actions):
        problems.extend(_action(rule, f"actions[{index}]", action, catalog))
    if isinstance(catalog, StackCatalog):
        problems.extend(check_calls(rule, catalog))
        problems.extend(_given_messages(rule, catalog))
    return problems


def _given_messages(rule: Rule, catalog: StackCatalog) -> Iterator[Problem]:
    """Check the fields of messages that methods of components are given as mappings."""
    for index, action in enumerate(rule.actions):
        if not isinstance(action, Method):
            continue
        component = catalog.components().get(action.component)
        method = component.methods.get(action.method) if component is not None else None
        for argument in method.arguments if method is not None else ():
            value = action.kwargs.get(argument.name)
            if argument.message and isinstance(value, dict):
                where = f"actions[{index}].kwargs.{argument.name}"
                yield from _fields(rule, where, value, argument.message, (), catalog)


def _condition(rule: Rule, root: str, condition: Condition, catalog: Catalog) -> Iterator[Problem]:
    for path, leaf in leaves(condition):
        where = root + _tree_text(condition, path)
        if isinstance(leaf, CallableCondition):
            continue
        if isinstance(leaf, Rate):
            if leaf.type and catalog.field_type(leaf.type, ()) is None:
                yield _unknown_type(rule, f"{where}.type", leaf.type)
            continue
        found = _signal(rule, f"{where}.signal", leaf.signal, catalog)
        if isinstance(found, Problem):
            yield found
        elif isinstance(leaf, Compare):
            yield from _literal(rule, where, leaf, found)
        elif isinstance(leaf, Changed) and leaf.deadband and found.kind not in ("int", "float"):
            yield Problem(
                rule.id,
                f"{where}.deadband",
                leaf.deadband,
                f"{_field_text(leaf.signal)} is {_a(found)}, not a number",
                "leave the deadband out",
            )


def _tree_text(condition: Condition, path: tuple[int, ...]) -> str:
    text = ""
    for index in path:
        if condition.kind == "not":
            text, condition = f"{text}.condition", condition.condition
        elif condition.kind == "all" or condition.kind == "any":
            text, condition = f"{text}.conditions[{index}]", condition.conditions[index]
    return text


def _signal(rule: Rule, where: str, signal: Signal, catalog: Catalog) -> FieldType | Problem:
    """Return the type of a signal's value, its aggregate included, or what is wrong."""
    if catalog.field_type(signal.type, ()) is None:
        return _unknown_type(rule, f"{where}.type", signal.type)
    found = catalog.field_type(signal.type, signal.path)
    if found is None:
        text, remedy = _missing(signal.type, signal.path, catalog)
        return Problem(rule.id, f"{where}.path", path_text(signal.path), text, remedy, FIELD)
    if signal.aggregate is None:
        return found
    element = found.element.kind if found.element else None
    if found.kind != "list" or (
        signal.aggregate != "len" and element not in ("bool", "int", "float")
    ):
        return Problem(
            rule.id,
            f"{where}.aggregate",
            signal.aggregate,
            f"{_field_text(signal)} is {_a(found)}",
            "an aggregate is made of a list of numbers; leave it out",
        )
    if signal.aggregate in ("any", "all"):
        return FieldType("bool")
    return FieldType("int" if signal.aggregate == "len" else "float")


def _unknown_type(rule: Rule, where: str, name: str) -> Problem:
    remedy = "install its package, or correct the name"
    return Problem(rule.id, where, name, "no such message type", remedy, "unknown-type")


def _missing(type_name: str, path: tuple[str | int, ...], catalog: Catalog) -> tuple[str, str]:
    """Say which step of a path fails, and what there is instead."""
    good = 0
    while catalog.field_type(type_name, path[: good + 1]) is not None:
        good += 1
    parent, step = catalog.field_type(type_name, path[:good]), path[good]
    assert parent is not None
    at = path_text(path[:good]) or type_name
    if isinstance(step, int) and parent.size is not None:
        text = f"'{at}' always has {parent.size} items, and none at [{step}]"
        return text, f"choose one of [0] to [{parent.size - 1}]"
    if isinstance(step, int):
        return f"'{at}' is {_a(parent)}, which has no items", "leave the index out"
    if parent.kind == "list":
        return f"'{at}' is a list", f"choose an item, e.g. '{at}[0].{step}', or an aggregate"
    if parent.kind != "message":
        return f"'{at}' is {_a(parent)}, which has no fields", f"end the path at '{at}'"
    names = sorted(catalog.fields(parent.name or type_name))
    close = difflib.get_close_matches(step, names, n=1)
    remedy = f"did you mean '{close[0]}'?" if close else f"known are: {', '.join(names)}"
    return f"'{at}' has no field '{step}'", remedy


def _literal(rule: Rule, where: str, leaf: Compare, found: FieldType) -> Iterator[Problem]:
    """Check that the operator and the literal go with the type of the value."""
    name, operator, kind = _field_text(leaf.signal), leaf.operator, found.kind
    if kind == "message":
        remedy = "compare one of its fields"
        yield Problem(rule.id, where, describe(leaf), f"{name} is {_a(found)}", remedy)
        return
    literals = leaf.value if isinstance(leaf.value, tuple) else (leaf.value,)
    wanted: FieldType | None = found
    if operator in ("==", "!="):
        if (kind == "list") != isinstance(leaf.value, tuple):
            remedy = "give a list" if kind == "list" else "give one value, or use 'in'"
            yield Problem(rule.id, f"{where}.value", leaf.value, f"{name} is {_a(found)}", remedy)
            return
        wanted = found.element if kind == "list" else found
    elif "contains" in operator:
        if kind not in ("list", "text"):
            remedy = "use '==' or 'in'"
            yield Problem(rule.id, f"{where}.operator", operator, f"{name} is {_a(found)}", remedy)
            return
        wanted = found.element if kind == "list" else found
    elif kind == "list" or (kind == "bool" and operator not in ("in", "not_in")):
        remedy = "use an index or an aggregate" if kind == "list" else "use '== true' or '== false'"
        yield Problem(rule.id, f"{where}.operator", operator, f"{name} is {_a(found)}", remedy)
        return
    elif operator == "between" and kind == "text":
        remedy = "use '==' or 'in'; 'between' is for numbers"
        yield Problem(rule.id, f"{where}.operator", operator, f"{name} is {_a(found)}", remedy)
        return
    for literal in literals:
        if wanted is not None and not _fits(literal, wanted):
            yield Problem(
                rule.id,
                f"{where}.value",
                literal,
                f"{name} {'holds' if wanted is not found else 'is'} {_a(wanted)}",
                f"give {_a(wanted)}",
            )
            return
    vain = None if leaf.tolerance else sought_in_vain(found, operator, leaf.value)
    if vain is not None:
        literal, misfit = vain
        text = f"{name} is {misfit.text}: this is never true"
        yield Problem(rule.id, f"{where}.value", literal, text, misfit.remedy, misfit.code)


def _fits(literal: Scalar, wanted: FieldType) -> bool:
    kinds = {"number": ("int", "float"), "bool": ("bool",), "text": ("text",)}
    return wanted.kind in kinds[kind_of(literal)]


def _action(rule: Rule, where: str, action: Action, catalog: Catalog) -> Iterator[Problem]:
    for topic, path in references(arguments_of(action)):
        yield from _reference(rule, where, topic, path, catalog)
    target, suffix, name = _target(action)
    if target is None:
        return
    type_name = target + suffix
    if catalog.field_type(type_name, ()) is None:
        yield _unknown_type(rule, f"{where}.type", target)
        return
    arguments = arguments_of(action)
    try:
        expand(arguments)
    except ArgumentError as error:
        text, remedy = str(error).split("; ", 1)
        yield Problem(rule.id, f"{where}.{name}", arguments, text, remedy)
        return
    yield from _fields(rule, f"{where}.{name}", arguments, type_name, (), catalog)


def _target(action: Action) -> tuple[str | None, str, str]:
    if isinstance(action, Publish):
        return action.type, "", "message"
    if isinstance(action, CallService):
        return action.type, "_Request", "request"
    return (action.type, "_Goal", "goal") if isinstance(action, SendGoal) else (None, "", "")


def _fields(
    rule: Rule,
    where: str,
    value: dict[str, JsonValue],
    type_name: str,
    at: tuple[str | int, ...],
    catalog: Catalog,
) -> Iterator[Problem]:
    """Check the keys of an argument, nested or with dots, and the values below them."""
    for key, item in value.items():
        path = (*at, *key.split("."))
        found = catalog.field_type(type_name, path)
        if found is None:
            text, remedy = _missing(type_name, path, catalog)
            yield Problem(rule.id, where, key, text, remedy, FIELD)
        else:
            yield from _value(rule, f"{where}.{key}", item, found, type_name, path, catalog)


def _value(
    rule: Rule,
    where: str,
    value: JsonValue,
    found: FieldType,
    type_name: str,
    at: tuple[str | int, ...],
    catalog: Catalog,
) -> Iterator[Problem]:
    """Check a literal against the field that it is for, to its innermost items."""
    if is_reference(value):
        return  # what it brings is seen when it is there
    value = meant(value)
    if found.kind == "message" and isinstance(value, dict):
        yield from _fields(rule, where, value, type_name, at, catalog)
        return
    if found.kind == "list":
        misfit = length_misfit(found, len(value)) if isinstance(value, list) else wrong_type(found)
    else:
        misfit = wrong_type(found) if found.kind == "message" else scalar_misfit(found, value)
    if misfit is not None:
        text = f"'{path_text(at)}' is {misfit.text}"
        yield Problem(rule.id, where, value, text, misfit.remedy, misfit.code)
    elif isinstance(value, list) and found.element is not None:
        for index, item in enumerate(value):
            inner = (*at, index)
            yield from _value(
                rule, f"{where}[{index}]", item, found.element, type_name, inner, catalog
            )


def _reference(
    rule: Rule, where: str, topic: str | None, path: tuple[str | int, ...], catalog: Catalog
) -> Iterator[Problem]:
    """Check a reference against the topics whose types the condition tells."""
    types = {
        topic_of(leaf): leaf.type if isinstance(leaf, Rate) else leaf.signal.type
        for _, leaf in leaves(rule.event.condition)
        if not isinstance(leaf, CallableCondition)
    }
    for name, type_name in types.items():
        if topic not in (None, name) or type_name is None:
            continue
        if catalog.field_type(type_name, ()) is None:
            continue
        if catalog.field_type(type_name, path) is None:
            text, remedy = _missing(type_name, path, catalog)
            if topic is None and len(types) > 1:
                remedy = (
                    f"any of its topics may trigger the rule; write '$topic[/name]…' or {remedy}"
                )
            reference = f"${'msg' if topic is None else f'topic[/{topic}]'}.{path_text(path)}"
            yield Problem(
                rule.id, where, reference, f"in a message of /{name} {text}", remedy, FIELD
            )


def _field_text(signal: Signal) -> str:
    return f"'{path_text(signal.path)}'" if signal.path else f"the message of /{signal.topic}"


def _a(found: FieldType) -> str:
    words = {"bool": "a bool", "int": "an integer", "float": "a number", "text": "a text"}
    if found.kind == "list":
        return f"a list of {found.element.kind if found.element else 'unknown'}s"
    return words.get(found.kind, f"a message ({found.name})")
