"""What rules can be made of on the running robot, for forms that need no typing of type names."""

from typing import Literal

from pydantic import Field, JsonValue

from kompass.rules.schema.model import Model


class FieldView(Model):
    """A field of a message, however deep.

    Attributes
    ----------
    path
        As in :class:`kompass.rules.schema.signals.Signal`; text as ``pose.position.x``.
    kind
        Sort of the value; a list of ``element``.
    constants
        Names and values of constants of the message that go with it (``ALGORITHM_FAILURE``).
    """

    path: tuple[str | int, ...]
    text: str
    kind: Literal["bool", "int", "float", "text", "message", "list"]
    element: str = ""
    constants: dict[str, int] = Field(default_factory=dict)


class TopicView(Model):
    """A topic on the graph.

    Attributes
    ----------
    rate
        Hz as last measured by the monitor; None where it does not listen, or nothing comes.
    silent
        Seconds since the last message, or since the monitor began to listen to a topic that has
        never spoken; None where it does not listen, or messages come.
    """

    name: str
    type: str
    latched: bool
    publishers: int
    component: str = ""  # whose status it is
    rate: float | None = None
    silent: float | None = None


class ParameterView(Model):
    """A parameter of a component that rules may change."""

    name: str
    kind: str
    value: JsonValue = None
    text: str = ""


class MethodView(Model):
    """A method of a component that rules may call."""

    name: str
    text: str
    arguments: tuple[ParameterView, ...] = ()


class ComponentView(Model):
    """A component of the stack."""

    name: str
    kind: str
    methods: tuple[MethodView, ...]
    parameters: tuple[ParameterView, ...]


class TargetView(Model):
    """A service or an action server on the graph, with the fields of a request or a goal."""

    name: str
    type: str


class GraphView(Model):
    """All of it.

    Attributes
    ----------
    types
        Fields of every message, request (``…_Request``) and goal (``…_Goal``) type named anywhere
        in here.
    refused
        What rules of an operator (``edited``) and of an engineer may not do, whatever they say
        besides: an action's kind and what it is for, as ``publish:cmd_vel``,
        ``lifecycle:drive_manager:stop`` or ``method:controller:reconfigure``.
    """

    topics: tuple[TopicView, ...]
    types: dict[str, tuple[FieldView, ...]]
    components: tuple[ComponentView, ...]
    services: tuple[TargetView, ...]
    actions: tuple[TargetView, ...]
    functions: tuple[str, ...]  # of the recipe
    refused: dict[Literal["edited", "engineer"], tuple[str, ...]] = Field(default_factory=dict)
