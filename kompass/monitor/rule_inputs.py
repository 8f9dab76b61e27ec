"""Subscribe to what rules look at, with a quality of service that fits the publishers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from kompass.recipe.messages import ros_class

DEPTH = 100
# A best-effort reader matches every publisher at once, so nothing waits for discovery. Once the
# publishers are known, the reader is made as good as they are.
FIRST = (ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.VOLATILE)
Offer = tuple[ReliabilityPolicy, DurabilityPolicy]


class RuleInputs:
    """One subscription per topic of the table, whatever number of rules use it."""

    def __init__(self, node: Node, receive: Callable[[str, Any], None]) -> None:
        self._node = node
        self._receive = receive
        self._open: dict[str, tuple[Any, Offer, Any]] = {}

    def follow(self, topics: Iterable[tuple[str, str]]) -> None:
        """Listen to these topics (name without slash, ``package/msg/Name``), and to no others."""
        wanted = dict(topics)
        for name in [name for name in self._open if name not in wanted]:
            self._node.destroy_subscription(self._open.pop(name)[0])
        for name, kind in wanted.items():
            if name not in self._open:
                message = ros_class(kind)
                self._open[name] = (self._subscribe(name, message, FIRST), FIRST, message)

    def fit(self) -> None:
        """Make each subscription as reliable, and as latched, as all of its publishers are."""
        for name, (subscription, offer, message) in list(self._open.items()):
            resolved = self._node.resolve_topic_name(name)
            offers = [
                (info.qos_profile.reliability, info.qos_profile.durability)
                for info in self._node.get_publishers_info_by_topic(resolved)
            ]
            if not offers:
                continue
            reliable = all(each[0] == ReliabilityPolicy.RELIABLE for each in offers)
            latched = all(each[1] == DurabilityPolicy.TRANSIENT_LOCAL for each in offers)
            best = (
                ReliabilityPolicy.RELIABLE if reliable else FIRST[0],
                DurabilityPolicy.TRANSIENT_LOCAL if latched else FIRST[1],
            )
            if best != offer:
                # The old one goes first: for the moment of the change a message may be missed, but
                # none is handled twice.
                self._node.destroy_subscription(subscription)
                self._open[name] = (self._subscribe(name, message, best), best, message)

    def _subscribe(self, name: str, message: Any, offer: Offer) -> Any:
        qos = QoSProfile(depth=DEPTH, reliability=offer[0], durability=offer[1])
        return self._node.create_subscription(
            message, name, lambda received: self._receive(name, received), qos
        )
