"""A stand-in for the navigation stack and its robot: the far side of DDS for the console's tests.

It keeps the ROS contract (topics, QoS, services, the PlanPath action) and moves a point along a
straight line; nothing of it plans or simulates. Run it with `python -m tests.console.fake_stack`.
"""

from __future__ import annotations

import argparse
import math
import os
import signal
import threading
import time
from array import array
from itertools import count

import numpy as np
import rclpy
from automatika_ros_sugar.msg import ComponentStatus
from geometry_msgs.msg import (
    Point32,
    PointStamped,
    PolygonStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    Quaternion,
    TransformStamped,
)
from kompass_interfaces.action import PlanPath
from kompass_interfaces.msg import DriveState, HandCommand
from kompass_interfaces.srv import CheckGoal, ReleaseStop, StopRobot, TakeWheel
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float32
from tf2_msgs.msg import TFMessage

from kompass.access.gatekeeper import Gatekeeper, NotAdmitted
from kompass.rclpy_ext.node import PlainNode
from kompass.signing.session_key import SessionKey

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SENSOR = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)

RESOLUTION = 0.05
ORIGIN = (-4.0, -3.0)
SIZE = (8.0, 6.0)
PILLARS = [(x, y) for x in (-1.5, 0.0, 1.5) for y in (-1.2, 0.0, 1.2)]
PILLAR_RADIUS = 0.15
ROOM = (-3.4, -2.4, 3.4, 2.4)
SPEED = 0.8
COMPONENTS = ("planner", "controller", "mapper", "drive_manager")


def occupied(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """1 where a pillar or the room's wall is."""
    x0, y0, x1, y1 = ROOM
    inside = (x > x0) & (x < x1) & (y > y0) & (y < y1)
    wall = ~inside & (x > x0 - 0.1) & (x < x1 + 0.1) & (y > y0 - 0.1) & (y < y1 + 0.1)
    for px, py in PILLARS:
        wall |= np.hypot(x - px, y - py) < PILLAR_RADIUS
    return wall


def world_map() -> np.ndarray:
    """Cells int8 (H, W)."""
    columns = np.arange(int(SIZE[0] / RESOLUTION)) * RESOLUTION + ORIGIN[0] + RESOLUTION / 2
    rows = np.arange(int(SIZE[1] / RESOLUTION)) * RESOLUTION + ORIGIN[1] + RESOLUTION / 2
    x, y = np.meshgrid(columns, rows)
    cells = np.full(x.shape, -1, dtype=np.int8)
    cells[(x > ROOM[0]) & (x < ROOM[2]) & (y > ROOM[1]) & (y < ROOM[3])] = 0
    cells[occupied(x, y)] = 100
    return cells


def building(rows: int, columns: int) -> np.ndarray:
    """A building as a laser maps it: rooms with ragged walls, speckle, and unknown outside."""
    chance = np.random.default_rng(4)
    cells = np.full((rows, columns), -1, np.int8)
    cells[40:-40, 40:-40] = 0
    for row in range(40, rows - 40, 90):
        for column in range(40, columns - 40):
            if column % 90 > 16:  # the rest is a door
                cells[row + chance.integers(-1, 2), column] = 100
    for column in range(40, columns - 40, 90):
        cells[40:-40, column : column + 2] = 100
    speckle = chance.random(cells.shape) < 0.002
    cells[speckle] = 100
    return cells


def quaternion(yaw: float) -> Quaternion:
    return Quaternion(z=math.sin(yaw / 2.0), w=math.cos(yaw / 2.0))


class FakeStack:
    """All of the contract in one node."""

    def __init__(
        self,
        *,
        poses: bool,
        points: bool,
        planner: bool,
        drive: bool,
        action: bool,
        statuses: bool,
        slow_checks: float,
        slow_release: float,
        failing: str,
        onlookers: bool,
        localiser: bool,
        large: bool,
    ) -> None:
        self.node = rclpy.create_node("planner")
        self.x, self.y, self.yaw, self.v = -0.75, -0.6, 0.4, 0.0
        self.astray = (0.0, 0.0, 0.0)  # x, y, yaw that it tells, less those that are so
        self.stopped_by = ""
        self.reason = ""
        self.driven_by = self.hand_session = ""
        self.hand_key: SessionKey | None = None
        self.stopped = threading.Event()
        self.ending = threading.Event()
        self.slow_checks = slow_checks
        self.slow_release = slow_release
        self.failing = failing
        self.cells = building(1674, 1006) if large else world_map()
        self.sensed: tuple[tuple[float, float, float], LaserScan, OccupancyGrid] | None = None
        group = ReentrantCallbackGroup()
        node = self.node
        self.map = node.create_publisher(OccupancyGrid, "/map", LATCHED)
        self.odometry = node.create_publisher(Odometry, "/odometry/filtered", 10)
        self.scan = node.create_publisher(LaserScan, "/scan", SENSOR)
        self.local_map = node.create_publisher(OccupancyGrid, "/local_map/occupancy_layer", 1)
        self.plan = node.create_publisher(Path, "/plan", LATCHED)
        self.footprint = node.create_publisher(PolygonStamped, "/footprint", LATCHED)
        self.static = node.create_publisher(TFMessage, "/tf_static", LATCHED)
        self.rate = node.create_publisher(Float32, "/simulator/rate", 10)
        self.statuses = {
            name: [
                node.create_publisher(ComponentStatus, f"/{name}{twin}", LATCHED)
                for twin in ("/status", "_status")
            ]
            for name in (COMPONENTS if statuses else ())
        }
        self.latch()
        self.gate: PlainNode | None = None
        if drive:
            self.drive = node.create_publisher(DriveState, "/drive_state", LATCHED)
            self.gate = PlainNode("drive_manager")
            self.gatekeeper = Gatekeeper(self.gate)
            node.create_service(StopRobot, "/drive_manager/stop", self.stop)
            node.create_service(ReleaseStop, "/drive_manager/release_stop", self.release)
            node.create_service(TakeWheel, "/drive_manager/take_wheel", self.take_wheel)
            node.create_subscription(HandCommand, "/drive_manager/hand", self.by_hand, SENSOR)
        else:
            self.drive = None
        if planner:
            node.create_service(
                CheckGoal, "/planner/check_goal", self.check_goal, callback_group=group
            )
        self.own = None
        if action:
            self.server = ActionServer(
                node,
                PlanPath,
                "/planner/plan_path",
                self.execute,
                goal_callback=lambda _: GoalResponse.ACCEPT,
                cancel_callback=lambda _: CancelResponse.ACCEPT,
                callback_group=group,
            )
            self.own = rclpy.action.ActionClient(node, PlanPath, "/planner/plan_path")
        if localiser:
            node.create_subscription(
                PoseWithCovarianceStamped, "/initialpose", self.place, 1, callback_group=group
            )
        if poses:
            node.create_subscription(
                PoseStamped, "/goal_pose", lambda m: self.take(m.pose), 10, callback_group=group
            )
        if points:
            node.create_subscription(
                PointStamped, "/clicked_point", self.take_point, 10, callback_group=group
            )

        # As a recorder and another console have it: they hear of every goal, and take none.
        self.onlookers = [
            PlainNode(name) for name in (("recorder", "kompass_console_1") if onlookers else ())
        ]
        for each in self.onlookers:
            each.create_subscription(PoseStamped, "/goal_pose", lambda _: None, 10)
            each.create_subscription(PointStamped, "/clicked_point", lambda _: None, 10)

    def speak(self) -> None:
        """Say what is so, at its rates, until the end.

        On a thread of its own: an executor of many threads takes the processor much longer for a
        timer than all this does.
        """
        for beat in count():
            self.move()
            if beat % 5 == 0:
                self.sense()
            if beat % 10 == 0:
                self.report()
            if self.ending.wait(0.02):
                return

    def latch(self) -> None:
        grid = OccupancyGrid()
        grid.header.frame_id = "map"
        grid.info.resolution = RESOLUTION
        grid.info.height, grid.info.width = self.cells.shape
        grid.info.origin.position.x, grid.info.origin.position.y = ORIGIN
        grid.data = array("b", self.cells.tobytes())
        self.map.publish(grid)
        ring = PolygonStamped()
        ring.header.frame_id = "base_link"
        ring.polygon.points = [
            Point32(x=0.105 * math.cos(a), y=0.105 * math.sin(a))
            for a in np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
        ]
        self.footprint.publish(ring)
        mount = TransformStamped()
        mount.header.frame_id, mount.child_frame_id = "base_link", "LDS-01"
        mount.transform.translation.x, mount.transform.rotation.w = -0.032, 1.0
        self.static.publish(TFMessage(transforms=[mount]))

    def move(self) -> None:
        message = Odometry()
        message.header.stamp = self.node.get_clock().now().to_msg()
        message.header.frame_id, message.child_frame_id = "map", "base_link"
        astray_x, astray_y, astray_yaw = self.astray
        at = message.pose.pose.position
        at.x, at.y = self.x + astray_x, self.y + astray_y
        message.pose.pose.orientation = quaternion(self.yaw + astray_yaw)
        message.twist.twist.linear.x = self.v
        self.odometry.publish(message)

    def place(self, message: PoseWithCovarianceStamped) -> None:
        at, turned = message.pose.pose.position, message.pose.pose.orientation
        yaw = 2.0 * math.atan2(turned.z, turned.w)
        self.astray = (at.x - self.x, at.y - self.y, yaw - self.yaw)

    def sense(self) -> None:
        at = (self.x, self.y, self.yaw)
        if self.sensed is None or self.sensed[0] != at:
            self.sensed = at, self.laser_scan(), self.local_grid()
        _, scan, grid = self.sensed
        scan.header.stamp = self.node.get_clock().now().to_msg()
        self.scan.publish(scan)
        self.local_map.publish(grid)

    def laser_scan(self) -> LaserScan:
        angles = np.arange(360) * math.pi / 180.0
        steps = np.arange(0.12, 3.5, 0.02)
        reach_x = self.x + np.cos(self.yaw + angles)[:, None] * steps
        reach_y = self.y + np.sin(self.yaw + angles)[:, None] * steps
        hit = occupied(reach_x, reach_y)
        ranges = np.where(hit.any(axis=1), steps[hit.argmax(axis=1)], np.inf)
        scan = LaserScan(angle_min=0.0, angle_increment=math.pi / 180.0)
        scan.header.frame_id = "LDS-01"
        scan.range_min, scan.range_max = 0.12, 3.5
        scan.ranges = ranges.tolist()
        return scan

    def local_grid(self) -> OccupancyGrid:
        size, half = 60, 1.5
        at = (np.arange(size) + 0.5) * RESOLUTION - half
        forward, left = np.meshgrid(at, at)
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        cells = occupied(self.x + c * forward - s * left, self.y + s * forward + c * left)
        grid = OccupancyGrid()
        grid.header.frame_id = "map"
        grid.info.resolution, grid.info.width, grid.info.height = RESOLUTION, size, size
        grid.info.origin.position.x = self.x - c * half + s * half
        grid.info.origin.position.y = self.y - s * half - c * half
        grid.info.origin.orientation = quaternion(self.yaw)
        grid.data = np.where(cells, 100, 0).astype(np.int8).ravel().tolist()
        return grid

    def report(self) -> None:
        self.rate.publish(Float32(data=1.0))
        for name, publishers in self.statuses.items():
            status = ComponentStatus()
            if name == self.failing:
                status.status, status.msg = 3, "No scan for 2 s."
                status.src_topics = ["/scan"]
            for publisher in publishers:
                publisher.publish(status)
        self.say_drive()

    def say_drive(self) -> None:
        if self.drive is None:
            return
        state = DriveState(
            stopped=self.stopped.is_set(), standstill=self.v == 0.0, speed_factor=1.0
        )
        state.stopped_by, state.reason = self.stopped_by, self.reason
        state.limited_by = "stop" if self.stopped.is_set() else ""
        state.driven_by, state.hand_session = self.driven_by, self.hand_session
        self.drive.publish(state)

    def stop(self, request: StopRobot.Request, response: StopRobot.Response) -> object:
        self.stopped_by, self.reason = request.operator_name, request.reason
        self.stopped.set()
        self.v = 0.0
        self.say_drive()
        response.success, response.message = True, "stopped"
        return response

    def release(self, request: ReleaseStop.Request, response: ReleaseStop.Response) -> object:
        try:
            self.gatekeeper.admit("drive_manager/release_stop", request)
        except NotAdmitted as error:
            response.message = str(error)
            return response
        self.ending.wait(self.slow_release)
        self.stopped.clear()
        self.stopped_by, self.reason = "", ""
        self.say_drive()
        response.success, response.message = True, "released"
        return response

    def take_wheel(self, request: TakeWheel.Request, response: TakeWheel.Response) -> object:
        try:
            self.gatekeeper.admit("drive_manager/take_wheel", request)
        except NotAdmitted as error:
            response.message = str(error)
            return response
        mine = request.session == self.hand_session
        if request.what == TakeWheel.Request.GIVE:
            if mine:
                # As a drive manager does: the last command, zero, may come after this.
                self.driven_by = self.hand_session = ""
                self.v = 0.0
        elif self.driven_by and not mine and request.what != TakeWheel.Request.TAKE_OVER:
            response.message = f"{self.driven_by} drives by hand"
            return response
        else:
            self.driven_by, self.hand_session = request.operator_name, request.session
            response.seed = "seed"
            self.hand_key = self.gatekeeper.session_key(request.session, response.seed)
            response.max_vx, response.max_omega = 0.4, 2.0
        self.say_drive()
        response.success = True
        return response

    def by_hand(self, command: HandCommand) -> None:
        """Obeys for ever, as no drive manager may: so what others do about it can be seen."""
        if command.session == self.hand_session and self.hand_key is not None:
            assert self.hand_key.has_signed(command)
            self.v = command.vx
            self.yaw += command.omega  # a step for each: who looks later still sees it

    def path_to(self, x: float, y: float) -> Path:
        path = Path()
        path.header.frame_id = "map"
        for f in np.linspace(0.0, 1.0, 40):
            pose = PoseStamped()
            bow = 0.35 * math.sin(math.pi * f)
            pose.pose.position.x = self.x + f * (x - self.x)
            pose.pose.position.y = self.y + f * (y - self.y) + bow
            path.poses.append(pose)
        return path

    def check_goal(self, request: CheckGoal.Request, response: CheckGoal.Response) -> object:
        self.ending.wait(self.slow_checks)
        x, y = request.goal.position.x, request.goal.position.y
        inside = ROOM[0] < x < ROOM[2] and ROOM[1] < y < ROOM[3]
        if not inside:
            response.reason, response.message = 2, "This point is outside the map."
            response.has_nearest = True
            response.nearest.x = min(max(x, ROOM[0] + 0.2), ROOM[2] - 0.2)
            response.nearest.y = min(max(y, ROOM[1] + 0.2), ROOM[3] - 0.2)
        elif bool(occupied(np.array([x]), np.array([y]))[0]):
            response.reason, response.message = 3, "This point is inside an obstacle."
        else:
            response.reachable = True
            response.preview = self.path_to(x, y)
            response.length = math.hypot(x - self.x, y - self.y)
            response.duration = response.length / SPEED
        return response

    def take_point(self, message: PointStamped) -> None:
        pose = PoseStamped().pose
        pose.position.x, pose.position.y = message.point.x, message.point.y
        self.take(pose)

    def take(self, pose: object) -> None:
        if self.own is not None:
            self.own.send_goal_async(PlanPath.Goal(goal=pose))

    def execute(self, handle: ServerGoalHandle) -> PlanPath.Result:
        goal = handle.request.goal.position
        result = PlanPath.Result()
        if self.stopped.is_set():
            handle.abort()
            result.outcome, result.message = 3, "The robot is stopped; release STOP first."
            return result
        self.plan.publish(self.path_to(goal.x, goal.y))
        while not self.ending.is_set():
            left = math.hypot(goal.x - self.x, goal.y - self.y)
            if handle.is_cancel_requested:
                handle.canceled()
                result.outcome, result.message = 5, "Canceled by the operator."
                break
            if self.stopped.is_set():
                handle.abort()
                result.outcome, result.message = 3, f"Stopped by {self.stopped_by}."
                break
            if left < 0.02:
                result.reached_end, result.message = True, "Arrived."
                handle.succeed()
                break
            self.yaw = math.atan2(goal.y - self.y, goal.x - self.x)
            step = min(left, SPEED * 0.05)
            self.v = SPEED
            self.x += step * math.cos(self.yaw)
            self.y += step * math.sin(self.yaw)
            feedback = PlanPath.Feedback(distance_left=left)
            handle.publish_feedback(feedback)
            time.sleep(0.05)
        else:
            handle.abort()
        self.v = 0.0
        self.plan.publish(Path())
        return result


def main() -> None:
    """Run until SIGTERM."""
    parser = argparse.ArgumentParser()
    for name in ("poses", "points", "planner", "drive", "action", "statuses", "localiser"):
        parser.add_argument(f"--no-{name}", dest=name, action="store_false")
    parser.add_argument("--slow-checks", type=float, default=0.0)
    parser.add_argument("--slow-release", type=float, default=0.0)
    parser.add_argument("--failing", default="")
    parser.add_argument("--onlookers", action="store_true")
    parser.add_argument("--large", action="store_true")
    rclpy.init()
    stack = FakeStack(**vars(parser.parse_args()))
    executor = MultiThreadedExecutor(16)  # more than checks that wait at once
    executor.add_node(stack.node)
    if stack.gate is not None:
        executor.add_node(stack.gate)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stack.ending.set())
    spinning = threading.Thread(target=executor.spin)
    spinning.start()
    stack.speak()
    # Whatever holds it up, it ends.
    threading.Timer(4.0, os._exit, (0,)).start()
    # Leave in this order, or the graph shows the node for another 20 s.
    executor.shutdown(2.0)
    spinning.join(2.0)
    stack.node.destroy_node()
    # Requests that still wait for a thread of the executor would be answered first, and for ever.
    os._exit(0)


if __name__ == "__main__":
    main()
