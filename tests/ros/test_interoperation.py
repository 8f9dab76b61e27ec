"""Other ROS 2 programs see and drive the robot, knowing nothing of this project."""

import os
import subprocess
import sys
import textwrap

import pytest

from tests.support.patience import patient
from tests.support.robot import Robot
from tests.support.stack import Stack

pytestmark = pytest.mark.ros

# Only rclpy and the common messages; the middleware as ROS 2 configures it by itself.
STRANGER = """
    import math, sys, time
    import rclpy
    from geometry_msgs.msg import PointStamped
    from nav_msgs.msg import OccupancyGrid, Odometry
    from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
    from sensor_msgs.msg import LaserScan

    assert not any(name.startswith("kompass") for name in sys.modules)
    x, y, patience = (float(word) for word in sys.argv[1:])
    rclpy.init()
    node = rclpy.create_node("stranger")
    seen = {}
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(OccupancyGrid, "/map", lambda m: seen.update(map=m), latched)
    node.create_subscription(LaserScan, "/scan", lambda m: seen.update(scan=m),
                             qos_profile_sensor_data)
    node.create_subscription(Odometry, "/odometry/filtered", lambda m: seen.update(odom=m), 10)
    clicks = node.create_publisher(PointStamped, "/clicked_point", 10)

    def wait(condition, what):
        end = time.monotonic() + patience
        while not condition():
            if time.monotonic() > end:
                raise SystemExit(f"not seen: {what}")
            rclpy.spin_once(node, timeout_sec=0.1)

    wait(lambda: {"map", "scan", "odom"} <= set(seen), "map, scan and odometry")
    wanted = {"/plan", "/cmd_vel", "/tf", "/planner/status", "/drive_manager_status"}
    wait(lambda: wanted <= set(dict(node.get_topic_names_and_types())), "the topics")

    # The planner is not the only one that hears clicks: one that went out before all were
    # connected may have reached the others.
    def connected():
        listeners = node.get_subscriptions_info_by_topic("/clicked_point")
        names = {listener.node_name for listener in listeners}
        return "planner" in names and clicks.get_subscription_count() >= len(listeners)

    wait(connected, "the planner, listening for clicks")
    message = PointStamped()
    message.header.frame_id = "map"
    message.point.x, message.point.y = x, y
    clicks.publish(message)

    def distance():
        at = seen["odom"].pose.pose.position
        return math.hypot(at.x - x, at.y - y)

    wait(lambda: distance() < 0.1, "arrival")
    print(f"arrived {distance():.3f}")
"""


def test_a_program_with_only_the_ros_wheels_sees_the_topics_and_sends_the_robot(
    stack: Stack, robot: Robot
) -> None:
    ours = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_BUILTIN_TRANSPORTS", "AMENT_PREFIX_PATH")
    environment = {key: value for key, value in os.environ.items() if key not in ours}
    stranger = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(STRANGER), "-1.5", "0.5", str(patient(20))],
        env={
            **environment,
            "ROS_DOMAIN_ID": str(stack.domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        },
        capture_output=True,
        text=True,
        timeout=patient(60),
        check=False,
    )
    assert stranger.returncode == 0, stranger.stderr
    assert stranger.stdout.startswith("arrived")
    assert robot.distance_to(-1.5, 0.5) < 0.12
