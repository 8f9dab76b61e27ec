"""Actions by name: what a recipe can have done without writing a function for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kompass.components.base.component import Component
from kompass.components.base.parameter import with_values
from kompass.message_types import type_name
from kompass.named_arguments import named_arguments
from kompass.rclpy_ext.messages import copy_fields
from kompass.rclpy_ext.topic import Topic
from kompass.recipe.action import METHOD_TIMEOUT, Action
from kompass.recipe.arguments import argument, message_data, refers
from kompass.rules.schema.actions import (
    CallService,
    Lifecycle,
    Log,
    Method,
    Publish,
    Reconfigure,
    SendGoal,
    UpdateParameters,
)


def _component(name: str, component: Any) -> str:
    if not isinstance(component, Component):
        raise TypeError(f"{name}: component = {component!r} is not a component")
    return component.node_name


@named_arguments
def start(*, component: Component) -> Action:
    """Configure and activate a component."""
    return Action.from_data(
        Lifecycle(component=_component("start", component), action="start", timeout=30.0)
    )


@named_arguments
def stop(*, component: Component) -> Action:
    """Deactivate a component."""
    return Action.from_data(
        Lifecycle(component=_component("stop", component), action="stop", timeout=30.0)
    )


@named_arguments
def restart(*, component: Component, wait_time: float | None = None) -> Action:
    """Deactivate and activate a component.

    Parameters
    ----------
    wait_time
        Seconds in between.
    """
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


@named_arguments
def reconfigure(*, component: Component, new_config: Any, keep_alive: bool = False) -> Action:
    """Give a component a new configuration.

    Parameters
    ----------
    new_config
        A config object, a mapping, or the path of a file.
    keep_alive
        Take it while running, instead of after a restart.
    """
    name = _component("reconfigure", component)
    dump = getattr(new_config, "model_dump", None)
    config = dump(mode="json") if dump is not None else new_config
    if isinstance(config, Mapping):
        config = message_data("reconfigure", config)
    return Action.from_data(
        Reconfigure(component=name, config=config, keep_alive=keep_alive, timeout=30.0)
    )


@named_arguments
def update_parameter(
    *, component: Component, param_name: str, new_value: Any, keep_alive: bool = True
) -> Action:
    """Change one parameter; name and value are checked while the recipe is read.

    Parameters
    ----------
    keep_alive
        Take it while running, instead of after a restart.

    Raises
    ------
    ParameterError
        When there is no such parameter, or the value does not fit it.
    """
    return update_parameters(
        component=component,
        params_names=[param_name],
        new_values=[new_value],
        keep_alive=keep_alive,
    )


@named_arguments
def update_parameters(
    *,
    component: Component,
    params_names: Sequence[str],
    new_values: Sequence[Any],
    keep_alive: bool = True,
) -> Action:
    """Change several parameters; all of them or none.

    Parameters
    ----------
    params_names, new_values
        As many of the one as of the other.
    keep_alive
        Take it while running, instead of after a restart.

    Raises
    ------
    ValueError
        When there are not as many values as names.
    ParameterError
        When there is no such parameter, or a value does not fit it.
    """
    name = _component("update_parameters", component)
    if len(params_names) != len(new_values):
        raise ValueError(
            f"update_parameters: {len(params_names)} names, but {len(new_values)} values"
        )
    values = dict(zip(params_names, new_values, strict=True))
    # What is taken from a topic is known, and checked, only when the rule fires.
    with_values(
        component.config,
        {key: value for key, value in values.items() if not refers(value)},
        name,
    )
    return Action.from_data(
        UpdateParameters(
            component=name,
            parameters={key: argument("update_parameters", key, values[key]) for key in values},
            keep_alive=keep_alive,
        )
    )


@named_arguments
def send_srv_request(*, srv_name: str, srv_type: type, srv_request_msg: Any = None) -> Action:
    """Call a service of any node.

    Parameters
    ----------
    srv_request_msg
        The request; an empty one unless given.

    Raises
    ------
    ValueError
        When a field cannot hold the value that the request has.
    """
    return Action.from_data(
        CallService(
            service=srv_name,
            type=type_name(srv_type),
            request=message_data("send_srv_request", srv_request_msg),
        )
    )


@named_arguments
def send_action_goal(
    *,
    action_name: str | None = None,
    action_type: type | None = None,
    action_request_msg: Any = None,
    server_name: str | None = None,
    server_type: type | None = None,
    request_msg: Any = None,
) -> Action:
    """Send a goal to an action server of any node.

    Parameters
    ----------
    action_name, action_type, action_request_msg
        Name, type and goal; an empty goal unless given.
    server_name, server_type, request_msg
        The same in older recipes.

    Raises
    ------
    TypeError
        When there is no name or no type.
    ValueError
        When a field cannot hold the value that the goal has.
    """
    name, kind = action_name or server_name, action_type or server_type
    if name is None or kind is None:
        raise TypeError("send_action_goal: action_name and action_type are needed")
    goal = action_request_msg if action_request_msg is not None else request_msg
    return Action.from_data(
        SendGoal(
            action=name,
            type=type_name(kind),
            goal=message_data("send_action_goal", goal),
            timeout=None,
        )
    )


@named_arguments
def trigger_service(*, srv_name: str, srv_type: type) -> Action:
    """Call a service of any node with a request made from the message that triggered.

    The message is the request itself, or has fields of the same names and types.
    """
    action = send_srv_request(srv_name=srv_name, srv_type=srv_type)
    action.event_parser(_copier(srv_type.Request), "srv_request_msg")  # type: ignore[attr-defined]
    return action


@named_arguments
def trigger_action_server(*, server_name: str, server_type: type) -> Action:
    """Send a goal made from the message that triggered; see :func:`trigger_service`."""
    action = send_action_goal(server_name=server_name, server_type=server_type)
    action.event_parser(_copier(server_type.Goal), "request_msg")  # type: ignore[attr-defined]
    return action


@named_arguments
def send_component_action_server_goal(*, component: Component, request_msg: Any) -> Action:
    """Send a goal to a component's main action.

    Raises
    ------
    TypeError
        When the component has none.
    """
    name, kind = _main_action("send_component_action_server_goal", component)
    return send_action_goal(server_name=name, server_type=kind, request_msg=request_msg)


@named_arguments
def trigger_component_action_server(*, component: Component) -> Action:
    """Send a component's main action a goal made from the message that triggered."""
    name, kind = _main_action("trigger_component_action_server", component)
    return trigger_action_server(server_name=name, server_type=kind)


def _main_action(name: str, component: Component) -> tuple[str, type]:
    node = _component(name, component)
    kind = component.main_action_type
    if kind is None:
        raise TypeError(f"{name}: {node} has no action; a Planner has one")
    return f"/{component.main_action_name}", kind


def _copier(kind: type) -> Any:
    def fields_of_the_message(*, msg: Any, **_: Any) -> Any:
        return msg if isinstance(msg, kind) else copy_fields(msg, kind())

    return fields_of_the_message


@named_arguments
def publish_message(
    *,
    topic: Topic,
    msg: Any,
    publish_rate: float | None = None,
    publish_period: float | None = None,
) -> Action:
    """Publish a message: once, or again and again.

    Parameters
    ----------
    publish_rate
        How often [Hz]; once unless given.
    publish_period
        For how long [s]; for ever unless given.

    Raises
    ------
    ValueError
        When a field cannot hold the value that the message has.
    """
    return Action.from_data(
        Publish(
            topic=topic.name,
            type=type_name(topic.ros_msg_type),
            message=message_data("publish_message", msg),
            rate=publish_rate or (1.0 if publish_period else None),
            period=publish_period,
            timeout=None,
        )
    )


@named_arguments
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
    trigger_service = staticmethod(trigger_service)
    trigger_action_server = staticmethod(trigger_action_server)
    send_component_action_server_goal = staticmethod(send_component_action_server_goal)
    trigger_component_action_server = staticmethod(trigger_component_action_server)
    publish_message = staticmethod(publish_message)
    log = staticmethod(log)
