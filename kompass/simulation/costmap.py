"""A stand-in for somebody else's costmap node: it can be cleared, and counts how often it was."""

from __future__ import annotations

from nav2_msgs.srv import ClearEntireCostmap
from std_msgs.msg import UInt32

from kompass.bus.node import Node
from kompass.rclpy_ext.qos import LATCHED_PROFILE

# As Nav2's costmap node calls it.
SERVICE = "/global_costmap/clear_entirely_global_costmap"
TOPIC = "/global_costmap/times_cleared"


class Costmap:
    """What a rule that calls a service of another node can be tried on."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._cleared = 0
        self._publisher = node.create_publisher(UInt32, TOPIC, LATCHED_PROFILE)
        self._publisher.publish(UInt32(data=0))
        node.create_service(ClearEntireCostmap, SERVICE, self._on_clear)

    def _on_clear(
        self, _request: ClearEntireCostmap.Request, response: ClearEntireCostmap.Response
    ) -> ClearEntireCostmap.Response:
        self._cleared += 1
        self._node.get_logger().info(f"costmap cleared ({self._cleared})")
        self._publisher.publish(UInt32(data=self._cleared))
        return response
