"""All that rules are checked against: messages, components, functions of the recipe."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from kompass.components.base.component import Component
from kompass.monitor.introspection.component_specs import component_spec
from kompass.monitor.introspection.message_types import MessageTypes
from kompass.recipe.table import RecipeRules
from kompass.rules.checks.catalog import ComponentSpec


class RecipeCatalog(MessageTypes):
    """What is installed, and what a recipe brings.

    Parameters
    ----------
    components
        Of the launcher.
    rules
        Of the recipe; their functions are known by name.
    """

    def __init__(self, components: Sequence[Component], rules: RecipeRules) -> None:
        self._components = {each.node_name: component_spec(each) for each in components}
        self._functions = frozenset((*rules.functions, *rules.polled))
        self.publishes = {
            name: spec.speaks.union(status_topics(name)) for name, spec in self._components.items()
        }

    def components(self) -> Mapping[str, ComponentSpec]:
        """The components of the stack by node name."""
        return self._components

    def functions(self) -> Collection[str]:
        """Names of the recipe's functions that rules may call or poll."""
        return self._functions


def status_topics(component: str) -> tuple[str, str]:
    """The topics on which a component tells its health, in both generations' names."""
    return f"{component}/status", f"{component}_status"
