"""The base of all components: declared by the recipe, alive in a process, open to rules."""

import inspect
import re
import traceback
from collections.abc import Awaitable, Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from automatika_ros_sugar.msg import ComponentStatus
from rclpy.task import Future

from kompass.access.gatekeeper import Gatekeeper
from kompass.bus.clock import SYSTEM, Clock
from kompass.bus.node import LifecycleNode, MakeNode
from kompass.components.base.actions import (
    ActionRefused,
    ActionSpec,
    actions_of,
    component_action,
    fitted_call,
    undecorated,
)
from kompass.components.base.attributes import mistaken_attribute
from kompass.components.base.component_config import (
    NO_ROBOT,
    ComponentConfig,
    ComponentRunType,
)
from kompass.components.base.config_file import ConfiguredTopics, settings_of_file
from kompass.components.base.fallbacks import Fallbacks, make_fallback
from kompass.components.base.health import HEALTHY_TEXT, Health, StatusPublisher
from kompass.components.base.hooks import check_hooks
from kompass.components.base.main_interfaces import MainAction, MainService
from kompass.components.base.message_callback import message_callback
from kompass.components.base.node import ComponentNode
from kompass.components.base.parameter import ParameterError, with_values
from kompass.components.base.ports import (
    Input,
    InputPorts,
    Output,
    OutputPorts,
    Place,
    PortView,
)
from kompass.components.base.services import ComponentServices
from kompass.components.base.topics import DeclaredTopics, by_key
from kompass.named_arguments import named_arguments
from kompass.rclpy_ext.topic import AllowedTopics, QoSConfig, Topic
from kompass.robot import RobotConfig, RobotFrames
from kompass.settings import notice_once

RATES = ("loop_rate", "status_rate")
MOST_TEXTS = 200  # warnings that are remembered, so as not to repeat them
# What ROS takes for a node, and leaves room for the names of its topics (255 in all).
_NODE_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,199}")


class Component:
    """A lifecycle node with declared inputs and outputs, whose actions and settings rules reach.

    The object is made when the recipe is read; its ROS node comes to life in the process that
    runs it (:meth:`create_node`). Node, status and services last from there to :meth:`leave`;
    outputs last while it is configured; inputs are open while it is active.

    Parameters
    ----------
    component_name
        Name of the node.
    config
        Settings; the default ones of the class when left out.
    config_file
        A yaml, toml or json file; its section named like the node is laid over ``config``.
    inputs, outputs
        Topics by key, instead of the default ones; or a list of topics, each of which then goes by
        its name where the class declares no keys.
    fallbacks
        What to do about its failures, as :meth:`on_fail` and its kin say it one by one.
    main_action_type, main_srv_type
        Types of the action and of the service by which it is asked to do its work; what serves
        them is ``main_action_callback`` and ``main_service_callback``.
    callback_group
        Accepted from older components; without effect, since a component has one thread.

    Raises
    ------
    ValueError, TypeError
        When a key, topic or setting is not allowed; the message names it and the remedy.
    """

    config_class: ClassVar[type[ComponentConfig]] = ComponentConfig
    allowed_inputs: ClassVar[Mapping[str, AllowedTopics]] = {}
    allowed_outputs: ClassVar[Mapping[str, AllowedTopics]] = {}
    default_inputs: ClassVar[Mapping[str, list[Topic]]] = {}
    default_outputs: ClassVar[Mapping[str, list[Topic]]] = {}
    # The first is that of a component of which the recipe says nothing.
    allowed_run_types: ClassVar[tuple[ComponentRunType, ...]] = tuple(ComponentRunType)
    # Keys of files written for other stacks that mean nothing here, with the reason: accepted, and
    # told once. What the config class ignores need not be named again.
    ignored_settings: ClassVar[Mapping[str, str]] = {}
    ignored_inputs: ClassVar[Mapping[str, str]] = {}
    # Quality of service of keys whose message type alone does not tell it.
    qos: ClassVar[Mapping[str, QoSConfig]] = {}
    # Whether it does not become active before somebody described the robot.
    needs_robot: ClassVar[bool] = False
    # Whether it must end before all others, because it is what halts the robot.
    stops_robot: ClassVar[bool] = False
    # Whether it has what stops the robot drive it by actions; its death halts the robot then.
    asks_for_motion: ClassVar[bool] = False
    # The ROS action and service by which it is asked to do its work, when it has them.
    main_action_type: ClassVar[type | None] = None
    main_srv_type: ClassVar[type | None] = None
    # Whether the class serves its main action without ``main_action_callback``.
    serves_main_action_itself: ClassVar[bool] = False
    # Whether its status says which inputs have not spoken yet, when the step says nothing.
    tells_missing_inputs: ClassVar[bool] = True
    # Whether the main loop does its step in every run type, not only in the timed one.
    steps_in_any_run_type: ClassVar[bool] = False

    @named_arguments
    def __init__(
        self,
        component_name: str | None = None,
        config: ComponentConfig | None = None,
        config_file: str | None = None,
        inputs: Mapping[str, Topic | list[Topic]] | Sequence[Topic] | None = None,
        outputs: Mapping[str, Topic | list[Topic]] | Sequence[Topic] | None = None,
        *,
        fallbacks: Fallbacks | None = None,
        main_action_type: type | None = None,
        main_srv_type: type | None = None,
        node_name: str | None = None,
        callback_group: Any = None,
        enable_health_broadcast: bool = True,
    ) -> None:
        check_hooks(type(self), Component)
        name = component_name or node_name
        if not name:
            raise ValueError(f"{type(self).__name__}: component_name is missing")
        if not (isinstance(name, str) and _NODE_NAME.fullmatch(name)):
            raise ValueError(
                f"{type(self).__name__}: component_name = {name!r} is no name of a ROS node; give "
                "letters (a to z), digits and _, at most 200, not beginning with a digit"
            )
        if not enable_health_broadcast:
            notice_once(f"{name}: the status is always published")
        if callback_group is not None:
            notice_once(f"{name}: callback_group has no effect; a component has one thread")
        if config is not None and not isinstance(config, self.config_class):
            wanted = self.config_class.__name__
            raise TypeError(f"{name}: config, a {type(config).__name__}, is not a {wanted}")
        self.node_name = name
        self.config = config.model_copy(deep=True) if config else self.config_class()
        self._run_type = self.allowed_run_types[0]
        allowed_in, topics_in = by_key(name, "input", inputs, self.allowed_inputs)
        allowed_out, topics_out = by_key(name, "output", outputs, self.allowed_outputs)
        # Those of the object, where the class leaves it to whoever makes one.
        self.allowed_inputs = allowed_in  # type: ignore[misc]
        self.allowed_outputs = allowed_out  # type: ignore[misc]
        self._topics_in = DeclaredTopics(name, "input", allowed_in, self.default_inputs)
        self._topics_out = DeclaredTopics(name, "output", allowed_out, self.default_outputs)
        if main_action_type is not None:
            self.action_type = main_action_type
        if main_srv_type is not None:
            self.service_type = main_srv_type
        self._main_action_name = self._main_srv_name = ""
        self._main_action: MainAction | None = None
        self._opened: dict[str, ActionSpec] = {}
        self.fallbacks = fallbacks or Fallbacks()
        self.health = Health()
        # What the status says of hooks that have raised, until they do not.
        self._hook_failures: dict[str, str] = {}
        self._executed_once = False
        self._told_missing = ""
        self._node: LifecycleNode | None = None
        self._status: StatusPublisher | None = None
        self._inputs = InputPorts(self.qos)
        self._outputs = OutputPorts(self.qos)
        self._timers: list[Any] = []
        self._loop: list[Any] = []
        self._idle: Any = None  # timer
        self._active_since: float | None = None
        self._logged: dict[str, float] = {}
        self.action_problem = ""
        # Told whether the component is meant to be active, for its next life.
        self.on_intent: Callable[[bool], None] | None = None
        self._keeps_intent = False
        if config_file:
            self.apply_config_file(config_file)
        self._topics_in.replace(topics_in)
        self._topics_out.replace(topics_out)

    if not TYPE_CHECKING:  # whom it would tell that any name may be set

        def __setattr__(self, name: str, value: Any) -> None:
            own = self.__dict__
            if name not in own and "config" in own:
                problem = mistaken_attribute(type(self), name, self.config, own.keys())
                if problem:
                    raise AttributeError(f"{own['node_name']}: {problem}")
            super().__setattr__(name, value)

    # -- what a recipe says -------------------------------------------------------------------

    def inputs(self, **topics: Topic | list[Topic]) -> None:
        """Replace the topics of input keys."""
        self._topics_in.replace(topics)

    def outputs(self, **topics: Topic | list[Topic]) -> None:
        """Replace the topics of output keys."""
        self._topics_out.replace(topics)

    def set_input(self, **topics: Topic | list[Topic]) -> bool:
        """As :meth:`inputs`; False when the component has no such key."""
        return self._topics_in.replace_known(topics)

    def set_output(self, **topics: Topic | list[Topic]) -> bool:
        """As :meth:`outputs`; False when the component has no such key."""
        return self._topics_out.replace_known(topics)

    @property
    def inputs_keys(self) -> list[str]:
        """Keys that take an input."""
        return list(self.allowed_inputs)

    @property
    def outputs_keys(self) -> list[str]:
        """Keys that give an output."""
        return list(self.allowed_outputs)

    def get_in_topic(self, key: str) -> Topic | list[Topic] | None:
        """The topic of an input key; a list when there are several, None when there is none."""
        return self._topics_in.topic(key)

    def get_out_topic(self, key: str) -> Topic | list[Topic] | None:
        """The topic of an output key; a list when there are several, None when there is none."""
        return self._topics_out.topic(key)

    def in_topic_name(self, key: str) -> str | list[str] | None:
        """As :meth:`get_in_topic`, names only."""
        return self._topics_in.topic_name(key)

    def out_topic_name(self, key: str) -> str | list[str] | None:
        """As :meth:`get_out_topic`, names only."""
        return self._topics_out.topic_name(key)

    @property
    def run_type(self) -> ComponentRunType:
        """What makes the component work."""
        return self._run_type_for_now or self._run_type

    @run_type.setter
    def run_type(self, value: str | ComponentRunType) -> None:
        run_type = ComponentRunType.read(value)
        if run_type not in self.allowed_run_types:
            names = ", ".join(allowed.value for allowed in self.allowed_run_types)
            raise ValueError(
                f"{self.node_name}: run_type = {run_type.value} is not possible for a "
                f"{type(self).__name__}; possible are {names}"
            )
        only = self._run_type_for_now
        if only is not None and run_type is not only:
            raise ValueError(
                f"{self.node_name}: run_type = {run_type.value} is not possible as a "
                f"{type(self).__name__} is set here; it is {only.value}"
            )
        self._run_type = run_type

    @property
    def _run_type_for_now(self) -> ComponentRunType | None:
        """The only one that the settings allow, whatever was chosen; None when they allow all."""
        return None

    @property
    def robot(self) -> RobotConfig | None:
        """The robot that the component works for; None until somebody describes it."""
        return self.config.robot

    @robot.setter
    def robot(self, value: RobotConfig | None) -> None:
        self.config.robot = value

    @property
    def frames(self) -> RobotFrames:
        """Names of the coordinate frames."""
        return self.config.frames

    @frames.setter
    def frames(self, value: RobotFrames) -> None:
        self.config.frames = value

    @property
    def loop_rate(self) -> float:
        """Rate of the main loop [Hz]."""
        return self.config.loop_rate

    @loop_rate.setter
    def loop_rate(self, value: float) -> None:
        self.config.loop_rate = value

    @property
    def status_topic(self) -> Topic:
        """Where the component publishes its health."""
        return Topic(name=f"{self.node_name}/status", msg_type=ComponentStatus)

    @property
    def action_type(self) -> type | None:
        """Type of its main action; another name of ``main_action_type``, to be set."""
        return self.main_action_type

    @action_type.setter
    def action_type(self, value: type | None) -> None:
        self.main_action_type = _interface(self.node_name, "main_action_type", "Goal", value)  # type: ignore[misc]

    @property
    def service_type(self) -> type | None:
        """Type of its main service; another name of ``main_srv_type``, to be set."""
        return self.main_srv_type

    @service_type.setter
    def service_type(self, value: type | None) -> None:
        self.main_srv_type = _interface(self.node_name, "main_srv_type", "Request", value)  # type: ignore[misc]

    @property
    def main_action_name(self) -> str:
        """Name of its main action, without the leading slash; ``<node>/<type>`` unless set.

        Raises
        ------
        TypeError
            When it has none.
        """
        if self.main_action_type is None:
            raise TypeError(f"{self.node_name}: a {type(self).__name__} has no action of its own")
        return self._main_action_name or f"{self.node_name}/{_snake(self.main_action_type)}"

    @main_action_name.setter
    def main_action_name(self, value: str) -> None:
        self._main_action_name = _interface_name(self.node_name, "main_action_name", value)

    @property
    def main_srv_name(self) -> str:
        """Name of its main service; as :attr:`main_action_name`."""
        if self.main_srv_type is None:
            raise TypeError(f"{self.node_name}: a {type(self).__name__} has no service of its own")
        return self._main_srv_name or f"{self.node_name}/{_snake(self.main_srv_type)}"

    @main_srv_name.setter
    def main_srv_name(self, value: str) -> None:
        self._main_srv_name = _interface_name(self.node_name, "main_srv_name", value)

    @property
    def ui_main_action_input(self) -> str:
        """What older recipes hand to ``launcher.enable_ui``; see :attr:`main_action_name`."""
        return self.main_action_name

    @property
    def action_specs(self) -> Mapping[str, ActionSpec]:
        """What may be called: the component actions, and what the recipe has opened."""
        return {**actions_of(type(self)), **self._opened}

    @property
    def available_actions(self) -> list[str]:
        """Names of the methods that rules may call."""
        return list(self.action_specs)

    def open_to_recipe(self, name: str) -> bool:
        """Let the rules of the recipe call a public method of one's own that is not marked.

        An ``Action`` of the recipe does so by itself. Rules that people make or change cannot call
        it: for that it must be marked with ``@component_action``.

        Returns
        -------
        bool
            False when there is no such method, or it is one of ours.
        """
        if name in self.action_specs:
            return True
        spec = undecorated(type(self), name, Component)
        if spec is not None:
            self._opened[name] = spec
        return spec is not None

    def check_declaration(self) -> None:
        """Look whether it can do what it is declared to do, before it is started.

        Raises
        ------
        ValueError, TypeError
            When a topic, a type or a hook is missing; names it and the remedy.
        """
        for word, topics in (("input", self._topics_in), ("output", self._topics_out)):
            for key in topics.missing():
                raise ValueError(
                    f"{self.node_name}: {word} '{key}' has too few topics; give them with "
                    f"{word}s={{'{key}': Topic(…)}}"
                )
        own_action = _overridden(self, "main_action_callback")
        if self.serves_main_action_itself and own_action:
            raise TypeError(
                f"{self.node_name}: main_action_callback would never be called, because a "
                f"{type(self).__name__} serves /{self.main_action_name} itself"
            )
        for given, kind, hook, run_type in (
            (self.main_srv_type, "main_srv_type", "main_service_callback", "Server"),
            (self.main_action_type, "main_action_type", "main_action_callback", "ActionServer"),
        ):
            written = _overridden(self, hook)
            if kind == "main_action_type" and self.serves_main_action_itself:
                continue
            if given is None and written:
                text = f"{hook} would never be called; say what it serves with {kind}=…"
                raise TypeError(f"{self.node_name}: {text}")
            if given is not None and not written:
                text = f"{kind} = {given.__name__}, and nothing that serves it; write {hook}"
                raise TypeError(f"{self.node_name}: {text}")
            if given is None and self.run_type.value == run_type:
                text = f"run_type = {run_type} needs {kind}=… and {hook}"
                raise TypeError(f"{self.node_name}: {text}")
        if self._steps_on_messages:
            if not _overridden(self, "_execution_step"):
                raise TypeError(f"{self.node_name}: run_type = Event needs an _execution_step")
            if not any(topics for _, topics in self._topics_in.items()):
                raise ValueError(
                    f"{self.node_name}: run_type = Event needs an input, whose messages are the "
                    "events"
                )

    # -- what it does about its own failures --------------------------------------------------

    @named_arguments
    def on_fail(
        self, action: Any = None, max_retries: int | None = None, *, fallback: Any = None
    ) -> None:
        """What to do on any failure that has no fallback of its own kind.

        ``action`` is one action or a list, tried in its order, each ``max_retries`` times (None: no
        limit); ``fallback`` is another name of it.

        Raises
        ------
        ValueError, TypeError
            When the action is missing, is none, or is one of another component.
        """
        self.fallbacks.on_fail = make_fallback(self, action or fallback, max_retries)

    @named_arguments
    def on_algorithm_fail(
        self, action: Any = None, max_retries: int | None = None, *, fallback: Any = None
    ) -> None:
        """What to do when the algorithm finds no answer; see :meth:`on_fail`."""
        self.fallbacks.on_algorithm_fail = make_fallback(self, action or fallback, max_retries)

    @named_arguments
    def on_component_fail(
        self, action: Any = None, max_retries: int | None = None, *, fallback: Any = None
    ) -> None:
        """What to do about a defect of the component itself; see :meth:`on_fail`."""
        self.fallbacks.on_component_fail = make_fallback(self, action or fallback, max_retries)

    @named_arguments
    def on_system_fail(
        self, action: Any = None, max_retries: int | None = None, *, fallback: Any = None
    ) -> None:
        """What to do when something outside is missing; see :meth:`on_fail`."""
        self.fallbacks.on_system_fail = make_fallback(self, action or fallback, max_retries)

    @named_arguments
    def on_giveup(
        self, action: Any = None, max_retries: int | None = 1, *, fallback: Any = None
    ) -> None:
        """What to do when all other fallbacks were tried in vain; see :meth:`on_fail`."""
        self.fallbacks.on_giveup = make_fallback(self, action or fallback, max_retries)

    # -- configuration files ------------------------------------------------------------------

    def apply_config_file(self, path: str) -> None:
        """Lay the sections ``/**`` and ``<node_name>`` of a file over the settings.

        Raises
        ------
        ConfigFileError
            When the file or a setting in it cannot be used; nothing is changed then.
        """
        updated, topics = self.settings_of_file(path)
        self.config = updated
        self.inputs(**topics["inputs"])
        self.outputs(**topics["outputs"])

    def settings_of_file(self, path: str) -> tuple[ComponentConfig, ConfiguredTopics]:
        """The settings and topics that :meth:`apply_config_file` would set; changes nothing."""
        return settings_of_file(
            path,
            self.node_name,
            self.config,
            {"inputs": self.allowed_inputs, "outputs": self.allowed_outputs},
            ignored_settings=self.ignored_settings,
            ignored_inputs=self.ignored_inputs,
        )

    def __repr__(self) -> str:
        return f"{type(self).__name__}('{self.node_name}')"

    # -- life --------------------------------------------------------------------------------

    @property
    def node(self) -> LifecycleNode:
        """The ROS node; only in the process that runs the component."""
        if self._node is None:
            raise RuntimeError(
                f"{self.node_name} has no ROS node yet; it is made by Launcher.bringup()"
            )
        return self._node

    @property
    def clock(self) -> Clock:
        """The time of the world that it runs in; ask it instead of the machine's."""
        return SYSTEM if self._node is None else self._node.clock

    @property
    def is_active(self) -> bool:
        """Whether the main loop runs."""
        return self._active_since is not None

    def create_node(self, namespace: str = "", make: MakeNode = ComponentNode) -> LifecycleNode:
        """Make the node and the services that everybody offers.

        Parameters
        ----------
        make
            Of a node of ROS when left out; rclpy must be initialised.
        """
        self.check_declaration()
        self._node = make(self.node_name, self, namespace)
        self._node.set_log_levels(self.config.log_level, self.config.rclpy_log_level)
        self._status = StatusPublisher(self._node, self.config.status_rate)
        self.health.set_inactive()
        self._say_while_inactive()
        self._gatekeeper = Gatekeeper(self._node)
        self.init_variables()
        self.create_interfaces()
        self._offer_main_interfaces()
        self._services = ComponentServices(self, self._gatekeeper)
        return self._node

    def _offer_main_interfaces(self) -> None:
        """Offer the main service and action; they last as long as the node."""
        if self.main_srv_type is not None:
            MainService(self, self.main_srv_type, self.main_srv_name)
        if self.main_action_type is not None and not self.serves_main_action_itself:
            self._main_action = MainAction(self, self.main_action_type, self.main_action_name)

    def leave(self) -> None:
        """Deactivate and give the node back, before the process ends."""
        self._keeps_intent = True
        if self._node is not None:
            if self.is_active:
                self._node.trigger_deactivate()
            self._node.trigger_shutdown()
            self._node.destroy_node()
            self._node = None

    # -- transitions --------------------------------------------------------------------------

    @property
    def lacks_robot(self) -> bool:
        """Whether it cannot become active, because nobody described the robot."""
        return self.needs_robot and self.config.robot is None

    def on_configure(self) -> None:
        if self.lacks_robot:
            raise ValueError(NO_ROBOT)
        try:
            self._outputs.make(self.node, self._topics_out)
            self._inputs.make(self._topics_in)
            self.init_variables()
            self.custom_on_configure()
        except Exception:
            self._give_back()
            raise

    def on_activate(self) -> None:
        try:
            self._inputs.open(self.node, self.wants_input)
            self.health.set_healthy()
            self._hook_failures = {}
            self._executed_once, self._told_missing = False, ""
            for _, port in self._inputs.walk():
                port.afterwards = self._on_input if self._steps_on_messages else None
            self._active_since = self.clock.monotonic()
            self.custom_on_activate()
            self._start_loop()
        except Exception:
            self._active_since = None
            self._close()
            raise
        self._intend(True)
        self.publish_status()

    def on_deactivate(self) -> None:
        try:
            self.custom_on_deactivate()
        finally:
            self._active_since = None
            if self._main_action is not None:
                self._main_action.withdraw()
            self._close()
            self._intend(False)
            self.health.set_inactive()
            self.publish_status()

    def _intend(self, active: bool) -> None:
        if self.on_intent is not None and not self._keeps_intent:
            self.on_intent(active)

    def on_cleanup(self) -> None:
        self.custom_on_cleanup()
        self._give_back()

    def on_shutdown(self) -> None:
        self.custom_on_shutdown()

    def on_transition_error(self, transition: str, error: Exception) -> None:
        self.health.set_fail_component([self.node_name], f"{transition} failed: {error}")
        self.node.get_logger().error(f"{transition} failed: {type(error).__name__}: {error}")
        self._guarded("custom_on_error", self.custom_on_error)
        self.publish_status()

    def on_callback_error(self, error: Exception) -> None:
        """Something that ROS called here has raised: a failure that shows, and no more."""
        text = f"{type(error).__name__}: {error}"
        self.health.set_fail_component([self.node_name], text)
        where = traceback.extract_tb(error.__traceback__)[-1]
        self.warn(f"a callback failed: {text} ({where.filename}:{where.lineno})")
        self.publish_status()

    def on_hook_error(self, hook: str, error: Exception) -> None:
        """A hook has raised: a failure that shows, until the hook does not raise or it restarts."""
        text = f"{type(error).__name__}: {error}"
        step = hook == "_execution_step"
        self.health.set_fail_component([self.node_name], text if step else f"{hook}: {text}")
        self._hook_failures[hook] = self.health.message
        where = traceback.extract_tb(error.__traceback__)[-1]
        name = "step" if step else hook
        self.warn(f"{name} failed: {text} ({where.filename}:{where.lineno})")
        self.publish_status()

    def on_hook_done(self, hook: str) -> None:
        """A hook has not raised, this time."""
        failure = self._hook_failures.pop(hook, None)
        # Unless something else has been said meanwhile.
        if failure is not None and self.health.message == failure:
            self.health.set_healthy()
            self.publish_status()

    def _guarded(self, hook: str, call: Callable[[], object]) -> None:
        try:
            call()
        except Exception as error:  # noqa: BLE001 - becomes the component's status
            self.on_hook_error(hook, error)
        else:
            self.on_hook_done(hook)

    def _close(self) -> None:
        for timer in self._timers:
            self.node.destroy_timer(timer)
        self._timers, self._loop = [], []
        self._inputs.close(self.node)

    def _say_while_inactive(self) -> None:
        """Repeat the status at its rate while no main loop does; so that silence means a defect.

        The timer stays while the component is active, for a timer that ends is a danger: what of
        it has been queued for the executor already takes the executor with it.
        """
        if self._idle is not None:
            self.node.destroy_timer(self._idle)
        self._idle = self.node.create_timer(1.0 / self.config.status_rate, self._say_inactive)

    def _say_inactive(self) -> None:
        if not self.is_active:
            self.publish_status()

    def _give_back(self) -> None:
        self._outputs.destroy()
        self._inputs.forget()

    def _start_loop(self) -> None:
        """Start the main loop, or start it again at another rate."""
        for timer in self._loop:
            self.destroy_timer(timer)
        self._loop = [self.create_timer(1.0 / self.config.loop_rate, self._tick)]
        # A slow loop must not make the component look silent.
        if self.config.loop_rate < self.config.status_rate:
            self._loop.append(self.create_timer(1.0 / self.config.status_rate, self.publish_status))

    # -- what a component overrides -----------------------------------------------------------

    def create_interfaces(self) -> None:
        """Make the services and publishers that last as long as the node, active or not."""

    def init_variables(self) -> None:
        """Make what the component needs before it runs; with the node, and at each configure."""

    def wants_input(self, key: str) -> bool:
        """Whether an input is subscribed to when the component becomes active."""
        return True

    def custom_on_configure(self) -> None:
        """After inputs and outputs are known."""

    def custom_on_activate(self) -> None:
        """Before the first step."""

    def custom_on_deactivate(self) -> None:
        """After the last step; timers and inputs are still there."""

    def custom_on_cleanup(self) -> None:
        """Give back what :meth:`custom_on_configure` took."""

    def custom_on_shutdown(self) -> None:
        """Before the process ends."""

    def custom_on_error(self) -> None:
        """After a transition has failed."""

    def on_feeder_lost(self, reason: str) -> None:
        """One that publishes its commands has died, hangs, or was stopped by a signal.

        Told only to those that stop the robot, configured or not, within milliseconds.
        """

    @property
    def longest_step(self) -> float:
        """How long a step may take by design before its process counts as stuck [s].

        What is shorter than the supervisor's own patience has no effect.
        """
        return 0.0

    def _execution_step(self) -> None:
        """One turn of the main loop, or what an event component does at each message.

        An exception becomes a component failure, which ends with the next turn that raises none.
        """

    def _execute_once(self) -> None:
        """Once in each activation, in every run type, after the first turn of the main loop."""

    def main_service_callback(self, request: Any, response: Any) -> Any:
        """Answer a request of the main service; to be overridden where there is one.

        It may be an ``async def``. Served in every run type, while the component is active.

        Returns
        -------
        Any
            The response.
        """
        raise NotImplementedError(f"{self.node_name}: main_service_callback is not written")

    def main_action_callback(self, goal_handle: Any) -> Any:
        """Pursue a goal of the main action; to be overridden where there is one.

        A plain function runs on a thread of its own and may wait; an ``async def`` runs beside the
        loop. Say how the goal ended with ``goal_handle.succeed()``, ``.abort()`` or
        ``.canceled()``; a goal of which nothing was said is aborted. Served in every run type.

        Parameters
        ----------
        goal_handle
            ``request``, ``is_cancel_requested``, ``is_active``, ``publish_feedback(…)``.

        Returns
        -------
        Any
            The result.
        """
        raise NotImplementedError(f"{self.node_name}: main_action_callback is not written")

    # -- what a component uses ----------------------------------------------------------------

    def input(self, key: str, index: int = 0) -> Input:
        """An input of the running component."""
        return self._inputs[key][index]

    def awaits(self, *sources: Input) -> list[Input]:
        """Those sources that have said nothing yet, while they still may: just after activation.

        For ``topic_subscription_timeout`` a source that has never spoken is no failure; discovery
        takes its time. One that has spoken and fell silent is.
        """
        return [source for source in sources if source.received is None and self.is_starting]

    @property
    def is_starting(self) -> bool:
        """Whether it became active less than ``topic_subscription_timeout`` ago."""
        since = self._active_since
        limit = self.config.topic_subscription_timeout
        return since is not None and self.clock.monotonic() - since <= limit

    def publish(self, key: str, message: Any, index: int = 0) -> None:
        """Publish on an output; nothing happens when the recipe took the output away."""
        self._outputs.publish(key, message, index)

    def publish_status(self, *, always: bool = False) -> None:
        """Publish the health when it changed or is due, or ``always``."""
        if self._status is not None:
            self._status.publish(self.health, always=always)

    def warn(self, text: str, every: float = 5.0) -> None:
        """Log a warning, the same one at most once in ``every`` seconds."""
        now = self.clock.monotonic()
        if now - self._logged.get(text, -float("inf")) >= every:
            if len(self._logged) >= MOST_TEXTS:  # what others say may be in them, and ever new
                self._logged.clear()
            self._logged[text] = now
            self.node.write_log("warning", text)

    def fails(self, problem: str) -> bool:
        """End a component action with False, and say why: ``return self.fails("…")``."""
        self.action_problem = problem
        self.warn(problem)
        return False

    def create_timer(self, period: float, callback: Callable[[], None]) -> Any:
        """A timer [s] that ends with the component's activity."""
        timer = self.node.create_timer(period, callback)
        self._timers.append(timer)
        return timer

    def destroy_timer(self, timer: Any) -> None:
        """End a timer of :meth:`create_timer` before that."""
        self._timers.remove(timer)
        self.node.destroy_timer(timer)

    async def sleep(self, seconds: float) -> None:
        """Wait in a component action; the loop and all services go on meanwhile."""
        over = Future(executor=self.node.executor)

        def ring() -> None:
            timer.cancel()
            over.set_result(None)

        timer = self.node.create_timer(seconds, ring)
        try:
            await over
        finally:
            self.node.destroy_timer(timer)

    @property
    def callbacks(self) -> PortView[Input]:
        """The inputs by key, and by the name of their topic: ``callbacks["level"].get_output()``.

        They are there while the component is configured; one that is not there is a KeyError.
        """
        return self._inputs.by_name(self.node_name)

    @property
    def publishers_dict(self) -> PortView[Output]:
        """The outputs by key, and by the name of their topic; see :attr:`callbacks`.

        ``publishers_dict["level"].publish(1.5)`` takes a plain value or a message.
        """
        return self._outputs.by_name(self.node_name)

    @property
    def health_status(self) -> Health:
        """Another name of :attr:`health`."""
        return self.health

    @property
    def lifecycle_state(self) -> int:
        """Number of the lifecycle's state, as in ``lifecycle_msgs/msg/State``."""
        return self.node.state_id

    def get_logger(self) -> Any:
        """The logger of the node."""
        return self.node.get_logger()

    def got_all_inputs(
        self,
        inputs_to_check: Collection[str] | None = None,
        inputs_to_exclude: Collection[str] | None = None,
    ) -> bool:
        """Whether each input has had a message since the component became active.

        Parameters
        ----------
        inputs_to_check, inputs_to_exclude
            Keys, or names of topics: look at these only, or at all but these.

        Raises
        ------
        ValueError
            When one of them is none of the inputs.
        """
        wanted = None if inputs_to_check is None else self._places_of(inputs_to_check)
        unwanted = self._places_of(inputs_to_exclude or ())
        return not any(
            port.is_open and not port.got_msg
            for place, port in self._inputs.walk()
            if (wanted is None or place in wanted) and place not in unwanted
        )

    def get_missing_inputs(self) -> list[str]:
        """Names of the topics that it listens to and that have said nothing yet."""
        ports = (port for _, port in self._inputs.walk())
        return [port.topic.name for port in ports if port.is_open and not port.got_msg]

    def _places_of(self, names: Collection[str]) -> set[Place]:
        return {self._topics_in.find(name) for name in names}

    def attach_custom_callback(
        self, input_topic: Topic | str, callback: Callable[..., object]
    ) -> None:
        """Have a function called at each message of an input, also after a restart.

        Parameters
        ----------
        input_topic
            The topic, its name, or the key of the input.
        callback
            Called with those of ``msg`` (the message), ``topic`` and ``output`` (what the message
            says) that it takes; one of a single parameter of another name gets the message.

        Raises
        ------
        ValueError
            When no input uses the topic.
        TypeError
            When it is not a function, or takes something else.
        """
        call = message_callback(self.node_name, callback)
        name = f"callback {getattr(callback, '__name__', type(callback).__name__)}"
        self._inputs.callbacks[self._topics_in.find(_name_of(input_topic))].append(
            lambda port: self._guarded(name, lambda: call(port))
        )

    def add_callback_postprocessor(
        self, input_topic: Topic | str, func: Callable[[Any], Any]
    ) -> None:
        """Have what ``get_output()`` of an input gives go through a function, after those before.

        Raises as :meth:`attach_custom_callback`.
        """
        place = self._topics_in.find(_name_of(input_topic))
        self._inputs.postprocessors[place].append(_function(self.node_name, func))

    def add_publisher_preprocessor(
        self, output_topic: Topic | str, func: Callable[[Any], Any]
    ) -> None:
        """Have what is published on an output go through a function first, after those before.

        What it returns is published; None means that nothing is. Raises as
        :meth:`attach_custom_callback`.
        """
        place = self._topics_out.find(_name_of(output_topic))
        self._outputs.preprocessors[place].append(_function(self.node_name, func))

    @contextmanager
    def safe_restart(self) -> Iterator[None]:
        """Be inactive and cleaned up during the body of a ``with``, and active after it.

        It may be used in a step, a callback or an action. An error in the body is raised after the
        restart.

        Raises
        ------
        RuntimeError
            When it does not become active again; the status is a component failure then. And on
            the thread of a goal, which cannot stop what others work with.
        """
        if self._main_action is not None and self._main_action.is_pursuing_here:
            raise RuntimeError(
                f"{self.node_name}: safe_restart is not possible on the thread of a goal; make "
                "main_action_callback an 'async def', or restart in a step"
            )
        self._down()
        try:
            yield
        finally:
            if not self.start():
                text = f"not active again after safe_restart: {self.health.message}"
                self.health.set_fail_component([self.node_name], text)
                self.publish_status()
                raise RuntimeError(f"{self.node_name}: {text}")

    @property
    def _steps_on_messages(self) -> bool:
        return self.run_type is ComponentRunType.EVENT and not self.steps_in_any_run_type

    def _tick(self) -> None:
        if self.run_type is ComponentRunType.TIMED or self.steps_in_any_run_type:
            self._guarded("_execution_step", self._execution_step)
        if self.is_active and not self._executed_once:
            self._executed_once = True
            self._guarded("_execute_once", self._execute_once)
        self._tell_missing()
        self.publish_status()

    def _on_input(self) -> None:
        """A message of an event component."""
        if self.is_active:
            self._guarded("_execution_step", self._execution_step)
            self.publish_status()

    def _tell_missing(self) -> None:
        """Say in the status of one that is well which inputs it waits for."""
        if not self.tells_missing_inputs or not self.is_active or not self.health.is_healthy:
            return
        missing = ", ".join(f"/{name}" for name in self.get_missing_inputs())
        text = f"waiting for {missing}" if missing else ""
        if self._told_missing == self.health.message or self.health.message == HEALTHY_TEXT:
            self.health.set_healthy(text)
            self._told_missing = self.health.message

    # -- actions ------------------------------------------------------------------------------

    async def call_action(self, name: str, kwargs: Mapping[str, Any]) -> Any:
        """Carry out a component action in this process.

        Returns
        -------
        Any
            What it returns: True for success, False for failure, None, or a value.

        Raises
        ------
        ActionRefused
            When there is no such action, its arguments do not fit, or it needs an active component.
        """
        spec = actions_of(type(self)).get(name) or self._opened.get(name)
        if spec is None:
            raise ActionRefused(
                f"{self.node_name} has no action '{name}'; known are "
                f"{', '.join(self.available_actions)}"
            )
        method = getattr(self, name)
        kwargs = fitted_call(self.node_name, method, kwargs)
        if spec.active and not self.is_active:
            raise ActionRefused(f"{self.node_name} is not active; start it before '{name}'")
        result = method(**kwargs)
        return await result if inspect.isawaitable(result) else result

    def answer_call(self, service: str, request: bytes) -> Awaitable[bytes]:
        """Answer a call of one of its own services by who was let in, in this process.

        Parameters
        ----------
        service
            The last part of the service's name.
        request
            As ROS serialises it; the answer too.

        Raises
        ------
        NoSuchService
            When it is not offered.
        """
        return self._services.answer(service, request)

    @component_action
    def start(self) -> bool:
        """Configure if need be, and activate."""
        node = self.node
        if node.state == "unconfigured":
            node.trigger_configure()
        if node.state == "inactive":
            node.trigger_activate()
        return self.is_active

    @component_action
    def stop(self) -> bool:
        """Deactivate; services and node stay."""
        if self.is_active:
            self.node.trigger_deactivate()
        return not self.is_active

    @component_action
    async def restart(self, *, wait_time: float | None = None) -> bool:
        """Deactivate, clean up, configure and activate; True when active again.

        Parameters
        ----------
        wait_time
            Rest between the two halves [s].
        """
        self._down()
        if wait_time:
            await self.sleep(float(wait_time))
        return self.start()

    @component_action(recipe_only=True)
    def reconfigure(
        self,
        new_config: ComponentConfig | Mapping[str, Any] | str,
        keep_alive: bool = False,
    ) -> bool:
        """Take other settings.

        Parameters
        ----------
        new_config
            Settings by name, a whole config, or the path of a file.
        keep_alive
            Take them while running, instead of after a restart.

        Raises
        ------
        ParameterError, ConfigFileError
            When one of them is refused; nothing changes then.
        """
        topics: ConfiguredTopics = {"inputs": {}, "outputs": {}}
        if isinstance(new_config, str | Path):
            config, topics = self.settings_of_file(str(new_config))
        elif isinstance(new_config, ComponentConfig):
            if not isinstance(new_config, self.config_class):
                raise ParameterError(
                    f"{self.node_name}: new_config is a {type(new_config).__name__}; "
                    f"give a {self.config_class.__name__}"
                )
            config = new_config.model_copy(deep=True)
        else:
            config = with_values(self.config, new_config, self.node_name)
        if keep_alive:
            self._take(config)
            for direction, table in (("input", topics["inputs"]), ("output", topics["outputs"])):
                for key, topic in table.items():
                    self._change_topic(direction, key, 0, topic)
            return True
        was_active = self.is_active
        self._down()
        self.config = config
        self.inputs(**topics["inputs"])
        self.outputs(**topics["outputs"])
        return self.start() if was_active else True

    @component_action(recipe_only=True)
    def set_param(self, param_name: str, new_value: Any, keep_alive: bool = True) -> bool:
        """Change one setting; see :meth:`set_params`."""
        return self.set_params([param_name], [new_value], keep_alive)

    @component_action(recipe_only=True)
    def set_params(
        self, params_names: list[str], new_values: list[Any], keep_alive: bool = True
    ) -> bool:
        """Change settings, all or none, with effect at once.

        Parameters
        ----------
        params_names
            Fields of the config; a dot leads into a nested one.
        new_values
            As many.
        keep_alive
            Change them while running; otherwise the component restarts with them.

        Raises
        ------
        ParameterError
            When one is refused; nothing changes then.
        """
        if len(params_names) != len(new_values):
            raise ParameterError(
                f"{self.node_name}: {len(params_names)} names for {len(new_values)} values; "
                "give one value for each name"
            )
        values = dict(zip(params_names, new_values, strict=True))
        return self.reconfigure(values, keep_alive)

    @component_action
    def broadcast_status(self) -> bool:
        """Publish the status now."""
        self.publish_status(always=True)
        return True

    def _down(self) -> None:
        """Deactivate and clean up, to come back soon."""
        self._keeps_intent = True
        try:
            self.stop()
            if self.node.state == "inactive":
                self.node.trigger_cleanup()
        finally:
            self._keeps_intent = False

    # -- live changes -------------------------------------------------------------------------

    def on_config_changed(self, names: set[str]) -> None:
        """Take changed settings into account; ``names`` are the config's fields that changed.

        Called while configured. An exception undoes the change.
        """

    def _take(self, config: ComponentConfig) -> None:
        old, self.config = self.config, config
        before, after = old.model_dump(), config.model_dump()
        names = {name for name in after if after[name] != before[name]}
        if not names or self._node is None:
            return
        self._node.set_log_levels(config.log_level, config.rclpy_log_level)
        if self._node.state != "unconfigured":
            self._tell_of_change(old, names)
        if self.is_active and names & set(RATES):
            self._start_loop()
        if self._status is not None and "status_rate" in names:
            self._status.set_rate(config.status_rate)
            self._say_while_inactive()

    def _tell_of_change(self, old: ComponentConfig, names: set[str]) -> None:
        """Have a change taken into account, or undo it."""
        try:
            if self.lacks_robot:
                raise ParameterError(f"{self.node_name}: 'robot' = None: {NO_ROBOT}")
            self.on_config_changed(names)
        except ParameterError:
            self.config = old
            raise
        except Exception:
            self.config = old
            self.on_config_changed(names)
            raise

    def replace_topic(self, direction: str, old_name: str, topic: Topic) -> None:
        """Use another topic for an input or output, while running too.

        Parameters
        ----------
        direction
            "input" or "output".
        old_name
            Name of the topic to be replaced, with or without the leading slash.

        Raises
        ------
        ValueError, TypeError
            When no key uses ``old_name``, or the new one does not fit; nothing changes then.
        """
        declared = self._topics_in if direction == "input" else self._topics_out
        key, index = declared.place_of(old_name)
        self._change_topic(direction, key, index, topic)

    def _change_topic(self, direction: str, key: str, index: int, topic: Topic) -> None:
        if direction == "input":
            self._topics_in.replace_one(key, index, topic)
            if self._node is not None:
                self._inputs.change(self._node, key, index, topic)
        else:
            self._topics_out.replace_one(key, index, topic)
            if self._node is not None:
                self._outputs.change(self._node, key, index, topic)


def _snake(kind: type) -> str:
    return re.sub(r"(?<!^)(?=[A-Z])", "_", kind.__name__).lower()


def _interface(owner: str, field: str, part: str, value: type | None) -> type | None:
    if value is not None and not hasattr(value, part):
        word = "action" if part == "Goal" else "service"
        raise TypeError(f"{owner}: {field} = {value!r} is not the type of a ROS {word}")
    return value


def _interface_name(owner: str, field: str, value: str) -> str:
    name = value.strip().removeprefix("/")
    if not name:
        raise ValueError(f"{owner}: {field} = {value!r} is empty")
    return name


def _overridden(component: Component, hook: str) -> bool:
    return getattr(type(component), hook) is not getattr(Component, hook)


def _name_of(topic: Topic | str) -> str:
    return topic.name if isinstance(topic, Topic) else topic


def _function(owner: str, function: Callable[[Any], Any]) -> Callable[[Any], Any]:
    if not callable(function):
        raise TypeError(f"{owner}: {function!r} is not a function")
    return function
