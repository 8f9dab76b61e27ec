"""What is large and sent best effort, as point clouds are, comes to another process whole."""

import subprocess
import sys
from pathlib import Path

import pytest
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import PointCloud2

from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros

POINTS, COUNT = 40_000, 20
SIZE = 16 * POINTS  # bytes
LARGEST = int(Path("/proc/sys/net/core/rmem_max").read_text())  # that a socket may keep

SENDER = f"""
import sys
import time
import kompass
import rclpy
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import PointCloud2

rclpy.init(domain_id=int(sys.argv[1]))
node = rclpy.create_node("camera")
sender = node.create_publisher(PointCloud2, "/cloud", qos_profile_sensor_data)
input()
while not sender.get_subscription_count():
    time.sleep(0.01)
message = PointCloud2(data=bytes({SIZE}))
for number in range({COUNT}):
    message.width = number
    sender.publish(message)
    time.sleep(0.1)
input()
"""


@pytest.mark.skipif(LARGEST < 2 * SIZE, reason="the kernel gives sockets no room (rmem_max)")
def test_no_cloud_is_lost_between_two_processes(spinning: Spinning) -> None:
    heard: list[int] = []
    listening = spinning.node.create_subscription(
        PointCloud2, "/cloud", lambda cloud: heard.append(cloud.width), qos_profile_sensor_data
    )
    domain = spinning.node.context.get_domain_id()
    sender = subprocess.Popen(
        [sys.executable, "-c", SENDER, str(domain)], stdin=subprocess.PIPE, text=True
    )
    assert sender.stdin is not None
    try:
        # Both sides must know each other: what is sent best effort before is lost by right.
        spinning.until(lambda: listening.get_publisher_count() > 0, 20)
        print(file=sender.stdin, flush=True)
        spinning.until(lambda: COUNT - 1 in heard, 20)
    finally:
        sender.kill()
        sender.communicate()
    assert heard == list(range(COUNT))
