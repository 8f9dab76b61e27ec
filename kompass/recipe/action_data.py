"""Actions of a recipe as data: what is a function of the recipe stays code, known by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from kompass.components.base.component import Component
from kompass.recipe.action import Action
from kompass.recipe.function_names import FunctionNames, Use
from kompass.recipe.functions import by_name, name_of
from kompass.recipe.parsed import Parsed, ParsedCall, Parser, takes
from kompass.rules.schema.actions import Action as RuleAction
from kompass.rules.schema.actions import Method, Python, component_of, topics_in


def uses_of(actions: Iterable[Any]) -> Iterable[Use]:
    """The functions that actions need a name for; what is no action has none."""
    for action in actions:
        if not isinstance(action, Action):
            continue
        if action.method is not None and isinstance(action.to_data(), Python):
            yield Use(action.method)
        elif action.parser is not None:
            yield Use(action.parser.function)


class ActionData:
    """Translates actions, and keeps the functions that their data names.

    Parameters
    ----------
    components
        Of the launcher, by node name.
    names
        Of the functions.
    functions
        Gets them by name.
    """

    def __init__(
        self,
        components: Mapping[str, Component],
        names: FunctionNames,
        functions: dict[str, Any],
    ) -> None:
        self._components, self._names, self.functions = components, names, functions

    def of(self, action: Any, where: str) -> RuleAction:
        """An action as data; ``where`` begins the sentence of an error.

        Raises
        ------
        TypeError
            When it is no action.
        ValueError
            When it lacks an argument, or belongs to a component that was not added.
        """
        if not isinstance(action, Action):
            raise TypeError(f"{where}: {action!r} is not an action")
        data = action.to_data()
        component = component_of(data)
        if component is not None and component not in self._components:
            raise ValueError(
                f"{where}: '{component}' is not among the components of the launcher; "
                f"those are {', '.join(self._components)}"
            )
        if component is not None and isinstance(data, Method):
            # One that is not marked is for the recipe's rules, in whatever way they name it.
            self._components[component].open_to_recipe(data.method)
        parser = action.parser
        if parser is not None and parser.output is not None:
            _check_output(parser.output, data, action, where)
        missing = action.missing()
        if missing:
            raise ValueError(
                f"{where}: {action!r} lacks {', '.join(missing)}; give it with args or kwargs, or "
                "let an event_parser make it"
            )
        if isinstance(data, Python) and action.method is not None:
            name = self._names.of(Use(action.method))
            method = by_name(action.method)
            if parser is None:
                return self._register(method, name, data, data.kwargs)
            kwargs = {**data.kwargs, "msg": "$msg"}
            return self._register(ParsedCall(method, parser), name, data, kwargs)
        if parser is not None:
            # The topics from which its other arguments are taken must be listened to.
            kwargs = {f"/{topic}": f"$topic[/{topic}]" for topic in topics_in(data)}
            return self._register(Parsed(data, parser), self._title(data, parser), data, kwargs)
        return data

    def base_of(self, action: RuleAction) -> RuleAction:
        """The action behind one with a parser; others themselves."""
        entry = self.functions.get(action.name) if isinstance(action, Python) else None
        return entry.action if isinstance(entry, Parsed) else action

    def _title(self, data: RuleAction, parser: Parser) -> str:
        target = getattr(data, "action", None) or getattr(data, "service", None) or data.kind
        return f"{data.kind} {target} from {self._names.of(Use(parser.function))}"

    def _register(
        self,
        entry: Callable[..., Any] | Parsed,
        name: str,
        data: RuleAction,
        kwargs: Mapping[str, Any],
    ) -> RuleAction:
        known = self.functions.get(name)
        number, base = 2, name
        while known is not None and not _is_same(known, entry):
            name = f"{base} {number}"
            known, number = self.functions.get(name), number + 1
        self.functions[name] = entry
        return Python(name=name, kwargs=dict(kwargs), timeout=data.timeout, on_error=data.on_error)


def _check_output(output: str, data: RuleAction, action: Action, where: str) -> None:
    taken = takes(data, action.method)
    if taken is not None and output not in taken:
        name = data.kind if action.method is None else name_of(action.method)
        known = " or ".join(taken)
        remedy = f"give it {known}" if known else "it takes none; make it with a function of yours"
        raise ValueError(f"{where}: output_mapping = {output!r} is no argument of {name}; {remedy}")


def _is_same(one: Any, other: Any) -> bool:
    if isinstance(one, Parsed) and isinstance(other, Parsed):
        return one.parser is other.parser and one.action == other.action
    if isinstance(one, ParsedCall) and isinstance(other, ParsedCall):
        return one.parser is other.parser and _is_same(one.method, other.method)
    return callable(one) and callable(other) and name_of(one) == name_of(other) and one == other
