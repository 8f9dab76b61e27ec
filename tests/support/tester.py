"""A client that sees and drives a robot, whichever bus and time the robot lives in."""

from __future__ import annotations

import json
import math
from typing import Any

from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ExecuteMethod
from geometry_msgs.msg import PointStamped, Pose, PoseStamped, Twist
from kompass_interfaces.action import PlanPath
from kompass_interfaces.msg import DriveState
from kompass_interfaces.srv import CheckGoal, ReleaseStop, SetFault, StopRobot
from nav_msgs.msg import Odometry
from rclpy.qos import ReliabilityPolicy
from std_msgs.msg import UInt32

from kompass.components.base.health import HEALTHY_TEXT
from kompass.rclpy_ext.reply import NoAnswer
from tests.support.client import LATCHED, Client

__all__ = ["LATCHED", "Tester", "pose"]

PERIOD = 0.05  # s between two looks at where the robot is


class Tester(Client):
    """What the tests do with a robot."""

    def __init__(self, node: Any) -> None:
        super().__init__(node)
        self.subscribe(Odometry, "/simulator/ground_truth")
        self.subscribe(UInt32, "/simulator/contacts")
        self.subscribe(Twist, "/cmd_vel")
        self.subscribe(DriveState, "/drive_state", LATCHED)
        self._clicks = node.create_publisher(PointStamped, "/clicked_point", 10)
        self._poses = node.create_publisher(PoseStamped, "/goal_pose", 10)
        self._action = self.action_client(PlanPath, "/planner/plan_path")

    def ready(self) -> None:
        """Wait until the planner accepts that goals can be planned."""

        def plans() -> bool:
            try:
                return bool(self.check(0.0, 0.0).reason not in (1, 6))
            except NoAnswer:
                # DDS makes each side known to the other by itself: the planner may be asked before
                # it knows who asks, and what it then answers is given up after 0.1 s.
                return False

        self.wait_until(lambda: "/simulator/ground_truth" in self.newest, 20, "the robot's pose")
        self.wait_until(plans, 20, "a planner with map and pose")

    def drive_manager_does(self, action: str, **kwargs: object) -> bool:
        """Whether the drive manager succeeds in an action."""
        request = ExecuteMethod.Request(name=action, kwargs_json=json.dumps(kwargs))
        return bool(self.call(ExecuteMethod, "/drive_manager/execute_method", request).success)

    def can_be_tested(self) -> None:
        """Wait until the drive manager has measured the room, and the motion server hears all."""
        self.subscribe(ComponentStatus, "/motion_server/status", LATCHED)
        self.wait_until(
            lambda: self.drive_manager_does("room_for", legs=[[0.0, 0.0, 0.0, 1.0]]), 20, "a scan"
        )
        status = "/motion_server/status"
        self.wait_until(
            lambda: status in self.newest and self.newest[status].msg == HEALTHY_TEXT,
            20,
            "what it records",
        )

    def check(self, x: float, y: float) -> CheckGoal.Response:
        """Ask whether a point could be reached."""
        request = CheckGoal.Request()
        request.goal.position.x, request.goal.position.y = x, y
        return self.call(CheckGoal, "/planner/check_goal", request)

    def send_goal(self, x: float, y: float, yaw: float | None = None) -> Any:
        """Send a PlanPath goal; its handle, once accepted."""
        goal = PlanPath.Goal(goal=pose(x, y, yaw or 0.0))
        goal.end_tolerance.lateral_distance_error = 0.05
        goal.end_tolerance.orientation_error = math.pi if yaw is None else 0.1
        handle = self.send(self._action, goal)
        assert handle.accepted
        return handle

    def fault(self, name: str, *, on: bool = True, duration: float = 0.0) -> None:
        """Switch a fault, as soon as the simulator has found what it is about."""
        request = SetFault.Request(fault=name, on=on, duration=duration)

        def switched() -> bool:
            return bool(self.call(SetFault, "/simulator/set_fault", request).success)

        self.wait_until(switched, 10, f"the fault {name}")

    def wait_for_listeners(self, topic: str, *nodes: str) -> None:
        """Wait until nodes are known to listen to a topic, as they know who speaks there."""

        def known() -> bool:
            infos = self.node.get_subscriptions_info_by_topic(topic)
            return set(nodes) <= {info.node_name for info in infos}

        self.wait_until(known, 20, f"{', '.join(nodes)} to listen to {topic}")

    def wait_for_reliable_listener(self, topic: str, node: str) -> None:
        """Wait until a node reads a topic as reliably as it is published.

        It does so once it knows the publisher: before, what is published once may pass it by.
        """

        def reliable() -> bool:
            infos = self.node.get_subscriptions_info_by_topic(topic)
            return any(
                info.node_name == node
                and info.qos_profile.reliability == ReliabilityPolicy.RELIABLE
                for info in infos
            )

        self.wait_until(reliable, 20, f"{node} to read {topic} reliably")

    def click(self, x: float, y: float, taker: str) -> None:
        """Publish Point, as RViz does, once the node that makes a goal of it is there to hear it:
        a recorder or a console that was found first makes none."""
        message = PointStamped()
        message.header.frame_id = "map"
        message.header.stamp = self.node.get_clock().now().to_msg()
        message.point.x, message.point.y = x, y
        self.wait_for_listeners("/clicked_point", taker)
        self._clicks.publish(message)

    def stop(self) -> StopRobot.Response:
        """Press STOP."""
        request = StopRobot.Request(operator_name="tester", reason="test")
        return self.call(StopRobot, "/drive_manager/stop", request)

    def release(self) -> ReleaseStop.Response:
        """Release STOP, as a person."""
        request = ReleaseStop.Request(operator_name="tester")
        return self.call(ReleaseStop, "/drive_manager/release_stop", request)

    def has_stopped(self, stopped: bool = True) -> None:
        """Wait until the robot says that STOP is pressed, or that it is not.

        Whoever pressed it may have the answer before the robot's word is here.
        """
        what = "STOP" if stopped else "no STOP"
        self.wait_until(lambda: self.newest["/drive_state"].stopped == stopped, 5, what)

    # -- where it is --------------------------------------------------------------------------

    @property
    def truth(self) -> tuple[float, float, float]:
        """Where the robot really is."""
        at = self.newest["/simulator/ground_truth"].pose.pose
        return at.position.x, at.position.y, 2 * math.atan2(at.orientation.z, at.orientation.w)

    @property
    def speed(self) -> float:
        """How fast it really moves [m/s]."""
        twist = self.newest["/simulator/ground_truth"].twist.twist
        return math.hypot(twist.linear.x, twist.linear.y)

    @property
    def contacts(self) -> int:
        """How often it has touched something."""
        self.wait_until(lambda: "/simulator/contacts" in self.newest, 5, "the count of contacts")
        return int(self.newest["/simulator/contacts"].data)

    def distance_to(self, x: float, y: float) -> float:
        """From where it really is [m]."""
        return math.hypot(self.truth[0] - x, self.truth[1] - y)

    def watch(self, seconds: float) -> list[tuple[float, float, float]]:
        """Poses during a while."""
        seen, end = [], self.clock.monotonic() + seconds
        while self.clock.monotonic() < end:
            seen.append(self.truth)
            self.rest(PERIOD)
        return seen


def pose(x: float, y: float, yaw: float) -> Pose:
    """A planar pose as a message."""
    made = Pose()
    made.position.x, made.position.y = x, y
    made.orientation.z, made.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return made
