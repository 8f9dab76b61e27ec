"""Components in functions of the recipe: their actions are called for real, and no more is reached.

A function of the recipe runs in the monitor's process. The component that it names is a copy there,
from before the processes parted: it has no node, and its settings are those of the start. So the
copies are made handles: a component action is called where the component runs, and what would be
that of the copy, without a word, is refused.
"""

from __future__ import annotations

import asyncio
import inspect
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Future
from typing import Any

from kompass.components.base.actions import actions_of, fitted_call
from kompass.components.base.component import Component

# Calls an action of a component, by node name, and gives its result.
Reach = Callable[[str, str, Mapping[str, Any]], Future[Any]]

# What is the same in every process for as long as the stack runs.
_FIXED = frozenset(
    {
        *("node_name", "status_topic", "available_actions", "inputs_keys", "outputs_keys"),
        *("main_action_type", "main_action_name", "ui_main_action_input", "config_class"),
    }
)


class NotReached(RuntimeError):
    """A function of the recipe asked for something of a component that lives elsewhere."""


def make_handles(components: Iterable[Component], reach: Reach | None) -> None:
    """Turn this process's copies of components into handles of the real ones.

    Parameters
    ----------
    components
        Of the launcher; changed in place, as the functions of the recipe hold them.
    reach
        Calls an action; None in a process from where none can be called.
    """
    for component in components:
        component.__class__ = _handle_class(type(component), reach)


def _handle_class(kind: type[Component], reach: Reach | None) -> type[Component]:
    actions = actions_of(kind)

    def get(self: Component, name: str) -> Any:
        if name.startswith("__") or name in _FIXED:
            return object.__getattribute__(self, name)
        node = object.__getattribute__(self, "node_name")
        if name in actions and reach is not None:
            return _action(node, name, object.__getattribute__(self, name), reach)
        if name not in object.__getattribute__(self, "__dict__"):
            constant = inspect.getattr_static(kind, name)  # AttributeError for what there is not
            if not callable(constant) and not hasattr(constant, "__get__"):
                return constant
        raise NotReached(
            f"{node}.{name} is not reached from here: {node} runs in a process of its own; "
            + _remedy(actions if reach is not None else ())
        )

    def put(self: Component, name: str, value: Any) -> None:
        node = object.__getattribute__(self, "node_name")
        raise NotReached(
            f"{node}.{name} = {value!r} is not possible from here: {node} runs in a process of its "
            f"own; call {node}.set_param({name!r}, {value!r}), or let a rule do it "
            "(update_parameter)"
        )

    more = {"__getattribute__": get, "__setattr__": put, "__module__": kind.__module__}
    made: type[Component] = type(kind.__name__, (kind,), more)
    return made


def _remedy(actions: Iterable[str]) -> str:
    callable_ = ", ".join(actions)
    call = f"call one of its actions ({callable_})" if callable_ else "let a rule do it"
    return f"{call}, take a value from its topics, or read settings before launcher.bringup()"


def _action(node: str, name: str, method: Any, reach: Reach) -> Callable[..., Any]:
    """An action of a component, to be called as in its own process."""
    signature = inspect.signature(method)

    def call(*args: Any, **kwargs: Any) -> Any:
        try:
            given = dict(signature.bind(*args, **kwargs).arguments)
        except TypeError as error:
            fitted_call(node, method, kwargs)  # tells what it takes, where that is by name
            raise TypeError(f"{node}.{name}: {error}") from None
        for key in list(given):
            if signature.parameters[key].kind is inspect.Parameter.VAR_KEYWORD:
                given.update(given.pop(key))
        answer = reach(node, name, given)
        if inspect.iscoroutinefunction(method) and _in_loop():
            return _awaited(answer)
        return answer.result()

    return call


def _in_loop() -> bool:
    try:
        asyncio.get_running_loop()
    except RuntimeError:
        return False
    return True


async def _awaited(answer: Future[Any]) -> Any:
    return await asyncio.wrap_future(answer)
