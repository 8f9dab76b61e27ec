"""Actions of a recipe, and what they become as data."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from kompass.components.component import Component
from kompass.components.topic import Topic
from kompass.expressions import MessageField, reference_of, type_name
from kompass.recipe.messages import to_plain
from kompass.rules.actions import Action as RuleAction
from kompass.rules.actions import (
    CallService,
    Lifecycle,
    Log,
    Method,
    Publish,
    Python,
    Reconfigure,
    SendGoal,
    UpdateParameters,
)

LIFECYCLE = ("start", "stop", "restart")
# Seconds; a goal takes as long as it takes, and ends by itself.
METHOD_TIMEOUT = 120.0


@dataclass
class Parser:
    """A function of the recipe that makes an argument of an action from the message."""

    function: Callable[..., Any]
    output: str | None
    extra: dict[str, Any] = field(default_factory=dict)


class Action:
    """Something to do: a method of a component, or a function of the recipe.

    Parameters
    ----------
    method
        A bound method of a component, or any function.
    args, kwargs
        Arguments; ``topic.msg.field`` stands for the newest value of that field.

    Raises
    ------
    TypeError
        When the arguments do not fit the function.
    """

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
        self._data = _data_of(method, tuple(given), kwargs or {})

    @classmethod
    def from_data(cls, data: RuleAction) -> Action:
        """An action that is data from the start."""
        made = cls.__new__(cls)
        made.description, made.parser, made.method, made._data = "", None, None, data
        return made

    def event_parser(
        self, method: Callable[..., Any], output_mapping: str | None = None, **extra: Any
    ) -> None:
        """Make an argument from the message that triggered: ``method(msg=…, **_)``.

        ``output_mapping`` names the argument that its result becomes; without, a mapping of
        results is laid over the arguments.
        """
        if not callable(method):
            raise TypeError(f"event_parser: method = {method!r} is not a function")
        self.parser = Parser(method, output_mapping, extra)

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
    owner = getattr(method, "__self__", None)
    name = getattr(method, "__name__", type(method).__name__)
    bound = _bind(method, name, args, kwargs)
    if isinstance(owner, Component):
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
    signature = inspect.signature(method)
    try:
        bound = signature.bind_partial(*args, **kwargs).arguments
    except TypeError as error:
        raise TypeError(
            f"Action: {name}{signature} does not take {args!r} {kwargs!r}: {error}"
        ) from None
    flat: dict[str, Any] = {}
    for key, value in bound.items():
        kind = signature.parameters[key].kind
        if kind is inspect.Parameter.VAR_POSITIONAL:
            raise TypeError(f"Action: {name}: give the arguments of *{key} by name")
        flat.update(value if kind is inspect.Parameter.VAR_KEYWORD else {key: value})
    return flat


def _arguments(name: str, bound: dict[str, Any]) -> dict[str, Any]:
    made = {}
    for key, value in bound.items():
        made[key] = reference_of(value) if isinstance(value, MessageField) else to_plain(value)
        try:
            json.dumps(made[key])
        except (TypeError, ValueError):
            raise TypeError(
                f"Action: argument {key} = {value!r} of {name} cannot be stored as data; "
                "give numbers, texts, lists or mappings, or make it inside the function"
            ) from None
    return made


def _component(name: str, component: Any) -> str:
    if not isinstance(component, Component):
        raise TypeError(f"{name}: component = {component!r} is not a component")
    return component.node_name


def start(*, component: Component) -> Action:
    """Configure and activate a component."""
    return Action.from_data(
        Lifecycle(component=_component("start", component), action="start", timeout=30.0)
    )


def stop(*, component: Component) -> Action:
    """Deactivate a component."""
    return Action.from_data(
        Lifecycle(component=_component("stop", component), action="stop", timeout=30.0)
    )


def restart(*, component: Component, wait_time: float | None = None) -> Action:
    """Deactivate and activate a component."""
    name = _component("restart", component)
    if wait_time:
        return Action.from_data(
            Method(
                component=name,
                method="restart",
                kwargs={"wait_time": wait_time},
                timeout=METHOD_TIMEOUT,
            )
        )
    return Action.from_data(Lifecycle(component=name, action="restart", timeout=30.0))


def reconfigure(*, component: Component, new_config: Any, keep_alive: bool = False) -> Action:
    """Give a component a new configuration: a config object, a mapping, or the path of a file."""
    name = _component("reconfigure", component)
    dump = getattr(new_config, "model_dump", None)
    config = dump(mode="json") if dump is not None else new_config
    return Action.from_data(
        Reconfigure(component=name, config=config, keep_alive=keep_alive, timeout=30.0)
    )


def update_parameter(
    *, component: Component, param_name: str, new_value: Any, keep_alive: bool = True
) -> Action:
    """Change one parameter; name and value are checked now, not in the night."""
    return update_parameters(
        component=component,
        params_names=[param_name],
        new_values=[new_value],
        keep_alive=keep_alive,
    )


def update_parameters(
    *,
    component: Component,
    params_names: Sequence[str],
    new_values: Sequence[Any],
    keep_alive: bool = True,
) -> Action:
    """Change several parameters; all of them or none.

    Raises
    ------
    ValueError
        When there are not as many values as names, or a value does not fit its parameter.
    """
    name = _component("update_parameters", component)
    if len(params_names) != len(new_values):
        raise ValueError(
            f"update_parameters: {len(params_names)} names, but {len(new_values)} values"
        )
    values = dict(zip(params_names, new_values, strict=True))
    trial = component.config.model_copy(deep=True)
    for key, value in values.items():
        target = trial
        *path, last = key.split(".")
        for part in path:
            target = getattr(target, part)
        if last not in type(target).model_fields:
            known = ", ".join(type(target).model_fields)
            raise ValueError(f"{name} has no parameter '{key}'; known are {known}")
        setattr(target, last, value)  # validated by the model
    return Action.from_data(
        UpdateParameters(
            component=name,
            parameters={
                key: to_plain(getattr(value, "value", value)) for key, value in values.items()
            },
            keep_alive=keep_alive,
        )
    )


def send_srv_request(*, srv_name: str, srv_type: type, srv_request_msg: Any = None) -> Action:
    """Call a service of any node."""
    return Action.from_data(
        CallService(
            service=srv_name, type=type_name(srv_type), request=to_plain(srv_request_msg) or {}
        )
    )


def send_action_goal(
    *,
    action_name: str | None = None,
    action_type: type | None = None,
    action_request_msg: Any = None,
    server_name: str | None = None,
    server_type: type | None = None,
    request_msg: Any = None,
) -> Action:
    """Send a goal to an action server of any node; both generations of keywords."""
    name, kind = action_name or server_name, action_type or server_type
    if name is None or kind is None:
        raise TypeError("send_action_goal: action_name and action_type are needed")
    goal = action_request_msg if action_request_msg is not None else request_msg
    return Action.from_data(
        SendGoal(action=name, type=type_name(kind), goal=to_plain(goal) or {}, timeout=None)
    )


def publish_message(
    *,
    topic: Topic,
    msg: Any,
    publish_rate: float | None = None,
    publish_period: float | None = None,
) -> Action:
    """Publish a message: once, or at a rate, for a period or for ever."""
    return Action.from_data(
        Publish(
            topic=topic.name,
            type=type_name(topic.ros_msg_type),
            message=to_plain(msg),
            rate=publish_rate or (1.0 if publish_period else None),
            period=publish_period,
            timeout=None,
        )
    )


def log(*, msg: str, logger_name: str | None = None) -> Action:
    """Write a line to the log."""
    return Action.from_data(Log(text=f"{logger_name}: {msg}" if logger_name else msg))


def LogInfo(*, msg: str, logger_name: str | None = None) -> Action:
    """Write a line to the log."""
    return log(msg=msg, logger_name=logger_name)


class ComponentActions:
    """The same functions under the class of older recipes."""

    start = staticmethod(start)
    stop = staticmethod(stop)
    restart = staticmethod(restart)
    reconfigure = staticmethod(reconfigure)
    update_parameter = staticmethod(update_parameter)
    update_parameters = staticmethod(update_parameters)
    send_srv_request = staticmethod(send_srv_request)
    send_action_goal = staticmethod(send_action_goal)
    publish_message = staticmethod(publish_message)
    log = staticmethod(log)
