"""Actions as data: what a rule does when it fires.

A text ``"$msg.a.b[0]"`` anywhere in an argument is taken from the triggering message, and
``"$topic[/name].a.b"`` from the newest message of another topic
(:mod:`kompass.rules.schema.arguments`).
"""

from collections.abc import Iterator
from typing import Annotated, Literal, TypeAlias

from pydantic import AfterValidator, Field, JsonValue

from kompass.rules.schema.arguments import is_exactly_reference, references
from kompass.rules.schema.model import JsonObject, Model, Name, PositiveSeconds, TopicName, TypeName


def _readable(arguments: dict[str, JsonValue]) -> dict[str, JsonValue]:
    list(references(arguments))  # raises for what starts like a reference and is none
    return arguments


Arguments = Annotated[JsonObject, AfterValidator(_readable)]


class _Action(Model):
    """What all actions have.

    Attributes
    ----------
    timeout
        Seconds after which the action counts as failed; None to wait for ever.
    on_error
        Whether a failure ends the list of actions or the next one is run all the same.
    """

    timeout: PositiveSeconds | None = 10.0
    on_error: Literal["continue", "abort"] = "abort"


class Log(_Action):
    """Write a line to the log."""

    kind: Literal["log"] = "log"
    text: str
    level: Literal["debug", "info", "warning", "error"] = "info"


class Method(_Action):
    """Call a method of a component."""

    kind: Literal["method"] = "method"
    component: Name
    method: Name
    kwargs: Arguments = Field(default_factory=dict)


class Lifecycle(_Action):
    """Start, stop, restart or configure a component."""

    kind: Literal["lifecycle"] = "lifecycle"
    component: Name
    action: Literal["start", "stop", "restart", "configure"]


class Reconfigure(_Action):
    """Give a component a new configuration: a mapping, or the path of a file."""

    kind: Literal["reconfigure"] = "reconfigure"
    component: Name
    config: Arguments | str
    keep_alive: bool = False


class UpdateParameters(_Action):
    """Change parameters of a component; all of them or none."""

    kind: Literal["update_parameters"] = "update_parameters"
    component: Name
    parameters: Annotated[Arguments, Field(min_length=1)]
    keep_alive: bool = True


class Publish(_Action):
    """Publish a message: once, or at ``rate`` Hz for ``period`` seconds (for ever without)."""

    kind: Literal["publish"] = "publish"
    topic: TopicName
    type: TypeName
    message: Arguments = Field(default_factory=dict)
    rate: Annotated[float, Field(gt=0.0, le=1000.0)] | None = None
    period: PositiveSeconds | None = None


class CallService(_Action):
    """Call a service and wait for its answer."""

    kind: Literal["call_service"] = "call_service"
    service: TopicName
    type: TypeName
    request: Arguments = Field(default_factory=dict)


class SendGoal(_Action):
    """Send a goal to an action server and wait for its result."""

    kind: Literal["send_goal"] = "send_goal"
    action: TopicName
    type: TypeName
    goal: Arguments = Field(default_factory=dict)


class CancelGoal(_Action):
    """Cancel all goals of an action server."""

    kind: Literal["cancel_goal"] = "cancel_goal"
    action: TopicName


class RaiseAlarm(_Action):
    """Show an alarm to the operators until it is cleared.

    A ``text`` that is a reference is taken from the message; any other is shown as it is.
    """

    kind: Literal["raise_alarm"] = "raise_alarm"
    alarm: Name
    text: str = ""


class ClearAlarm(_Action):
    """Take an alarm back."""

    kind: Literal["clear_alarm"] = "clear_alarm"
    alarm: Name
    text: str = ""


class StartMission(_Action):
    """Begin the mission of that name, or let it wait for its turn behind the one that runs."""

    kind: Literal["start_mission"] = "start_mission"
    mission: Name


class Python(_Action):
    """Call a function of the recipe, known by name; its code cannot be edited."""

    kind: Literal["python"] = "python"
    name: Name
    kwargs: Arguments = Field(default_factory=dict)


Action: TypeAlias = Annotated[
    Log
    | Method
    | Lifecycle
    | Reconfigure
    | UpdateParameters
    | Publish
    | CallService
    | SendGoal
    | CancelGoal
    | RaiseAlarm
    | ClearAlarm
    | StartMission
    | Python,
    Field(discriminator="kind"),
]


def component_of(action: Action) -> str | None:
    """Return the component that an action acts on, if it acts on one."""
    if isinstance(action, (Method, Lifecycle, Reconfigure, UpdateParameters)):
        return action.component
    return None


def arguments_of(action: Action) -> dict[str, JsonValue]:
    """Return the arguments in which references to messages may stand; empty for most kinds."""
    if isinstance(action, (Method, Python)):
        return action.kwargs
    if isinstance(action, Reconfigure):
        return action.config if isinstance(action.config, dict) else {}
    if isinstance(action, UpdateParameters):
        return action.parameters
    if isinstance(action, Publish):
        return action.message
    if isinstance(action, RaiseAlarm):
        return {"text": action.text} if is_exactly_reference(action.text) else {}
    if isinstance(action, CallService):
        return action.request
    return action.goal if isinstance(action, SendGoal) else {}


def topics_in(action: Action) -> Iterator[str]:
    """Walk the topics, other than the triggering one, from which arguments are taken."""
    for topic, _ in references(arguments_of(action)):
        if topic is not None:
            yield topic
