"""The base of all components: declared inputs and outputs, a lifecycle, a status."""

import copy
import time
from collections.abc import Mapping
from typing import Any, ClassVar

from automatika_ros_sugar.msg import ComponentStatus
from pydantic import ValidationError

from kompass.components.component_config import ComponentConfig, ComponentRunType
from kompass.components.config_file import COMMON, ConfigFileError, read_config_file
from kompass.components.health import Health
from kompass.components.input import Input
from kompass.components.node import ComponentNode
from kompass.components.status import StatusPublisher
from kompass.components.topic import AllowedTopics, QoSConfig, Topic
from kompass.robot import RobotConfig, RobotFrames
from kompass.settings import explain


class Component:
    """A lifecycle node with declared inputs and outputs.

    The object is made when the recipe is read; its ROS node comes to life in the process that
    runs it (:meth:`create_node`).

    Parameters
    ----------
    component_name
        Name of the node.
    config
        Settings; the default ones of the class when left out.
    config_file
        A yaml, toml or json file; its section named like the node is laid over ``config``.
    inputs, outputs
        Topics by key, instead of the default ones.

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
    allowed_run_types: ClassVar[tuple[ComponentRunType, ...]] = (ComponentRunType.TIMED,)
    # Quality of service of keys whose message type alone does not tell it.
    qos: ClassVar[Mapping[str, QoSConfig]] = {}
    # Whether it must end before all others, because it is what halts the robot.
    stops_robot: ClassVar[bool] = False
    # Whether the main loop does its step in every run type, not only in the timed one.
    steps_in_any_run_type: ClassVar[bool] = False

    def __init__(
        self,
        component_name: str | None = None,
        config: ComponentConfig | None = None,
        config_file: str | None = None,
        inputs: Mapping[str, Topic | list[Topic]] | None = None,
        outputs: Mapping[str, Topic | list[Topic]] | None = None,
        *,
        node_name: str | None = None,
    ) -> None:
        name = component_name or node_name
        if not name:
            raise ValueError(f"{type(self).__name__}: component_name is missing")
        if config is not None and not isinstance(config, self.config_class):
            raise TypeError(f"{name}: config = {config!r} is not a {self.config_class.__name__}")
        self.node_name = name
        self.config = config.model_copy(deep=True) if config else self.config_class()
        self._run_type = self.allowed_run_types[0]
        self._topics_in = {key: list(topics) for key, topics in self.default_inputs.items()}
        self._topics_out = {key: list(topics) for key, topics in self.default_outputs.items()}
        self.health = Health()
        self._node: ComponentNode | None = None
        self._status: StatusPublisher | None = None
        self._inputs: dict[str, list[Input]] = {}
        self._publishers: dict[str, list[Any]] = {}
        self._timer: Any = None
        self._logged: dict[str, float] = {}
        if config_file:
            self.apply_config_file(config_file)
        self.inputs(**(inputs or {}))
        self.outputs(**(outputs or {}))

    # -- what a recipe says -------------------------------------------------------------------

    def inputs(self, **topics: Topic | list[Topic]) -> None:
        """Replace the topics of input keys."""
        self._replace(self._topics_in, self.allowed_inputs, topics, "input")

    def outputs(self, **topics: Topic | list[Topic]) -> None:
        """Replace the topics of output keys."""
        self._replace(self._topics_out, self.allowed_outputs, topics, "output")

    def set_input(self, **topics: Topic | list[Topic]) -> bool:
        """As :meth:`inputs`; False when the component has no such key."""
        if not set(topics) <= set(self.allowed_inputs):
            return False
        self.inputs(**topics)
        return True

    def set_output(self, **topics: Topic | list[Topic]) -> bool:
        """As :meth:`outputs`; False when the component has no such key."""
        if not set(topics) <= set(self.allowed_outputs):
            return False
        self.outputs(**topics)
        return True

    def _replace(
        self,
        table: dict[str, list[Topic]],
        allowed: Mapping[str, AllowedTopics],
        topics: Mapping[str, Topic | list[Topic]],
        kind: str,
    ) -> None:
        checked = {}
        for key, value in topics.items():
            if key not in allowed:
                raise ValueError(
                    f"{self.node_name}: '{key}' is not an {kind}; known are {', '.join(allowed)}"
                )
            listed = list(value) if isinstance(value, list | tuple) else [value]
            allowed[key].check(self.node_name, key, listed)
            checked[key] = listed
        table.update(checked)

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
        return _one_or_all(self._topics_in.get(str(getattr(key, "value", key)), []))

    def get_out_topic(self, key: str) -> Topic | list[Topic] | None:
        """The topic of an output key; a list when there are several, None when there is none."""
        return _one_or_all(self._topics_out.get(str(getattr(key, "value", key)), []))

    @property
    def run_type(self) -> ComponentRunType:
        """What makes the component work."""
        return self._run_type

    @run_type.setter
    def run_type(self, value: str | ComponentRunType) -> None:
        run_type = ComponentRunType.read(value)
        if run_type not in self.allowed_run_types:
            names = ", ".join(allowed.value for allowed in self.allowed_run_types)
            raise ValueError(
                f"{self.node_name}: run_type = {run_type.value} is not possible for a "
                f"{type(self).__name__}; possible are {names}"
            )
        self._run_type = run_type

    @property
    def robot(self) -> RobotConfig:
        """The robot that the component assumes."""
        return self.config.robot

    @robot.setter
    def robot(self, value: RobotConfig) -> None:
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

    def apply_config_file(self, path: str) -> None:
        """Lay the sections ``/**`` and ``<node_name>`` of a file over the settings.

        Raises
        ------
        ConfigFileError
            When the file or a setting in it cannot be used; nothing is changed then.
        """
        sections = read_config_file(path)
        config = self.config.model_dump()
        topics: dict[str, dict[str, Any]] = {"inputs": {}, "outputs": {}}
        for name in (COMMON, self.node_name):
            section = sections.get(name) or {}
            where = f"{path}, section '{name}'"
            if not isinstance(section, dict):
                raise ConfigFileError(f"{where}: expected settings, found {section!r}")
            for key, value in section.items():
                if key in topics:
                    topics[key].update(self._read_topics(key, value, where, name == COMMON))
                elif self._takes_section(key, value, name == COMMON):
                    continue
                elif key in config or name != COMMON:
                    _lay_over(config, key, value)
        try:
            updated = self.config_class.model_validate(config)
        except ValidationError as error:
            raise ConfigFileError(explain(error, self.config_class, path)) from None
        self.config = updated
        self.inputs(**topics["inputs"])
        self.outputs(**topics["outputs"])

    def _takes_section(self, key: str, value: Any, common: bool) -> bool:
        """Whether a key of the file is a section of the component's own, e.g. an algorithm."""
        return False

    def _read_topics(self, kind: str, value: Any, where: str, common: bool) -> dict[str, Topic]:
        allowed = self.allowed_inputs if kind == "inputs" else self.allowed_outputs
        read = {}
        for key, fields in value.items():
            if common and key not in allowed:
                continue
            try:
                read[key] = Topic(**fields)
            except (TypeError, ValueError) as error:
                raise ConfigFileError(f"{where}, {kind}.{key}: {error}") from None
        return read

    # -- life ---------------------------------------------------------------------------------

    @property
    def node(self) -> ComponentNode:
        """The ROS node; only in the process that runs the component."""
        if self._node is None:
            raise RuntimeError(
                f"{self.node_name} has no ROS node yet; it is made by Launcher.bringup()"
            )
        return self._node

    def create_node(self, namespace: str = "") -> ComponentNode:
        """Make the ROS node; rclpy must be initialised."""
        self._node = ComponentNode(self.node_name, self, namespace)
        return self._node

    def leave(self) -> None:
        """Deactivate and give the node back, before the process ends."""
        if self._node is not None:
            if self._timer is not None:
                self._node.trigger_deactivate()
            self._node.trigger_shutdown()
            self._node.destroy_node()
            self._node = None

    def on_configure(self) -> None:
        self._status = StatusPublisher(self.node, self.config.status_rate)
        for key, topics in self._topics_out.items():
            self._publishers[key] = [
                self.node.create_publisher(
                    topic.ros_msg_type,
                    topic.name,
                    (topic.qos_profile or self.qos.get(key) or QoSConfig()).to_ros(),
                )
                for topic in topics
            ]
        for key, topics in self._topics_in.items():
            self._inputs[key] = [Input(topic, self.qos.get(key)) for topic in topics]
        self.init_variables()
        self.custom_on_configure()

    def on_activate(self) -> None:
        for key in self._topics_in:
            for source in self._inputs[key]:
                source.open(self.node)
        self.health.set_healthy()
        self.custom_on_activate()
        self._timer = self.node.create_timer(1.0 / self.config.loop_rate, self._tick)
        # A slow loop must not make the component look silent.
        if self.config.loop_rate < self.config.status_rate:
            self.node.create_timer(1.0 / self.config.status_rate, self.publish_status)
        self.publish_status()

    def on_deactivate(self) -> None:
        self.custom_on_deactivate()
        for timer in list(self.node.timers):
            self.node.destroy_timer(timer)
        self._timer = None
        for sources in self._inputs.values():
            for source in sources:
                source.close(self.node)

    def on_cleanup(self) -> None:
        self.custom_on_cleanup()
        for publishers in self._publishers.values():
            for publisher in publishers:
                self.node.destroy_publisher(publisher)
        self._publishers, self._inputs = {}, {}

    def on_shutdown(self) -> None:
        self.custom_on_shutdown()

    def on_transition_error(self, transition: str, error: Exception) -> None:
        self.health.set_fail_component([self.node_name], f"{transition} failed: {error}")
        self.node.get_logger().error(f"{transition} failed: {type(error).__name__}: {error}")
        self.publish_status()

    # -- what a component overrides -----------------------------------------------------------

    def init_variables(self) -> None:
        """Make what the component needs before it runs."""

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

    def _execution_step(self) -> None:
        """One turn of the main loop. An exception becomes a component failure."""

    # -- what a component uses ----------------------------------------------------------------

    def input(self, key: str, index: int = 0) -> Input:
        """An input of the running component."""
        return self._inputs[key][index]

    def publish(self, key: str, message: Any, index: int = 0) -> None:
        """Publish on an output; nothing happens when the recipe took the output away."""
        publishers = self._publishers.get(key, [])
        if index < len(publishers):
            publishers[index].publish(message)

    def publish_status(self) -> None:
        """Publish the health when it changed or is due."""
        if self._status is not None:
            self._status.publish(self.health)

    def warn(self, text: str, every: float = 5.0) -> None:
        """Log a warning, the same one at most once in ``every`` seconds."""
        now = time.monotonic()
        if now - self._logged.get(text, -float("inf")) >= every:
            self._logged[text] = now
            self.node.get_logger().warning(text)

    def _tick(self) -> None:
        if self.run_type is ComponentRunType.TIMED or self.steps_in_any_run_type:
            try:
                self._execution_step()
            except Exception as error:  # noqa: BLE001 - becomes the component's status
                text = f"{type(error).__name__}: {error}"
                self.health.set_fail_component([self.node_name], text)
                self.warn(f"step failed: {text}")
        self.publish_status()

    def __repr__(self) -> str:
        return f"{type(self).__name__}('{self.node_name}')"


def _one_or_all(topics: list[Topic]) -> Topic | list[Topic] | None:
    return topics[0] if len(topics) == 1 else (list(topics) or None)


def _lay_over(config: dict[str, Any], key: str, value: Any) -> None:
    if isinstance(value, dict) and isinstance(config.get(key), dict):
        for inner, inner_value in value.items():
            _lay_over(config[key], inner, inner_value)
    else:
        config[key] = copy.deepcopy(value)
