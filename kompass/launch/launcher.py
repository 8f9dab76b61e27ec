"""The launcher of a recipe: components in, a supervised stack out."""

import difflib
import logging
import math
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import TypeAdapter, ValidationError

from kompass.components.base.component import Component
from kompass.components.base.component_config import NO_ROBOT, ComponentConfig
from kompass.components.base.config_file import check_path, sections_of_nobody
from kompass.components.base.parameter import with_values
from kompass.components.controller.controller import Controller
from kompass.components.drive.drive_manager import DriveManager
from kompass.components.planner.planner import Planner
from kompass.invalid import first_invalid
from kompass.launch.companions import (
    add_companion,
    function_process,
    program_process,
)
from kompass.launch.environment import check_environment, processes_wanted
from kompass.launch.failure_policies import FailurePolicies
from kompass.launch.processes import run_processes
from kompass.launch.stack import Monitored, Stack, taker
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.process import NAME as MONITOR_NODE
from kompass.monitor.tables.recipe_check import check_recipe
from kompass.named_arguments import named_arguments
from kompass.printable import log_to_terminal
from kompass.rclpy_ext.topic import Topic
from kompass.recipe.ladder import ladder
from kompass.recipe.table import recipe_rules
from kompass.robot import RobotConfig, RobotFrames
from kompass.rulebook.permissions import NOTHING_OPENED, Opened, opened
from kompass.rules.schema.model import TopicName
from kompass.settings import ignored_of, notice_once
from kompass.supervisor.liveness import LivenessLimits
from kompass.zones.mask import Mask

NAMESPACE = re.compile(r"/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*/?", re.ASCII)


class Launcher:
    """Collects the components of a recipe and runs them.

    Parameters
    ----------
    namespace
        ROS namespace of all nodes.
    config_file
        Applied to each component when it is added; what the recipe sets afterwards wins.
    enable_monitoring
        Run the monitor, which carries out events, actions and fallbacks.
    activation_timeout
        Within which all components must be active [s]; the stack ends otherwise. None to wait.
    robot_plugin
        Refused: plugins of robots are not offered here.
    multi_processing, multiprocessing, activate_all_components_on_start
        What :meth:`kompass` assumes where it is not told.
    patience
        When a process counts as busy or stuck, and when one that is stuck is killed.

    Raises
    ------
    ValueError
        When a robot plugin is given, a namespace that ROS does not have, no time for
        ``activation_timeout``, or both spellings of one argument and they differ.
    TypeError
        When ``config_file`` is no path.
    AttributeError
        When something is set that a launcher does not have.
    """

    @named_arguments
    def __init__(
        self,
        namespace: str = "",
        config_file: str | None = None,
        enable_monitoring: bool = True,
        activation_timeout: float | None = None,
        robot_plugin: Any = None,
        *,
        multi_processing: bool | None = None,
        multiprocessing: bool | None = None,
        activate_all_components_on_start: bool = True,
        patience: LivenessLimits | None = None,
    ) -> None:
        if robot_plugin is not None:
            raise ValueError(
                "robot_plugin: plugins of robots are not offered here; connect the robot's own "
                "topics with launcher.inputs(…) and launcher.outputs(…)"
            )
        self.namespace = namespace
        self.config_file = config_file
        self.enable_monitoring = enable_monitoring
        self.activation_timeout = activation_timeout
        self.patience = LivenessLimits() if patience is None else patience
        self._in_processes = _either("Launcher", multi_processing, multiprocessing)
        _check_truth("activate_all_components_on_start", activate_all_components_on_start)
        self._activates = activate_all_components_on_start
        self._components: list[Component] = []
        self._failure_policies = FailurePolicies()
        self._activate: list[str] = []
        self._threaded: list[Component] = []
        self._events_actions: dict[Any, Any] = {}
        self._opened = NOTHING_OPENED
        self._files = [config_file] if config_file else []
        # Given before there were components; those that come take them.
        self._robot: RobotConfig | None = None
        self._frames: RobotFrames | None = None
        self._masks: tuple[Mask, ...] | None = None
        self._made = True

    if not TYPE_CHECKING:  # whom it would tell that any name may be set

        def __setattr__(self, name: str, value: Any) -> None:
            if name in _CHECKS:
                _CHECKS[name](name, value)
            elif not name.startswith("_") and callable(getattr(type(self), name, None)):
                raise AttributeError(f"launcher.{name} is to be called, as launcher.{name}(…)")
            if (
                "_made" in self.__dict__
                and name not in self.__dict__
                and not hasattr(type(self), name)
            ):
                known = [one for one in {*dir(self)} if not one.startswith("_")]
                near = difflib.get_close_matches(name, known, n=1)
                remedy = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(known)}"
                raise AttributeError(f"a Launcher has no attribute '{name}'; {remedy}")
            super().__setattr__(name, value)

    @named_arguments
    def kompass(
        self,
        components: list[Component],
        events_actions: Mapping[Any, Any] | None = None,
        multiprocessing: bool | None = None,
        activate_all_components_on_start: bool | None = None,
        components_to_activate_on_start: list[Component] | None = None,
        ros_log_level: str | None = None,
        rclpy_log_level: str | None = None,
        *,
        multi_processing: bool | None = None,
    ) -> None:
        """Add components; when one is refused, none is added.

        Parameters
        ----------
        components
            In the order in which they start.
        events_actions
            An action, or a list of them, for each event.
        activate_all_components_on_start, components_to_activate_on_start
            Which become active at once: those of the list, or else all or none.
        multi_processing, multiprocessing
            A process for each (the default), or one for all of them; both spellings are in use.
        ros_log_level
            From which on the components' logs are written: their ``log_level``.
        rclpy_log_level
            From which on ROS' own log of their processes is.

        Raises
        ------
        ValueError
            When two components have one name, one is to be activated that is not added here, a
            level does not exist, or both spellings are given and differ.
        TypeError
            When something in the list is not a component, or an argument is of another kind.
        """
        added = _listed("components", components)
        self._refuse_twins(added)
        chosen = _chosen(added, components_to_activate_on_start)
        if events_actions is not None and not isinstance(events_actions, Mapping):
            raise TypeError(
                f"events_actions = {events_actions!r} is no mapping; give {{event: action}}"
            )
        if activate_all_components_on_start is not None:
            _check_truth("activate_all_components_on_start", activate_all_components_on_start)
        in_processes = _either("kompass", multi_processing, multiprocessing)
        if in_processes is None:
            in_processes = self._in_processes
        apart = processes_wanted(in_processes)
        if chosen is None:
            all_active = activate_all_components_on_start
            chosen = added if (self._activates if all_active is None else all_active) else []
        levels = {"log_level": ros_log_level, "rclpy_log_level": rclpy_log_level}
        given = {name: level for name, level in levels.items() if level is not None}
        configs = [
            with_values(one.config, given, one.node_name) if given else one.config for one in added
        ]
        if self.config_file:
            _check_file(self.config_file, added)
        for component, config in zip(added, configs, strict=True):
            self._set_up(component, config)
        self._components += added
        self._activate += [one.node_name for one in chosen]
        for event, action in (events_actions or {}).items():
            self.on(event, action)
        if not apart:
            self._threaded += added

    def _refuse_twins(self, added: list[Component]) -> None:
        names = [component.node_name for component in (*self._components, *added)]
        for name in names:
            if name == MONITOR_NODE:
                raise ValueError(
                    f"component_name = '{name}' is the name of the node that runs the rules; "
                    "choose another"
                )
            if names.count(name) > 1:
                raise ValueError(f"two components are called '{name}'; names must differ")

    def _set_up(self, component: Component, config: ComponentConfig) -> None:
        """Give a new component what the launcher was given for all."""
        component.config = config
        if self.config_file:
            component.apply_config_file(self.config_file)
        if self._robot is not None:
            component.robot = self._robot
        if self._frames is not None:
            component.frames = self._frames
        if self._masks is not None:
            _mask(component, self._masks)

    def agents(self, components: list[Component], *args: Any, **kwargs: Any) -> None:
        """As :meth:`kompass`."""
        self.kompass(components, *args, **kwargs)

    @named_arguments
    def add_pkg(
        self,
        components: list[Component],
        package_name: str | None = None,
        executable_entry_point: str = "executable",
        events_actions: Mapping[Any, Any] | None = None,
        multiprocessing: bool = False,
        activate_all_components_on_start: bool = True,
        components_to_activate_on_start: list[Component] | None = None,
        ros_log_level: str | None = None,
        rclpy_log_level: str | None = None,
    ) -> None:
        """As :meth:`kompass`, with threads unless processes are asked for.

        ``package_name`` and ``executable_entry_point`` have no meaning here: a process is a fork,
        so any component can have one.
        """
        self.kompass(
            components,
            events_actions,
            multiprocessing,
            activate_all_components_on_start,
            components_to_activate_on_start,
            ros_log_level,
            rclpy_log_level,
        )

    def on(self, event: Any, action: Any) -> None:
        """Answer an event with an action, or a list of them.

        What answers it already, here or in the ``events_actions`` of a package, stays and comes
        first; all of them are the actions of one rule.
        """
        more = list(action) if isinstance(action, list | tuple) else [action]
        self._events_actions[event] = [*self._events_actions.get(event, ()), *more]

    def recovery(self) -> None:
        """Add the recovery ladder: rules for what is tried before a goal is given up.

        They are ordinary rules, in the table like all others.

        Raises
        ------
        ValueError
            When there is not one planner and one drive manager among the components.
        """
        planners = [one for one in self._components if isinstance(one, Planner)]
        drivers = [one for one in self._components if isinstance(one, DriveManager)]
        if len(planners) != 1 or len(drivers) != 1:
            raise ValueError(
                f"recovery: {len(planners)} planners and {len(drivers)} drive managers were added; "
                "the ladder is for one of each, so add them first, with launcher.kompass(…)"
            )
        for event, action in ladder(planners[0], drivers[0]).items():
            self.on(event, action)

    def open_to_rules(
        self,
        *,
        topics: Sequence[str] = (),
        services: Sequence[str] = (),
        actions: Sequence[str] = (),
    ) -> None:
        """Let rules that operators make or change use names outside of this stack.

        What the recipe's own rules use is open already, and engineers need no list. What belongs to
        the gate before the wheels is never open.

        Parameters
        ----------
        topics
            To publish on.
        services
            To call.
        actions
            To send goals to, and to cancel these.

        Raises
        ------
        TypeError
            When something else is given than a list of texts.
        ValueError
            When one of them is no name.
        """
        for key, names in (("topics", topics), ("services", services), ("actions", actions)):
            if isinstance(names, str) or not isinstance(names, Collection):
                raise TypeError(f"open_to_rules: {key} = {names!r} is no list; give one of names")
            for name in names:
                try:
                    _NAME.validate_python(name, strict=True)
                except ValidationError as error:
                    raise ValueError(
                        f"open_to_rules: {key} holds {name!r}: {first_invalid(error).text}"
                    ) from None
        more = opened(topics, services, actions)
        self._opened = Opened(*(one | other for one, other in zip(self._opened, more, strict=True)))

    @property
    def components(self) -> list[Component]:
        """All components added so far."""
        return list(self._components)

    @property
    def robot(self) -> dict[str, RobotConfig | None]:
        """The robot that each component works for, by node name; None where nobody told."""
        return {component.node_name: component.robot for component in self._components}

    @robot.setter
    def robot(self, value: RobotConfig) -> None:
        if not isinstance(value, RobotConfig):
            raise TypeError(f"launcher.robot = {value!r} is no robot; give a RobotConfig(…)")
        self._robot = value.model_copy()
        for component in self._components:
            component.robot = value

    @property
    def frames(self) -> dict[str, RobotFrames]:
        """The frame names that each component uses, by node name."""
        return {component.node_name: component.frames for component in self._components}

    @frames.setter
    def frames(self, value: RobotFrames) -> None:
        if not isinstance(value, RobotFrames):
            raise TypeError(f"launcher.frames = {value!r} are no frames; give RobotFrames(…)")
        self._frames = value.model_copy()
        for component in self._components:
            component.frames = value

    @property
    def masks(self) -> dict[str, tuple[Mask, ...]]:
        """The masks that each component keeps to, by node name; of those that look at any."""
        found = {each.node_name: getattr(each.config, "masks", None) for each in self._components}
        return {name: masks for name, masks in found.items() if masks is not None}

    @masks.setter
    def masks(self, value: Sequence[Mask]) -> None:
        given = tuple(value) if isinstance(value, Sequence) else ()
        if not given or not all(isinstance(mask, Mask) for mask in given):
            raise TypeError(
                f"launcher.masks = {value!r} are no masks; give a list, [Mask(file=…, kind=…)]"
            )
        self._masks = given
        for component in self._components:
            _mask(component, given)

    def configure(self, config_file: str, component_name: str | None = None) -> None:
        """Apply a configuration file to all components, or to one.

        Raises
        ------
        ValueError
            When there is no such component.
        ConfigFileError
            When the file or a setting in it cannot be used; nothing is changed then.
        """
        chosen = [c for c in self._components if component_name in (None, c.node_name)]
        if not chosen:
            known = ", ".join(component.node_name for component in self._components)
            raise ValueError(f"configure: no component '{component_name}'; there are {known}")
        self._apply_file(config_file, chosen)

    def _apply_file(self, path: str, components: Sequence[Component]) -> None:
        _check_file(path, components)
        for component in components:
            component.apply_config_file(path)
        self._files.append(path)

    # -- topics -------------------------------------------------------------------------------

    def inputs(self, **topics: Topic | list[Topic]) -> None:
        """Set an input of every component that has it.

        Raises
        ------
        ValueError
            When no component has it.
        """
        self._spread("set_input", "allowed_inputs", topics)

    def outputs(self, **topics: Topic | list[Topic]) -> None:
        """Set an output of every component that has it.

        Raises
        ------
        ValueError
            When no component has it.
        """
        self._spread("set_output", "allowed_outputs", topics)

    def _spread(self, setter: str, allowed: str, topics: Mapping[str, Any]) -> None:
        if not self._components:
            raise ValueError(
                f"{', '.join(topics)}: no component was added yet; launcher.kompass(…) comes first"
            )
        for key, value in topics.items():
            taken = [getattr(component, setter)(**{key: value}) for component in self._components]
            if not any(taken):
                known = sorted({k for c in self._components for k in getattr(c, allowed)})
                raise ValueError(f"no component has '{key}'; known are {', '.join(known)}")

    @named_arguments
    def bringup(
        self,
        config_file: str | None = None,
        introspect: bool = False,
        launch_debug: bool = False,
        ros_log_level: str | None = None,
    ) -> None:
        """Run the stack; blocks until SIGINT or SIGTERM, then stops the robot and all processes.

        Parameters
        ----------
        config_file
            Laid over the settings of all components.
        introspect, launch_debug
            Refused when true: nothing is launched by ROS 2 Launch here.
        ros_log_level
            From which on the logs of all components are written.

        Raises
        ------
        ValueError
            When no component was added, one lacks a topic that it needs, or one that can never
            become active is waited for.
        TypeError
            When one lacks a hook or a type that its run type needs.
        EnvironmentProblem
            When the environment, or the robot's key, cannot be used.
        AlreadyRunning
            When another stack runs the same nodes.
        StartupError
            When a process cannot start.
        """
        if not self._components:
            raise ValueError("the launcher has no components; add them with launcher.kompass(…)")
        for name, given in (("introspect", introspect), ("launch_debug", launch_debug)):
            if given:
                raise ValueError(
                    f"bringup: {name} = {given!r} is of ROS 2 Launch, which runs nothing here; "
                    "leave it out: the page and the log show what is done"
                )
        check_environment()
        if config_file:
            self._apply_file(config_file, self._components)
        if ros_log_level is not None:
            for component in self._components:
                component.config = with_values(
                    component.config, {"log_level": ros_log_level}, component.node_name
                )
        for component in self._components:
            component.check_declaration()
        self._check_topics()
        self._failure_policies.apply(self._components)
        log_to_terminal("kompass")
        stack = self._stack()
        self._judge_robot()
        self._judge_commands()
        self._judge_files()
        taker(run_processes)(stack)

    def _stack(self) -> Stack:
        groups = [[one] for one in self._components if one not in self._threaded]
        return Stack(
            groups=[*groups, self._threaded] if self._threaded else groups,
            activate=frozenset(self._activate),
            namespace=self.namespace,
            monitored=self._monitored() if self.enable_monitoring else None,
            process_retries=self._failure_policies.process_retries,
            patience=self.patience,
            activation_timeout=self.activation_timeout,
        )

    def _monitored(self) -> Monitored:
        rules = recipe_rules(self._events_actions, self._components)
        rules.opened = self._opened
        catalog = RecipeCatalog(self._components, rules)
        check_recipe(rules.table, catalog)
        return Monitored(rules, catalog)

    def _check_topics(self) -> None:
        """Raise where two components, or one, mean messages of different types by one topic."""
        meant: dict[str, tuple[str, Topic]] = {}
        for component in self._components:
            for key, topic in _topics_of(component):
                where, other = meant.setdefault(
                    topic.name, (f"{component.node_name}: {key}", topic)
                )
                if other.ros_msg_type is not topic.ros_msg_type:
                    raise ValueError(
                        f"/{topic.name} is a {other.msg_type} for {where}, and a {topic.msg_type} "
                        f"for {component.node_name}: {key}; give one of them another topic"
                    )

    def _judge_commands(self) -> None:
        """Say that nobody takes the controllers' commands to the wheels."""
        if any(isinstance(one, DriveManager) for one in self._components):
            return
        (unsaid,) = Controller.default_outputs["command"]
        for one in self._components:
            if isinstance(one, Controller) and one.out_topic_name("command") == unsaid.name:
                logging.getLogger("kompass").warning(
                    f"{one.node_name} publishes commands on /{unsaid.name}, and the recipe has "
                    "no DriveManager that takes them to the wheels; add one, unless another "
                    "program does that"
                )

    def _judge_robot(self) -> None:
        """Say which components will not become active, for want of a robot."""
        lacking = [one.node_name for one in self._components if one.lacks_robot]
        if not lacking:
            return
        text = f"{', '.join(lacking)} cannot become active: {NO_ROBOT}"
        if self.activation_timeout is not None and set(lacking) & set(self._activate):
            raise ValueError(f"activation_timeout = {self.activation_timeout:g}: {text}")
        logging.getLogger("kompass").warning(text)

    def _judge_files(self) -> None:
        """Say which sections of the configuration files are read by nobody."""
        names = [component.node_name for component in self._components]
        known = {"inputs", "outputs"}
        for one in self._components:
            kind = type(one.config)
            known |= {*kind.model_fields, *ignored_of(kind), *one.ignored_settings}
        found = (sections_of_nobody(path, names, known) for path in self._files)
        for text in {text: None for told in found for text in told}:
            logging.getLogger("kompass").warning(text)

    # -- failures -----------------------------------------------------------------------------

    @property
    def fallback_rate(self) -> dict[str, float]:
        """How often each component's fallbacks are tried at most, by node name [Hz]."""
        return {one.node_name: one.config.fallback_rate for one in self._components}

    @fallback_rate.setter
    def fallback_rate(self, value: float) -> None:
        if not self._components:
            raise ValueError(
                f"fallback_rate = {value!r}: no component was added yet; launcher.kompass(…) comes "
                "first"
            )
        for component in self._components:
            component.config.fallback_rate = value

    def on_process_fail(self, max_retries: int = 3) -> None:
        """How often in a row a process that died is started again before it is given up.

        Raises
        ------
        ValueError
            When it is no positive whole number.
        """
        self._failure_policies.set_process_retries(max_retries)

    def on_fail(self, action_name: str = "restart", max_retries: int | None = None) -> None:
        """What every component does on a failure, unless the recipe gave it a fallback of its own.

        Parameters
        ----------
        action_name
            A component action, e.g. "restart"; only components that have it are meant.
        max_retries
            How often it is tried in a row; None means no limit.

        Raises
        ------
        ValueError
            When no component has it.
        """
        self._failure_policies.add("on_fail", action_name, max_retries, self._components)

    def on_algorithm_fail(
        self, action_name: str = "restart", max_retries: int | None = None
    ) -> None:
        """As :meth:`on_fail`, when an algorithm finds no answer."""
        self._failure_policies.add("on_algorithm_fail", action_name, max_retries, self._components)

    def on_component_fail(
        self, action_name: str = "restart", max_retries: int | None = None
    ) -> None:
        """As :meth:`on_fail`, about a defect of a component itself."""
        self._failure_policies.add("on_component_fail", action_name, max_retries, self._components)

    def on_system_fail(self, action_name: str = "restart", max_retries: int | None = None) -> None:
        """As :meth:`on_fail`, when something outside is missing."""
        self._failure_policies.add("on_system_fail", action_name, max_retries, self._components)

    def on_giveup(self, action_name: str = "stop", max_retries: int | None = 1) -> None:
        """As :meth:`on_fail`, when all other fallbacks were tried in vain."""
        self._failure_policies.add("on_giveup", action_name, max_retries, self._components)

    # -- beside the components ----------------------------------------------------------------

    def add_py_executable(self, path_to_executable: str, name: str = "python3") -> None:
        """Run a Python program beside the components, started again when it dies.

        ``name`` has no meaning here: the program runs in the interpreter of the stack.

        Raises
        ------
        FileNotFoundError
            When there is no such program.
        """
        add_companion(program_process(Path(path_to_executable)))

    def add_method(
        self,
        method: Callable[..., Any],
        args: Sequence[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
    ) -> None:
        """Run a function once beside the components, in a process of its own.

        Raises
        ------
        TypeError
            When it is not a function.
        """
        # The list itself: what is added later counts as well.
        add_companion(function_process(method, args or (), kwargs or {}, self._components))

    def enable_ui(self, *_: Any, **__: Any) -> None:
        """Say where the page comes from today."""
        notice_once(
            "launcher.enable_ui(): the page comes with `kompass-console run <recipe>`, and shows "
            "all components without being told"
        )

    def setup_launch_description(self) -> None:
        """Nothing is to be set up before :meth:`bringup`."""


def _mask(component: Component, masks: tuple[Mask, ...]) -> None:
    """Have a component keep to masks, if it looks at any."""
    if "masks" in type(component.config).model_fields:
        component.config.masks = masks


def _topics_of(component: Component) -> Iterator[tuple[str, Topic]]:
    """Keys and topics, of both directions."""
    for keys, topic_of in (
        (component.inputs_keys, component.get_in_topic),
        (component.outputs_keys, component.get_out_topic),
    ):
        for key in keys:
            found = topic_of(key)
            if isinstance(found, Topic):
                yield key, found
            elif found is not None:
                yield from ((key, topic) for topic in found)


def _check_truth(name: str, value: Any) -> None:
    if not isinstance(value, bool):
        raise TypeError(f"{name} = {value!r} is neither True nor False")


def _check_namespace(name: str, value: Any) -> None:
    if value != "" and not (isinstance(value, str) and NAMESPACE.fullmatch(value)):
        raise ValueError(
            f"{name} = {value!r} is none in ROS; give words of letters, digits and underscores "
            "between slashes, e.g. 'fleet/robot1'"
        )


def _check_config_file(name: str, value: Any) -> None:
    if value is not None:
        check_path(name, value)


def _check_timeout(name: str, value: Any) -> None:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if value is not None and not (number and 0 < value < math.inf):
        raise ValueError(f"{name} = {value!r}: give seconds above 0, or None")


def _check_patience(name: str, value: Any) -> None:
    if not isinstance(value, LivenessLimits):
        raise TypeError(f"{name} = {value!r} are no limits; give LivenessLimits(…)")


_NAME: TypeAdapter[str] = TypeAdapter(TopicName)
# Of what is a plain attribute: whoever sets it later is told at once, too.
_CHECKS: dict[str, Callable[[str, Any], None]] = {
    "namespace": _check_namespace,
    "config_file": _check_config_file,
    "enable_monitoring": _check_truth,
    "activation_timeout": _check_timeout,
    "patience": _check_patience,
}


def _check_file(path: str, components: Iterable[Component]) -> None:
    """Raise what a component has against a file before the file has changed another one."""
    for component in components:
        component.settings_of_file(path)


def _either(where: str, one: bool | None, other: bool | None) -> bool | None:
    """What is given in one of two spellings."""
    for name, value in (("multi_processing", one), ("multiprocessing", other)):
        if value is not None and not isinstance(value, bool):
            raise TypeError(f"{where}: {name} = {value!r} is neither True nor False")
    if one is not None and other is not None and one != other:
        raise ValueError(
            f"{where}: multi_processing = {one} and multiprocessing = {other} are one thing in two "
            "spellings; give one"
        )
    return one if one is not None else other


def _listed(name: str, given: Any) -> list[Component]:
    if isinstance(given, Component):
        raise TypeError(f"{name} = {given!r} is a component; give a list, [{given.node_name}]")
    if not isinstance(given, Iterable):
        raise TypeError(f"{name} = {given!r} is no list of components")
    found = list(given)
    for one in found:
        if not isinstance(one, Component):
            raise TypeError(f"{name} holds {one!r}, which is not a component")
    return found


def _chosen(added: list[Component], given: Any) -> list[Component] | None:
    """The components to activate, all of which are among those added; None when none is said."""
    if given is None:
        return None
    name = "components_to_activate_on_start"
    found = _listed(name, given)
    for one in found:
        if one not in added:
            raise ValueError(f"{name} holds '{one.node_name}', which is not among the components")
    return found
