"""The launcher of a recipe: components in, a supervised stack out."""

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from kompass.components.base.component import Component
from kompass.launch.companions import (
    add_companion,
    companions,
    function_process,
    program_process,
)
from kompass.launch.environment import check_environment, prepare_key, processes_wanted
from kompass.launch.failure_policies import FailurePolicies
from kompass.launch.gates import feeders_of, halt_process
from kompass.launch.host import host
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.process import NAME, run_monitor
from kompass.monitor.tables.recipe_check import check_recipe
from kompass.printable import log_to_terminal
from kompass.rclpy_ext.topic import Topic
from kompass.recipe.table import recipe_rules
from kompass.recorder.process import flight_recorder
from kompass.robot import RobotConfig, RobotFrames
from kompass.rulebook.permissions import NOTHING_OPENED, Opened, opened
from kompass.settings import notice_once
from kompass.supervisor.desired_state import DesiredState
from kompass.supervisor.instance_lock import lock_instance
from kompass.supervisor.liveness import LivenessLimits
from kompass.supervisor.process import ProcessSpec, Report
from kompass.supervisor.restarts import Restarts
from kompass.supervisor.supervisor import Supervisor


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
        When a robot plugin is given.
    """

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
        self.patience = patience or LivenessLimits()
        self._in_processes = _either(multi_processing, multiprocessing)
        self._activates = activate_all_components_on_start
        self._components: list[Component] = []
        self._failure_policies = FailurePolicies()
        self._activate: list[str] = []
        self._threaded: list[Component] = []
        self._events_actions: dict[Any, Any] = {}
        self._opened = NOTHING_OPENED

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
        """Add components.

        Parameters
        ----------
        components
            In the order in which they start.
        events_actions
            An action, or a list of them, for each event.
        activate_all_components_on_start, components_to_activate_on_start
            Which become active at once.
        multi_processing, multiprocessing
            A process for each (the default), or one for all of them; both spellings are in use.
        ros_log_level, rclpy_log_level
            Of the components' loggers.

        Raises
        ------
        ValueError
            When two components have one name.
        TypeError
            When something in the list is not a component.
        """
        all_active = activate_all_components_on_start
        if all_active is None:
            all_active = self._activates
        for component in components:
            if not isinstance(component, Component):
                raise TypeError(f"components holds {component!r}, which is not a component")
            if any(component.node_name == other.node_name for other in self._components):
                raise ValueError(
                    f"two components are called '{component.node_name}'; names must differ"
                )
            if self.config_file:
                component.apply_config_file(self.config_file)
            self._components.append(component)
            chosen = components_to_activate_on_start
            if component in chosen if chosen is not None else all_active:
                self._activate.append(component.node_name)
            for level in (ros_log_level, rclpy_log_level):
                if level is not None:
                    component.config.rclpy_log_level = level
        self._events_actions.update(events_actions or {})
        stated = _either(multi_processing, multiprocessing)
        if not processes_wanted(self._in_processes if stated is None else stated):
            self._threaded += components

    def agents(self, components: list[Component], *args: Any, **kwargs: Any) -> None:
        """As :meth:`kompass`."""
        self.kompass(components, *args, **kwargs)

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
        """Answer an event with an action, or a list of them."""
        self._events_actions[event] = action

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
            When a single text is given for a list.
        """
        for key, names in (("topics", topics), ("services", services), ("actions", actions)):
            if isinstance(names, str):
                raise TypeError(f"open_to_rules: {key} = {names!r} is a text; give a list of names")
        more = opened(topics, services, actions)
        self._opened = Opened(*(one | other for one, other in zip(self._opened, more, strict=True)))

    @property
    def components(self) -> list[Component]:
        """All components added so far."""
        return list(self._components)

    @property
    def robot(self) -> dict[str, RobotConfig]:
        """The robot that each component assumes, by node name."""
        return {component.node_name: component.robot for component in self._components}

    @robot.setter
    def robot(self, value: RobotConfig) -> None:
        for component in self._components:
            component.robot = value

    @property
    def frames(self) -> dict[str, RobotFrames]:
        """The frame names that each component uses, by node name."""
        return {component.node_name: component.frames for component in self._components}

    @frames.setter
    def frames(self, value: RobotFrames) -> None:
        for component in self._components:
            component.frames = value

    def configure(self, config_file: str, component_name: str | None = None) -> None:
        """Apply a configuration file to all components, or to one.

        Raises
        ------
        ValueError
            When there is no such component.
        ConfigFileError
            When the file or a setting in it cannot be used.
        """
        chosen = [c for c in self._components if component_name in (None, c.node_name)]
        if not chosen:
            known = ", ".join(component.node_name for component in self._components)
            raise ValueError(f"configure: no component '{component_name}'; there are {known}")
        for component in chosen:
            component.apply_config_file(config_file)

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
        for key, value in topics.items():
            taken = [getattr(component, setter)(**{key: value}) for component in self._components]
            if not any(taken):
                known = sorted({k for c in self._components for k in getattr(c, allowed)})
                raise ValueError(f"no component has '{key}'; known are {', '.join(known)}")

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
        introspect, launch_debug, ros_log_level
            Accepted from older recipes; without effect.

        Raises
        ------
        ValueError
            When no component was added.
        EnvironmentProblem
            When the environment, or the robot's key, cannot be used.
        AlreadyRunning
            When another stack runs the same nodes.
        StartupError
            When a process cannot start.
        """
        if not self._components:
            raise ValueError("the launcher has no components; add them with launcher.kompass(…)")
        check_environment()
        prepare_key()
        if config_file:
            for component in self._components:
                component.apply_config_file(config_file)
        self._failure_policies.apply(self._components)
        log_to_terminal("kompass")
        own, recorder = self._specs(), list[ProcessSpec]()
        if self.enable_monitoring:
            monitor, recorder = self._monitor()
            own.append(monitor)
        names = [name for spec in own for name in spec.names]
        # A node of the recipe's own takes the place of a companion of that name.
        halt = halt_process(self._components, self.namespace)
        more = [*halt, *recorder, *companions()]
        beside = [spec for spec in more if not set(spec.names) & set(names)]
        names += [name for spec in beside for name in spec.names]
        held = lock_instance(names, self.namespace)
        try:
            Supervisor(
                [*own, *beside],
                announced=[spec.name for spec in own],
                limits=self.patience,
                restarts=Restarts(self._failure_policies.process_retries),
                activation_timeout=self.activation_timeout,
            ).run()
        finally:
            for descriptor in held:
                os.close(descriptor)

    # -- failures -----------------------------------------------------------------------------

    @property
    def fallback_rate(self) -> dict[str, float]:
        """How often each component's fallbacks are tried at most, by node name [Hz]."""
        return {one.node_name: one.config.fallback_rate for one in self._components}

    @fallback_rate.setter
    def fallback_rate(self, value: float) -> None:
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
        add_companion(function_process(method, args or (), kwargs or {}))

    def enable_ui(self, *_: Any, **__: Any) -> None:
        """Say where the page comes from today."""
        notice_once(
            "launcher.enable_ui(): the page comes with `kompass-console run <recipe>`, and shows "
            "all components without being told"
        )

    def setup_launch_description(self) -> None:
        """Nothing is to be set up before :meth:`bringup`."""

    # -- processes ----------------------------------------------------------------------------

    def _specs(self) -> list[ProcessSpec]:
        """The processes of the components."""
        groups = [[c] for c in self._components if c not in self._threaded]
        if self._threaded:
            groups.append(self._threaded)
        return [self._spec(group) for group in groups]

    def _monitor(self) -> tuple[ProcessSpec, list[ProcessSpec]]:
        """The monitor's process, and those of its flight recorder."""
        rules = recipe_rules(self._events_actions, self._components)
        rules.opened = self._opened
        catalog = RecipeCatalog(self._components, rules)
        check_recipe(rules.table, catalog)
        recording, recorder = flight_recorder(self._components, self.namespace)

        def main(report: Report) -> None:
            run_monitor(rules, catalog, report, spec.inbox, self.namespace, recording)

        spec = ProcessSpec(name=NAME, main=main, names=[NAME], listens=True)
        return spec, recorder

    def _spec(self, group: list[Component]) -> ProcessSpec:
        names = [component.node_name for component in group]
        desired_state = DesiredState({name: name in self._activate for name in names})
        stops_robot = any(component.stops_robot for component in group)

        def main(report: Report) -> None:
            host(
                group,
                desired_state,
                report,
                namespace=self.namespace,
                first_start=spec.starts == 1,
                inbox=spec.inbox,
                feeders={
                    component.node_name: feeders_of(component, self._components)
                    for component in group
                    if component.stops_robot
                },
            )

        spec = ProcessSpec(
            name=names[0] if len(names) == 1 else "components",
            main=main,
            names=names,
            stops_robot=stops_robot,
            listens=stops_robot,
            allowed={component.node_name: component.longest_step for component in group},
        )
        return spec


def _either(one: bool | None, other: bool | None) -> bool | None:
    return one if one is not None else other
