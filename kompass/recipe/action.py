"""Actions of a recipe, and what they become as data."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, get_type_hints

from pydantic import PydanticSchemaGenerationError, PydanticUserError, TypeAdapter, ValidationError

from kompass.components.base.actions import signature_text
from kompass.components.base.component import Component
from kompass.invalid import first_invalid
from kompass.named_arguments import named_arguments
from kompass.recipe.arguments import argument, refers
from kompass.recipe.functions import component_of, name_of, needed, signature_of
from kompass.recipe.parsed import Parser
from kompass.rules.schema.actions import Action as RuleAction
from kompass.rules.schema.actions import Lifecycle, Method, Python

LIFECYCLE = ("start", "stop", "restart")
# Seconds; a goal takes as long as it takes, and ends by itself.
METHOD_TIMEOUT = 120.0


class Action:
    """Something to do: a method of a component, or a function of the recipe.

    Parameters
    ----------
    method
        A bound method of a component, or any function.
    args, kwargs
        Arguments; ``topic.msg.field`` stands for the newest value of that field.
    description
        What it does, for a person.

    Raises
    ------
    TypeError
        When the arguments do not fit the function.
    """

    @named_arguments
    def __init__(
        self,
        method: Callable[..., Any],
        args: Any = (),
        kwargs: dict[str, Any] | None = None,
        description: str | None = None,
    ) -> None:
        if not callable(method):
            raise TypeError(f"Action: method = {method!r} is not a function")
        given = args if isinstance(args, tuple | list) else (args,)
        self.description = description or ""
        self.parser: Parser | None = None
        self.method: Callable[..., Any] | None = method
        self._given = tuple(given), dict(kwargs or {})
        self._data = _data_of(method, tuple(given), kwargs or {})

    @classmethod
    def from_data(cls, data: RuleAction) -> Action:
        """Make an action of data, as a rule holds it."""
        made = cls.__new__(cls)
        made.description, made.parser, made.method, made._data = "", None, None, data
        made._given = (), {}
        return made

    def event_parser(
        self, method: Callable[..., Any], output_mapping: str | None = None, **extra: Any
    ) -> None:
        """Have an argument made from the message that triggered.

        Parameters
        ----------
        method
            Called as ``method(msg=…, trigger=…, **extra)``.
        output_mapping
            Name of the argument that its result becomes; without, it returns a mapping that is
            laid over the arguments.

        Raises
        ------
        TypeError
            When the method is not a function.
        """
        if not callable(method):
            raise TypeError(f"event_parser: method = {method!r} is not a function")
        self.parser = Parser(method, output_mapping, extra)

    def missing(self) -> list[str]:
        """Names of the arguments that the function needs and nothing gives."""
        if self.method is None:
            return []
        given = set(getattr(self._data, "kwargs", ()))
        if self.parser is not None:
            if self.parser.output is None:
                return []  # what it makes is known only when it was called
            given |= {self.parser.output, *self.parser.extra}
        return needed(signature_of(self.method, "Action"), given)

    def __call__(self) -> Any:
        """Call the function here and now, as when it is the condition of an event.

        Raises
        ------
        TypeError
            When it is no function of the recipe.
        """
        if self.method is None or isinstance(getattr(self.method, "__self__", None), Component):
            raise TypeError(
                f"{self!r} is carried out by a rule; only plain functions can be called"
            )
        args, kwargs = self._given
        return self.method(*args, **kwargs)

    def to_data(self) -> RuleAction:
        """The action as a rule holds it."""
        return self._data

    @property
    def component(self) -> str | None:
        """Node name of the component that it acts on."""
        return getattr(self._data, "component", None)

    def __repr__(self) -> str:
        return f"Action({self._data!r})"


def _data_of(
    method: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]
) -> RuleAction:
    name = name_of(method)
    bound = _bind(method, name, args, kwargs)
    owner = component_of(method)
    if owner is not None and isinstance(method, functools.partial):
        raise TypeError(
            f"Action: {name} of {owner.node_name} is called in the process of {owner.node_name}, "
            f"which knows no functools.partial; write Action({owner.node_name}.{name}, kwargs=…)"
        )
    if owner is not None:
        if not owner.open_to_recipe(name):
            raise TypeError(
                f"Action: {owner.node_name}.{name} cannot be called by a rule; mark it with "
                f"@component_action, or choose one of {', '.join(owner.available_actions)}"
            )
        _check_types(method, f"{owner.node_name}.{name}", bound)
        if name in LIFECYCLE and not bound:
            return Lifecycle(component=owner.node_name, action=name, timeout=30.0)  # type: ignore[arg-type]
        return Method(
            component=owner.node_name,
            method=name,
            kwargs=_arguments(name, bound),
            timeout=METHOD_TIMEOUT,
        )
    return Python(name=name, kwargs=_arguments(name, bound), timeout=METHOD_TIMEOUT)


def _bind(
    method: Callable[..., Any], name: str, args: tuple[Any, ...], kwargs: dict[str, Any]
) -> dict[str, Any]:
    signature = signature_of(method, "Action")
    try:
        bound = signature.bind_partial(*args, **kwargs).arguments
    except TypeError as error:
        raise TypeError(
            f"Action: {name}{signature} does not take {args!r} {kwargs!r}: {error}"
        ) from None
    flat: dict[str, Any] = {}
    for key, value in bound.items():
        kind = signature.parameters[key].kind
        more = {key: value}
        if kind is inspect.Parameter.VAR_POSITIONAL:
            more = {f"*{key}": list(value)}
        elif kind is inspect.Parameter.VAR_KEYWORD:
            more = value
        twice = flat.keys() & more.keys()
        if twice:
            raise TypeError(f"Action: {name}: {min(twice)} is given twice; call one otherwise")
        flat.update(more)
    return flat


def _check_types(method: Callable[..., Any], name: str, bound: dict[str, Any]) -> None:
    """Raise TypeError when a value does not fit what the method says that it takes."""
    hints = get_type_hints(inspect.unwrap(method))
    for key, value in bound.items():
        if key not in hints or refers(value):
            continue  # what is taken from a topic is known, and checked, when the rule fires
        try:
            TypeAdapter(hints[key]).validate_python(value)
        except ValidationError as error:
            raise TypeError(
                f"Action: {name}{signature_text(inspect.signature(method))}: "
                f"{key} = {value!r}: {first_invalid(error).text}"
            ) from None
        except (PydanticSchemaGenerationError, PydanticUserError):
            continue  # a type of the recipe's own, of which nothing is known


def _arguments(name: str, bound: dict[str, Any]) -> dict[str, Any]:
    return {key: argument(name, key, value) for key, value in bound.items()}
