"""What a launcher does about failures of its components and of their processes."""

from __future__ import annotations

from kompass.components.base.component import Component
from kompass.supervisor.restarts import RETRIES


class FailurePolicies:
    """Rules for all components at once; what a recipe says of a single one goes before."""

    def __init__(self) -> None:
        self._components: list[Component] = []
        self._retries = RETRIES
        self._policies: list[tuple[str, str, int | None]] = []

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
        if not isinstance(max_retries, int) or isinstance(max_retries, bool) or max_retries < 1:
            raise ValueError(f"on_process_fail: max_retries = {max_retries!r}; give 1 or more")
        self._retries = max_retries

    def on_fail(self, action_name: str = "restart", max_retries: int | None = None) -> None:
        """What every component does on a failure, unless the recipe gave it a fallback of its own.

        Parameters
        ----------
        action_name
            A component action, e.g. "restart"; only components that have it are meant.

        Raises
        ------
        ValueError
            When no component has it.
        """
        self._add_policy("on_fail", action_name, max_retries)

    def on_algorithm_fail(
        self, action_name: str = "restart", max_retries: int | None = None
    ) -> None:
        """As :meth:`on_fail`, when an algorithm finds no answer."""
        self._add_policy("on_algorithm_fail", action_name, max_retries)

    def on_component_fail(
        self, action_name: str = "restart", max_retries: int | None = None
    ) -> None:
        """As :meth:`on_fail`, about a defect of a component itself."""
        self._add_policy("on_component_fail", action_name, max_retries)

    def on_system_fail(self, action_name: str = "restart", max_retries: int | None = None) -> None:
        """As :meth:`on_fail`, when something outside is missing."""
        self._add_policy("on_system_fail", action_name, max_retries)

    def on_giveup(self, action_name: str = "stop", max_retries: int | None = 1) -> None:
        """As :meth:`on_fail`, when all other fallbacks were tried in vain."""
        self._add_policy("on_giveup", action_name, max_retries)

    def _add_policy(self, kind: str, action_name: str, max_retries: int | None) -> None:
        known = {name for component in self._components for name in component.available_actions}
        if self._components and action_name not in known:
            raise ValueError(
                f"launcher.{kind}: no component has an action '{action_name}'; "
                f"known are {', '.join(sorted(known))}"
            )
        self._policies.append((kind, action_name, max_retries))

    def _apply_policies(self) -> None:
        for kind, name, max_retries in self._policies:
            for component in self._components:
                if (
                    getattr(component.fallbacks, kind) is None
                    and name in component.available_actions
                ):
                    getattr(component, kind)(getattr(component, name), max_retries)
