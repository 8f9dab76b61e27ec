"""Nodes whose publishers and subscriptions may come and go under the events executor."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterable
from typing import Any

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node


class NoEventCallbacks:
    """Part of a node: its publishers and subscriptions have no event handlers unless asked for.

    rclpy gives each one two, which log a warning when somebody's quality of service does not fit.
    Where that happens while the publisher or subscription is destroyed, the events executor (7.1.6)
    dies of SIGSEGV (``ros2/rclpy`` issue 1644). A rule, a restart or a page that is closed destroys
    them all the time.
    """

    def create_publisher(self, *args: Any, **kwargs: Any) -> Any:
        """As of :class:`rclpy.node.Node`."""
        kwargs.setdefault("event_callbacks", _NO_PUBLISHER_EVENTS)
        return super().create_publisher(*args, **kwargs)  # type: ignore[misc]

    def create_subscription(self, *args: Any, **kwargs: Any) -> Any:
        """As of :class:`rclpy.node.Node`."""
        kwargs.setdefault("event_callbacks", _NO_SUBSCRIPTION_EVENTS)
        return super().create_subscription(*args, **kwargs)  # type: ignore[misc]

    def destroy_subscription(self, subscription: Any) -> bool:
        """As of :class:`rclpy.node.Node`; its callback group forgets it too.

        rclpy's does not (7.1.6, ``ros2/rclpy`` issue 1356): a little memory for each that ever was.
        """
        entities = subscription.callback_group.entities
        entities.discard(weakref.ref(subscription))
        return bool(super().destroy_subscription(subscription))  # type: ignore[misc]


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


class PlainNode(NoEventCallbacks, Node):  # type: ignore[misc]  # rclpy has no types
    """A node to be spun by :class:`kompass.rclpy_ext.executor.TaskExecutor`."""


_NO_PUBLISHER_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)
_NO_SUBSCRIPTION_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)
