"""Listens to who says where the robot is, as a localiser on a robot does."""

from __future__ import annotations

import math
from collections.abc import Callable

from geometry_msgs.msg import PoseWithCovarianceStamped
from rclpy.qos import QoSProfile

from kompass.algorithms.geometry import Pose2D, yaw_from_quaternion
from kompass.bus.node import Node
from kompass.simulation.physics.parts import NoReading

TOPIC = "/initialpose"
FRAME = "map"
FARTHEST = 1e5  # m from the map's origin; no map reaches farther


class PoseInput:
    """Takes ``/initialpose``, and says in the log why not when it cannot.

    Parameters
    ----------
    node
        Owns the subscription.
    relocate
        Called with the pose; its NoReading becomes a warning.
    """

    def __init__(self, node: Node, relocate: Callable[[Pose2D], None]) -> None:
        self._node = node
        self._relocate = relocate
        node.create_subscription(
            PoseWithCovarianceStamped, TOPIC, self._on_pose, QoSProfile(depth=1)
        )

    def _on_pose(self, message: PoseWithCovarianceStamped) -> None:
        log = self._node.get_logger()
        frame = message.header.frame_id.removeprefix("/")
        at, q = message.pose.pose.position, message.pose.pose.orientation
        numbers = (at.x, at.y, q.x, q.y, q.z, q.w)
        if frame != FRAME:
            log.warning(f"{TOPIC} ignored: its frame is {frame!r}; send it in {FRAME!r}")
        elif not all(map(math.isfinite, numbers)) or not any(numbers[2:]):
            log.warning(f"{TOPIC} ignored: its pose is none; give finite numbers and a rotation")
        elif max(abs(at.x), abs(at.y)) > FARTHEST:
            log.warning(
                f"{TOPIC} ignored: x = {at.x:g} m, y = {at.y:g} m is farther than {FARTHEST:g} m "
                "from the map's origin; give a place on the map"
            )
        else:
            yaw = yaw_from_quaternion(q.x, q.y, q.z, q.w)
            try:
                self._relocate((at.x, at.y, yaw))
            except NoReading as error:
                log.warning(f"{TOPIC} ignored: {error}")
                return
            log.info(f"told to be at x {at.x:.2f}, y {at.y:.2f} m, {math.degrees(yaw):.0f} deg")
