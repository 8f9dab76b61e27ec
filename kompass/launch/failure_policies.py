"""What a launcher does about failures of all its components, and of their processes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

from kompass.components.base.component import Component
from kompass.supervisor.restarts import RETRIES

FailureKind = Literal[
    "on_fail", "on_algorithm_fail", "on_component_fail", "on_system_fail", "on_giveup"
]


class _Policy(NamedTuple):
    kind: FailureKind
    action_name: str
    max_retries: int | None


class FailurePolicies:
    """Fallbacks for all components at once; what a recipe says of a single one goes before.

    Attributes
    ----------
    process_retries
        How often in a row a process that died is started again before it is given up.
    """

    def __init__(self) -> None:
        self.process_retries = RETRIES
        self._policies: list[_Policy] = []

    def set_process_retries(self, max_retries: int) -> None:
        """Set :attr:`process_retries`.

        Raises
        ------
        ValueError
            When it is no positive whole number.
        """
        if not isinstance(max_retries, int) or isinstance(max_retries, bool) or max_retries < 1:
            raise ValueError(f"on_process_fail: max_retries = {max_retries!r}; give 1 or more")
        self.process_retries = max_retries

    def add(
        self,
        kind: FailureKind,
        action_name: str,
        max_retries: int | None,
        components: Sequence[Component],
    ) -> None:
        """Have each component that has an action do it on a kind of failure.

        Raises
        ------
        ValueError
            When there are components, and none of them has it.
        """
        policy = _Policy(kind, action_name, max_retries)
        if components:
            _check(policy, components)
        self._policies.append(policy)

    def apply(self, components: Sequence[Component]) -> None:
        """Give the fallbacks to the components that have none of that kind.

        Raises
        ------
        ValueError
            When none of them has the action of a policy that was stated before they were added.
        """
        for policy in self._policies:
            _check(policy, components)
        for component in components:
            for kind, name, max_retries in self._policies:
                stated = getattr(component.fallbacks, kind) is not None
                if not stated and name in component.available_actions:
                    getattr(component, kind)(getattr(component, name), max_retries)


def _check(policy: _Policy, components: Sequence[Component]) -> None:
    known = {name for component in components for name in component.available_actions}
    if policy.action_name not in known:
        raise ValueError(
            f"launcher.{policy.kind}: no component has an action '{policy.action_name}'; "
            f"known are {', '.join(sorted(known))}"
        )
