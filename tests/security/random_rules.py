"""Random actions from all that is on a robot's graph, and from what an attacker would think of."""

import random
from typing import Any

from kompass.rulebook.schema.graph_view import ComponentView, GraphView

Action = dict[str, Any]
# Names that stand for others, hidden ones, and ones of other robots.
_SPELLINGS = ("{}", "/{}", "~/{}", "{{node}}/{}", "other/{}", "{}/_action/send_goal", "{}_status")
_VALUES: tuple[Any, ...] = (0, 1, -1, True, 1e9, 0.01, "", "on", "/etc/passwd", [], {}, "$msg.data")


def random_actions(source: random.Random, graph: GraphView, count: int) -> list[Action]:
    """So many actions that a rule might hold.

    Parameters
    ----------
    source
        Of chance.
    graph
        What the robot has.
    """
    makers = [_service, _service, _publish, _publish, _goal, _cancel, _method, _parameters]
    makers += [_lifecycle, _reconfigure]
    return [source.choice(makers)(source, graph) | {"timeout": 0.5} for _ in range(count)]


def _service(source: random.Random, graph: GraphView) -> Action:
    target = source.choice(graph.services)
    type_name = source.choice([target.type, target.type, source.choice(graph.services).type])
    return {
        "kind": "call_service",
        "service": _name(source, target.name),
        "type": type_name,
        "request": _fields(source, graph, f"{type_name}_Request"),
    }


def _publish(source: random.Random, graph: GraphView) -> Action:
    target = source.choice(graph.topics)
    type_name = source.choice([target.type, target.type, "geometry_msgs/msg/Twist"])
    return {
        "kind": "publish",
        "topic": _name(source, target.name),
        "type": type_name,
        "message": _fields(source, graph, type_name),
    }


def _goal(source: random.Random, graph: GraphView) -> Action:
    target = source.choice(graph.actions)
    return {"kind": "send_goal", "action": _name(source, target.name), "type": target.type}


def _cancel(source: random.Random, graph: GraphView) -> Action:
    return {"kind": "cancel_goal", "action": _name(source, source.choice(graph.actions).name)}


def _method(source: random.Random, graph: GraphView) -> Action:
    component = source.choice(graph.components)
    names = [method.name for method in component.methods]
    more = ("release_stop", "reconfigure", "set_params", "stop", "change_topic", "configure")
    return {
        "kind": "method",
        "component": component.name,
        "method": source.choice([*names, *more]),
        "kwargs": _arguments(source, component),
    }


def _arguments(source: random.Random, component: ComponentView) -> dict[str, Any]:
    named = [each.name for method in component.methods for each in method.arguments]
    return {name: source.choice(_VALUES) for name in named if source.random() < 0.2}


def _parameters(source: random.Random, graph: GraphView) -> Action:
    component = source.choice(graph.components)
    parameter = source.choice(component.parameters)
    value = source.choice([parameter.value, *_VALUES])
    return {
        "kind": "update_parameters",
        "component": component.name,
        "parameters": {source.choice([parameter.name, "robot", "frames"]): value},
    }


def _lifecycle(source: random.Random, graph: GraphView) -> Action:
    return {
        "kind": "lifecycle",
        "component": source.choice(graph.components).name,
        "action": source.choice(("start", "stop", "restart", "configure")),
    }


def _reconfigure(source: random.Random, graph: GraphView) -> Action:
    component = source.choice(graph.components)
    parameter = source.choice(component.parameters)
    config = source.choice(["/etc/passwd", "/tmp/x.yaml", {parameter.name: parameter.value}])
    return {"kind": "reconfigure", "component": component.name, "config": config}


def _fields(source: random.Random, graph: GraphView, type_name: str) -> dict[str, Any]:
    fields = graph.types.get(type_name, ())
    plain = [field for field in fields if field.kind in ("bool", "int", "float", "text")]
    chosen = [field for field in plain if source.random() < 0.3]
    return {field.text: source.choice(_VALUES) for field in chosen}


def _name(source: random.Random, name: str) -> str:
    return name if source.random() < 0.6 else source.choice(_SPELLINGS).format(name)
