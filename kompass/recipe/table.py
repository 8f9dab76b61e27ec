"""The rule table of a recipe: its events and actions as data, its functions by name."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from kompass.components.base.component import Component
from kompass.recipe.action import Action, Parser
from kompass.recipe.event import Event
from kompass.recipe.fallbacks import FallbackSequence, fallback_rules
from kompass.rulebook.permissions import NOTHING_OPENED, Opened
from kompass.rules.schema.actions import Action as RuleAction
from kompass.rules.schema.actions import Method, Python, SendGoal, component_of
from kompass.rules.schema.describe import describe
from kompass.rules.schema.events import Parallel
from kompass.rules.schema.table import Rule, Table


@dataclass(frozen=True)
class Parsed:
    """An action whose argument a function of the recipe makes from the message."""

    action: RuleAction
    parser: Parser


@dataclass
class RecipeRules:
    """What the monitor runs: data, and the code that the data names.

    Attributes
    ----------
    functions
        What opaque actions do, by name.
    polled
        Conditions that are functions, by name.
    opened
        Names outside of the stack that rules of people may use.
    """

    table: Table = field(default_factory=Table)
    functions: dict[str, Callable[..., Any] | Parsed | FallbackSequence] = field(
        default_factory=dict
    )
    polled: dict[str, Callable[[], bool]] = field(default_factory=dict)
    opened: Opened = NOTHING_OPENED


def recipe_rules(
    events_actions: Mapping[Event, Action | Sequence[Action]], components: Sequence[Component]
) -> RecipeRules:
    """Translate a recipe's events and actions.

    Raises
    ------
    TypeError
        When a key is not an event, or a value not an action.
    ValueError
        When an action belongs to a component that was not added, or two events have one name.
    """
    made = RecipeRules()
    names = {component.node_name: component for component in components}
    rules: list[Rule] = []
    for event, value in events_actions.items():
        if not isinstance(event, Event):
            raise TypeError(f"events_actions: {event!r} is not an event")
        actions = list(value) if isinstance(value, list | tuple) else [value]
        data = tuple(_action(action, event, names, made) for action in actions)
        rules.append(_rule(event, data, {rule.id for rule in rules}, made))
    for component in components:
        rules += fallback_rules(component, made.functions)
    made.table = Table(rules=tuple(rules))
    return made


def _rule(
    event: Event, actions: tuple[RuleAction, ...], taken: set[str], made: RecipeRules
) -> Rule:
    text = describe(event.rule_event.condition)
    stated = event.rule_fields.get("id")
    wanted = stated or slug(event.name or text)
    if (event.name or stated) and wanted in taken:
        raise ValueError(f"two events are called {stated or event.name!r}; names must differ")
    rule_event = event.rule_event
    if event.function is not None:
        made.polled[rule_event.condition.name] = event.function  # type: ignore[union-attr]
    # A goal runs for minutes; the next one is to take over and not to be dropped meanwhile.
    goal = any(isinstance(_base(action, made), SendGoal) for action in actions)
    if goal and "mode" not in event.event_fields:
        rule_event = rule_event.model_copy(update={"mode": Parallel()})
    fields: dict[str, Any] = {"name": event.name or text, **event.rule_fields}
    fields["id"] = _free(wanted, taken)
    return Rule(event=rule_event, actions=actions, source="recipe", **fields)


def _base(action: RuleAction, made: RecipeRules) -> RuleAction:
    parsed = made.functions.get(action.name) if isinstance(action, Python) else None
    return parsed.action if isinstance(parsed, Parsed) else action


def _action(
    action: Any, event: Event, names: Mapping[str, Component], made: RecipeRules
) -> RuleAction:
    if not isinstance(action, Action):
        raise TypeError(f"events_actions: {event!r}: {action!r} is not an action")
    data = action.to_data()
    component = component_of(data)
    if component is not None and component not in names:
        raise ValueError(
            f"{event!r}: '{component}' is not among the components of the launcher; "
            f"those are {', '.join(names)}"
        )
    if component is not None and isinstance(data, Method):
        # One that is not marked is for the recipe's rules, however the recipe writes the action.
        names[component].open_to_recipe(data.method)
    missing = action.missing()
    if missing:
        raise ValueError(
            f"{event!r}: {action!r} lacks {', '.join(missing)}; give it with args or kwargs, or "
            "let an event_parser make it"
        )
    if action.parser is not None and isinstance(data, Python) and action.method is not None:
        parsed = _parsed_call(action.method, action.parser)
        kwargs = {**data.kwargs, "msg": "$msg"}
        return _register(made, parsed, data.name, data.model_copy(update={"kwargs": kwargs}))
    if action.parser is not None:
        return _register(made, Parsed(data, action.parser), _title(data, action.parser), data)
    if isinstance(data, Python) and action.method is not None:
        return _register(made, action.method, data.name, data)
    return data


def _parsed_call(method: Callable[..., Any], parser: Parser) -> Callable[..., Any]:
    """A function of the recipe that takes what another one makes of the message."""

    def call(msg: Any, **kwargs: Any) -> Any:
        made = parser.function(msg=msg, trigger=msg, **parser.extra)
        return method(**{**kwargs, **({parser.output: made} if parser.output else made)})

    return call


def _title(data: RuleAction, parser: Parser) -> str:
    target = getattr(data, "action", None) or getattr(data, "service", None) or data.kind
    return f"{data.kind} {target} from {parser.function.__name__}"


def _register(
    made: RecipeRules, entry: Callable[..., Any] | Parsed, name: str, data: RuleAction
) -> RuleAction:
    known = made.functions.get(name)
    number = 2
    base = name
    while known is not None and known != entry:
        name = f"{base} {number}"
        known, number = made.functions.get(name), number + 1
    made.functions[name] = entry
    kwargs = data.kwargs if isinstance(data, Python) else {}
    return Python(name=name, kwargs=kwargs, timeout=data.timeout, on_error=data.on_error)


def slug(text: str) -> str:
    """Turn a name or a condition into an identifier of small letters, digits and dashes."""
    words = {
        "==": "is",
        "!=": "is-not",
        "<=": "at-most",
        ">=": "at-least",
        "<": "below",
        ">": "above",
    }
    for sign, word in words.items():
        text = text.replace(sign, f" {word} ")
    made = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:80]
    return made or "rule"


def _free(wanted: str, taken: set[str]) -> str:
    name, number = wanted, 2
    while name in taken:
        name, number = f"{wanted}-{number}", number + 1
    return name
