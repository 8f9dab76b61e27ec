"""A node that logs as fast as it can, for as long as it lives; run with its name."""

import sys

import rclpy
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile


def main() -> None:
    rclpy.init(args=[])
    node = rclpy.create_node(sys.argv[1])
    profile = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = node.create_publisher(Log, "/rosout", profile)
    line = Log(level=20, name=sys.argv[1], msg="over and over " * 8)
    bad = Log(level=40, name=sys.argv[1], msg="something is wrong")
    number = 0
    while True:
        number += 1
        publisher.publish(line if number % 5000 else bad)


if __name__ == "__main__":
    main()
