"""A node: how a program speaks to others, and is spoken to.

The names are those of rclpy, whose nodes are one kind of it (:mod:`kompass.rclpy_ext.node`). What
our programs use of a node is here and nothing else, so that there may be another kind.
"""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Iterable, Sequence
from concurrent.futures import Executor as Threads
from typing import Any, Protocol

from kompass.bus.clock import Clock

# Pursues a goal, given its handle.
Execute = Callable[[Any], Coroutine[Any, Any, Any]]
# Takes of a message an object with some of its fields, and a function that makes the whole of it.
HeardInPart = Callable[[Any, Callable[[], Any]], object]
# Of a topic, a service or an action, and the types under which it is offered.
NamesAndTypes = Sequence[tuple[str, Sequence[str]]]


class Log(Protocol):
    """Where a node writes for people; its name is that of the node."""

    @property
    def name(self) -> str: ...
    def debug(self, message: str, **options: Any) -> object: ...
    def info(self, message: str, **options: Any) -> object: ...
    def warning(self, message: str, **options: Any) -> object: ...
    def error(self, message: str, **options: Any) -> object: ...
    def fatal(self, message: str, **options: Any) -> object: ...


class Timer(Protocol):
    """Calls a function again and again."""

    def cancel(self) -> None:
        """Call it no more, until :meth:`reset`."""

    def reset(self) -> None:
        """Call it a whole period from now, and on."""

    def is_canceled(self) -> bool:
        """Whether it was cancelled."""


class Publisher(Protocol):
    """Speaks on a topic."""

    def publish(self, message: Any) -> None:
        """Send a message, or one that is serialized already (bytes)."""

    def get_subscription_count(self) -> int:
        """How many listen whose quality of service fits."""

    def wait_for_all_acked(self, timeout: Any) -> bool:
        """Whether every reliable listener has got what was sent, at most ``timeout`` later."""


class Client(Protocol):
    """Asks a service."""

    def service_is_ready(self) -> bool:
        """Whether somebody offers it."""

    def call_async(self, request: Any) -> Any:
        """Send a request; a future of the answer."""

    def remove_pending_request(self, future: Any) -> None:
        """Wait no more for an answer."""


class ActionClient(Protocol):
    """Sends goals."""

    def server_is_ready(self) -> bool:
        """Whether somebody takes them."""

    def send_goal_async(
        self, goal: Any, feedback_callback: Any = None, goal_uuid: Any = None
    ) -> Any:
        """Send a goal; a future of its handle."""

    def destroy(self) -> None:
        """Give it back."""


class Executor(Protocol):
    """The one thread on which everything of a node happens."""

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Any:
        """Have a function or a coroutine run there, from any thread; a future of its result."""

    def add_timers(self, timers: Any) -> None:
        """Fire these when they are due; see :class:`kompass.rclpy_ext.timers.Timers`."""


class Graph(Protocol):
    """Who there is, and what they offer and hear."""

    def get_node_names_and_namespaces(self) -> Sequence[tuple[str, str]]: ...
    def get_topic_names_and_types(self) -> NamesAndTypes: ...
    def get_service_names_and_types(self) -> NamesAndTypes: ...
    def get_service_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> NamesAndTypes: ...
    def get_action_names_and_types(self) -> NamesAndTypes: ...
    def get_action_server_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> NamesAndTypes: ...
    def get_publishers_info_by_topic(self, topic_name: str) -> Sequence[Any]: ...
    def get_subscriptions_info_by_topic(self, topic_name: str) -> Sequence[Any]: ...
    def count_subscribers(self, topic_name: str) -> int: ...
    def count_services(self, service_name: str) -> int: ...


class Node(Graph, Protocol):
    """A node on the bus.

    Attributes
    ----------
    clock
        Of the world that it is in.
    executor
        Once it was given to one.
    """

    @property
    def clock(self) -> Clock: ...
    @property
    def executor(self) -> Executor: ...
    def get_name(self) -> str: ...
    def get_namespace(self) -> str: ...
    def get_logger(self) -> Log: ...
    def get_clock(self) -> Any:
        """Whose ``now().to_msg()`` goes into headers."""

    def resolve_topic_name(self, topic: str) -> str: ...
    def resolve_service_name(self, service: str) -> str: ...
    def create_publisher(self, msg_type: Any, topic: str, qos_profile: Any) -> Publisher: ...
    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], object],
        qos_profile: Any,
        *,
        raw: bool = False,
    ) -> Any: ...
    def create_partial_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: HeardInPart,
        qos_profile: Any,
        paths: Iterable[tuple[str, ...]],
    ) -> Any:
        """Hear of each message a few fields, which costs a tenth of having it made.

        Parameters
        ----------
        paths
            To the fields, none of them a message or behind a sequence of messages.
        """

    def create_service(self, srv_type: Any, srv_name: str, callback: Any) -> Any: ...
    def create_client(self, srv_type: Any, srv_name: str) -> Client: ...
    def create_timer(self, timer_period_sec: float, callback: Callable[[], object]) -> Timer: ...
    def create_action_server(
        self,
        action_type: Any,
        action_name: str,
        execute: Execute,
        *,
        goal_callback: Callable[[Any], Any],
        cancel_callback: Callable[[Any], Any],
    ) -> Any:
        """Take goals. When a callback raises, the node is told, and what was asked is refused."""

    def create_action_client(self, action_type: Any, action_name: str) -> ActionClient: ...
    def destroy_publisher(self, publisher: Any) -> bool: ...
    def destroy_subscription(self, subscription: Any) -> bool: ...
    def destroy_client(self, client: Any) -> bool: ...
    def destroy_timer(self, timer: Any) -> bool: ...
    def destroy_node(self) -> None: ...
    def write_log(self, level: str, text: str) -> None:
        """A line of its log, for people; ``level`` is debug, info, warning or error."""

    def threads(self, count: int, name: str) -> Threads:
        """Threads for work that may block; what it has to say goes to the executor."""


class Transitions(Protocol):
    """What a component does at each transition. An exception fails the transition."""

    def on_configure(self) -> None: ...
    def on_activate(self) -> None: ...
    def on_deactivate(self) -> None: ...
    def on_cleanup(self) -> None: ...
    def on_shutdown(self) -> None: ...
    def on_transition_error(self, transition: str, error: Exception) -> None: ...
    def on_callback_error(self, error: Exception) -> None: ...


ChangeState = Callable[[Any, Any], Any]


class LifecycleNode(Node, Protocol):
    """A node with the life cycle of ROS 2 (design.ros2.org, "Managed nodes")."""

    @property
    def state(self) -> str:
        """Label of the state: unconfigured, inactive, active, finalized."""

    @property
    def state_id(self) -> int:
        """Its number, as in ``lifecycle_msgs/msg/State``."""

    def trigger_configure(self) -> Any: ...
    def trigger_activate(self) -> Any: ...
    def trigger_deactivate(self) -> Any: ...
    def trigger_cleanup(self) -> Any: ...
    def trigger_shutdown(self) -> Any: ...
    def set_log_levels(self, own: str, ros: str) -> None:
        """From which level on is written: its own log, and that of the middleware."""

    def guard_transitions(self, guard: Callable[[ChangeState], ChangeState]) -> None:
        """Put something in front of the service for transitions."""


# Makes the node of a component: its name, the component, its namespace.
MakeNode = Callable[[str, Transitions, str], LifecycleNode]
