"""Tells the robot's localiser where the robot is."""

from __future__ import annotations

import math

import numpy as np
from geometry_msgs.msg import PoseWithCovarianceStamped
from rclpy.node import Node
from rclpy.qos import QoSProfile

from kompass.rclpy_ext.node import of_others
from kompass_console.link.goals.goals import pose_message

TOPIC = "/initialpose"

_FRAME = "map"
# How sure a person's hand is, as RViz says it: half a metre, and a twelfth of a half turn.
_COVARIANCE = np.zeros(36)
_COVARIANCE[[0, 7, 35]] = 0.25, 0.25, (math.pi / 12.0) ** 2


class InitialPose:
    """The topic on which localisers are told."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._publisher = node.create_publisher(
            PoseWithCovarianceStamped, TOPIC, QoSProfile(depth=1)
        )

    @property
    def listened(self) -> bool:
        """Whether anybody takes it; cheap, any thread."""
        return bool(of_others(self._node, self._node.get_subscriptions_info_by_topic(TOPIC)))

    def send(self, x: float, y: float, yaw: float) -> None:
        """Say where the robot is (m, rad, map frame). Any thread."""
        message = PoseWithCovarianceStamped()
        message.header.frame_id = _FRAME
        message.header.stamp = self._node.get_clock().now().to_msg()
        message.pose.pose = pose_message(x, y, yaw)
        message.pose.covariance = _COVARIANCE
        self._publisher.publish(message)
