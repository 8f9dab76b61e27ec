"""What a recipe says of a component: topics, settings, run type, fallbacks."""

import copy
import re
from collections.abc import Mapping
from typing import Any, ClassVar

from automatika_ros_sugar.msg import ComponentStatus
from pydantic import ValidationError

from kompass.components.base.actions import actions_of
from kompass.components.base.component_config import ComponentConfig, ComponentRunType
from kompass.components.base.config_file import COMMON, ConfigFileError, read_config_file
from kompass.components.base.fallbacks import Fallbacks, make_fallback
from kompass.components.base.notice import notice_once
from kompass.rclpy_ext.topic import AllowedTopics, QoSConfig, Topic
from kompass.robot import RobotConfig, RobotFrames
from kompass.settings import explain


class Declaration:
    """The part of a component that exists without ROS: made when the recipe is read.

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
    # Keys of files written for other stacks that mean nothing here: accepted, and said once.
    ignored_settings: ClassVar[Mapping[str, str]] = {}
    ignored_inputs: ClassVar[Mapping[str, str]] = {}
    # Quality of service of keys whose message type alone does not tell it.
    qos: ClassVar[Mapping[str, QoSConfig]] = {}
    # Whether it must end before all others, because it is what halts the robot.
    stops_robot: ClassVar[bool] = False
    # The ROS action by which it is asked to do its work, when it has one.
    main_action_type: ClassVar[type | None] = None
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
        enable_health_broadcast: bool = True,
    ) -> None:
        if not enable_health_broadcast:
            notice_once(f"{component_name or node_name}: the status is always published")
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
        self.fallbacks = Fallbacks()
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

    def in_topic_name(self, key: str) -> str | list[str] | None:
        """As :meth:`get_in_topic`, names only."""
        return _names(self.get_in_topic(key))

    def out_topic_name(self, key: str) -> str | list[str] | None:
        """As :meth:`get_out_topic`, names only."""
        return _names(self.get_out_topic(key))

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

    @property
    def main_action_name(self) -> str:
        """Name of its main action, without the leading slash.

        Raises
        ------
        TypeError
            When it has none.
        """
        if self.main_action_type is None:
            raise TypeError(f"{self.node_name}: a {type(self).__name__} has no action of its own")
        snake = re.sub(r"(?<!^)(?=[A-Z])", "_", self.main_action_type.__name__).lower()
        return f"{self.node_name}/{snake}"

    @property
    def ui_main_action_input(self) -> str:
        """What older recipes hand to ``launcher.enable_ui``; see :attr:`main_action_name`."""
        return self.main_action_name

    @property
    def available_actions(self) -> list[str]:
        """Names of the methods that rules may call."""
        return list(actions_of(type(self)))

    # -- what it does about its own failures --------------------------------------------------

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

    def on_algorithm_fail(
        self, action: Any = None, max_retries: int | None = None, *, fallback: Any = None
    ) -> None:
        """What to do when the algorithm finds no answer; see :meth:`on_fail`."""
        self.fallbacks.on_algorithm_fail = make_fallback(self, action or fallback, max_retries)

    def on_component_fail(
        self, action: Any = None, max_retries: int | None = None, *, fallback: Any = None
    ) -> None:
        """What to do about a defect of the component itself; see :meth:`on_fail`."""
        self.fallbacks.on_component_fail = make_fallback(self, action or fallback, max_retries)

    def on_system_fail(
        self, action: Any = None, max_retries: int | None = None, *, fallback: Any = None
    ) -> None:
        """What to do when something outside is missing; see :meth:`on_fail`."""
        self.fallbacks.on_system_fail = make_fallback(self, action or fallback, max_retries)

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

    def settings_of_file(self, path: str) -> tuple[ComponentConfig, dict[str, dict[str, Any]]]:
        """The settings and topics that :meth:`apply_config_file` would set; changes nothing."""
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
                elif key in self.ignored_settings:
                    notice_once(f"{where}: '{key}' is ignored: {self.ignored_settings[key]}")
                elif key in config or name != COMMON:
                    _lay_over(config, key, value)
        try:
            updated = self.config_class.model_validate(config)
        except ValidationError as error:
            raise ConfigFileError(explain(error, self.config_class, path)) from None
        return updated, topics

    def _read_topics(self, kind: str, value: Any, where: str, common: bool) -> dict[str, Topic]:
        allowed = self.allowed_inputs if kind == "inputs" else self.allowed_outputs
        read = {}
        for key, fields in value.items():
            if common and key not in allowed:
                continue
            if kind == "inputs" and key in self.ignored_inputs:
                notice_once(f"{where}: inputs.{key} is ignored: {self.ignored_inputs[key]}")
                continue
            try:
                if key not in allowed:
                    raise ValueError(f"no such key; known are {', '.join(allowed)}")
                read[key] = Topic(**fields)
                allowed[key].check(self.node_name, key, [read[key]])
            except (TypeError, ValueError) as error:
                raise ConfigFileError(f"{where}, {kind}.{key}: {error}") from None
        return read

    def __repr__(self) -> str:
        return f"{type(self).__name__}('{self.node_name}')"


def _one_or_all(topics: list[Topic]) -> Topic | list[Topic] | None:
    return topics[0] if len(topics) == 1 else (list(topics) or None)


def _names(topics: Topic | list[Topic] | None) -> str | list[str] | None:
    if isinstance(topics, list):
        return [topic.name for topic in topics]
    return topics.name if topics is not None else None


def _lay_over(config: dict[str, Any], key: str, value: Any) -> None:
    if isinstance(value, dict) and isinstance(config.get(key), dict):
        for inner, inner_value in value.items():
            _lay_over(config[key], inner, inner_value)
    else:
        config[key] = copy.deepcopy(value)
