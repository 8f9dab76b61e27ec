"""A rule table as JSON, as YAML, and as the part of a recipe that declares it.

The Python fragment is written with the names that recipes use, as far as these have words for a
rule; what they have none for is written as data. Read with the components of the stack in scope
(under their node names), it defines ``events_actions``, which gives the same rules again.
"""

from __future__ import annotations

import json
import keyword
import re
from collections.abc import Iterable, Iterator
from typing import Any, Literal, get_args

from pydantic import BaseModel, JsonValue

from kompass.rulebook.views.recipe_code import functions_in
from kompass.rulebook.views.wording import describe_rule
from kompass.rules import schema
from kompass.rules.schema.actions import (
    Action,
    Lifecycle,
    Log,
    Method,
    Python,
    UpdateParameters,
    arguments_of,
    component_of,
)
from kompass.rules.schema.conditions import (
    AllOf,
    AnyOf,
    CallableCondition,
    Compare,
    Condition,
    Not,
    Received,
    children,
    leaves,
)
from kompass.rules.schema.events import Event, Single
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table

Format = Literal["json", "yaml", "python"]
# What the functions of :mod:`kompass.actions` set by themselves; s.
_TIMEOUTS: dict[type, float] = {Log: 10.0, Lifecycle: 30.0, UpdateParameters: 10.0, Method: 120.0}
_FALLBACK = re.compile(
    r"(?P<component>.+) (on fail|on algorithm fail|on component fail|on system fail|recovered)"
)
# Names that the text uses itself.
_TAKEN = {
    "events_actions",
    "data",
    *("Topic", "Action", "Expression", "QoSConfig", "DurabilityPolicy", *schema.__all__),
    *("log", "start", "stop", "restart", "update_parameter", "update_parameters"),
}
_ACTIONS = get_args(Action)[0]
_SEVERITY, _LANE = "warning", "normal"


def export(table: Table, form: Format, *, title: str = "") -> str:
    """Return a table as text.

    Parameters
    ----------
    form
        ``json`` and ``yaml`` can be applied again; ``python`` is for a recipe.
    title
        Where it comes from, for the first line of the Python text.

    Raises
    ------
    ValueError
        If there is no such form.
    """
    if form == "json":
        return to_json(table)
    if form == "yaml":
        return to_yaml(table)
    if form == "python":
        return to_python(table, title=title)
    raise ValueError(f"format {form!r} is not known; known are: json, yaml, python")


def to_json(table: Table) -> str:
    """Return a table as JSON, indented."""
    return json.dumps(table.model_dump(mode="json"), indent=2, ensure_ascii=False) + "\n"


def to_yaml(table: Table) -> str:
    """Return a table as YAML for a person to edit: what is as usual is left out."""
    import yaml

    data = {"rules": [_told(rule) for rule in table.rules]}
    text: str = yaml.safe_dump(data, sort_keys=False, allow_unicode=True, width=100)
    return text


def _told(model: BaseModel) -> dict[str, Any]:
    """The fields that differ from their defaults, after the kind that tells the model."""
    dumped = model.model_dump(mode="json")
    told: dict[str, Any] = {"kind": dumped["kind"]} if "kind" in dumped else {}
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        if name == "kind" or value == field.get_default(call_default_factory=True):
            continue
        if isinstance(value, BaseModel):
            told[name] = _told(value)
        elif isinstance(value, tuple) and any(isinstance(item, BaseModel) for item in value):
            told[name] = [_told(item) for item in value]
        else:
            told[name] = dumped[name]
    return told


def to_python(table: Table, *, title: str = "") -> str:
    """Return a table as the part of a recipe that declares it.

    Rules that come from the fallbacks of a component (``component.on_fail(…)``) are named in a
    comment and left out: the components declare them.
    """
    return _Fragment(table).text(title)


class _Fragment:
    """Collects what the rules need: topics, functions, components and imports."""

    def __init__(self, table: Table) -> None:
        self._topics: dict[tuple[str, str, float | None], str] = {}
        self._names: set[str] = set(_TAKEN)
        self._functions: dict[str, None] = {}
        self._components: dict[str, None] = {}
        self._ros: set[str] = {"Event"}
        self._actions: set[str] = set()
        self._schema: set[str] = set()  # names of kompass.rules.schema
        self._with_expression = self._with_data = self._latched = False
        self._left_out = [rule for rule in table.rules if _is_fallback(rule)]
        kept = [rule for rule in table.rules if not _is_fallback(rule)]
        self._reserve(kept)
        self._rules = [self._rule(rule) for rule in kept]

    def _reserve(self, rules: Iterable[Rule]) -> None:
        """Keep the names of components and functions from being used for topics."""
        for rule in rules:
            self._names.update(map(_identifier, functions_in(rule)))
            self._names.update(_identifier(c) for a in rule.actions if (c := component_of(a)))

    # -- the text -----------------------------------------------------------------------------

    def text(self, title: str) -> str:
        of = f" of {title}" if title else ""
        parts = [f"# Rules{of}, as a recipe declares them."]
        parts += self._imports()
        parts += self._needed()
        parts += [f"{name} = {self._topic(*key)}" for key, name in self._topics.items()]
        parts += ["", "events_actions = {"]
        for lines in self._rules:
            parts += [f"    {line}" if line else "" for line in lines]
        parts += ["}"]
        for rule in self._left_out:
            action = rule.actions[0]
            assert isinstance(action, Python)
            component = _FALLBACK.fullmatch(action.name)
            assert component is not None
            parts.append(
                f"# '{rule.id}' is a fallback of {component['component']}: "
                "declared with its on_fail(…) and the like"
            )
        return "\n".join(parts) + "\n"

    def _imports(self) -> Iterator[str]:
        if self._latched:
            self._ros.add("QoSConfig")
            yield "from rclpy.qos import DurabilityPolicy"
            yield ""
        if self._actions:
            yield f"from kompass.actions import {', '.join(sorted(self._actions))}"
        if self._with_expression:
            yield "from kompass.expressions import Expression"
        if self._topics:
            self._ros.add("Topic")
        yield f"from kompass.ros import {', '.join(sorted(self._ros))}"
        if self._with_data:
            yield "from kompass.rules import actions as data"
        if self._schema:
            yield f"from kompass.rules.schema import {', '.join(sorted(self._schema))}"

    def _needed(self) -> Iterator[str]:
        yield ""
        if self._components:
            yield f"# Components of the recipe: {', '.join(self._components)}"
        if self._functions:
            yield f"# Functions of the recipe, which must stand above: {', '.join(self._functions)}"
        if self._components or self._functions:
            yield ""

    def _topic(self, name: str, kind: str, timeout: float | None) -> str:
        text = f'Topic(name="/{name}", msg_type="{kind}"'
        if timeout is None:
            return f"{text}, qos_profile=QoSConfig(durability=DurabilityPolicy.TRANSIENT_LOCAL))"
        return f"{text})" if timeout == 1.0 else f"{text}, data_timeout={timeout!r})"

    # -- rules --------------------------------------------------------------------------------

    def _rule(self, rule: Rule) -> list[str]:
        fields = ", ".join([repr(rule.id), *self._stated(rule)])
        lines = ["", f"# {describe_rule(rule)}"]
        lines.append(f"{self._event(rule.event)}.as_rule({fields}): [")
        lines += [f"    {self._action(action)}," for action in rule.actions]
        return [*lines, "],"]

    def _event(self, event: Event) -> str:
        condition = event.condition
        more = []
        if isinstance(condition, CallableCondition) and self._callable(condition):
            first = _identifier(condition.name)
            self._functions[condition.name] = None
            more.append(f"check_rate={condition.rate!r}")
        elif isinstance(condition, Received) and not condition.signal.path:
            first = self._topic_of(condition.signal)
        else:
            first = self._condition(condition)
        if event.trigger == "edge":
            more.append("on_change=True")
        if event.once:
            more.append("handle_once=True")
        if event.cooldown:
            more.append(f"keep_event_delay={event.cooldown!r}")
        return f"Event({', '.join([first, *more])})"

    def _callable(self, condition: CallableCondition) -> bool:
        """Whether the recipe's API has words for it."""
        plain = _identifier(condition.name) == condition.name and condition.timeout is None
        return plain and condition.rate is not None

    def _stated(self, rule: Rule) -> Iterator[str]:
        """Walk what must be said beside the event and the actions."""
        event = rule.event
        yield f"name={rule.name!r}"
        if event.trigger == "change":
            yield "trigger='change'"
        if event.hold:
            yield f"hold={event.hold!r}"
        if event.clear is not None:
            yield f"clear={self._condition(event.clear)}"
        goal = any(action.kind in ("send_goal", "python") for action in rule.actions)
        if event.mode != Single() or goal:
            yield f"mode={self._construct(event.mode)}"
        if event.max_rate is not None:
            yield f"max_rate={self._construct(event.max_rate)}"
        if not event.first_true_is_edge:
            yield "first_true_is_edge=False"
        for name, usual in (("enabled", True), ("protected", False), ("shadow", False)):
            if getattr(rule, name) is not usual:
                yield f"{name}={getattr(rule, name)!r}"
        if rule.severity.name.lower() != _SEVERITY:
            yield f"severity={rule.severity.name.lower()!r}"
        if rule.lane != _LANE:
            yield f"lane={rule.lane!r}"
        if rule.note:
            yield f"note={rule.note!r}"

    # -- conditions ---------------------------------------------------------------------------

    def _condition(self, condition: Condition) -> str:
        """Return a condition in the operators of recipes where they have it."""
        if isinstance(condition, (AllOf, AnyOf)) and len(condition.conditions) == 2:
            sign = " & " if isinstance(condition, AllOf) else " | "
            return sign.join(f"({self._condition(child)})" for child in children(condition))
        if isinstance(condition, Not):
            return f"~({self._condition(condition.condition)})"
        if isinstance(condition, Compare):
            text = self._compare(condition)
            if text:
                return text
        for _, leaf in leaves(condition):
            if isinstance(leaf, CallableCondition):
                self._functions[leaf.name] = None
        self._with_expression = True
        return f"Expression({self._construct(condition)})"

    def _compare(self, condition: Compare) -> str:
        signal, value = condition.signal, condition.value
        if signal.aggregate or condition.tolerance or not signal.path:
            return ""
        field = self._field(signal)
        if condition.operator in ("==", "!=", "<", "<=", ">", ">="):
            return f"{field} {condition.operator} {_literal(value)}"
        if condition.operator == "between":
            assert isinstance(value, tuple)
            low, high = value
            return f"{field}.between({_literal(low)}, {_literal(high)})"
        method = {"in": "is_in"}.get(condition.operator, condition.operator)
        return f"{field}.{method}({_literal(value)})"

    def _field(self, signal: Signal) -> str:
        text = f"{self._topic_of(signal)}.msg"
        for step in signal.path:
            text += f"[{step}]" if isinstance(step, int) else f".{step}"
        return text

    def _topic_of(self, signal: Signal) -> str:
        key = (signal.topic, signal.type, signal.timeout)
        if key not in self._topics:
            self._latched = self._latched or signal.timeout is None
            self._topics[key] = self._free(_identifier(signal.topic.replace("/", "_")))
        return self._topics[key]

    def _free(self, wanted: str) -> str:
        name, number = wanted, 2
        if name in self._names:
            name = f"{wanted}_topic"
        while name in self._names:
            name, number = f"{wanted}_topic_{number}", number + 1
        self._names.add(name)
        return name

    # -- actions ------------------------------------------------------------------------------

    def _action(self, action: Action) -> str:
        usual = action.timeout == _TIMEOUTS.get(type(action)) and action.on_error == "abort"
        # The functions of recipes take a text for a text, and mark it when it looks like another.
        plain = usual and not _has_dollar(arguments_of(action))
        if isinstance(action, Log) and plain and action.level == "info":
            return self._call("log", f"msg={action.text!r}")
        if isinstance(action, Method) and plain and (action.kwargs or action.method not in _TAKEN):
            kwargs = f", kwargs={action.kwargs!r}" if action.kwargs else ""
            self._ros.add("Action")
            return f"Action({self._component(action)}.{action.method}{kwargs})"
        if isinstance(action, Lifecycle) and plain and action.action != "configure":
            return self._call(action.action, f"component={self._component(action)}")
        if isinstance(action, UpdateParameters) and plain:
            names, values = list(action.parameters), list(action.parameters.values())
            kept = "" if action.keep_alive else ", keep_alive=False"
            given = f"component={self._component(action)}"
            if len(names) == 1:
                given += f", param_name={names[0]!r}, new_value={values[0]!r}{kept}"
                return self._call("update_parameter", given)
            given += f", params_names={names!r}, new_values={values!r}{kept}"
            return self._call("update_parameters", given)
        if isinstance(action, Python):
            self._functions[action.name] = None
        self._ros.add("Action")
        self._with_data = True
        return f"Action.from_data(data.{self._construct(action)})"

    def _call(self, function: str, arguments: str) -> str:
        self._actions.add(function)
        return f"{function}({arguments})"

    def _component(self, action: Action) -> str:
        name = component_of(action)
        assert name is not None
        self._components[name] = None
        return _identifier(name)

    # -- data ---------------------------------------------------------------------------------

    def _construct(self, model: BaseModel) -> str:
        """Return the call that makes a model, with what is not as it is by default."""
        name = type(model).__name__
        if not isinstance(model, _ACTIONS):
            self._schema.add(name)
        given = []
        for key, field in type(model).model_fields.items():
            value = getattr(model, key)
            usual = None if field.is_required() else field.get_default(call_default_factory=True)
            if key != "kind" and (field.is_required() or value != usual):
                given.append(f"{key}={self._construct_value(value)}")
        return f"{name}({', '.join(given)})"

    def _construct_value(self, value: Any) -> str:
        if isinstance(value, BaseModel):
            return self._construct(value)
        if isinstance(value, tuple):
            items = [self._construct_value(item) for item in value]
            return f"({', '.join(items)}{',' if len(items) == 1 else ''})"
        return repr(value)


def _has_dollar(value: JsonValue) -> bool:
    """Whether a reference, or a text that begins like one, is among some arguments."""
    if isinstance(value, str):
        return value.startswith("$")
    items = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return any(map(_has_dollar, items))


def _is_fallback(rule: Rule) -> bool:
    action = rule.actions[0]
    return (
        len(rule.actions) == 1
        and isinstance(action, Python)
        and _FALLBACK.fullmatch(action.name) is not None
        and re.sub(r"[ _]", "-", action.name) == rule.id
    )


def _identifier(name: str) -> str:
    """Return a name as a variable of Python."""
    made = re.sub(r"\W", "_", name)
    if not made or made[0].isdigit():
        made = f"_{made}"
    return f"{made}_" if keyword.iskeyword(made) else made


def _literal(value: Any) -> str:
    return repr(list(value)) if isinstance(value, tuple) else repr(value)
