"""What forms need not offer: the actions that the guard rails refuse in any case."""

from collections.abc import Iterator
from typing import Final, Literal, TypeAlias

from pydantic import JsonValue

from kompass.rulebook.permissions import Permissions
from kompass.rulebook.schema.graph_view import GraphView
from kompass.rules.schema.actions import (
    Action,
    CallService,
    CancelGoal,
    Lifecycle,
    Log,
    Method,
    Publish,
    Reconfigure,
    SendGoal,
    UpdateParameters,
)
from kompass.rules.schema.conditions import Received
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule

Person: TypeAlias = Literal["edited", "engineer"]

_PEOPLE: Final[tuple[Person, ...]] = ("edited", "engineer")
_ID = "new-rule"


def refused(graph: GraphView, permissions: Permissions) -> dict[Person, tuple[str, ...]]:
    """Keys of the actions on this graph that rules of each kind of person may not take."""
    actions = dict(_actions(graph))
    rules = {who: _rule(who) for who in _PEOPLE}
    return {
        who: tuple(
            key for key, action in actions.items() if permissions.refusal(rule, action) is not None
        )
        for who, rule in rules.items()
    }


def _rule(source: Person) -> Rule:
    condition = Received(signal=Signal(topic="anything", type="std_msgs/msg/Empty"))
    return Rule(
        id=_ID, event=Event(condition=condition), actions=(Log(text="nothing"),), source=source
    )


def _actions(graph: GraphView) -> Iterator[tuple[str, Action]]:
    for topic in graph.topics:
        yield f"publish:{topic.name}", Publish(topic=topic.name, type=topic.type, message={})
    for service in graph.services:
        yield (
            f"call_service:{service.name}",
            CallService(service=service.name, type=service.type, request={}),
        )
    for server in graph.actions:
        yield f"send_goal:{server.name}", SendGoal(action=server.name, type=server.type, goal={})
        yield f"cancel_goal:{server.name}", CancelGoal(action=server.name)
    for component in graph.components:
        name = component.name
        for method in component.methods:
            yield f"method:{name}:{method.name}", Method(component=name, method=method.name)
        for what in ("start", "stop", "restart", "configure"):
            yield f"lifecycle:{name}:{what}", Lifecycle(component=name, action=what)
        yield f"reconfigure:{name}", Reconfigure(component=name, config={})
        if component.parameters:
            any_of_them: dict[str, JsonValue] = {component.parameters[0].name: 0}
            yield (
                f"update_parameters:{name}",
                UpdateParameters(component=name, parameters=any_of_them),
            )
