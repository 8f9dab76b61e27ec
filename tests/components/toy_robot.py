"""A robot of a few lines: it follows commands at once, among posts that its scan sees."""

import math
from collections.abc import Callable

import numpy as np
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

from tests.components.alive import Alive

PERIOD = 0.02  # s
RAYS = 360
Post = tuple[float, float, float]  # x, y, radius [m]


class ToyRobot:
    """Listens on /cmd_vel; publishes /odom (in frame map) and /scan, mounted at the centre."""

    def __init__(self, alive: Alive, posts: list[Post] | None = None) -> None:
        self.posts = posts or []
        self.x = self.y = self.yaw = 0.0
        self.turned = 0.0
        self.wheels_blocked = False
        self.scans = True
        self.odometry = True
        self.worsen: Callable[[Odometry], object] = lambda _odometry: None  # before it is sent
        self.commands: list[tuple[float, float]] = []
        self._twist = Twist()
        self._ticks = 0
        self._clock = alive.clock
        self._last = self._clock.monotonic()
        self._node = node = alive.node
        node.create_subscription(Twist, "/cmd_vel", self._on_command, 10)
        self._odometry = node.create_publisher(Odometry, "/odom", 10)
        self._scan = node.create_publisher(LaserScan, "/scan", qos_profile_sensor_data)
        node.create_timer(PERIOD, self._tick)
        alive.wait_until(self._found, 10, "a listener to the scan or the odometry")

    def is_halted(self) -> bool:
        """Whether the newest command is zero; it may come after the answer of who sent it."""
        return bool(self.commands) and self.commands[-1] == (0.0, 0.0)

    def _found(self) -> bool:
        return bool(self._odometry.get_subscription_count())

    def _on_command(self, twist: Twist) -> None:
        self._twist = twist
        self.commands.append((twist.linear.x, twist.angular.z))

    def _tick(self) -> None:
        v, omega = self._twist.linear.x, self._twist.angular.z
        if self.wheels_blocked:
            v = omega = 0.0
        # By the clock: on a busy machine the timer is late, and the robot must not be slow.
        now = self._clock.monotonic()
        passed, self._last = min(now - self._last, 0.2), now
        self.x += v * math.cos(self.yaw) * passed
        self.y += v * math.sin(self.yaw) * passed
        self.yaw += omega * passed
        self.turned += omega * passed
        if self.odometry:
            message = Odometry()
            message.header.frame_id = "map"
            message.header.stamp = self._node.get_clock().now().to_msg()
            message.pose.pose.position.x, message.pose.pose.position.y = self.x, self.y
            message.pose.pose.orientation.z = math.sin(self.yaw / 2)
            message.pose.pose.orientation.w = math.cos(self.yaw / 2)
            message.twist.twist.linear.x, message.twist.twist.angular.z = v, omega
            self.worsen(message)
            self._odometry.publish(message)
        self._ticks += 1
        if self.scans and self._ticks % 5 == 0:
            self._scan.publish(self.make_scan())

    def make_scan(self) -> LaserScan:
        scan = LaserScan(range_min=0.05, range_max=3.5)
        scan.header.frame_id = "base_link"
        scan.header.stamp = self._node.get_clock().now().to_msg()
        scan.angle_min, scan.angle_increment = -math.pi, 2 * math.pi / RAYS
        angles = self.yaw - math.pi + 2 * math.pi / RAYS * np.arange(RAYS)
        ranges = np.full(RAYS, math.inf)
        for px, py, radius in self.posts:
            dx, dy = px - self.x, py - self.y
            along = dx * np.cos(angles) + dy * np.sin(angles)
            aside = dx * np.sin(angles) - dy * np.cos(angles)
            hits = (along > 0) & (np.abs(aside) < radius)
            reach = along[hits] - np.sqrt(radius**2 - aside[hits] ** 2)
            ranges[hits] = np.minimum(ranges[hits], reach)
        scan.ranges = [float(value) for value in ranges]
        return scan


def ring(distance: float, count: int = 24, gap: float = 0.0) -> list[Post]:
    """Posts all around the origin; those within ``gap`` [rad] of the back are left out."""
    angles = np.linspace(-math.pi, math.pi, count, endpoint=False).tolist()
    return [
        (distance * math.cos(angle), distance * math.sin(angle), 0.03)
        for angle in angles
        if abs(math.remainder(angle - math.pi, 2 * math.pi)) > gap or not gap
    ]
