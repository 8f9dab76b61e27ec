"""A function of the recipe that an event asks."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from kompass.recipe.action import Action
from kompass.recipe.function_names import Use
from kompass.recipe.functions import by_name, component_of, name_of, needed, signature_of
from kompass.rules.schema.arguments import references, resolve

RATE = 10.0  # Hz, unless stated


@dataclass(frozen=True)
class ConditionFunction:
    """Asked for its truth, with the arguments that it was given.

    Attributes
    ----------
    use
        By which it is named.
    """

    use: Use

    def __call__(self) -> Any:
        """Ask; the answer of an ``async def`` is to be awaited."""
        return by_name(self.use.function)(**self.use.given)


def condition_function(asked: Any, check_rate: float | None) -> ConditionFunction:
    """Read the function of an event: a function, or an :class:`Action` of one.

    Raises
    ------
    TypeError
        When it cannot be asked: it needs arguments, says that it returns something else than a
        truth value, or belongs to a component, which lives in another process.
    ValueError
        When it cannot be asked that often.
    """
    given: dict[str, Any] = {}
    function: Callable[..., Any] = asked
    if isinstance(asked, Action):
        if asked.method is None or asked.parser is not None:
            raise TypeError(f"Event: {asked!r} is an action and no condition; give a function")
        function, given = asked.method, getattr(asked.to_data(), "kwargs", {})
    name = name_of(function)
    owner = component_of(function)
    if owner is not None:
        raise TypeError(
            f"Event: {owner.node_name}.{name} runs in the process of {owner.node_name}, and the "
            "condition of an event in that of the monitor; compare what it publishes, as "
            f"{owner.node_name}.status_topic.msg.status"
        )
    signature = signature_of(function, "Event")
    if signature.return_annotation not in (bool, "bool", inspect.Signature.empty):
        raise TypeError(
            f"Event: {name} returns {signature.return_annotation!r}; "
            "the function of an event returns bool"
        )
    for key, value in given.items():
        if any(references(value)):
            raise TypeError(
                f"Event: {name}: {key} = {value}: whoever is asked at a rate has no message; "
                "compare the field of the topic instead"
            )
    missing = needed(signature, given)
    if missing:
        raise TypeError(
            f"Event: {name} needs {', '.join(missing)}; give it with Action({name}, kwargs={{…}})"
        )
    return ConditionFunction(Use(function, resolve(given, None), _rate(check_rate)))


def _rate(stated: float | None) -> float:
    if stated is None:
        return RATE
    fits = isinstance(stated, int | float) and not isinstance(stated, bool)
    if not fits or not math.isfinite(stated) or stated <= 0:
        raise ValueError(f"check_rate = {stated!r}: give a number of Hz above 0")
    return float(stated)
