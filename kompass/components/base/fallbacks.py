"""What a component is to do when it fails: plain data, which the rule monitor carries out."""

from dataclasses import dataclass
from typing import Any

KINDS = ("on_algorithm_fail", "on_component_fail", "on_system_fail", "on_fail", "on_giveup")


@dataclass(frozen=True)
class Fallback:
    """Actions in the order in which they are tried.

    Attributes
    ----------
    actions
        What to do, one after another until the component is healthy again.
    max_retries
        How often each is tried before the next; None for no limit.
    """

    actions: tuple[Any, ...]
    max_retries: int | None


@dataclass
class Fallbacks:
    """By kind of failure. The specific ones come before ``on_fail``, which stands for any."""

    on_algorithm_fail: Fallback | None = None
    on_component_fail: Fallback | None = None
    on_system_fail: Fallback | None = None
    on_fail: Fallback | None = None
    on_giveup: Fallback | None = None


def make_fallback(owner: Any, action: Any, max_retries: int | None) -> Fallback:
    """Check the actions of a fallback of the component ``owner``.

    An action is a method of the component, something that wraps one (attribute ``method``),
    something of a generic kind (attribute ``to_data``: a log entry, a message, a service call), or
    a plain function.

    Raises
    ------
    ValueError
        When there is no action, or ``max_retries`` is no number, or below 1.
    TypeError
        When an action is none, or belongs to another component.
    """
    actions = tuple(action) if isinstance(action, list | tuple) else (action,)
    if not actions or any(one is None for one in actions):
        raise ValueError(f"{owner.node_name}: a fallback needs an action, e.g. Action(x.restart)")
    counts = isinstance(max_retries, int) and not isinstance(max_retries, bool)
    if max_retries is not None and not counts:
        raise ValueError(
            f"{owner.node_name}: max_retries = {max_retries!r} is no whole number; give one, or "
            "None for no limit"
        )
    if max_retries is not None and max_retries < 1:
        raise ValueError(
            f"{owner.node_name}: max_retries = {max_retries} is below 1; None means no limit"
        )
    for one in actions:
        _check(owner, one)
    return Fallback(actions, max_retries)


def _check(owner: Any, action: Any) -> None:
    method = getattr(action, "method", action)
    target: Any = getattr(method, "__self__", None)
    known = owner.available_actions
    stranger = getattr(target, "node_name", None) or getattr(action, "component", None)
    if target is owner:
        if not owner.open_to_recipe(method.__name__):
            raise TypeError(
                f"{owner.node_name}: {method.__name__} is not a component action; "
                f"known are {', '.join(known)}"
            )
    elif isinstance(stranger, str) and stranger != owner.node_name:
        raise TypeError(
            f"{owner.node_name}: a fallback cannot be an action of '{stranger}'; "
            "wire an event on the status topic to it instead"
        )
    elif not hasattr(action, "to_data") and not callable(action):
        raise TypeError(f"{owner.node_name}: {action!r} is no action; known are {', '.join(known)}")
