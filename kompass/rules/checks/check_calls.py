"""Whether what a rule calls exists and takes what it is given: components, methods, functions."""

import difflib
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from pydantic import JsonValue

from kompass.rules.checks.catalog import ArgumentSpec, ComponentSpec, ParameterSpec, StackCatalog
from kompass.rules.checks.problem import Problem
from kompass.rules.schema.actions import (
    Action,
    Lifecycle,
    Method,
    Python,
    Reconfigure,
    UpdateParameters,
    component_of,
)
from kompass.rules.schema.arguments import is_reference, meant
from kompass.rules.schema.conditions import CallableCondition, Condition, leaves
from kompass.rules.schema.table import Rule

# Every component has these, whether or not they are listed among its methods.
LIFECYCLE = ("start", "stop", "restart", "reconfigure", "configure")


def check_calls(rule: Rule, catalog: StackCatalog) -> Iterator[Problem]:
    """Check all that a rule calls by name."""
    conditions = {"event.condition": rule.event.condition, "event.clear": rule.event.clear}
    for where, condition in conditions.items():
        if condition is not None:
            yield from _polled(rule, where, condition, catalog.functions())
    for index, action in enumerate(rule.actions):
        where = f"actions[{index}]"
        if isinstance(action, Python):
            if action.name not in catalog.functions():
                yield _no_function(rule, f"{where}.name", action.name, catalog.functions())
        elif component_of(action) is not None:
            yield from _component(rule, where, action, catalog.components())


def _polled(
    rule: Rule, where: str, condition: Condition, functions: Collection[str]
) -> Iterator[Problem]:
    for _, leaf in leaves(condition):
        if isinstance(leaf, CallableCondition) and leaf.name not in functions:
            yield _no_function(rule, where, leaf.name, functions)


def _no_function(rule: Rule, where: str, name: str, functions: Collection[str]) -> Problem:
    remedy = nearest(name, functions, "the recipe has no functions; choose another action")
    return Problem(
        rule.id, where, name, f"the recipe has no function '{name}'", remedy, "unknown-function"
    )


def _component(
    rule: Rule, where: str, action: Action, components: Mapping[str, ComponentSpec]
) -> Iterator[Problem]:
    name = component_of(action)
    assert name is not None
    component = components.get(name)
    if component is None:
        yield Problem(
            rule.id,
            f"{where}.component",
            name,
            f"there is no component '{name}'",
            nearest(name, components, "the stack has no components"),
            "unknown-component",
        )
    elif isinstance(action, Method):
        yield from _method(rule, where, action, component)
    elif isinstance(action, UpdateParameters):
        yield from _parameters(rule, f"{where}.parameters", action.parameters, component)
    elif isinstance(action, Reconfigure) and isinstance(action.config, dict):
        yield from _parameters(rule, f"{where}.config", action.config, component)
    else:
        assert isinstance(action, (Lifecycle, Reconfigure))


def _method(rule: Rule, where: str, action: Method, component: ComponentSpec) -> Iterator[Problem]:
    method = component.methods.get(action.method)
    if method is None:
        if action.method in LIFECYCLE:
            return
        yield Problem(
            rule.id,
            f"{where}.method",
            action.method,
            f"'{component.name}' has no method '{action.method}' that rules may call",
            nearest(action.method, component.methods, "it has none; choose another action"),
            "unknown-method",
        )
        return
    known = {argument.name: argument for argument in method.arguments}
    for name, value in action.kwargs.items():
        at = f"{where}.kwargs.{name}"
        if name in known:
            yield from _value(rule, at, value, known[name], f"argument '{name}' of {method.name}")
        elif not method.open:
            text = f"{component.name}.{method.name} takes no argument '{name}'"
            remedy = nearest(name, known, "leave it out: it takes none")
            yield Problem(rule.id, at, value, text, remedy, "unknown-argument")
    for name, argument in known.items():
        if argument.required and name not in action.kwargs:
            text = f"{component.name}.{method.name} needs the argument '{name}'"
            remedy = f"give {_a(argument.kind)}" + (f": {argument.text}" if argument.text else "")
            yield Problem(rule.id, f"{where}.kwargs", action.kwargs, text, remedy, "no-argument")


def _parameters(
    rule: Rule, where: str, given: Mapping[str, JsonValue], component: ComponentSpec
) -> Iterator[Problem]:
    for name, value in given.items():
        at = f"{where}.{name}"
        parameter = component.parameters.get(name)
        if parameter is not None:
            yield from _value(rule, at, value, parameter, f"'{name}' of {component.name}")
            continue
        if name in component.ignored:
            text = f"'{name}' of {component.name} would have no effect: {component.ignored[name]}"
            yield Problem(rule.id, at, value, text, "leave it out", "ignored-parameter")
            continue
        # A part of a parameter whose parts are not listed, or a whole whose parts are.
        parents = _parents(name)
        inner = any(known.startswith(f"{name}.") for known in component.parameters)
        open_parent = any(
            p in component.parameters and component.parameters[p].kind in ("object", "any")
            for p in parents
        )
        if inner or open_parent:
            continue
        text = f"'{component.name}' has no parameter '{name}'"
        remedy = nearest(name, component.parameters, "it has none that rules may change")
        yield Problem(rule.id, at, value, text, remedy, "unknown-parameter")


def _parents(name: str) -> list[str]:
    parts = name.split(".")
    return [".".join(parts[:end]) for end in range(1, len(parts))]


def _value(
    rule: Rule, where: str, value: JsonValue, spec: ArgumentSpec | ParameterSpec, what: str
) -> Iterator[Problem]:
    if is_reference(value):
        return  # what it brings is seen when it is there
    optional = spec.optional if isinstance(spec, ParameterSpec) else not spec.required
    if value is None and (optional or spec.kind == "any"):
        return
    if not _fits(value, spec.kind):
        text, remedy = f"{what} is {_a(spec.kind)}", f"give {_a(spec.kind)}"
        yield Problem(rule.id, where, value, text, remedy, "wrong-type")
    elif spec.options and meant(value) not in spec.options:
        options = [str(option) for option in spec.options]
        remedy = nearest(str(value), options, "")
        text = f"{what} is one of: {', '.join(options)}"
        yield Problem(rule.id, where, value, text, remedy, "not-an-option")
    elif isinstance(spec, ParameterSpec) and isinstance(value, (int, float)):
        yield from _bounds(rule, where, value, spec, what)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            if not is_reference(item) and not _fits(item, spec.element):
                text, remedy = f"each item of {what} is {_a(spec.element)}", "correct it"
                yield Problem(rule.id, f"{where}[{index}]", item, text, remedy, "wrong-type")


def _bounds(
    rule: Rule, where: str, value: float, spec: ParameterSpec, what: str
) -> Iterator[Problem]:
    low, high = spec.minimum, spec.maximum
    below, above = low is not None and value < low, high is not None and value > high
    if below or above:
        limits = [f"at least {low:g}"] if low is not None else []
        limits += [f"at most {high:g}"] if high is not None else []
        text = f"{what} is {' and '.join(limits)}"
        remedy = f"give {low if below else high:g}, or what lies within"
        yield Problem(rule.id, where, value, text, remedy, "out-of-range")


_TYPES: dict[str, tuple[type[Any], ...]] = {
    "bool": (bool,),
    "int": (int,),
    "float": (int, float),
    "text": (str,),
    "list": (list,),
    "object": (dict,),
}


def _fits(value: JsonValue, kind: str) -> bool:
    if kind == "any":
        return True
    if isinstance(value, bool):
        return kind == "bool"
    return isinstance(value, _TYPES[kind]) or (
        kind == "int" and isinstance(value, float) and value.is_integer()
    )


def _a(kind: str) -> str:
    words = {
        "bool": "true or false",
        "int": "a whole number",
        "float": "a number",
        "text": "a text",
        "list": "a list",
        "object": "a mapping",
        "any": "a value",
    }
    return words[kind]


def nearest(name: str, known: Collection[str], otherwise: str) -> str:
    """Return a remedy for a name that is not known: the nearest one, or all there are."""
    close = difflib.get_close_matches(name, list(known), n=1)
    if close:
        return f"did you mean '{close[0]}'?"
    return f"known are: {', '.join(sorted(known))}" if known else otherwise
