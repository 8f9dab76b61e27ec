"""Actions: services and topics that belong together, as in ROS."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Sequence
from typing import Any, Protocol

from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from rclpy.action import CancelResponse, GoalResponse
from rclpy.executors import await_or_execute
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.qos import qos_profile_action_status_default
from rclpy.task import Future
from unique_identifier_msgs.msg import UUID

from kompass.bus.node import Execute, Node
from kompass.rclpy_ext.deferred_service import defer_answers
from kompass.rclpy_ext.guarded import guarded
from kompass.virtual.process import VirtualProcess

RESULT_KEPT = 900 * 1_000_000_000  # ns for which a server remembers a goal that has ended
_FEEDBACK = "/_action/feedback"
_FEEDBACK_TYPE = "_FeedbackMessage"
_ACTIVE = (
    GoalStatus.STATUS_ACCEPTED,
    GoalStatus.STATUS_EXECUTING,
    GoalStatus.STATUS_CANCELING,
)
_OVER = (GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_CANCELED, GoalStatus.STATUS_ABORTED)
# Which status follows on an event (design.ros2.org, "Actions").
_FOLLOWS = {
    ("execute", GoalStatus.STATUS_ACCEPTED): GoalStatus.STATUS_EXECUTING,
    ("cancel", GoalStatus.STATUS_ACCEPTED): GoalStatus.STATUS_CANCELING,
    ("cancel", GoalStatus.STATUS_EXECUTING): GoalStatus.STATUS_CANCELING,
    ("succeed", GoalStatus.STATUS_EXECUTING): GoalStatus.STATUS_SUCCEEDED,
    ("succeed", GoalStatus.STATUS_CANCELING): GoalStatus.STATUS_SUCCEEDED,
    ("abort", GoalStatus.STATUS_EXECUTING): GoalStatus.STATUS_ABORTED,
    ("abort", GoalStatus.STATUS_CANCELING): GoalStatus.STATUS_ABORTED,
    ("canceled", GoalStatus.STATUS_CANCELING): GoalStatus.STATUS_CANCELED,
}


def action_names_and_types(topics: Sequence[tuple[str, Sequence[str]]]) -> list[Any]:
    """The actions that topics belong to, as rcl finds them."""
    return [
        (name.removesuffix(_FEEDBACK), [each.removesuffix(_FEEDBACK_TYPE) for each in types])
        for name, types in topics
        if name.endswith(_FEEDBACK)
    ]


class ActionNode(Node, Protocol):
    """What an action is made of."""

    @property
    def process(self) -> VirtualProcess: ...
    def on_callback_error(self, error: Exception) -> None: ...
    def destroy_service(self, service: Any) -> bool: ...


class VirtualGoalHandle:
    """A goal, on the side of its server; as rclpy's ``ServerGoalHandle``."""

    def __init__(self, server: VirtualActionServer, info: GoalInfo, request: Any) -> None:
        self._server, self.info, self._request = server, info, request
        self._status: int = GoalStatus.STATUS_ACCEPTED
        self.ended_at: int | None = None
        self.forgotten = False
        self.result = Future()

    @property
    def request(self) -> Any:
        """What is asked for."""
        return self._request

    @property
    def goal_id(self) -> UUID:
        return self.info.goal_id

    @property
    def status(self) -> int:
        """As in ``action_msgs/msg/GoalStatus``; unknown once the server is gone."""
        return 0 if self.forgotten else self._status

    @property
    def is_active(self) -> bool:
        """Whether it has not come to an end."""
        return self.status in _ACTIVE

    @property
    def is_cancel_requested(self) -> bool:
        return bool(self.status == GoalStatus.STATUS_CANCELING)

    def execute(self, execute: Callable[[Any], Any] | None = None) -> None:
        """Begin."""
        if not self.is_cancel_requested:
            self.advance("execute")
        self._server.execute(self, execute)

    def publish_feedback(self, feedback: Any) -> None:
        """Tell how far it has come."""
        if not self.forgotten:
            self._server.publish_feedback(self, feedback)

    def succeed(self) -> None:
        self.advance("succeed")

    def abort(self) -> None:
        self.advance("abort")

    def canceled(self) -> None:
        self.advance("canceled")

    def can(self, event: str) -> bool:
        """Whether a status follows on an event."""
        return (event, self.status) in _FOLLOWS

    def advance(self, event: str) -> None:
        """Go on to the status that follows.

        Raises
        ------
        rclpy._rclpy_pybind11.RCLError
            When none does.
        """
        if self.forgotten:
            return
        follows = _FOLLOWS.get((event, self._status))
        if follows is None:
            raise rclpy_implementation.RCLError(
                f"Failed to update goal state: goal_handle attempted invalid transition from "
                f"state {self._status} with event {event}"
            )
        self._status = follows
        if follows in _OVER:
            self.ended_at = self._server.now
        self._server.publish_status()


class VirtualActionServer:
    """Takes goals, as :class:`rclpy.action.ActionServer`."""

    def __init__(
        self,
        node: ActionNode,
        action_type: Any,
        action_name: str,
        execute: Execute,
        *,
        goal_callback: Callable[[Any], Any],
        cancel_callback: Callable[[Any], Any],
    ) -> None:
        self._node, self.action_type, self._execute = node, action_type, execute
        tell = node.on_callback_error
        self._goal_callback = guarded(goal_callback, GoalResponse.REJECT, tell)
        self._cancel_callback = guarded(cancel_callback, CancelResponse.REJECT, tell)
        self._goals: dict[bytes, VirtualGoalHandle] = {}
        impl = action_type.Impl
        self._services = []
        for kind, name, answer in (
            (impl.SendGoalService, "send_goal", self._on_goal),
            (impl.GetResultService, "get_result", self._on_result),
            (CancelGoal, "cancel_goal", self._on_cancel),
        ):
            service = node.create_service(kind, f"{action_name}/_action/{name}", answer)
            defer_answers(node, service)
            self._services.append(service)
        self._feedback = node.create_publisher(
            impl.FeedbackMessage, f"{action_name}{_FEEDBACK}", 10
        )
        self._status = node.create_publisher(
            GoalStatusArray, f"{action_name}/_action/status", qos_profile_action_status_default
        )

    @property
    def now(self) -> int:
        """Monotonic [ns]."""
        return self._node.process.world.scheduler.now

    def destroy(self) -> None:
        """Take it from the network; the goals under way are forgotten."""
        for goal in self._goals.values():
            goal.forgotten = True
        for service in self._services:
            self._node.destroy_service(service)
        self._node.destroy_publisher(self._feedback)
        self._node.destroy_publisher(self._status)

    async def expire_goals(self) -> None:
        """Forget the goals that ended long ago."""
        for key, goal in list(self._goals.items()):
            if goal.ended_at is not None and self.now - goal.ended_at > RESULT_KEPT:
                goal.forgotten = True
                del self._goals[key]

    # -- for goal handles ---------------------------------------------------------------------

    def execute(self, goal: VirtualGoalHandle, execute: Callable[[Any], Any] | None) -> None:
        """Pursue a goal."""
        self._node.executor.create_task(self._pursue, goal, execute or self._execute)

    def publish_status(self) -> None:
        """Tell of all goals."""
        goals = [
            GoalStatus(goal_info=goal.info, status=goal.status) for goal in self._goals.values()
        ]
        self._status.publish(GoalStatusArray(status_list=goals))

    def publish_feedback(self, goal: VirtualGoalHandle, feedback: Any) -> None:
        """Tell how far a goal has come.

        Raises
        ------
        TypeError
            When the feedback is that of another action.
        """
        if not isinstance(feedback, self.action_type.Feedback):
            raise TypeError(f"Expected {self.action_type.Feedback}, got {type(feedback)}")
        message = self.action_type.Impl.FeedbackMessage(goal_id=goal.goal_id, feedback=feedback)
        self._feedback.publish(message)

    # -- what is asked ------------------------------------------------------------------------

    async def _on_goal(self, request: Any, response: Any) -> Any:
        key = bytes(request.goal_id.uuid)
        if key not in self._goals:
            answer = await self._goal_callback(request.goal)
            response.accepted = answer == GoalResponse.ACCEPT
        response.stamp = self._node.get_clock().now().to_msg()
        if response.accepted:
            info = GoalInfo(goal_id=request.goal_id, stamp=response.stamp)
            goal = self._goals[key] = VirtualGoalHandle(self, info, request.goal)
            self._node.executor.create_task(self._begin, goal)
        return response

    def _begin(self, goal: VirtualGoalHandle) -> None:
        self.publish_status()
        goal.execute()

    async def _pursue(self, goal: VirtualGoalHandle, execute: Callable[[Any], Any]) -> None:
        log = self._node.get_logger()
        try:
            result = await await_or_execute(execute, goal)
        except Exception as error:  # noqa: BLE001 - as rclpy: logged, and the goal is aborted
            result = self.action_type.Result()
            log.error(f"Error raised in execute callback: {error}")
        if goal.is_active:
            log.warning(f"Goal state not set, assuming aborted. Goal ID: {goal.goal_id.uuid}")
            goal.abort()
        goal.result.set_result((goal.status, result))

    async def _on_result(self, request: Any, response: Any) -> Any:
        goal = self._goals.get(bytes(request.goal_id.uuid))
        if goal is None:
            response.status = GoalStatus.STATUS_UNKNOWN
        else:
            response.status, response.result = await goal.result
        return response

    async def _on_cancel(self, request: Any, response: Any) -> Any:
        response.return_code, goals = self._to_cancel(request.goal_info)
        for goal in goals:
            answer = await self._cancel_callback(goal)
            # As rclpy: the code says no that all were refused.
            if answer == CancelResponse.ACCEPT and goal.can("cancel"):
                goal.advance("cancel")
                response.goals_canceling.append(goal.info)
        return response

    def _to_cancel(self, info: GoalInfo) -> tuple[int, list[VirtualGoalHandle]]:
        """Which goals a request means (action_msgs/srv/CancelGoal), and the code of the answer."""
        key, before = bytes(info.goal_id.uuid), _time(info)
        everybody = key == bytes(16) and not before
        if everybody or before:
            meant = [
                goal
                for goal in self._goals.values()
                if everybody or _time(goal.info) <= before or bytes(goal.goal_id.uuid) == key
            ]
            return CancelGoal.Response.ERROR_NONE, [g for g in meant if g.can("cancel")]
        if key not in self._goals:
            return CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID, []
        if not self._goals[key].can("cancel"):
            return CancelGoal.Response.ERROR_GOAL_TERMINATED, []
        return CancelGoal.Response.ERROR_NONE, [self._goals[key]]


class VirtualClientGoalHandle:
    """A goal, on the side of its client; as rclpy's ``ClientGoalHandle``."""

    def __init__(self, client: VirtualActionClient, goal_id: UUID, response: Any) -> None:
        self._client, self._goal_id, self._response = client, goal_id, response
        self.status = GoalStatus.STATUS_UNKNOWN

    @property
    def goal_id(self) -> UUID:
        return self._goal_id

    @property
    def stamp(self) -> Any:
        """When it was answered."""
        return self._response.stamp

    @property
    def accepted(self) -> bool:
        return bool(self._response.accepted)

    def get_result_async(self) -> Future:
        """A future of the end, with ``status`` and ``result``."""
        return self._client.ask_result(self._goal_id)

    def cancel_goal_async(self) -> Future:
        """Ask for its end; a future of the answer."""
        return self._client.cancel(self._goal_id)


class VirtualActionClient:
    """Sends goals, as :class:`rclpy.action.ActionClient`."""

    def __init__(self, node: ActionNode, action_type: Any, action_name: str) -> None:
        self._node, self._action_type = node, action_type
        impl = action_type.Impl
        self._send_goal, self._get_result, self._cancel_goal = self._clients = tuple(
            node.create_client(kind, f"{action_name}/_action/{name}")
            for kind, name in (
                (impl.SendGoalService, "send_goal"),
                (impl.GetResultService, "get_result"),
                (CancelGoal, "cancel_goal"),
            )
        )
        self._heard = (
            node.create_subscription(
                impl.FeedbackMessage, f"{action_name}{_FEEDBACK}", self._on_feedback, 10
            ),
            node.create_subscription(
                GoalStatusArray,
                f"{action_name}/_action/status",
                self._on_status,
                qos_profile_action_status_default,
            ),
        )
        self._goals: dict[bytes, VirtualClientGoalHandle] = {}
        self._feedback: dict[bytes, Callable[[Any], object]] = {}

    def server_is_ready(self) -> bool:
        """Whether all that belongs to an action is there."""
        return all(client.service_is_ready() for client in self._clients) and all(
            heard.is_matched for heard in self._heard
        )

    def send_goal_async(
        self,
        goal: Any,
        feedback_callback: Callable[[Any], object] | None = None,
        goal_uuid: UUID | None = None,
    ) -> Future:
        """Send a goal; a future of its handle.

        Raises
        ------
        TypeError
            When the goal is that of another action.
        """
        if not isinstance(goal, self._action_type.Goal):
            raise TypeError(f"Expected {self._action_type.Goal}, got {type(goal)}")
        if goal_uuid is None:
            number = self._node.process.chance.getrandbits(128)
            goal_uuid = UUID(uuid=list(uuid.UUID(int=number, version=4).bytes))
        key = bytes(goal_uuid.uuid)
        if feedback_callback is not None:
            self._feedback[key] = feedback_callback
        request = self._action_type.Impl.SendGoalService.Request(goal_id=goal_uuid, goal=goal)
        sent = Future()

        def answered(answer: Future) -> None:
            handle = VirtualClientGoalHandle(self, goal_uuid, answer.result())
            if handle.accepted:
                self._goals[key] = handle
            sent._set_executor(self._node.executor)
            sent.set_result(handle)

        self._send_goal.call_async(request).add_done_callback(answered)
        return sent

    def ask_result(self, goal_id: UUID) -> Future:
        """For a goal handle."""
        request = self._action_type.Impl.GetResultService.Request(goal_id=goal_id)
        asked = self._get_result.call_async(request)
        asked.add_done_callback(lambda _: self._feedback.pop(bytes(goal_id.uuid), None))
        return asked

    def cancel(self, goal_id: UUID) -> Future:
        """For a goal handle."""
        return self._cancel_goal.call_async(CancelGoal.Request(goal_info=GoalInfo(goal_id=goal_id)))

    def destroy(self) -> None:
        """Take it from the network."""
        for client in self._clients:
            self._node.destroy_client(client)
        for heard in self._heard:
            self._node.destroy_subscription(heard)

    def _on_feedback(self, message: Any) -> None:
        callback = self._feedback.get(bytes(message.goal_id.uuid))
        if callback is not None:
            try:
                callback(message)
            except Exception as error:  # noqa: BLE001 - is told of, as by nodes on DDS
                self._node.on_callback_error(error)

    def _on_status(self, message: GoalStatusArray) -> None:
        for each in message.status_list:
            key = bytes(each.goal_info.goal_id.uuid)
            handle = self._goals.get(key)
            if handle is not None:
                handle.status = each.status
                if each.status in _OVER:
                    del self._goals[key]


def _time(info: GoalInfo) -> int:
    """When a goal was accepted [ns]."""
    return int(info.stamp.sec) * 1_000_000_000 + int(info.stamp.nanosec)
