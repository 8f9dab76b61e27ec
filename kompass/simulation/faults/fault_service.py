"""Faults over ROS: a service to switch them, a topic that tells which are on."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence

from kompass_interfaces.srv import SetFault
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from kompass.simulation.faults.fault_manager import BodyFaults, FaultManager, FaultRefused
from kompass.simulation.faults.fault_names import MAP_WITHHELD, FaultOrder, UnknownFault, help_text
from kompass.simulation.faults.map_faults import MapFaults
from kompass.simulation.faults.process_faults import ProcessFaults
from kompass.simulation.faults.robot_faults import RobotFaults
from kompass.simulation.robot import Robot

SERVICE = "/simulator/set_fault"
TOPIC = "/simulator/faults"
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class FaultService:
    """`/simulator/set_fault`, and the faults that are on as a JSON list on `/simulator/faults`.

    Args:
        node: Of the simulator.
        robot: Whose faults they are.
        orders: Faults to begin by themselves.
    """

    def __init__(self, node: Node, robot: Robot, orders: Sequence[FaultOrder]) -> None:
        self._node = node
        self._published: tuple[str, ...] | None = None
        self._publisher = node.create_publisher(String, TOPIC, _LATCHED)
        withheld = any(order.name == MAP_WITHHELD for order in orders)
        kinds = (
            BodyFaults(RobotFaults(robot)),
            ProcessFaults(node),
            MapFaults(node, robot, withheld=withheld),
        )
        self._desk = FaultManager(kinds, orders, time.monotonic(), self._publish)
        self._publish(())
        node.create_service(SetFault, SERVICE, self._on_request)

    def advance(self, now: float) -> None:
        """Begin and end what is due at `now` (monotonic seconds)."""
        try:
            self._desk.advance(now)
        except FaultRefused as refusal:
            self._node.get_logger().error(str(refusal), throttle_duration_sec=5.0)

    def close(self) -> None:
        """End all faults."""
        self._desk.close()

    def _on_request(
        self, request: SetFault.Request, response: SetFault.Response
    ) -> SetFault.Response:
        try:
            if request.fault:
                self._desk.switch(request.fault, request.on, request.duration, time.monotonic())
                response.message = f"{request.fault} is {'on' if request.on else 'off'}"
            else:
                response.message = help_text()
            response.success = True
        except (UnknownFault, FaultRefused) as refusal:
            response.message = str(refusal)
        response.active = list(self._desk.active)
        return response

    def _publish(self, active: tuple[str, ...]) -> None:
        if active == self._published:
            return
        if self._published is not None:
            self._node.get_logger().warning(f"faults: {', '.join(active) or 'none'}")
        self._published = active
        self._publisher.publish(String(data=json.dumps(active)))
