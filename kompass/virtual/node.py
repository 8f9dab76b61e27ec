"""A node on the virtual network; see :class:`kompass.bus.node.Node`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import Executor as Threads
from functools import partial
from typing import Any, Protocol, TypeVar

from rclpy.clock import ClockType
from rclpy.exceptions import InvalidHandle
from rclpy.expand_topic_name import expand_topic_name
from rclpy.lifecycle import LifecycleNode
from rclpy.node import NodeNameNonExistentError
from rclpy.task import Future
from rclpy.time import Time
from rclpy.type_support import check_is_valid_msg_type, check_is_valid_srv_type
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_topic_name import validate_topic_name

from kompass.bus.clock import Clock
from kompass.bus.node import Execute, HeardInPart, NamesAndTypes
from kompass.message_types import type_name
from kompass.printable import printable
from kompass.rclpy_ext.unreadable import LeftOut, Unreadable
from kompass.virtual.actions import VirtualActionClient, VirtualActionServer, action_names_and_types
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.log import VirtualLog
from kompass.virtual.network import (
    Endpoint,
    Kind,
    NodeEntry,
    Reader,
    Writer,
    endpoint_info,
    names_and_types,
)
from kompass.virtual.process import VirtualProcess
from kompass.virtual.qos import QoS, qos_of
from kompass.virtual.scheduler import Event, nanoseconds
from kompass.virtual.threads import VirtualThreads
from kompass.virtual.wire import Packet, fields_of

_SERVICE_QOS = qos_of(10, "services")  # rmw_qos_profile_services_default
Header = tuple[int, int]  # of a request and its answer: the client, and its number there


class _Part(Protocol):
    @property
    def ends(self) -> tuple[Endpoint, ...]: ...


P = TypeVar("P", bound=_Part)


class NotOnThisBus(AttributeError):
    """A program uses something of rclpy that virtual time does not have."""


class VirtualPublisher:
    """See :class:`kompass.bus.node.Publisher`."""

    def __init__(self, node: VirtualNode, msg_type: Any, topic: str, qos: QoS) -> None:
        self._node, self.msg_type, self.topic_name = node, msg_type, topic
        self.qos_profile = qos.profile
        self._writer = Writer(*node.place("topic", topic, type_name(msg_type), qos))
        self.ends: tuple[Endpoint, ...] = (self._writer,)

    def publish(self, message: Any) -> None:
        """Send a message, or one that is serialized already (bytes).

        Raises
        ------
        TypeError
            When it is of another type.
        rclpy.exceptions.InvalidHandle
            When it was destroyed.
        """
        self._check()
        if isinstance(message, self.msg_type):
            self._writer.send(Packet.of(message))
        elif isinstance(message, bytes):
            self._writer.send(Packet(data=message))
        else:
            raise TypeError(f"Expected {self.msg_type}, got {type(message)}")

    def get_subscription_count(self) -> int:
        """How many listen whose quality of service fits."""
        self._check()
        return len(self._writer.links)

    def wait_for_all_acked(self, timeout: Any) -> bool:
        """Whether all reliable listeners are there to acknowledge; no time passes meanwhile."""
        self._check()
        return self._writer.acknowledged

    def _check(self) -> None:
        if self._writer.closed and not self._node.process.dead:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")


class VirtualSubscription:
    """Calls back for each message on a topic, with what ``read`` makes of it."""

    def __init__(
        self,
        node: VirtualNode,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], object],
        qos: QoS,
        read: Callable[[Packet], Any],
    ) -> None:
        self.msg_type, self.topic_name, self.callback = msg_type, topic, callback
        self.qos_profile = qos.profile
        self._read = read
        self._reader = Reader(
            *node.place("topic", topic, type_name(msg_type), qos), arrived=node.to_do(self.take)
        )
        self.ends: tuple[Endpoint, ...] = (self._reader,)

    @property
    def is_matched(self) -> bool:
        """Whether somebody publishes for it."""
        return bool(self._reader.links)

    def take(self) -> None:
        """Handle the oldest message, if there is one."""
        if self._reader.closed or not self._reader.queue:
            return
        self.callback(self._read(self._reader.queue.popleft()))


def _bytes(packet: Packet) -> Any:
    return packet.data


def _as_it_is(packet: Packet) -> Any:
    return packet


class VirtualService:
    """Answers requests; ``callback`` and ``send_response`` may be replaced, as in rclpy."""

    def __init__(self, node: VirtualNode, srv_type: Any, name: str, callback: Any) -> None:
        self.srv_type, self.srv_name, self.callback = srv_type, name, callback
        kind = type_name(srv_type)
        self._writer = Writer(*node.place("response", name, kind, _SERVICE_QOS))
        self._reader = Reader(
            *node.place("request", name, kind, _SERVICE_QOS), arrived=node.to_do(self.take)
        )
        self.ends: tuple[Endpoint, ...] = (self._writer, self._reader)

    def take(self) -> None:
        """Handle the oldest request, if there is one."""
        if self._reader.closed or not self._reader.queue:
            return
        header, packet = self._reader.queue.popleft()
        request = packet.message(self.srv_type.Request)
        response = self.callback(request, self.srv_type.Response())
        self.send_response(response, header)

    def send_response(self, response: Any, header: Header) -> None:
        """Answer the request of a header.

        Raises
        ------
        TypeError
            When the response is of another type.
        """
        if not isinstance(response, self.srv_type.Response):
            raise TypeError(f"Expected {self.srv_type.Response}, got {type(response)}")
        if self._writer.closed:
            return
        answer = header, Packet.of(response)
        for link in self._writer.links:
            # DDS sends answers to all clients of the name, and each keeps its own.
            if link.reader.number == header[0]:
                link.send(answer)


class VirtualClient:
    """See :class:`kompass.bus.node.Client`."""

    def __init__(self, node: VirtualNode, srv_type: Any, name: str) -> None:
        self._node, self.srv_type, self.srv_name = node, srv_type, name
        kind = type_name(srv_type)
        self._pending: dict[int, Future] = {}
        self._asked = 0
        self._reader = Reader(
            *node.place("response", name, kind, _SERVICE_QOS), arrived=node.to_do(self.take)
        )
        self._writer = Writer(*node.place("request", name, kind, _SERVICE_QOS))
        self.ends: tuple[Endpoint, ...] = (self._reader, self._writer)

    def service_is_ready(self) -> bool:
        """Whether somebody offers it, and his answers would come."""
        self._check()
        return bool(self._writer.links) and bool(self._reader.links)

    def call_async(self, request: Any) -> Future:
        """Send a request; a future of the answer.

        Raises
        ------
        TypeError
            When the request is of another type.
        """
        if not isinstance(request, self.srv_type.Request):
            raise TypeError(f"Expected {self.srv_type.Request}, got {type(request)}")
        self._check()
        self._asked += 1
        self._writer.send(((self._reader.number, self._asked), Packet.of(request)))
        future = self._pending[self._asked] = Future()
        future.add_done_callback(self.remove_pending_request)
        return future

    def remove_pending_request(self, future: Future) -> None:
        """Wait no more for an answer."""
        for number, each in self._pending.items():
            if each is future:
                del self._pending[number]
                break

    def take(self) -> None:
        """Handle the oldest answer, if there is one."""
        if self._reader.closed or not self._reader.queue:
            return
        header, packet = self._reader.queue.popleft()
        future = self._pending.get(header[1])
        if future is None:
            return
        future._set_executor(self._node.executor)
        future.set_result(packet.message(self.srv_type.Response))

    def _check(self) -> None:
        if self._writer.closed and not self._node.process.dead:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")


class VirtualTimer:
    """See :class:`kompass.bus.node.Timer`. A period that is missed is left out."""

    def __init__(self, node: VirtualNode, period: int, callback: Callable[[], object]) -> None:
        self._node, self._period, self.callback = node, max(1, period), callback
        self._scheduler = node.process.world.scheduler
        self._at = 0
        self._event: Event | None = None
        self._canceled = self._destroyed = False
        self._call_soon = node.to_do(self._call)
        self.reset()

    def cancel(self) -> None:
        """Call it no more, until :meth:`reset`."""
        self._canceled = True
        self._forget()

    def reset(self) -> None:
        """Call it a whole period from now, and on."""
        if self._destroyed:
            return
        self._canceled = False
        self._at = self._scheduler.now + self._node.process.ahead + self._period
        self._arrange()

    def is_canceled(self) -> bool:
        """Whether it was cancelled."""
        return self._canceled

    def destroy(self) -> None:
        """Call it no more."""
        self._destroyed = True
        self.cancel()

    def _forget(self) -> None:
        if self._event is not None:
            self._event.cancel()
            self._event = None

    def _arrange(self) -> None:
        self._forget()
        self._event = self._scheduler.call_at(self._at, self._due)

    def _due(self) -> None:
        self._event = None
        self._call_soon()

    def _call(self) -> None:
        now = self._scheduler.now
        # Cancelled, or reset, while it waited for its turn.
        if self._canceled or now < self._at:
            return
        self._at += self._period
        if self._at < now:
            self._at += -((self._at - now) // self._period) * self._period
        self._arrange()
        self.callback()


class VirtualRosClock:
    """The clock for headers: wall time."""

    clock_type = ClockType.ROS_TIME

    def __init__(self, process: VirtualProcess) -> None:
        self._process, self._scheduler = process, process.world.scheduler

    def now(self) -> Time:
        """Virtual wall time."""
        now = self._scheduler.wall + self._process.ahead
        return Time(nanoseconds=now, clock_type=ClockType.ROS_TIME)


class VirtualNode:
    """A node in a process.

    Parameters
    ----------
    process
        Which it is in.
    name
        Of the node.
    namespace
        With or without the leading slash.
    """

    def __init__(self, process: VirtualProcess, name: str, namespace: str = "") -> None:
        validate_node_name(name)
        self._namespace = f"/{namespace.strip('/')}"
        validate_namespace(self._namespace)
        self.process, self._name = process, name
        world = process.world
        full = f"{self._namespace.strip('/').replace('/', '.')}.{name}".strip(".")
        self._logger = VirtualLog(full, world.scheduler, world.log.append)
        self._ros_clock = VirtualRosClock(process)
        self._executor: VirtualExecutor | None = None
        # What there is to do, before it is in an executor.
        self._waiting: list[Callable[[], object]] = []
        # In the order in which they came: a set would have one of addresses.
        self._parts: dict[_Part, None] = {}
        self._timers: dict[VirtualTimer, None] = {}
        self._destroyed = False
        self.entry: NodeEntry = world.network.add_node(process, name, self._namespace)
        process.add_node(self)

    # -- what it is ---------------------------------------------------------------------------

    def __getattr__(self, name: str) -> Any:
        if hasattr(LifecycleNode, name):
            raise NotOnThisBus(
                f"{name} of rclpy's nodes is not there in virtual time, as in a drill; use what "
                "kompass.bus.node has (create_action_client instead of rclpy.action.ActionClient)"
            )
        raise AttributeError(f"a node has no {name!r}")

    @property
    def clock(self) -> Clock:
        return self.process.clock

    @property
    def executor(self) -> VirtualExecutor:
        # As of rclpy, it is None before the node is given to one.
        return self._executor  # type: ignore[return-value]

    def get_name(self) -> str:
        return self._name

    def get_namespace(self) -> str:
        return self._namespace

    def get_fully_qualified_name(self) -> str:
        return f"{self._namespace.rstrip('/')}/{self._name}"

    def get_logger(self) -> VirtualLog:
        return self._logger

    def get_clock(self) -> VirtualRosClock:
        return self._ros_clock

    def resolve_topic_name(self, topic: str) -> str:
        """Its full name.

        Raises
        ------
        rclpy.exceptions.InvalidTopicNameException
            When it cannot be one.
        """
        return self._resolve(topic, is_service=False)

    def resolve_service_name(self, service: str) -> str:
        """As :meth:`resolve_topic_name`; raises its ``InvalidServiceNameException``."""
        return self._resolve(service, is_service=True)

    def _resolve(self, given: str, *, is_service: bool) -> str:
        try:
            name: str = expand_topic_name(given, self._name, self._namespace)
        except ValueError:
            validate_topic_name(given, is_service=is_service)
            raise
        validate_full_topic_name(name, is_service=is_service)
        return name

    # -- its parts ----------------------------------------------------------------------------

    def create_publisher(self, msg_type: Any, topic: str, qos_profile: Any) -> VirtualPublisher:
        check_is_valid_msg_type(msg_type)
        name = self.resolve_topic_name(topic)
        return self._keep(VirtualPublisher(self, msg_type, name, qos_of(qos_profile, name)))

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], object],
        qos_profile: Any,
        *,
        raw: bool = False,
    ) -> VirtualSubscription:
        if raw:
            return self._subscribe(msg_type, topic, callback, qos_profile, _bytes)
        return self._subscribe(
            msg_type, topic, callback, qos_profile, lambda packet: packet.message(msg_type)
        )

    def create_partial_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: HeardInPart,
        qos_profile: Any,
        paths: Iterable[tuple[str, ...]],
    ) -> VirtualSubscription:
        try:
            fields = fields_of(msg_type, paths)
        except ValueError as error:
            raise ValueError(f"{topic}: {error}") from None

        left_out = LeftOut(self, topic)

        def take(packet: Packet) -> None:
            try:
                found = fields(packet)
            except Unreadable as error:
                left_out.tell(error)
                return
            callback(found, partial(packet.message, msg_type))

        return self._subscribe(msg_type, topic, take, qos_profile, _as_it_is)

    def _subscribe(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], object],
        qos_profile: Any,
        read: Callable[[Packet], Any],
    ) -> VirtualSubscription:
        check_is_valid_msg_type(msg_type)
        name = self.resolve_topic_name(topic)
        qos = qos_of(qos_profile, name)
        return self._keep(VirtualSubscription(self, msg_type, name, callback, qos, read))

    def create_service(self, srv_type: Any, srv_name: str, callback: Any) -> VirtualService:
        check_is_valid_srv_type(srv_type)
        name = self.resolve_service_name(srv_name)
        return self._keep(VirtualService(self, srv_type, name, callback))

    def create_client(self, srv_type: Any, srv_name: str) -> VirtualClient:
        check_is_valid_srv_type(srv_type)
        return self._keep(VirtualClient(self, srv_type, self.resolve_service_name(srv_name)))

    def create_timer(self, timer_period_sec: float, callback: Callable[[], object]) -> VirtualTimer:
        timer = VirtualTimer(self, nanoseconds(timer_period_sec), callback)
        self._timers[timer] = None
        return timer

    def create_action_server(
        self, action_type: Any, action_name: str, execute: Execute, **callbacks: Any
    ) -> VirtualActionServer:
        return VirtualActionServer(self, action_type, action_name, execute, **callbacks)

    def create_action_client(self, action_type: Any, action_name: str) -> VirtualActionClient:
        return VirtualActionClient(self, action_type, action_name)

    def destroy_publisher(self, publisher: Any) -> bool:
        return self._drop(publisher)

    def destroy_subscription(self, subscription: Any) -> bool:
        return self._drop(subscription)

    def destroy_service(self, service: Any) -> bool:
        return self._drop(service)

    def destroy_client(self, client: Any) -> bool:
        return self._drop(client)

    def destroy_timer(self, timer: Any) -> bool:
        if timer not in self._timers:
            return False
        del self._timers[timer]
        timer.destroy()
        return True

    def destroy_node(self) -> None:
        """Take it from the network, with all its parts."""
        if self._destroyed or self.process.dead:
            return
        self._destroyed = True
        for part in list(self._parts):
            self._drop(part)
        for timer in list(self._timers):
            self.destroy_timer(timer)
        self.process.world.network.remove_node(self.entry)
        self.process.remove_node(self)
        self._executor = None

    def write_log(self, level: str, text: str) -> None:
        """A line of its log."""
        getattr(self._logger, level)(printable(text))

    def on_callback_error(self, error: Exception) -> None:
        """A callback of an action has raised."""
        self._logger.error(f"a callback failed: {type(error).__name__}: {error}")

    def threads(self, count: int, name: str) -> Threads:
        return VirtualThreads(self.process, count, name)

    # -- the graph ----------------------------------------------------------------------------

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        network = self.process.world.network
        return [(each.name, each.namespace) for each in network.nodes(self.process)]

    def get_topic_names_and_types(self) -> NamesAndTypes:
        return names_and_types(self.process.world.network.endpoints(self.process, "topic"))

    def get_service_names_and_types(self) -> NamesAndTypes:
        # Clients count, too, as on DDS.
        return names_and_types(self.process.world.network.endpoints(self.process, "request"))

    def get_service_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> NamesAndTypes:
        entries = self._entries(node_name, node_namespace)
        found = self.process.world.network.endpoints(self.process, "request")
        return names_and_types(
            each for each in found if each.node in entries and isinstance(each, Reader)
        )

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> NamesAndTypes:
        entries = self._entries(node_name, node_namespace)
        found = self.process.world.network.endpoints(self.process, "topic")
        return names_and_types(
            each for each in found if each.node in entries and isinstance(each, Writer)
        )

    def get_action_names_and_types(self) -> NamesAndTypes:
        return action_names_and_types(self.get_topic_names_and_types())

    def get_action_server_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> NamesAndTypes:
        found = self.get_publisher_names_and_types_by_node(node_name, node_namespace)
        return action_names_and_types(found)

    def get_publishers_info_by_topic(self, topic_name: str) -> list[Any]:
        name = self.resolve_topic_name(topic_name)
        found = self.process.world.network.writers(self.process, "topic", name)
        return [endpoint_info(each) for each in found]

    def get_subscriptions_info_by_topic(self, topic_name: str) -> list[Any]:
        name = self.resolve_topic_name(topic_name)
        found = self.process.world.network.readers(self.process, "topic", name)
        return [endpoint_info(each) for each in found]

    def count_publishers(self, topic_name: str) -> int:
        name = self.resolve_topic_name(topic_name)
        return len(self.process.world.network.writers(self.process, "topic", name))

    def count_subscribers(self, topic_name: str) -> int:
        name = self.resolve_topic_name(topic_name)
        return len(self.process.world.network.readers(self.process, "topic", name))

    def count_services(self, service_name: str) -> int:
        name = self.resolve_service_name(service_name)
        return len(self.process.world.network.readers(self.process, "request", name))

    def _entries(self, name: str, namespace: str) -> list[NodeEntry]:
        found = [
            each
            for each in self.process.world.network.nodes(self.process)
            if (each.name, each.namespace) == (name, namespace)
        ]
        if not found:
            raise NodeNameNonExistentError(
                f"Cannot find a node of the name {name!r} in the namespace {namespace!r}"
            )
        return found

    # -- for its parts ------------------------------------------------------------------------

    def place(self, kind: Kind, name: str, kind_of: str, qos: QoS) -> tuple[Any, ...]:
        """What an endpoint of this node is made of."""
        if self._destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")
        network = self.process.world.network
        return network, self.process, self.entry, kind, name, kind_of, qos

    def to_do(self, function: Callable[[], object]) -> Callable[[], None]:
        """What has a function called by the executor, as soon as the node is in one."""

        def push() -> None:
            if self._executor is not None:
                self._executor.push(function)
            elif not self.process.dead:
                self._waiting.append(function)

        return push

    def _keep(self, part: P) -> P:
        self._parts[part] = None
        if self.process.dead:  # its code may go on for a while, unheard
            for end in part.ends:
                end.close()
        return part

    def _drop(self, part: Any) -> bool:
        if part not in self._parts:
            return False
        del self._parts[part]
        if not self.process.dead:
            for end in part.ends:
                end.close()
        return True

    # -- for its process and its executor -----------------------------------------------------

    def join(self, executor: VirtualExecutor | None) -> None:
        """Have an executor handle what happens here."""
        if executor is not None and executor.process is not self.process:
            raise ValueError(
                f"the executor is in the process {executor.process.name!r}, and the node "
                f"{self._name!r} in {self.process.name!r}; give it to one of its own process"
            )
        self._executor = executor
        waiting, self._waiting = self._waiting, []
        for function in waiting:
            self.to_do(function)()

    def die(self) -> list[Endpoint]:
        """Have nothing come in or go out any more; what there is to be forgotten, later."""
        for timer in self._timers:
            timer.destroy()
        ends = [end for part in self._parts for end in part.ends]
        for end in ends:
            end.closed = True
        return ends
