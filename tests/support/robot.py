"""An independent rclpy client, as any other tool on the domain is one."""

import math
import threading
import time
from collections.abc import Callable
from typing import Any, TypeVar

import rclpy
from geometry_msgs.msg import PointStamped, Pose, PoseStamped, Twist
from kompass_interfaces.action import PlanPath
from kompass_interfaces.msg import DriveState
from kompass_interfaces.srv import CheckGoal, ReleaseStop, StopRobot
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import UInt32

from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.signed import SignedCalls

T = TypeVar("T")
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Robot:
    """Sees and drives the robot of one domain."""

    def __init__(self, domain: int) -> None:
        self.context = rclpy.Context()
        rclpy.init(args=[], context=self.context, domain_id=domain)
        self.node = rclpy.create_node("independent_tester", context=self.context)
        self._calls = SignedCalls(self.node)
        self.newest: dict[str, Any] = {}
        self.subscribe(Odometry, "/simulator/ground_truth")
        self.subscribe(UInt32, "/simulator/contacts")
        self.subscribe(Twist, "/cmd_vel")
        self.subscribe(DriveState, "/drive_state", LATCHED)
        self._clicks = self.node.create_publisher(PointStamped, "/clicked_point", 10)
        self._poses = self.node.create_publisher(PoseStamped, "/goal_pose", 10)
        self._action = ActionClient(self.node, PlanPath, "/planner/plan_path")
        self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self.node)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._spin)
        self._thread.start()

    def _spin(self) -> None:
        while not self._ended.is_set():
            self._executor.spin_once(timeout_sec=0.1)

    def close(self) -> None:
        """Leave the domain."""
        self._ended.set()
        self._thread.join()
        self._executor.shutdown()
        self._action.destroy()
        self.node.destroy_node()
        self.context.try_shutdown()

    def subscribe(self, kind: type, topic: str, qos: QoSProfile | int = 10) -> None:
        """Keep the newest message of a topic in ``newest``."""
        self.node.create_subscription(
            kind, topic, lambda message: self.newest.__setitem__(topic, message), qos
        )

    def do(self, work: Callable[[], T]) -> T:
        """Do something on the executor's thread, and return what it returns.

        rclpy's executor dies of what another thread destroys while it looks at it.
        """
        done: T = self.await_future(self._executor.create_task(work), 5, "the work")
        return done

    def await_future(self, future: Any, timeout: float, what: str) -> Any:
        """The result of a future."""
        wait_until(future.done, timeout, what)
        return future.result()

    def call(self, kind: type, name: str, request: Any, timeout: float = 5.0) -> Any:
        """Call a service; signed, as the console does it, if the service changes something."""
        return self._calls.begin(kind, name, request, patient(timeout)).wait()

    def call_unsigned(self, kind: type, name: str, request: Any, timeout: float = 5.0) -> Any:
        """Call a service as who has no key of the robot."""
        client = self.node.create_client(kind, name)
        try:
            wait_until(client.service_is_ready, 10, f"service {name}")
            return self.await_future(client.call_async(request), timeout, f"answer of {name}")
        finally:
            self.node.destroy_client(client)

    def ready(self) -> None:
        """Wait until the planner accepts that goals can be planned."""

        def plans() -> bool:
            return bool(self.check(0.0, 0.0).reason not in (1, 6))

        wait_until(lambda: "/simulator/ground_truth" in self.newest, 20, "the robot's pose")
        wait_until(plans, 20, "a planner with map and pose")

    def check(self, x: float, y: float) -> CheckGoal.Response:
        """Ask whether a point could be reached."""
        request = CheckGoal.Request()
        request.goal.position.x, request.goal.position.y = x, y
        return self.call(CheckGoal, "/planner/check_goal", request)

    def send_goal(self, x: float, y: float, yaw: float | None = None) -> Any:
        """Send a PlanPath goal; its handle, once accepted."""
        wait_until(self._action.server_is_ready, 10, "the PlanPath server")
        goal = PlanPath.Goal(goal=pose(x, y, yaw or 0.0))
        goal.end_tolerance.lateral_distance_error = 0.05
        goal.end_tolerance.orientation_error = math.pi if yaw is None else 0.1
        # From the executor's own thread: rclpy may otherwise see the answer before the question.
        sent = self._executor.create_task(lambda: self._action.send_goal_async(goal))
        handle = self.await_future(self.await_future(sent, 5, "sending"), 5, "acceptance")
        assert handle.accepted
        return handle

    def result(self, handle: Any, timeout: float = 60.0) -> Any:
        """How a goal ended: ``status`` and ``result``."""
        return self.await_future(handle.get_result_async(), timeout, "the end of the goal")

    def click(self, x: float, y: float) -> None:
        """Publish Point, as RViz does."""
        message = PointStamped()
        message.header.frame_id = "map"
        message.header.stamp = self.node.get_clock().now().to_msg()
        message.point.x, message.point.y = x, y
        wait_until(lambda: self._clicks.get_subscription_count() > 0, 10, "a listener for clicks")
        self._clicks.publish(message)

    def stop(self) -> StopRobot.Response:
        """Press STOP."""
        request = StopRobot.Request(operator_name="tester", reason="test")
        return self.call(StopRobot, "/drive_manager/stop", request)

    def release(self) -> ReleaseStop.Response:
        """Release STOP, as a person."""
        request = ReleaseStop.Request(operator_name="tester")
        return self.call(ReleaseStop, "/drive_manager/release_stop", request)

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
        wait_until(lambda: "/simulator/contacts" in self.newest, 5, "the count of contacts")
        return int(self.newest["/simulator/contacts"].data)

    def distance_to(self, x: float, y: float) -> float:
        """From where it really is [m]."""
        return math.hypot(self.truth[0] - x, self.truth[1] - y)

    def watch(self, seconds: float) -> list[tuple[float, float, float]]:
        """Poses during a while."""
        seen, end = [], time.monotonic() + seconds
        while time.monotonic() < end:
            seen.append(self.truth)
            time.sleep(0.05)
        return seen


def pose(x: float, y: float, yaw: float) -> Pose:
    """A planar pose as a message."""
    made = Pose()
    made.position.x, made.position.y = x, y
    made.orientation.z, made.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return made
