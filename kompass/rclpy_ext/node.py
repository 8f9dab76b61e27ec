"""Nodes whose publishers and subscriptions may come and go under the events executor."""

from __future__ import annotations

import struct
import weakref
from collections.abc import Callable, Iterable
from concurrent.futures import Executor as Threads
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

from rclpy.action import (
    ActionClient,
    ActionServer,
    CancelResponse,
    GoalResponse,
    get_action_names_and_types,
    get_action_server_names_and_types_by_node,
)
from rclpy.clock import Clock as RosClock
from rclpy.clock_type import ClockType
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node, NodeNameNonExistentError

from kompass.bus.clock import SYSTEM, Clock
from kompass.bus.node import Execute, HeardInPart, NamesAndTypes
from kompass.message_types import type_name
from kompass.rclpy_ext.action_server import ForgetfulActionServer
from kompass.rclpy_ext.guarded import guarded
from kompass.rclpy_ext.log import write_log
from kompass.rclpy_ext.partial_decoder import partial_decoder
from kompass.rclpy_ext.unreadable import LeftOut, Unreadable, read_message


def _deaf(message: Any) -> None:
    """Hears nothing."""


class NodeOnDDS:
    """Part of a node of rclpy that makes it one of :class:`kompass.bus.node.Node`.

    Its publishers and subscriptions have no event handlers unless asked for: rclpy gives each one
    two, which log a warning when somebody's quality of service does not fit.
    Where that happens while the publisher or subscription is destroyed, the events executor (7.1.6)
    dies of SIGSEGV (``ros2/rclpy`` issue 1644). A rule, a restart or a page that is closed destroys
    them all the time.
    """

    clock: Clock = SYSTEM

    def create_timer(self, *args: Any, **kwargs: Any) -> Any:
        """As of :class:`rclpy.node.Node`, on the clock that nobody sets."""
        kwargs.setdefault("clock", _STEADY)
        return super().create_timer(*args, **kwargs)  # type: ignore[misc]

    def create_publisher(self, *args: Any, **kwargs: Any) -> Any:
        """As of :class:`rclpy.node.Node`."""
        kwargs.setdefault("event_callbacks", _NO_PUBLISHER_EVENTS)
        return super().create_publisher(*args, **kwargs)  # type: ignore[misc]

    def create_subscription(self, *args: Any, **kwargs: Any) -> Any:
        """As of :class:`rclpy.node.Node`."""
        kwargs.setdefault("event_callbacks", _NO_SUBSCRIPTION_EVENTS)
        return super().create_subscription(*args, **kwargs)  # type: ignore[misc]

    def create_partial_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: HeardInPart,
        qos_profile: Any,
        paths: Iterable[tuple[str, ...]],
    ) -> Any:
        """As :meth:`kompass.bus.node.Node.create_partial_subscription`."""
        decode = partial_decoder(type_name(msg_type), paths, to_the_end=True)
        if decode is None:
            raise ValueError(f"{topic}: {msg_type.__name__} cannot be read in part")

        left_out = LeftOut(self, topic)

        def take(data: bytes) -> None:
            make = partial(read_message, data, msg_type)
            try:
                fields = decode(data)
            except (ValueError, struct.error):  # serialised otherwise than we know
                try:
                    fields = make()
                except Unreadable as error:
                    left_out.tell(error)
                    return
            callback(fields, make)

        return self.create_subscription(msg_type, topic, take, qos_profile, raw=True)

    def destroy_subscription(self, subscription: Any) -> bool:
        """As of :class:`rclpy.node.Node`; its callback group forgets it too, and it hears no more.

        rclpy's callback group does not (7.1.6, ``ros2/rclpy`` issue 1356): a little memory for each
        that ever was. And the events executor hands on what it has been told of before, to whoever
        may be gone by then.
        """
        subscription.callback = _deaf
        entities = subscription.callback_group.entities
        entities.discard(weakref.ref(subscription))
        return bool(super().destroy_subscription(subscription))  # type: ignore[misc]

    def create_action_server(
        self, action_type: Any, action_name: str, execute: Execute, **callbacks: Any
    ) -> ForgetfulActionServer:
        """As :meth:`kompass.bus.node.Node.create_action_server`."""
        return ForgetfulActionServer(self, action_type, action_name, execute, **callbacks)

    def create_action_client(self, action_type: Any, action_name: str) -> ActionClient:
        """As :class:`rclpy.action.ActionClient`."""
        return ActionClient(self, action_type, action_name)

    def destroy_node(self) -> None:
        """As of :class:`rclpy.node.Node`; its action clients and servers go with it.

        rclpy's leaves them to the garbage collector (7.1.6), which frees them on whatever thread it
        runs. Until then they keep the participant alive, with its threads and all that it hears,
        and a goal that is sent to such a server is never answered.
        """
        for waitable in list(self.waitables):  # type: ignore[attr-defined]
            if isinstance(waitable, ActionClient | ActionServer):
                waitable.destroy()
        super().destroy_node()  # type: ignore[misc]

    def add_waitable(self, waitable: Any) -> None:
        """As of :class:`rclpy.node.Node`; what a callback of an action raises ends no process.

        It is told, and a goal or cancel request that is not answered for that is refused.
        """
        if isinstance(waitable, ActionServer):  # also one that a recipe makes by itself
            tell = self.on_callback_error
            goal, cancel = waitable._goal_callback, waitable._cancel_callback
            waitable.register_goal_callback(guarded(goal, GoalResponse.REJECT, tell))
            waitable.register_cancel_callback(guarded(cancel, CancelResponse.REJECT, tell))
        waitable.execute = guarded(waitable.execute, None, self.on_callback_error)
        super().add_waitable(waitable)  # type: ignore[misc]

    def on_callback_error(self, error: Exception) -> None:
        """A callback of an action has raised."""
        text = f"a callback failed: {type(error).__name__}: {error}"
        self.get_logger().error(text)  # type: ignore[attr-defined]

    def get_action_names_and_types(self) -> NamesAndTypes:
        """As :func:`rclpy.action.get_action_names_and_types`."""
        found: NamesAndTypes = get_action_names_and_types(self)
        return found

    def get_action_server_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> NamesAndTypes:
        """As :func:`rclpy.action.get_action_server_names_and_types_by_node`.

        Raises
        ------
        rclpy.node.NodeNameNonExistentError
            When there is no such node; as for services, where rclpy's own has another name for it.
        """
        try:
            found: NamesAndTypes = get_action_server_names_and_types_by_node(
                self, node_name, node_namespace
            )
        except rclpy_implementation.RCLError as error:
            if (node_name, node_namespace) in self.get_node_names_and_namespaces():  # type: ignore[attr-defined]
                raise
            raise NodeNameNonExistentError(str(error)) from None
        return found

    def write_log(self, level: str, text: str) -> None:
        """A line of its log; see :func:`kompass.rclpy_ext.log.write_log`."""
        write_log(self.get_logger(), level, text)  # type: ignore[attr-defined]

    def threads(self, count: int, name: str) -> Threads:
        """A pool of threads."""
        return ThreadPoolExecutor(count, thread_name_prefix=name)


def lifecycle_state(node: LifecycleNode) -> str:
    """Label of the state of a lifecycle node, which rclpy (7.1.6) keeps to itself.

    Returns
    -------
    str
        "unconfigured", "inactive", "active", "finalized", or the name of a transition under way.
    """
    return str(node._state_machine.current_state[1])


def lifecycle_state_id(node: LifecycleNode) -> int:
    """Number of that state, as ``lifecycle_msgs/msg/State`` has it; rclpy has no name for it."""
    return int(node._state_machine.current_state[0])


def of_others(node: Node, endpoints: Iterable[Any]) -> list[Any]:
    """The publishers or subscriptions of a topic that other nodes have.

    By name and namespace, so that those of the node's own dead process are not another's.

    Parameters
    ----------
    endpoints
        As ``node.get_publishers_info_by_topic`` and its like tell them.
    """
    own = (node.get_name(), node.get_namespace())
    return [each for each in endpoints if (each.node_name, each.node_namespace) != own]


def guard_change_state(
    node: LifecycleNode, guard: Callable[[Callable[[Any, Any], Any]], Callable[[Any, Any], Any]]
) -> None:
    """Put something in front of the service ``~/change_state``, which rclpy makes by itself.

    Parameters
    ----------
    guard
        Takes what answers the service, and returns what is to answer it.
    """
    service = node._service_change_state
    service.callback = guard(service.callback)


class PlainNode(NodeOnDDS, Node):  # type: ignore[misc]  # rclpy has no types
    """A node to be spun by :class:`kompass.rclpy_ext.executor.TaskExecutor`."""


_NO_PUBLISHER_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)
_STEADY = RosClock(clock_type=ClockType.STEADY_TIME)
_NO_SUBSCRIPTION_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)
