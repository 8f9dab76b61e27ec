"""Follows goals that somebody else sends to the planner, as a rule does after a click."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from action_msgs.msg import GoalStatusArray
from kompass_interfaces.action import PlanPath
from rclpy.qos import qos_profile_action_status_default

from kompass.bus.node import Node


class GoalWatch:
    """Learns how the next goal that turns up has ended.

    Parameters
    ----------
    node
        Listens, and asks.
    action
        Full name.
    """

    def __init__(self, node: Node, action: str) -> None:
        self._node = node
        self._known: set[bytes] = set()
        self._ended: Callable[[Any], object] | None = None
        impl = PlanPath.Impl
        self._result = impl.GetResultService.Request
        self._client = node.create_client(impl.GetResultService, f"{action}/_action/get_result")
        node.create_subscription(
            GoalStatusArray,
            f"{action}/_action/status",
            self._on_status,
            qos_profile_action_status_default,
        )

    def follow_next(self, ended: Callable[[Any], object]) -> None:
        """Hand over the end of the next goal: an answer with ``status`` and ``result``."""
        self._ended = ended

    def _on_status(self, message: GoalStatusArray) -> None:
        for each in message.status_list:
            key = bytes(each.goal_info.goal_id.uuid)
            if key in self._known:
                continue
            self._known.add(key)
            ended, self._ended = self._ended, None
            if ended is not None:
                self._node.executor.create_task(self._follow, each.goal_info.goal_id, ended)

    async def _follow(self, goal_id: Any, ended: Callable[[Any], object]) -> None:
        ended(await self._client.call_async(self._result(goal_id=goal_id)))
