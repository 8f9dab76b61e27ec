"""The network between nodes: who is there, who hears whom, and how long it takes.

It knows writers and readers, and not what they write. A topic has those of its publishers and
subscriptions, a service two of each, and an action is made of services and topics, as in ROS.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Container, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum

from kompass.virtual.qos import QoS
from kompass.virtual.scheduler import Scheduler, nanoseconds

LEASE = 20.0  # s for which DDS believes in a process that was killed (Fast DDS' lease)
LONG = 50_000_000  # ns; who takes longer to send something has slept before
GID_PREFIX = 12  # bytes of an endpoint's id that name its process (RTPS 2.5, 9.3.1)

Kind = Literal["topic", "request", "response"]


@dataclass(frozen=True)
class Conditions:
    """What a message meets on its way.

    Attributes
    ----------
    fastest, slowest
        Seconds that it takes: any time between them is as likely.
    loss
        Share of the messages that get lost, where the reader did not ask for a reliable writer.
    """

    fastest: float = 0.0001
    slowest: float = 0.0004
    loss: float = 0.0

    def __post_init__(self) -> None:
        if not 0 <= self.fastest <= self.slowest:
            raise ValueError(
                f"Conditions: fastest = {self.fastest!r} s and slowest = {self.slowest!r} s; "
                "choose 0 <= fastest <= slowest"
            )
        if not 0 <= self.loss <= 1:
            raise ValueError(f"Conditions: loss = {self.loss!r} must be within 0 and 1")


class Owner(Protocol):
    """The process that an endpoint is in, as far as the network looks at it."""

    @property
    def name(self) -> str: ...
    @property
    def prefix(self) -> bytes: ...
    @property
    def sending_delay(self) -> int:
        """How much later than now leaves what it sends [ns]."""

    @property
    def dead(self) -> bool:
        """Whether it has ended, in whatever way."""

    @property
    def answers(self) -> bool:
        """Whether it acknowledges what it gets: it is neither dead nor stopped."""


class Endpoint:
    """One end of a topic or service, in a node.

    Attributes
    ----------
    name
        Of the topic or service, with its namespace.
    type_name
        As in "std_msgs/msg/Bool".
    born
        Monotonic time [ns].
    number
        No other endpoint has it.
    closed
        Whether nothing comes in or goes out any more. The others may not know it yet.
    """

    def __init__(
        self,
        network: Network,
        owner: Owner,
        node: NodeEntry,
        kind: Kind,
        name: str,
        type_name: str,
        qos: QoS,
    ) -> None:
        self.network, self.owner, self.node = network, owner, node
        self.kind, self.name, self.type_name, self.qos = kind, name, type_name, qos
        self.born = network.scheduler.now
        self.closed = False
        self.links: list[Link] = []
        self.number = network.new_number()

    @property
    def gid(self) -> bytes:
        """Its id on the network, which begins with that of its process."""
        return self.owner.prefix + self.number.to_bytes(4, "big")

    def close(self) -> None:
        """Take it from the network, which is told at once."""
        self.closed = True
        self.network.forget(self)


class Writer(Endpoint):
    """Sends to the readers that it is matched with.

    Attributes
    ----------
    alter
        What becomes of all that is sent; None for nothing.
    """

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.alter: Callable[[Any], Any] | None = None
        self._kept: deque[Any] = deque(maxlen=self.qos.depth)
        self._keeps = self.qos.latched
        self.network.add(self)

    def send(self, data: Any) -> None:
        """Send to all."""
        if self.closed:
            return
        if self.alter is not None:
            data = self.alter(data)
        if self.network.ear is not None and self.kind == "topic":
            self.network.ear(self, data)
        if self._keeps:
            self._kept.append(data)
        for link in self.links:
            link.send(data)

    def send_kept(self, link: Link) -> None:
        """Send to one that has just come what it asks to be given of before."""
        if self._keeps and link.reader.qos.latched:
            for data in self._kept:
                link.send(data)

    @property
    def acknowledged(self) -> bool:
        """Whether all that asked for it are there to acknowledge what was sent."""
        return all(link.reader.owner.answers for link in self.links if link.reliable)


class Reader(Endpoint):
    """Takes what comes, as much as its depth allows until they are read.

    Parameters
    ----------
    arrived
        Called for each message that there is one more of to be taken.
    """

    def __init__(self, *args: Any, arrived: Callable[[], object]) -> None:
        super().__init__(*args)
        self._arrived = arrived
        self.queue: deque[Any] = deque(maxlen=self.qos.depth)
        self.network.add(self)

    def arrive(self, data: Any) -> None:
        """Take in what comes over the network; the oldest makes room."""
        if self.closed:
            return
        queue = self.queue
        full = len(queue) == queue.maxlen
        queue.append(data)
        if not full:
            self._arrived()


class Link:
    """The way from a writer to a reader; what is sent on it arrives in its order."""

    __slots__ = ("_last", "_loss", "_network", "_random", "_shortest", "_spread", "reader",
                 "reliable", "writer")  # fmt: skip

    def __init__(self, network: Network, writer: Writer, reader: Reader) -> None:
        self._network, self.writer, self.reader = network, writer, reader
        self.reliable = reader.qos.reliable
        self._random = network.chance.random
        self._last = 0
        self.look_up()

    def look_up(self) -> None:
        """Take over the conditions that hold for it by now."""
        found = self._network.conditions_of(self.writer, self.reader)
        self._shortest = nanoseconds(found.fastest)
        self._spread = nanoseconds(found.slowest) - self._shortest
        self._loss = 0.0 if self.reliable else found.loss

    def send(self, data: Any) -> None:
        """Send on its way."""
        if self._loss and self._random() < self._loss:
            return
        scheduler = self._network.scheduler
        delay = self.writer.owner.sending_delay
        at = scheduler.now + delay + self._shortest
        at += int(self._random() * self._spread)
        if at <= self._last:
            at = self._last + 1
        self._last = at
        arrive = self.reader.arrive if delay < LONG else self._arrive_unless_dead
        scheduler.call_at(at, arrive, data)

    def _arrive_unless_dead(self, data: Any) -> None:
        """Of a callback that slept before it sent: its process may have died meanwhile."""
        if not self.writer.owner.dead:
            self.reader.arrive(data)


class NodeEntry:
    """A node as the others know it."""

    def __init__(self, owner: Owner, name: str, namespace: str, born: int) -> None:
        self.owner, self.name, self.namespace, self.born = owner, name, namespace, born


class Network:
    """A domain of its own.

    Parameters
    ----------
    scheduler
        Its time, and chance.
    conditions
        Where nothing else is said.
    discovery
        Seconds until the others know of what is new.
    lease
        Seconds until they know that a process was killed.

    Attributes
    ----------
    ear
        Told of all that is sent on topics, and by whom, without a part in it: it costs no time and
        no chance.
    """

    def __init__(
        self,
        scheduler: Scheduler,
        *,
        conditions: Conditions | None = None,
        discovery: float = 0.0,
        lease: float = LEASE,
    ) -> None:
        self.scheduler = scheduler
        self.chance = scheduler.random("network")
        self.lease = nanoseconds(lease)
        self._discovery = nanoseconds(discovery)
        self._conditions = conditions or Conditions()
        self._of_topic: dict[str, Conditions] = {}
        self._of_process: dict[str, Conditions] = {}
        # The order of all these is that in which they came: sets would have one of addresses.
        self._writers: dict[tuple[Kind, str], list[Writer]] = {}
        self._readers: dict[tuple[Kind, str], list[Reader]] = {}
        self._nodes: list[NodeEntry] = []
        self._numbers = 0
        self.ear: Callable[[Writer, Any], object] | None = None

    # -- conditions ---------------------------------------------------------------------------

    def set_conditions(
        self, conditions: Conditions, *, topic: str | None = None, process: str | None = None
    ) -> None:
        """Change what messages meet from now on.

        Parameters
        ----------
        topic
            Only on this topic or service (its full name), whatever is said of processes.
        process
            Only what this process sends or gets.
        """
        if topic is not None:
            self._of_topic[topic] = conditions
        elif process is not None:
            self._of_process[process] = conditions
        else:
            self._conditions = conditions
        for writers in self._writers.values():
            for writer in writers:
                for link in writer.links:
                    link.look_up()

    def conditions_of(self, writer: Writer, reader: Reader) -> Conditions:
        """What a message from one to the other meets."""
        return (
            self._of_topic.get(writer.name)
            or self._of_process.get(writer.owner.name)
            or self._of_process.get(reader.owner.name)
            or self._conditions
        )

    # -- who is there -------------------------------------------------------------------------

    def new_number(self) -> int:
        """A number for an endpoint."""
        self._numbers += 1
        return self._numbers

    def add_node(self, owner: Owner, name: str, namespace: str) -> NodeEntry:
        """Let others know of a node."""
        entry = NodeEntry(owner, name, namespace, self.scheduler.now)
        self._nodes.append(entry)
        return entry

    def remove_node(self, entry: NodeEntry) -> None:
        """Let them know that it has gone."""
        if entry in self._nodes:
            self._nodes.remove(entry)

    def add(self, endpoint: Writer | Reader) -> None:
        """Match what is new with what is there.

        Raises
        ------
        rclpy._rclpy_pybind11.RCLError
            When its process has the name with another type: a participant of DDS has one of each.
        """
        key = endpoint.kind, endpoint.name
        for ends in (self._writers, self._readers):
            for other in ends.get(key, ()):
                if other.owner is endpoint.owner and other.type_name != endpoint.type_name:
                    raise rclpy_implementation.RCLError(
                        f"{endpoint.name} is {other.type_name} in this process already, with "
                        f"which {endpoint.type_name} is incompatible"
                    )
        if isinstance(endpoint, Writer):
            self._writers.setdefault(key, []).append(endpoint)
            pairs = [(endpoint, reader) for reader in self._readers.get(key, ())]
        else:
            self._readers.setdefault(key, []).append(endpoint)
            pairs = [(writer, endpoint) for writer in self._writers.get(key, ())]
        for writer, reader in pairs:
            if writer.type_name != reader.type_name or not writer.qos.serves(reader.qos):
                continue
            if self._discovery and writer.owner is not reader.owner:
                self.scheduler.call_later(self._discovery, self._match, writer, reader)
            else:
                self._match(writer, reader)

    def _match(self, writer: Writer, reader: Reader) -> None:
        if writer.closed or reader.closed:
            return
        link = Link(self, writer, reader)
        writer.links.append(link)
        reader.links.append(link)
        writer.send_kept(link)

    def forget(self, endpoint: Endpoint) -> None:
        """Take an endpoint from the graph and from those that it is matched with."""
        key = endpoint.kind, endpoint.name
        ends = self._writers if isinstance(endpoint, Writer) else self._readers
        there = ends.get(key, [])
        if endpoint in there:
            there.remove(endpoint)  # type: ignore[arg-type]
            if not there:
                del ends[key]
        for link in endpoint.links:
            other = link.reader if link.writer is endpoint else link.writer
            other.links.remove(link)
        endpoint.links.clear()

    def forget_later(self, endpoints: Sequence[Endpoint], entries: Sequence[NodeEntry]) -> None:
        """As of a process that was killed: nobody is told, and its lease runs out."""

        def run_out() -> None:
            for endpoint in endpoints:
                self.forget(endpoint)
            for entry in entries:
                self.remove_node(entry)

        if self.lease:
            self.scheduler.call_later(self.lease, run_out)
        else:
            run_out()

    def writers_of(self, owner: Owner, nodes: Container[str]) -> list[Writer]:
        """What some nodes of a process publish topics with."""
        return [
            each
            for (kind, _), writers in self._writers.items()
            for each in writers
            if kind == "topic" and each.owner is owner and each.node.name in nodes
        ]

    # -- what can be asked --------------------------------------------------------------------

    def knows(self, asker: Owner, each: Endpoint | NodeEntry) -> bool:
        """Whether a process has found something."""
        if not self._discovery or each.owner is asker:
            return True
        return each.born + self._discovery <= self.scheduler.now

    def nodes(self, asker: Owner) -> Iterator[NodeEntry]:
        """The nodes that a process knows of."""
        return (entry for entry in self._nodes if self.knows(asker, entry))

    def writers(self, asker: Owner, kind: Kind, name: str) -> list[Writer]:
        """The writers of one name that a process knows of."""
        return [each for each in self._writers.get((kind, name), ()) if self.knows(asker, each)]

    def readers(self, asker: Owner, kind: Kind, name: str) -> list[Reader]:
        """The readers of one name that a process knows of."""
        return [each for each in self._readers.get((kind, name), ()) if self.knows(asker, each)]

    def endpoints(self, asker: Owner, kind: Kind) -> Iterator[Writer | Reader]:
        """All ends of topics, or of requests (whose readers are servers), that it knows of."""
        for ends in (self._writers, self._readers):
            for (found, _), several in ends.items():
                if found == kind:
                    yield from (each for each in several if self.knows(asker, each))


def names_and_types(endpoints: Iterator[Writer | Reader]) -> list[tuple[str, list[str]]]:
    """Names with all their types, in the order of the alphabet, as rclpy has them."""
    found: dict[str, set[str]] = {}
    for each in endpoints:
        found.setdefault(each.name, set()).add(each.type_name)
    return [(name, sorted(types)) for name, types in sorted(found.items())]


def endpoint_info(endpoint: Endpoint) -> TopicEndpointInfo:
    """What rclpy tells of an endpoint."""
    return TopicEndpointInfo(
        node_name=endpoint.node.name,
        node_namespace=endpoint.node.namespace,
        topic_type=endpoint.type_name,
        endpoint_type=TopicEndpointTypeEnum.PUBLISHER
        if isinstance(endpoint, Writer)
        else TopicEndpointTypeEnum.SUBSCRIPTION,
        endpoint_gid=list(endpoint.gid),
        qos_profile=endpoint.qos.profile,
    )
