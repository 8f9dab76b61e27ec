"""The base of all components: declared, alive, and open to rules."""

import inspect
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from kompass.components.base.actions import ActionRefused, actions_of, check_call, component_action
from kompass.components.base.component_config import ComponentConfig
from kompass.components.base.input import Input
from kompass.components.base.lifecycle import Lifecycle
from kompass.components.base.node import ComponentNode
from kompass.components.base.parameter import ParameterError, with_values
from kompass.components.base.services import ComponentServices
from kompass.rclpy_ext.topic import Topic

RATES = ("loop_rate", "status_rate")


class Component(Lifecycle):
    """A lifecycle node with declared inputs and outputs, whose actions and settings rules reach.

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

    def create_node(self, namespace: str = "") -> ComponentNode:
        """Make the ROS node and the services that everybody offers; rclpy must be initialised."""
        node = super().create_node(namespace)
        ComponentServices(self)
        return node

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
        spec = actions_of(type(self)).get(name)
        if spec is None:
            raise ActionRefused(
                f"{self.node_name} has no action '{name}'; known are "
                f"{', '.join(self.available_actions)}"
            )
        method = getattr(self, name)
        check_call(self.node_name, method, kwargs)
        if spec.active and not self.is_active:
            raise ActionRefused(f"{self.node_name} is not active; start it before '{name}'")
        result = method(**kwargs)
        return await result if inspect.isawaitable(result) else result

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

    @component_action
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
        topics: dict[str, dict[str, Topic]] = {"inputs": {}, "outputs": {}}
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

    @component_action
    def set_param(self, param_name: str, new_value: Any, keep_alive: bool = True) -> bool:
        """Change one setting; see :meth:`set_params`."""
        return self.set_params([param_name], [new_value], keep_alive)

    @component_action
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
        if not names or self._node is None or self._node.state == "unconfigured":
            return
        try:
            self.on_config_changed(names)
        except Exception:
            self.config = old
            self.on_config_changed(names)
            raise
        if self.is_active and names & set(RATES):
            self._start_loop()
        if self._status is not None:
            self._status.set_rate(config.status_rate)

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
        table = self._topics_in if direction == "input" else self._topics_out
        wanted = old_name.strip().removeprefix("/")
        for key, topics in table.items():
            for index, used in enumerate(topics):
                if used.name == wanted:
                    self._change_topic(direction, key, index, topic)
                    return
        names = ", ".join(f"/{used.name}" for topics in table.values() for used in topics)
        raise ValueError(
            f"{self.node_name}: no {direction} uses '{old_name}'; those in use are {names}"
        )

    def _change_topic(self, direction: str, key: str, index: int, topic: Topic) -> None:
        table, allowed, replace = (
            (self._topics_in, self.allowed_inputs, self.inputs)
            if direction == "input"
            else (self._topics_out, self.allowed_outputs, self.outputs)
        )
        topics = list(table.get(key, []))
        topics[index : index + 1] = [topic]
        allowed[key].check(self.node_name, key, topics)
        replace(**{key: topics})
        if direction == "output" and key in self._publishers:
            publisher = self._make_publisher(key, topic)
            self.node.destroy_publisher(self._publishers[key][index])
            self._publishers[key][index] = publisher
        elif direction == "input" and key in self._inputs:
            old, new = self._inputs[key][index], Input(topic, self.qos.get(key))
            new.on_message = old.on_message
            if old.is_open:
                new.open(self.node)
                old.close(self.node)
            self._inputs[key][index] = new
