"""What the rules of people may touch: a list of what is allowed, and nothing beside it.

Rules of the recipe may do what the recipe says. Every other rule has the rights of the weakest
person who had a hand in it (its ``source``), when it is applied and again each time that it fires.
"""

from collections.abc import Collection, Iterator, Mapping
from typing import NamedTuple

from pydantic import JsonValue

from kompass.rulebook.views.recipe_code import functions_of
from kompass.rulebook.views.wording import describe_action
from kompass.rules.checks.catalog import ComponentSpec
from kompass.rules.schema.actions import (
    Action,
    CallService,
    CancelGoal,
    Lifecycle,
    Method,
    Publish,
    Python,
    Reconfigure,
    SendGoal,
    UpdateParameters,
)
from kompass.rules.schema.model import topic_key
from kompass.rules.schema.table import Rule, Source, Table

RELEASE = "release_stop"
RELEASE_TYPE = "kompass_interfaces/srv/ReleaseStop"
# The wheels are reached through the drive manager's gate and by no other way.
MOTION_TYPES = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")
DRIVE_MANAGER = "drive_manager"
HAND = "hand"  # topic of a drive manager, for people only
MONITOR = "monitor"
# What the gate hears and says beside the topics of its inputs and outputs; and what every node of
# the robot believes.
_OF_THE_GATE = frozenset({"drive_state", "footprint", "masks"})
_OF_ALL = frozenset({"tf", "tf_static", "clock", "rosout", "parameter_events"})
# Until the stack is known: the usual names.
_USUAL = frozenset({"control", "control_list", "scan", "odom", "cmd_vel", "emergency_stop"})
# Services that change a component or the rules, by their types: whatever they are called.
_SETTING_TYPES = frozenset(
    {f"automatika_ros_sugar/srv/{name}" for name in ("ChangeParameter", "ChangeParameters")}
    | {f"automatika_ros_sugar/srv/{name}" for name in ("ConfigureFromFile", "ExecuteMethod")}
    | {"automatika_ros_sugar/srv/ReplaceTopic"}
    | {f"rcl_interfaces/srv/{name}" for name in ("SetParameters", "SetParametersAtomically")}
    | {"lifecycle_msgs/srv/ChangeState", "kompass_interfaces/srv/SignedCall"}
)
_TABLE_TYPES = frozenset(
    f"kompass_interfaces/srv/{name}"
    for name in (
        *("ApplyRules", "ConfirmRules", "RollbackRules", "ResetRule"),
        *("ChangePlaces", "ChangeMissions", "ChangeZones"),
    )
)
_OF_MONITOR = frozenset(
    {"save_recording", "get_rules", "get_history", "get_firings", "explain_rule", "check_rules"}
    | {"describe_graph"}
)
# Services of a component that only stop the robot, or only ask.
_ASKING = frozenset({"get_state", "get_available_states", "get_parameters", "list_parameters"})
_ASKING_OF_GATE = _ASKING | {"stop"}
_ASKING_OF_OTHERS = _ASKING | {"check_goal"}
# Methods that do what there is an action for, past the checks of that action.
_SETTERS = frozenset({"set_param", "set_params", "reconfigure"})
_ENGINEER = "ask an engineer, or let the recipe open it with launcher.open_to_rules(…)"


class Opened(NamedTuple):
    """Names outside of the stack that the recipe opens to rules, without the leading slash.

    Attributes
    ----------
    topics
        Rules may publish on them.
    services
        Rules may call them.
    actions
        Rules may send goals to them and cancel these.
    """

    topics: frozenset[str] = frozenset()
    services: frozenset[str] = frozenset()
    actions: frozenset[str] = frozenset()


NOTHING_OPENED = Opened()


class Refusal(NamedTuple):
    """Why an action may not be.

    Attributes
    ----------
    field
        Of the action; empty for the action itself.
    """

    code: str
    field: str
    value: JsonValue
    text: str
    remedy: str


class Permissions:
    """What rules may touch on one robot.

    Parameters
    ----------
    components
        Of the stack, by node name.
    recipe
        The table that the recipe declares. What its rules publish on, call or send goals to is
        opened by that.
    opened
        What the recipe opens beside.
    """

    def __init__(
        self,
        components: Mapping[str, ComponentSpec],
        recipe: Table,
        opened: Opened = NOTHING_OPENED,
    ) -> None:
        self._components = components
        self._functions = functions_of(recipe)
        self._own = {rule.id: rule for rule in recipe.rules}
        self.gates = frozenset(
            {DRIVE_MANAGER, *(name for name, spec in components.items() if spec.gate)}
        )
        gates = [spec for name, spec in components.items() if name in self.gates]
        chain = [spec.hears | spec.speaks for spec in gates] or [_USUAL]
        hands = frozenset(f"{gate}/{HAND}" for gate in self.gates)
        self._chain = frozenset.union(_OF_THE_GATE, hands, *chain)
        others = {name: spec for name, spec in components.items() if name not in self.gates}
        self._heard = frozenset[str]().union(*(spec.hears for spec in others.values()))
        self._spoken = {topic: name for name, spec in others.items() for topic in spec.speaks}
        self._statuses = {
            topic: name for name in components for topic in (f"{name}/status", f"{name}_status")
        }
        self._served = frozenset[str]().union(*(spec.serves for spec in components.values()))
        self._opened = _with_recipe(opened, recipe)

    def refusal(self, rule: Rule, action: Action) -> Refusal | None:
        """Why a rule may not do something; None if it may."""
        return next(self.refusals(rule, action), None)

    def refusals(self, rule: Rule, action: Action) -> Iterator[Refusal]:
        """Walk the reasons for which a rule may not do something; none if it may."""
        if self.is_own(rule):
            return
        engineer = rule.source == "engineer"
        if isinstance(action, Python):
            if action.name not in self._functions:
                yield Refusal("foreign-function", "name", action.name, *FOREIGN)
        elif isinstance(action, Method):
            yield from self._method(action)
        elif isinstance(action, Lifecycle):
            if action.component in self.gates and action.action in ("stop", "configure"):
                yield _keeps_running(action.component, "action", action.action)
        elif isinstance(action, Reconfigure):
            yield from self._reconfigure(action)
        elif isinstance(action, UpdateParameters):
            yield from self._parameters(action)
        elif isinstance(action, Publish):
            yield from self._publish(action, engineer)
        elif isinstance(action, CallService):
            yield from self._service(action, engineer)
        elif isinstance(action, SendGoal | CancelGoal):
            yield from self._goal(action, engineer)

    def is_own(self, rule: Rule) -> bool:
        """Whether a rule is the recipe's, but for its timing and what it is called.

        What the recipe lets it do, it lets it do then and there: on this condition, and together
        with its other actions.
        """
        own = self._own.get(rule.id)
        if rule.source == "recipe" or own is None:
            return rule.source == "recipe"
        now, then = rule.event, own.event
        return (now.condition, now.clear, now.trigger, now.once) == (
            *(then.condition, then.clear, then.trigger, then.once),
        ) and list(map(_essence, rule.actions)) == list(map(_essence, own.actions))

    def is_watched(self, action: Publish) -> bool:
        """Whether it matters who could publish there, though it may say nothing.

        For a second one on the topics of velocities the robot halts.
        """
        topic = topic_key(action.topic)
        return topic in self._chain or topic in self._statuses or action.type in MOTION_TYPES

    # -- components ---------------------------------------------------------------------------

    def _method(self, action: Method) -> Iterator[Refusal]:
        if action.method.endswith(RELEASE):
            yield _resumes(action)
            return
        spec = self._components.get(action.component)
        known = spec.methods.get(action.method) if spec is not None else None
        if action.component in self.gates and (
            action.method in ("stop", "configure") or (action.method == "restart" and action.kwargs)
        ):
            yield _keeps_running(action.component, "method", action.method)
        elif action.method in _SETTERS or (known is not None and known.recipe_only):
            text = f"{action.component}.{action.method} is for rules of the recipe only"
            remedy = "choose another action: that which changes parameters can be checked"
            code = "opens-gate" if action.component in self.gates else "recipe-only"
            yield Refusal(code, "method", action.method, text, remedy)

    def _reconfigure(self, action: Reconfigure) -> Iterator[Refusal]:
        only = "only the recipe may do that"
        if action.component in self.gates:
            text = f"a new configuration of {action.component} could switch its safety off"
            yield Refusal("opens-gate", "config", None, text, only)
        elif isinstance(action.config, str):
            text = "a file can hold anything, other topics included, when it is read"
            remedy = "give the settings themselves"
            yield Refusal("recipe-only", "config", action.config, text, remedy)

    def _parameters(self, action: UpdateParameters) -> Iterator[Refusal]:
        if action.component not in self.gates:
            return
        for name, value in action.parameters.items():
            text = f"settings of {action.component}, the gate before the wheels, are the recipe's"
            remedy = f"leave {name} out, or let a rule of the recipe set it"
            yield Refusal("opens-gate", f"parameters.{name}", value, text, remedy)

    # -- the graph ----------------------------------------------------------------------------

    def _publish(self, action: Publish, engineer: bool) -> Iterator[Refusal]:
        topic = topic_key(action.topic)
        if action.type in MOTION_TYPES:
            yield Refusal(
                "bypasses-gate",
                "type",
                action.type,
                f"velocities on /{topic} would reach the wheels past the drive manager's gate",
                "send a goal, or call a method of the drive manager",
            )
        elif _odd(topic):
            yield _odd_name("topic", topic)
        elif topic in self._chain:
            text = f"/{topic} is of the gate before the wheels, which must be able to believe it"
            yield Refusal("bypasses-gate", "topic", topic, text, "publish on another topic")
        elif topic in _OF_ALL or topic in self._statuses or topic.startswith(f"{MONITOR}/"):
            text = f"what is said on /{topic} is believed by the whole robot"
            yield Refusal("speaks-for-others", "topic", topic, text, "publish on another topic")
        elif not engineer and topic not in self._opened.topics:
            if topic in self._spoken:
                text = f"only {self._spoken[topic]} speaks on /{topic}"
                yield Refusal("speaks-for-others", "topic", topic, text, _ENGINEER)
            elif topic not in self._heard:
                text = f"no component hears /{topic}, and what else does is not known"
                yield Refusal("not-opened", "topic", topic, text, _ENGINEER)

    def _service(self, action: CallService, engineer: bool) -> Iterator[Refusal]:
        service = topic_key(action.service)
        *owners, name = service.split("/")
        owner = owners[-1] if owners else ""
        if action.type == RELEASE_TYPE or name.endswith(RELEASE):
            yield _resumes(action)
        elif _odd(service):
            yield _odd_name("service", service)
        elif action.type in _TABLE_TYPES or (owner == MONITOR and name not in _OF_MONITOR):
            text = "a rule may not change rules, places or missions"
            remedy = "leave it out: a person edits them"
            yield Refusal("changes-rules", "service", service, text, remedy)
        elif owner in self.gates and name not in _ASKING_OF_GATE:
            text = f"/{service} belongs to the gate before the wheels"
            remedy = "choose the action of that kind instead, so that it can be checked"
            yield Refusal("opens-gate", "service", service, text, remedy)
        elif action.type in _SETTING_TYPES and (owner in self._components or not engineer):
            text = f"/{service} changes what a component is, its topics included"
            remedy = "choose the action of that kind instead, so that it can be checked"
            yield Refusal("recipe-only", "service", service, text, remedy)
        elif owners in ([MONITOR], *([gate] for gate in self.gates)):
            return
        elif not engineer and service not in self._opened.services:
            # A name of the same end may be another robot's.
            if len(owners) > 1 or owner not in self._components:
                text = f"what /{service} does is not known"
                yield Refusal("not-opened", "service", service, text, _ENGINEER)
            elif name not in _ASKING_OF_OTHERS:
                text = f"/{service} does more than to ask"
                yield Refusal("not-opened", "service", service, text, _ENGINEER)

    def _goal(self, action: SendGoal | CancelGoal, engineer: bool) -> Iterator[Refusal]:
        name = topic_key(action.action)
        if _odd(name):
            yield _odd_name("action", name)
        elif name.startswith(f"{MONITOR}/"):
            text = "the monitor's own actions are for people"
            yield Refusal("changes-rules", "action", name, text, "leave it out")
        elif not engineer and name not in self._served | self._opened.actions:
            text = f"what /{name} does is not known"
            yield Refusal("not-opened", "action", name, text, _ENGINEER)


FOREIGN = (
    "only functions that rules of the recipe use can be called",
    "choose one of those, or let the recipe use it",
)


def opened(
    topics: Collection[str] = (), services: Collection[str] = (), actions: Collection[str] = ()
) -> Opened:
    """Return what is opened, however the names are spelled."""
    return Opened(*(frozenset(map(topic_key, names)) for names in (topics, services, actions)))


def rights_text(source: Source) -> str:
    """Return whose rights a rule has, for a sentence."""
    return {"recipe": "the recipe", "engineer": "an engineer", "edited": "an operator"}[source]


def _with_recipe(given: Opened, recipe: Table) -> Opened:
    """Open what the recipe's own rules use: it is no secret to those who see them."""
    used = [action for rule in recipe.rules for action in rule.actions]
    goals = {each.action for each in used if isinstance(each, SendGoal | CancelGoal)}
    own = opened(
        {each.topic for each in used if isinstance(each, Publish)},
        {each.service for each in used if isinstance(each, CallService)},
        goals,
    )
    return Opened(*(one | other for one, other in zip(given, own, strict=True)))


def _essence(action: Action) -> Action:
    """Return an action without its timeout and what follows a failure, for comparison."""
    return action.model_copy(update={"timeout": None, "on_error": "abort"})


def _resumes(action: Action) -> Refusal:
    return Refusal(
        "resumes-after-stop",
        "",
        describe_action(action),
        "it would let the robot move again after STOP",
        "leave it out: a person releases the STOP",
    )


def _keeps_running(component: str, field: str, value: str) -> Refusal:
    text = f"{component} is the gate before the wheels and keeps running"
    return Refusal("opens-gate", field, value, text, "only the recipe may do that")


def _odd(name: str) -> bool:
    """Whether a name stands for another one, or for the inside of an action."""
    return any(sign in name for sign in "~{}") or any(
        part.startswith("_") for part in name.split("/")
    )


def _odd_name(field: str, name: str) -> Refusal:
    text = f"{name!r} stands for another name, or for the inside of an action"
    return Refusal("odd-name", field, name, text, "give the name itself, without '~', '{', '_'")
