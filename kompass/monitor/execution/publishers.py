"""The publishers of rules: there before a rule fires, so that who listens has found them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

from rclpy.qos import DurabilityPolicy, QoSProfile

from kompass.bus.node import Node
from kompass.message_types import ros_class
from kompass.rclpy_ext.node import of_others
from kompass.rclpy_ext.qos import best_for
from kompass.recipe.fallbacks import FallbackSequence
from kompass.recipe.parsed import Parsed
from kompass.rulebook.permissions import Permissions
from kompass.rules.schema.actions import Action, Publish, Python
from kompass.rules.schema.table import Table

DEPTH = 1000  # messages that a slow listener may be behind
DEPTH_OF_LATCHED = 1
Functions: TypeAlias = Mapping[str, Callable[..., Any] | Parsed | FallbackSequence]


class Target(NamedTuple):
    """Topic without a leading slash, and type (``package/msg/Name``)."""

    topic: str
    type_name: str


class Listeners(NamedTuple):
    """Who hears a publisher.

    Attributes
    ----------
    matched
        Readers that are given what it says.
    unfit
        Readers of the type that ask for what it does not offer.
    """

    matched: int
    unfit: int


@dataclass(eq=False)
class RulePublisher:
    """A publisher, in use by ``users`` runs."""

    node: Node
    key: Target
    handle: Any
    latched: bool
    users: int = 0
    kept: bool = True

    def publish(self, message: Any) -> None:
        """Send a message."""
        self.handle.publish(message)

    def listeners(self) -> Listeners:
        """Who listens now."""
        readers = self.node.get_subscriptions_info_by_topic(
            self.node.resolve_topic_name(self.key.topic)
        )
        fit = [
            self.latched or info.qos_profile.durability != DurabilityPolicy.TRANSIENT_LOCAL
            for info in readers
            if info.topic_type == self.key.type_name
        ]
        return Listeners(self.handle.get_subscription_count(), fit.count(False))

    def has_found_all(self) -> bool:
        """Whether every listener that the graph knows is connected, and there is one."""
        readers = self.node.count_subscribers(self.node.resolve_topic_name(self.key.topic))
        matched = self.handle.get_subscription_count()
        return bool(matched and (matched >= readers or matched >= readers - self.listeners().unfit))


class Publishers:
    """One publisher for each topic that rules in force publish on; on the executor's thread.

    Where it matters who could speak even while it is silent (the drive manager halts for a second
    publisher of velocities) there is one only while a rule publishes.

    Parameters
    ----------
    node
        Publishes.
    permissions
        What rules may touch: nobody stands ready for what will be refused.
    functions
        What the recipe's opaque actions are called; some of them publish.
    """

    def __init__(self, node: Node, permissions: Permissions, functions: Functions) -> None:
        self._node, self._permissions, self._functions = node, permissions, functions
        self._open: dict[Target, RulePublisher] = {}

    @property
    def topics(self) -> frozenset[str]:
        """Names of the topics with a publisher, without the leading slash."""
        return frozenset(key.topic for key in list(self._open))

    def is_open(self, target: Target) -> bool:
        """Whether there is a publisher already; may be asked from any thread."""
        return target in self._open

    def targets(self, table: Table) -> frozenset[Target]:
        """What a table needs; may be asked from any thread."""
        return frozenset(
            Target(each.topic, each.type)
            for rule in table.rules
            if rule.enabled and not rule.shadow
            for action in rule.actions
            for each in self._meant(action)
            if isinstance(each, Publish)
            and not self._permissions.is_watched(each)
            and self._permissions.refusal(rule, action) is None
        )

    def prepare(self, wanted: Collection[Target]) -> None:
        """Open what a coming table needs."""
        for key in wanted:
            if key not in self._open:
                self._try_to_open(key)

    def follow(self, wanted: Collection[Target]) -> None:
        """Keep what a table needs, and nothing else; what is in use stays until it is not."""
        self.prepare(wanted)
        for key, each in list(self._open.items()):
            if key not in wanted:
                del self._open[key]
                self._retire(each)

    def fit(self) -> None:
        """Keep the last message for those who come later where every other publisher does.

        Readers ask of a topic what all of its publishers offer: one that offered less would take
        the map from whoever comes after it was published.
        """
        for key, each in list(self._open.items()):
            if self._should_latch(key, each.latched) != each.latched:
                del self._open[key]
                self._retire(each)
                self._try_to_open(key)

    @contextmanager
    def lease(self, action: Publish) -> Iterator[RulePublisher]:
        """The publisher for an action, to be used until the block ends.

        Raises
        ------
        ValueError
            When its message type is not installed.
        RCLError
            When the middleware refuses it, as for a second type on one topic.
        """
        key = Target(action.topic, action.type)
        each = self._open.get(key) or self._make(key, kept=False)
        each.users += 1
        try:
            yield each
        finally:
            each.users -= 1
            if not each.kept:
                self._retire(each)

    def _meant(self, action: Action) -> tuple[Action, ...]:
        entry = self._functions.get(action.name) if isinstance(action, Python) else None
        if isinstance(entry, Parsed):
            return (entry.action,)
        if isinstance(entry, FallbackSequence):
            return (*entry.actions, *entry.giveup)
        return (action,)

    def _try_to_open(self, key: Target) -> None:
        try:
            self._open[key] = self._make(key, kept=True)
        except Exception as error:  # noqa: BLE001 - the action says so when it is carried out
            self._node.get_logger().error(f"cannot publish on /{key.topic}: {error}")

    def _make(self, key: Target, *, kept: bool) -> RulePublisher:
        latched = self._should_latch(key, False)
        profile = QoSProfile(depth=DEPTH)
        if latched:
            profile = QoSProfile(
                depth=DEPTH_OF_LATCHED, durability=DurabilityPolicy.TRANSIENT_LOCAL
            )
        handle = self._node.create_publisher(ros_class(key.type_name), key.topic, profile)
        return RulePublisher(self._node, key, handle, latched, kept=kept)

    def _should_latch(self, key: Target, now: bool) -> bool:
        infos = self._node.get_publishers_info_by_topic(self._node.resolve_topic_name(key.topic))
        others = of_others(self._node, infos)
        return best_for(others).latched if others else now

    def _retire(self, each: RulePublisher) -> None:
        each.kept = False
        if not each.users:
            self._node.destroy_publisher(each.handle)
