"""What rules can be made of on the running robot."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence

from rclpy.qos import DurabilityPolicy

from kompass.bus.node import Node
from kompass.monitor.introspection.catalog import RecipeCatalog, status_topics
from kompass.monitor.introspection.message_types import constants
from kompass.monitor.introspection.refused import refused
from kompass.rclpy_ext.node import of_others
from kompass.rulebook.lint.context import LintContext, TopicFacts
from kompass.rulebook.permissions import Permissions
from kompass.rulebook.schema.graph_view import (
    ComponentView,
    FieldView,
    GraphView,
    MethodView,
    ParameterView,
    TargetView,
    TopicView,
)
from kompass.rules.checks.catalog import ComponentSpec
from kompass.rules.schema.signals import path_text

# Of the machinery that every node has, and no rule is made of.
_HIDDEN_TOPICS = ("rosout", "parameter_events")
_HIDDEN_SERVICES = (
    "rcl_interfaces/",
    "type_description_interfaces/",
    "lifecycle_msgs/",
    "kompass_interfaces/srv/SignedCall",  # an envelope, which nobody closes by hand
)


class Graph:
    """Looks at the graph from one node; may be used from any thread.

    Parameters
    ----------
    node
        Asks what there is.
    catalog
        What is installed, and what the recipe brings.
    counts
        Messages received so far, by topic.
    own
        Topics on which the node itself stands ready to publish for rules: it is no publisher that
        a rule could wait for.
    permissions
        What rules of people may touch.
    """

    def __init__(
        self,
        node: Node,
        catalog: RecipeCatalog,
        counts: Callable[[], dict[str, int]],
        own: Callable[[], Collection[str]] = tuple,
        *,
        permissions: Permissions,
    ) -> None:
        self._node, self._catalog, self._counts, self._own = node, catalog, counts, own
        self._permissions = permissions
        self._rates: dict[str, float] = {}
        self._before: tuple[float, dict[str, int]] = (node.clock.monotonic(), {})
        self._heard: dict[str, float] = {}  # when a message last came, at most

    def measure(self) -> None:
        """Take note of how fast messages come; to be called every two seconds or so."""
        now, counts = self._node.clock.monotonic(), self._counts()
        then, before = self._before
        self._heard = {
            name: now if count != before.get(name, 0) else self._heard.get(name, now)
            for name, count in counts.items()
        }
        self._rates = {
            name: (count - before[name]) / (now - then)
            for name, count in counts.items()
            if name in before and count > before[name]
        }
        self._before = (now, counts)

    def facts(self) -> LintContext:
        """What lints must know of the robot."""
        return LintContext(
            topics={
                each.name: TopicFacts(each.type, each.rate, each.latched, each.publishers)
                for each in self._topics()
            },
            services=_offered(self._node.get_service_names_and_types()),
            actions=_offered(self._node.get_action_names_and_types()),
            components=self._catalog.components(),
            publishes=self._catalog.publishes,
            messages=self._catalog,
        )

    def view(self) -> GraphView:
        """Everything, with the fields of all types that occur in it."""
        topics = tuple(self._topics())
        services, actions = tuple(self._services()), tuple(self._actions())
        named = [each.type for each in topics]
        named += [f"{each.type}_Request" for each in services]
        named += [f"{each.type}_Goal" for each in actions]
        view = GraphView(
            topics=topics,
            types={name: fields for name in dict.fromkeys(named) if (fields := self._fields(name))},
            components=tuple(map(_component, self._catalog.components().values())),
            services=services,
            actions=actions,
            functions=tuple(sorted(self._catalog.functions())),
        )
        return view.model_copy(update={"refused": refused(view, self._permissions)})

    def _topics(self) -> Iterable[TopicView]:
        status = {
            name: component
            for component in self._catalog.components()
            for name in status_topics(component)
        }
        own = self._own()
        for full, types in sorted(self._node.get_topic_names_and_types()):
            name = full.removeprefix("/")
            if name in _HIDDEN_TOPICS or "/_action/" in full or not types:
                continue
            infos = self._node.get_publishers_info_by_topic(full)
            if name in own:
                infos = of_others(self._node, infos)
            latched = bool(infos) and all(
                info.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for info in infos
            )
            yield TopicView(
                name=name,
                type=types[0],
                latched=latched,
                publishers=len(infos),
                component=status.get(name, ""),
                rate=self._rates.get(name),
                silent=self._silent(name),
            )

    def _silent(self, name: str) -> float | None:
        heard = self._heard.get(name)
        if heard is None or name in self._rates:
            return None
        return round(self._node.clock.monotonic() - heard, 1)

    def _services(self) -> Iterable[TargetView]:
        for full, types in sorted(self._node.get_service_names_and_types()):
            if "/_action/" in full or not types or types[0].startswith(_HIDDEN_SERVICES):
                continue
            yield TargetView(name=full.removeprefix("/"), type=types[0])

    def _actions(self) -> Iterable[TargetView]:
        for full, types in sorted(self._node.get_action_names_and_types()):
            if types:
                yield TargetView(name=full.removeprefix("/"), type=types[0])

    def _fields(self, type_name: str) -> tuple[FieldView, ...]:
        owners: dict[tuple[str | int, ...], str] = {(): type_name}
        made = []
        for path, found in self._catalog.walk(type_name):
            if found.kind == "message":
                owners[path] = found.name
            owner = owners.get(path[:-1], "")
            made.append(
                FieldView(
                    path=path,
                    text=path_text(path),
                    kind=found.kind,
                    element=""
                    if found.element is None
                    else found.element.name or found.element.kind,
                    constants=constants(owner, str(path[-1])) if found.kind == "int" else {},
                )
            )
        return tuple(made)


def _offered(named: Iterable[tuple[str, Sequence[str]]]) -> dict[str, Collection[str]]:
    """Types by name, without the leading slash; the services that make an action are its own."""
    return {full.removeprefix("/"): types for full, types in named if "/_action/" not in full}


def _component(spec: ComponentSpec) -> ComponentView:
    return ComponentView(
        name=spec.name,
        kind=spec.kind,
        methods=tuple(
            MethodView(
                name=method.name,
                text=method.text,
                arguments=tuple(
                    ParameterView(
                        name=argument.name,
                        kind=argument.kind,
                        value=argument.default,
                        text=argument.text or ("" if argument.required else "may be left out"),
                    )
                    for argument in method.arguments
                ),
            )
            for method in spec.methods.values()
        ),
        parameters=tuple(
            ParameterView(name=each.name, kind=each.kind, value=each.value, text=each.text)
            for each in spec.parameters.values()
            if each.kind != "object"
        ),
    )
