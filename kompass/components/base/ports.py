"""The subscriptions and publishers behind a running component's inputs and outputs."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Generic, TypeVar

from rclpy.duration import Duration

from kompass.algorithms.safety.lateness import Lateness
from kompass.bus.clock import SYSTEM, Clock
from kompass.bus.node import LifecycleNode
from kompass.components.base.topics import DeclaredTopics
from kompass.components.base.values import message_of, value_of
from kompass.rclpy_ext.qos import best_for
from kompass.rclpy_ext.topic import SENSOR, QoSConfig, Topic

# Fields by which the stack goes of a message that comes fifty times a second. Making the rest of
# it, its covariances above all, takes longer than all that is done about it.
IN_PART = {
    "Odometry": (
        *(("header", "stamp", part) for part in ("sec", "nanosec")),
        ("header", "frame_id"),
        *(("pose", "pose", "position", axis) for axis in "xyz"),
        *(("pose", "pose", "orientation", part) for part in "xyzw"),
        *(("twist", "twist", "linear", axis) for axis in "xy"),
        ("twist", "twist", "angular", "z"),
    )
}
# Messages of so many datagrams that where nobody resends one of them, most do not come whole.
LARGE_TYPES = {"PointCloud2"}
LOOK = 0.5  # s between looks at who publishes these
SENSOR_TYPES = {"LaserScan", "PointCloud2", "Imu", "Odometry", "Image", "Range"}
# Key and index of a topic among the inputs, or among the outputs.
Place = tuple[str, int]
Processor = Callable[[Any], Any]
P = TypeVar("P")


class Input:
    """Subscription that keeps the newest message. Ages are of the monotonic clock [s].

    A message is as old when it comes as its stamp says, where that can be believed
    (:class:`kompass.algorithms.safety.lateness.Lateness`).

    What is read in part (``IN_PART``) is made whole when somebody asks for the message.

    Large messages are read reliably where all who publish them let one; that is looked at again
    and again. Where the topic says how, it is read so.

    Parameters
    ----------
    callbacks
        Called with this input after each message.
    postprocessors
        What :meth:`get_output` gives goes through them, in their order.
    """

    def __init__(
        self,
        topic: Topic,
        qos: QoSConfig | None = None,
        callbacks: list[Callable[["Input"], None]] | None = None,
        postprocessors: list[Processor] | None = None,
    ) -> None:
        self.topic = topic
        self.received: float | None = None
        self._fields: Any = None
        self._make: Callable[[], Any] | None = None  # the message, of which there are fields only
        self.lateness = Lateness()
        # Called with `fields`.
        self.on_message: Callable[[Any], None] | None = None
        # Called when all others have been.
        self.afterwards: Callable[[], None] | None = None
        fitting = SENSOR if topic.msg_type in SENSOR_TYPES else QoSConfig()
        self._qos = topic.qos_profile or qos or fitting
        self._callbacks = [] if callbacks is None else callbacks
        self._postprocessors = [] if postprocessors is None else postprocessors
        self._follows = topic.msg_type in LARGE_TYPES and topic.qos_profile is None
        self._subscription: Any = None
        self._look: Any = None  # timer
        self._clock: Clock = SYSTEM

    @property
    def is_open(self) -> bool:
        """Whether it is subscribed."""
        return self._subscription is not None

    @property
    def fields(self) -> Any:
        """The newest message, or what is read of it; None before the first."""
        return self._fields

    @property
    def message(self) -> Any:
        """The newest message; None before the first."""
        if self._make is not None:
            self._fields, self._make = self._make(), None
        return self._fields

    @property
    def got_msg(self) -> bool:
        """Whether there has been a message since the component became active."""
        return self.received is not None

    def get_output(self, clear_last: bool = False) -> Any:
        """What the newest message says, through the post-processors; None before the first.

        Parameters
        ----------
        clear_last
            Forget the message, so that each is given once.

        See :func:`kompass.components.base.values.value_of` for what a message says.
        """
        message = self.message
        if message is None:
            return None
        value = value_of(message)
        for process in self._postprocessors:
            value = process(value)
        if clear_last:
            self.clear()
        return value

    def open(self, node: LifecycleNode) -> None:
        """Subscribe; nothing happens when it is."""
        if self.is_open:
            return
        self._clock = node.clock
        self._subscribe(node)
        if self._follows:
            self._look = node.create_timer(LOOK, lambda: self._follow(node))

    def close(self, node: LifecycleNode) -> None:
        """Unsubscribe and forget the last message."""
        if self._subscription is not None:
            node.destroy_subscription(self._subscription)
            self._subscription = None
        if self._look is not None:
            node.destroy_timer(self._look)
            self._look = None
        self.clear()

    def _subscribe(self, node: LifecycleNode) -> None:
        kind, name, qos = self.topic.ros_msg_type, self.topic.name, self._qos.to_ros()
        paths = IN_PART.get(self.topic.msg_type)
        if paths is None:
            self._subscription = node.create_subscription(kind, name, self._receive, qos)
        else:
            self._subscription = node.create_partial_subscription(
                kind, name, self._receive, qos, paths
            )

    def _follow(self, node: LifecycleNode) -> None:
        """Ask for what the publishers offer now; the newest message stays."""
        infos = node.get_publishers_info_by_topic(node.resolve_topic_name(self.topic.name))
        offers = [info for info in infos if info.topic_type.endswith(f"/{self.topic.msg_type}")]
        wanted = best_for(offers).reliability
        if offers and wanted != self._qos.reliability:
            self._qos = self._qos.model_copy(update={"reliability": wanted})
            node.destroy_subscription(self._subscription)
            self._subscribe(node)

    def clear(self) -> None:
        """Forget the last message."""
        self._fields, self._make, self.received = None, None, None
        self.lateness = Lateness()

    def age(self) -> float:
        """Seconds since the newest message was stamped; infinite before the first."""
        return self.silence() + self.lateness.late

    def silence(self) -> float:
        """Seconds since the newest message came; infinite before the first."""
        return float("inf") if self.received is None else self._clock.monotonic() - self.received

    @property
    def comes_late(self) -> bool:
        """Whether its age is more of its way than of the time since it came."""
        return self.lateness.late > self.silence()

    def too_old(self, limit: float) -> str:
        """Why there is nothing that is no older than ``limit`` [s]; empty when there is."""
        if self.age() <= limit:
            return ""
        topic = f"/{self.topic.name}"
        if not self.comes_late:
            return f"nothing on {topic}"
        return f"what is on {topic} is too old: {self.lateness.told}"

    def _receive(self, fields: Any, make: Callable[[], Any] | None = None) -> None:
        self._fields, self._make = fields, make
        self.received = self._clock.monotonic()
        stamp = getattr(getattr(fields, "header", None), "stamp", None)
        if stamp is not None:
            self.lateness.heard(stamp.sec + stamp.nanosec * 1e-9, self._clock.wall())
        if self.on_message is not None:
            self.on_message(fields)
        for callback in self._callbacks:
            callback(self)
        # One of the callbacks may have restarted the component, which has another input then.
        if self.afterwards is not None and self.is_open:
            self.afterwards()


class Output:
    """Publisher of one topic, which takes plain values too.

    Parameters
    ----------
    preprocessors
        What is published goes through them first, in their order; None of one means silence.
    """

    def __init__(
        self,
        node: LifecycleNode,
        topic: Topic,
        qos: QoSConfig | None = None,
        preprocessors: list[Processor] | None = None,
    ) -> None:
        self.topic = topic
        self._node = node
        self._preprocessors = [] if preprocessors is None else preprocessors
        profile = (topic.qos_profile or qos or QoSConfig()).to_ros()
        self._publisher = node.create_publisher(topic.ros_msg_type, topic.name, profile)

    def publish(self, value: Any, frame_id: str | None = None) -> None:
        """Publish a message, or a plain value that makes one.

        Parameters
        ----------
        value
            See :func:`kompass.components.base.values.message_of`.
        frame_id
            Put into the header. A header without a time gets that of the node's clock.

        Raises
        ------
        TypeError
            When the value makes no such message, or has no header for ``frame_id``; names the
            topic and what is taken.
        """
        for process in self._preprocessors:
            value = process(value)
            if value is None:
                return
        kind = self.topic.ros_msg_type
        made = isinstance(value, kind)
        try:
            message = value if made else message_of(kind, value)
        except TypeError as error:
            raise TypeError(f"/{self.topic.name}: {error}") from None
        if frame_id is not None or not made:
            self._head(message, frame_id)
        self._publisher.publish(message)

    def _head(self, message: Any, frame_id: str | None) -> None:
        header = getattr(message, "header", None)
        if header is None:
            if frame_id is not None:
                raise TypeError(
                    f"/{self.topic.name}: a {self.topic.msg_type} has no header for "
                    f"frame_id = {frame_id!r}; leave it out"
                )
            return
        if frame_id is not None:
            header.frame_id = frame_id
        if not (header.stamp.sec or header.stamp.nanosec):
            header.stamp = self._node.get_clock().now().to_msg()

    def wait_for_all_acked(self, timeout: Duration) -> bool:
        """Wait until every reliable listener has what was published; False after the timeout."""
        return bool(self._publisher.wait_for_all_acked(timeout))

    def destroy(self) -> None:
        """Give the publisher back."""
        self._node.destroy_publisher(self._publisher)


class PortView(Mapping[str, P], Generic[P]):
    """Inputs or outputs by key, and by the name of their topic; one for each topic.

    Parameters
    ----------
    ports
        By key.
    name
        Gives the name of a port's topic.
    owner, word
        For messages: the component, and what is looked for.
    """

    def __init__(
        self, ports: Mapping[str, list[P]], name: Callable[[P], str], owner: str, word: str
    ) -> None:
        single = {key: found[0] for key, found in ports.items() if len(found) == 1}
        several = {name(port): port for found in ports.values() if len(found) > 1 for port in found}
        self._ports = {**several, **single}
        self._by_topic = {name(port): port for found in ports.values() for port in found}
        self._owner, self._word = owner, word

    def __getitem__(self, key: str) -> P:
        text = str(getattr(key, "value", key))
        found = self._ports.get(text) or self._by_topic.get(text.strip().removeprefix("/"))
        if found is None:
            known = ", ".join(self._ports) or f"none: {self._word}s come when it is configured"
            raise KeyError(f"{self._owner}: there is no {self._word} '{text}'; there are {known}")
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self._ports)

    def __len__(self) -> int:
        return len(self._ports)


class InputPorts:
    """The inputs of a component by key: there while it is configured, open while it is active.

    Parameters
    ----------
    qos
        Quality of service of keys whose message type alone does not tell it.
    """

    def __init__(self, qos: Mapping[str, QoSConfig]) -> None:
        self._qos = qos
        self._inputs: dict[str, list[Input]] = {}
        # By place, so that they outlast the subscription: a restart, another topic.
        self.callbacks: dict[Place, list[Callable[[Input], None]]] = defaultdict(list)
        self.postprocessors: dict[Place, list[Processor]] = defaultdict(list)

    def __getitem__(self, key: str) -> list[Input]:
        return self._inputs[key]

    def walk(self) -> Iterator[tuple[Place, Input]]:
        """The inputs that there are now, with their places."""
        for key, inputs in self._inputs.items():
            for index, port in enumerate(inputs):
                yield (key, index), port

    def by_name(self, owner: str) -> PortView[Input]:
        """The inputs that there are now."""
        return PortView(self._inputs, lambda port: port.topic.name, owner, "input")

    def make(self, declared: DeclaredTopics) -> None:
        """Make an input, still closed, for each declared topic."""
        for key, topics in declared.items():
            self._inputs[key] = [
                self._make(key, index, topic) for index, topic in enumerate(topics)
            ]

    def _make(self, key: str, index: int, topic: Topic) -> Input:
        place = (key, index)
        return Input(topic, self._qos.get(key), self.callbacks[place], self.postprocessors[place])

    def open(self, node: LifecycleNode, wanted: Callable[[str], bool]) -> None:
        """Subscribe to those whose key is wanted."""
        for key, sources in self._inputs.items():
            if wanted(key):
                for source in sources:
                    source.open(node)

    def close(self, node: LifecycleNode) -> None:
        """Unsubscribe from all."""
        for sources in self._inputs.values():
            for source in sources:
                source.close(node)

    def forget(self) -> None:
        """Drop all; they must be closed."""
        self._inputs = {}

    def change(self, node: LifecycleNode, key: str, index: int, topic: Topic) -> None:
        """Take another topic in one place; nothing happens when the key has not been made."""
        if key not in self._inputs:
            return
        old, new = self._inputs[key][index], self._make(key, index, topic)
        new.on_message, new.afterwards = old.on_message, old.afterwards
        if old.is_open:
            new.open(node)
            old.close(node)
        self._inputs[key][index] = new


class OutputPorts:
    """The publishers of a component by key: there while it is configured.

    Parameters
    ----------
    qos
        Quality of service of keys that need another one than the usual.
    """

    def __init__(self, qos: Mapping[str, QoSConfig]) -> None:
        self._qos = qos
        self._outputs: dict[str, list[Output]] = {}
        self.preprocessors: dict[Place, list[Processor]] = defaultdict(list)

    def __getitem__(self, key: str) -> list[Output]:
        return self._outputs[key]

    def by_name(self, owner: str) -> PortView[Output]:
        """The outputs that there are now."""
        return PortView(self._outputs, lambda port: port.topic.name, owner, "output")

    def make(self, node: LifecycleNode, declared: DeclaredTopics) -> None:
        """Make a publisher for each declared topic."""
        for key, topics in declared.items():
            self._outputs[key] = [
                self._make(node, key, index, topic) for index, topic in enumerate(topics)
            ]

    def destroy(self) -> None:
        """Give all publishers back."""
        for outputs in self._outputs.values():
            for output in outputs:
                output.destroy()
        self._outputs = {}

    def publish(self, key: str, message: Any, index: int = 0) -> None:
        """Publish; nothing happens when there is no such output."""
        outputs = self._outputs.get(key, [])
        if index < len(outputs):
            outputs[index].publish(message)

    def change(self, node: LifecycleNode, key: str, index: int, topic: Topic) -> None:
        """Take another topic in one place; nothing happens when the key has not been made."""
        if key not in self._outputs:
            return
        output = self._make(node, key, index, topic)
        self._outputs[key][index].destroy()
        self._outputs[key][index] = output

    def _make(self, node: LifecycleNode, key: str, index: int, topic: Topic) -> Output:
        return Output(node, topic, self._qos.get(key), self.preprocessors[(key, index)])
