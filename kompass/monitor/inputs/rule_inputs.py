"""Subscribe to what rules look at, with a quality of service that fits the publishers."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from kompass.bus.node import Node
from kompass.message_types import ros_class
from kompass.rclpy_ext.node import of_others
from kompass.rclpy_ext.qos import FOR_ANY_PUBLISHER, ReaderQoS, best_for
from kompass.rclpy_ext.unreadable import LeftOut, Unreadable, read_message
from kompass.rules.engine.compiled_table import CompiledTable

# Messages that wait for a monitor that is held up: a second of a fast topic. Of large ones fewer.
DEPTH = 1000
DEPTH_OF_LARGE = 10
# Messages of before that a latched reader may be given again: publishers keep one as a rule.
RECENT = 2
# s within which two readers are handed the same message. A reliable one that has just found the
# publisher gets it by asking for it again, and a busy machine takes its time between the two.
TOGETHER = 0.25
LARGE = ("Image", "CompressedImage", "PointCloud2", "OccupancyGrid")
# Topic, type, message, and the bytes that it came as.
Receive = Callable[[str, str, Any, bytes], None]


@dataclass
class _Input:
    """One subscription."""

    type_name: str
    kind: type[Any]
    subscription: Any
    offer: ReaderQoS
    left_out: LeftOut
    count: int = 0
    # Messages that came before the table that asked for the topic; None once it is in force.
    early: deque[tuple[Any, bytes]] | None = field(default=None)
    # The reader that is about to go; what only one of the two has brought so far, when, and which.
    leaving: Any = None
    single: dict[bytes, list[tuple[float, Any]]] = field(default_factory=dict)
    again: set[bytes] = field(default_factory=set)
    recent: deque[bytes] = field(default_factory=lambda: deque(maxlen=RECENT))


class RuleInputs:
    """Subscribes once to each topic of the table, whatever number of rules use it.

    Parameters
    ----------
    node
        Subscribes.
    receive
        Takes topic, type, message, and the bytes that it came as (CDR).

    Attributes
    ----------
    broken
        Topics that cannot be listened to, and why.
    """

    def __init__(self, node: Node, receive: Receive) -> None:
        self._node = node
        self._receive = receive
        self._open: dict[str, _Input] = {}
        self._untyped: set[str] = set()
        self.broken: dict[str, str] = {}

    def listens_to(self, topic: str) -> bool:
        """Whether there is a subscription to a topic; may be asked from any thread."""
        return topic in self._open

    def prepare(self, topics: Mapping[str, str]) -> None:
        """Subscribe already to what a coming table needs; messages wait until it is in force.

        Parameters
        ----------
        topics
            Types (``package/msg/Name``) by name, without a leading slash.
        """
        for name in topics:
            if topics[name] and name not in self._open:
                self._begin(name, topics[name], early=True)

    def follow(self, topics: Mapping[str, str]) -> None:
        """Listen to these topics (``package/msg/Name`` by name without slash), and to no others.

        A topic that stays is not touched. Without a type, the type that is on the graph is taken.
        """
        for name in [name for name in self._open if name not in topics]:
            gone = self._open.pop(name)
            self._node.destroy_subscription(gone.subscription)
            self._let_go(gone)
        self.broken = {name: why for name, why in self.broken.items() if name in topics}
        self._untyped = {name for name, kind in topics.items() if not kind}
        for name, kind in topics.items():
            known = self._open.get(name)
            if known is None:
                if kind:
                    self._begin(name, kind, early=False)
            elif known.early is not None:
                waiting, known.early = known.early, None
                for message, raw in waiting:
                    self._receive(name, known.type_name, message, raw)

    def counts(self) -> dict[str, int]:
        """Messages received so far, by topic."""
        return {name: each.count for name, each in self._open.items()}

    def fit(self) -> None:
        """Make each subscription as reliable, and as latched, as all of its publishers are.

        The old reader stays until the next call, by when the new one has found the publishers:
        nothing is missed in between, and what both are given is handled once.
        """
        if self._untyped:
            self._find_types()
        for name, each in self._open.items():
            if each.leaving is None:
                each.single.clear()
            self._let_go(each)
            best = self._offer(name, each.type_name)
            if best != each.offer:
                each.leaving, each.offer = each.subscription, best
                if best.latched:
                    each.again.update(each.recent)
                each.subscription = self._subscribe(name, each.kind, best)

    def _let_go(self, each: _Input) -> None:
        if each.leaving is not None:
            self._node.destroy_subscription(each.leaving)
            each.leaving = None
            each.again.clear()

    def _find_types(self) -> None:
        known = dict(self._node.get_topic_names_and_types())
        for name in sorted(self._untyped - set(self._open)):
            types = known.get(self._node.resolve_topic_name(name))
            if types:
                self._begin(name, types[0], early=False)

    def _begin(self, name: str, type_name: str, *, early: bool) -> None:
        try:
            kind = ros_class(type_name)
        except ValueError as error:
            # Of a table that was stored when the package was still there; the others go on.
            self.broken[name] = str(error)
            self._node.get_logger().error(f"cannot listen to {name}: {error}")
            return
        offer = self._offer(name, type_name)
        held: deque[tuple[Any, bytes]] | None = deque(maxlen=_depth(kind)) if early else None
        self._open[name] = _Input(
            type_name,
            kind,
            self._subscribe(name, kind, offer),
            offer,
            LeftOut(self._node, f"/{name}"),
            early=held,
        )

    def _offer(self, name: str, type_name: str) -> ReaderQoS:
        """The best that every publisher of a topic offers."""
        infos = self._node.get_publishers_info_by_topic(self._node.resolve_topic_name(name))
        # What rules publish with gives way to whoever else speaks there.
        infos = of_others(self._node, infos) or infos
        fitting = [info for info in infos if info.topic_type == type_name]
        if infos and not fitting:
            self.broken[name] = f"/{name} is published as {infos[0].topic_type}, not as {type_name}"
        else:
            self.broken.pop(name, None)
        known = self._open.get(name)
        return best_for(fitting, known.offer if known else FOR_ANY_PUBLISHER)

    def _subscribe(self, name: str, kind: type[Any], offer: ReaderQoS) -> Any:
        qos = offer.profile(_depth(kind))
        reader: list[Any] = []

        def take(raw: bytes) -> None:
            self._take(name, reader[0], raw)

        # Raw, so that the event log gets the very bytes that the engine's message was made of.
        reader.append(self._node.create_subscription(kind, name, take, qos, raw=True))
        return reader[0]

    def _take(self, name: str, reader: Any, raw: bytes) -> None:
        each = self._open.get(name)
        if each is None or reader not in (each.subscription, each.leaving):
            return  # was on its way when the subscription ended
        single = each.leaving is None and not each.single
        if not single and _is_second(each, reader, raw, self._node.clock.monotonic()):
            return
        each.count += 1
        each.recent.append(raw)
        try:
            message = read_message(raw, each.kind)
        except Unreadable as error:
            each.left_out.tell(error)
            return
        if each.early is not None:
            each.early.append((message, raw))
        else:
            self._receive(name, each.type_name, message, raw)


def _is_second(each: _Input, reader: Any, raw: bytes, now: float) -> bool:
    """Whether the other of two readers has brought this message already.

    rclpy tells no sequence numbers here, so it is known by its bytes. Of equal ones as many count
    as the one reader was given that the other was not.
    """
    if raw in each.again and reader is each.subscription:
        each.again.discard(raw)
        return True
    brought = [(when, by) for when, by in each.single.pop(raw, []) if when > now - TOGETHER]
    second = bool(brought) and brought[-1][1] is not reader
    if second:
        brought.pop()
    elif each.leaving is not None:
        brought.append((now, reader))
    if brought:
        each.single[raw] = brought
    return second


def _depth(kind: type[Any]) -> int:
    return DEPTH_OF_LARGE if kind.__name__ in LARGE else DEPTH


def topics_of(table: CompiledTable) -> dict[str, str]:
    """The topics that a table looks at, with a type each; empty where the rules tell none."""
    types = table.topic_types().items()
    return {name: min(kinds) if kinds else "" for name, kinds in types}
