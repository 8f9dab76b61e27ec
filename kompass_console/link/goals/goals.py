"""Sending goals, and listening to the actions that carry them out."""

from __future__ import annotations

import logging
import math
import re
import secrets
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from action_msgs.msg import GoalStatusArray
from action_msgs.srv import CancelGoal
from geometry_msgs.msg import PointStamped, PoseStamped
from kompass_interfaces.action import PlanPath
from pydantic import ValidationError
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String

from kompass.algorithms.geometry import quaternion_from_yaw
from kompass.components.planner.goal_reports import GOAL_REPORTS, REPORTS
from kompass.invalid import first_invalid
from kompass.rclpy_ext.node import of_others
from kompass.rclpy_ext.reply import NoAnswer
from kompass.recorder.process import NAME as RECORDER
from kompass.timeline.goal import GoalReport
from kompass_console.link.goals.goal_follower import ActionStatus, Ending, GoalFollower
from kompass_console.link.graph.convert import seconds, yaw_of
from kompass_console.link.graph.discovery import NODE_NAME, Graph, action_names
from kompass_console.link.graph.reader import Reader
from kompass_console.link.graph.services import ServicePool
from kompass_console.schema.plain import plain
from kompass_console.schema.world import WorldModel

GoalTopic = Literal["/goal_pose", "/clicked_point"]
POSE_TOPIC: GoalTopic = "/goal_pose"
POINT_TOPIC: GoalTopic = "/clicked_point"

# Nodes that hear of every goal and take none: the flight recorder, and other consoles.
_WHO_ONLY_HEAR = re.compile(rf"{RECORDER}|{NODE_NAME}_\d+")
_ACTION = "kompass_interfaces/action/PlanPath"
_FRAME = "map"

_logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Listeners:
    """Whether somebody who may take a goal listens to each goal topic right now."""

    pose: bool
    point: bool

    def topic_for(self, yaw: float | None) -> GoalTopic | None:
        """Where a goal goes: with heading to who can use one, without to who wants points."""
        if yaw is not None and self.pose:
            return POSE_TOPIC
        if self.point:
            return POINT_TOPIC
        return POSE_TOPIC if self.pose else None


class Goals:
    """The goal topics and every PlanPath action on the graph."""

    def __init__(
        self,
        node: Node,
        world: WorldModel,
        changed: Callable[[], None],
        sender: Callable[[float, float], str],
    ) -> None:
        self._node = node
        self._world = world
        self.follower = GoalFollower(world, changed, sender=sender)
        self._poses = node.create_publisher(PoseStamped, POSE_TOPIC, QoSProfile(depth=10))
        self._points = node.create_publisher(PointStamped, POINT_TOPIC, QoSProfile(depth=10))
        node.create_subscription(PoseStamped, POSE_TOPIC, self._heard_pose, QoSProfile(depth=10))
        node.create_subscription(PointStamped, POINT_TOPIC, self._heard_point, QoSProfile(depth=10))
        node.create_subscription(String, GOAL_REPORTS, self._heard_report, REPORTS.to_ros())
        self._status: dict[str, Reader[dict[str, ActionStatus]]] = {}
        self._feedback: dict[str, Reader[tuple[str, float]]] = {}
        self._results: dict[str, Any] = {}
        self._unasked: list[tuple[str, str]] = []
        # The goal that is followed, and who served its action when it was taken (ids of DDS).
        self._served: tuple[str, frozenset[bytes]] = ("", frozenset())
        self._cancels = ServicePool(node, CancelGoal, "action_msgs/srv/CancelGoal")

    @property
    def action_there(self) -> bool:
        """Whether a PlanPath action is on the graph."""
        return bool(self._status)

    def listeners(self) -> Listeners:
        """Looks at the graph; cheap, any thread."""
        return Listeners(self._listened(POSE_TOPIC), self._listened(POINT_TOPIC))

    def refresh(self, published: Graph, services: Graph) -> None:
        """Follow the actions that are there now."""
        actions = action_names(published, f"{_ACTION}_FeedbackMessage")
        for action in actions:
            if action not in self._status:
                self._add(action)
            self._status[action].follow(f"{action}/_action/status")
            self._feedback[action].follow(f"{action}/_action/feedback")
        for action in [a for a in self._status if a not in actions]:
            self._status.pop(action).close()
            self._feedback.pop(action).close()
            self._node.destroy_client(self._results.pop(action))
        self._cancels.refresh(
            {n: t for n, t in services.items() if n.removesuffix("/_action/cancel_goal") in actions}
        )

    def tick(self) -> None:
        """Let time pass for the goal that is followed."""
        self._ask_results()
        self._look_at_server()
        self.follower.tick(action_there=self.action_there)

    def send(
        self,
        x: float,
        y: float,
        yaw: float | None,
        topic: GoalTopic,
        *,
        by: str,
        speed: float | None,
    ) -> str:
        """Publish a goal (m, rad, map frame) and follow it; returns its id. Any thread."""
        goal_id = secrets.token_hex(8)
        used = yaw if topic == POSE_TOPIC else None
        stamp = self._node.get_clock().now().to_msg()
        self.follower.sent(goal_id, x, y, used, by=by, speed=speed, stamp=seconds(stamp))
        if topic == POINT_TOPIC:
            point = PointStamped()
            point.header.frame_id, point.header.stamp = _FRAME, stamp
            point.point.x, point.point.y = x, y
            self._points.publish(point)
            return goal_id
        pose = PoseStamped()
        pose.header.frame_id, pose.header.stamp = _FRAME, stamp
        pose.pose = pose_message(x, y, self._bearing(x, y) if yaw is None else yaw)
        self._poses.publish(pose)
        return goal_id

    async def cancel(self, timeout: float) -> bool:
        """Cancel the goal that runs; False when none does.

        Raises
        ------
        NoAnswer
            When its action server does not answer.
        """
        target = self.follower.target()
        if target is None:
            return False
        action, uuid = target
        request = CancelGoal.Request()  # all zeros: every goal of the server
        if uuid:
            request.goal_info.goal_id.uuid = list(bytes.fromhex(uuid))
        servers = [f"{action}/_action/cancel_goal"] if action else self._cancels.names
        if not servers:
            raise NoAnswer("no planner with a PlanPath action is there")
        for server in servers:
            await self._cancels.call(request, timeout, server)
        if not uuid:
            self.follower.withdraw()
        return True

    def _bearing(self, x: float, y: float) -> float:
        """Heading (rad) from the robot towards a point: where it will look on arriving there."""
        motion = self._world.motion.get()
        if motion is None:
            return 0.0
        return math.atan2(y - motion.value.pose.y, x - motion.value.pose.x)

    def _listened(self, topic: str) -> bool:
        infos = self._node.get_subscriptions_info_by_topic(topic)
        others = of_others(self._node, infos)
        return any(_WHO_ONLY_HEAR.fullmatch(each.node_name) is None for each in others)

    def _heard_pose(self, message: Any) -> None:
        pose = message.pose
        self._hear(pose.position.x, pose.position.y, yaw_of(pose.orientation))

    def _heard_point(self, message: Any) -> None:
        self._hear(message.point.x, message.point.y, None)

    def _hear(self, x: float, y: float, yaw: float | None) -> None:
        if math.isfinite(x) and math.isfinite(y) and math.isfinite(yaw or 0.0):
            self.follower.heard(x, y, yaw)  # the planner refuses what is no number

    def _heard_report(self, message: Any) -> None:
        try:
            report = GoalReport.model_validate_json(message.data)
        except ValidationError as error:
            _logger.warning("/%s: %s", GOAL_REPORTS, plain(first_invalid(error).text))
            return
        if not report.outcome:
            self.follower.reported(report.x, report.y, report.yaw, report.time)

    def _add(self, action: str) -> None:
        self._results[action] = self._node.create_client(
            PlanPath.Impl.GetResultService, f"{action}/_action/get_result"
        )

        def statuses(goals: dict[str, ActionStatus]) -> None:
            self._unasked += [(action, uuid) for uuid in self.follower.statuses(action, goals)]
            self._ask_results()

        self._status[action] = Reader(
            self._node, GoalStatusArray, _statuses_of, statuses, latched=True, depth=10
        )
        self._feedback[action] = Reader(
            self._node,
            PlanPath.Impl.FeedbackMessage,
            _feedback_of,
            lambda feedback: self.follower.feedback(*feedback),
        )

    def _look_at_server(self) -> None:
        """A server that is started again has the name of the dead one, and knows no goal of it."""
        action, uuid = self.follower.target() or ("", "")
        if not uuid:
            return
        infos = self._node.get_publishers_info_by_topic(f"{action}/_action/status")
        now = frozenset(bytes(info.endpoint_gid) for info in infos)
        followed, before = self._served
        if followed != uuid or not before:
            self._served = uuid, now
        # DDS believes in one that was killed for a while; its successor is there before.
        elif not now or now - before:
            self.follower.lost(uuid)

    def _ask_results(self) -> None:
        """Ask for results as soon as their server is connected; before that, a request is lost."""
        waiting = [(action, uuid) for action, uuid in self._unasked if action in self._results]
        self._unasked = []
        for action, uuid in waiting:
            if self._results[action].service_is_ready():
                self._ask_result(action, uuid)
            else:
                self._unasked.append((action, uuid))

    def _ask_result(self, action: str, uuid: str) -> None:
        """Servers answer this when the goal ends, whoever sent it."""
        request = PlanPath.Impl.GetResultService.Request()
        request.goal_id.uuid = list(bytes.fromhex(uuid))

        def ended(done: Any) -> None:
            if done.cancelled() or done.exception() is not None:
                _logger.warning("%s: no result of goal %s", action, uuid)
                return
            answer = done.result()
            self.follower.result(uuid, Ending(int(answer.status), plain(answer.result.message)))

        self._results[action].call_async(request).add_done_callback(ended)


def pose_message(x: float, y: float, yaw: float) -> Any:
    """geometry_msgs/Pose of a planar pose."""
    pose = PoseStamped().pose
    pose.position.x, pose.position.y = float(x), float(y)
    _, _, pose.orientation.z, pose.orientation.w = quaternion_from_yaw(yaw)
    return pose


def _statuses_of(message: Any) -> dict[str, ActionStatus]:
    return {
        bytes(status.goal_info.goal_id.uuid).hex(): ActionStatus(
            int(status.status), seconds(status.goal_info.stamp)
        )
        for status in message.status_list
    }


def _feedback_of(message: Any) -> tuple[str, float]:
    return bytes(message.goal_id.uuid).hex(), float(message.feedback.distance_left)
