"""The rule table of a recipe: its events and actions as data, its functions by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pydantic import ValidationError

from kompass.components.base.component import Component
from kompass.invalid import first_invalid
from kompass.recipe.action import Action
from kompass.recipe.action_data import ActionData, uses_of
from kompass.recipe.event import Event, slug
from kompass.recipe.fallbacks import FallbackSequence, fallback_actions, fallback_rules
from kompass.recipe.function_names import FunctionNames
from kompass.recipe.parsed import Parsed
from kompass.rulebook.permissions import NOTHING_OPENED, Opened
from kompass.rules.schema.actions import Action as RuleAction
from kompass.rules.schema.actions import SendGoal
from kompass.rules.schema.conditions import CallableCondition
from kompass.rules.schema.describe import describe
from kompass.rules.schema.events import Event as RuleEvent
from kompass.rules.schema.events import Parallel
from kompass.rules.schema.table import Rule, Table


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
    components
        Of the launcher, as the functions hold them.
    """

    table: Table = field(default_factory=Table)
    functions: dict[str, Callable[..., Any] | Parsed | FallbackSequence] = field(
        default_factory=dict
    )
    polled: dict[str, Callable[[], Any]] = field(default_factory=dict)
    opened: Opened = NOTHING_OPENED
    components: tuple[Component, ...] = ()


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
    made = RecipeRules(components=tuple(components))
    given: dict[Event, list[Any]] = {}
    for event, value in events_actions.items():
        if not isinstance(event, Event):
            raise TypeError(f"events_actions: {event!r} is not an event")
        given[event] = list(value) if isinstance(value, list | tuple) else [value]
        if not given[event]:
            raise ValueError(
                f"events_actions: {event!r} has no action; give it one, or leave it out"
            )
    listed = [action for actions in given.values() for action in actions]
    fallbacks = {component: fallback_actions(component) for component in components}
    names = FunctionNames(
        [
            *(event.function.use for event in given if event.function is not None),
            *uses_of(listed),
            *(use for each in fallbacks.values() for use in uses_of(each.all())),
        ]
    )
    by_name = {component.node_name: component for component in components}
    data_of = ActionData(by_name, names, made.functions)
    rules: list[Rule] = []
    for event, actions in given.items():
        where = f"events_actions: {event!r}"
        data = tuple(data_of.of(action, where) for action in actions)
        rules.append(_rule(event, data, {rule.id for rule in rules}, made, names, data_of))
    for component in components:
        rules += fallback_rules(component, fallbacks[component], data_of)
    made.table = Table(rules=tuple(rules))
    return made


def _rule(
    event: Event,
    actions: tuple[RuleAction, ...],
    taken: set[str],
    made: RecipeRules,
    names: FunctionNames,
    data_of: ActionData,
) -> Rule:
    rule_event = _named(event, made, names)
    text = describe(rule_event.condition)
    stated = event.rule_fields.get("id")
    wanted = stated or slug(event.name or text)
    if (event.name or stated) and wanted in taken:
        raise ValueError(f"two events are called {stated or event.name!r}; names must differ")
    # A goal runs for minutes; the next one is to take over and not to be dropped meanwhile.
    goal = any(isinstance(data_of.base_of(action), SendGoal) for action in actions)
    if goal and "mode" not in event.event_fields:
        rule_event = rule_event.model_copy(update={"mode": Parallel()})
    fields: dict[str, Any] = {"name": event.name or text, **event.rule_fields}
    fields["id"] = _free(wanted, taken)
    try:
        return Rule(event=rule_event, actions=actions, source="recipe", **fields)
    except ValidationError as error:
        where, value, said = first_invalid(error)
        raise ValueError(f"{event!r}: {where} = {value!r}: {said}") from None


def _named(event: Event, made: RecipeRules, names: FunctionNames) -> RuleEvent:
    """The event with the name by which its function is known."""
    condition = event.rule_event.condition
    if event.function is None or not isinstance(condition, CallableCondition):
        return event.rule_event
    name = names.of(event.function.use)
    made.polled[name] = event.function
    named = condition.model_copy(update={"name": name})
    return event.rule_event.model_copy(update={"condition": named})


def _free(wanted: str, taken: set[str]) -> str:
    name, number = wanted, 2
    while name in taken:
        name, number = f"{wanted}-{number}", number + 1
    return name
