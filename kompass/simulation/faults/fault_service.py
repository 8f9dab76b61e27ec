"""Faults over ROS: a service to switch them, a topic that tells which are on."""

from __future__ import annotations

import json
from collections.abc import Sequence

from kompass_interfaces.srv import SetFault
from std_msgs.msg import String

from kompass.bus.node import Node
from kompass.rclpy_ext.qos import LATCHED_PROFILE
from kompass.simulation.faults.fault_manager import FaultKind, FaultManager, FaultRefused
from kompass.simulation.faults.fault_names import (
    FaultOrder,
    UnknownFault,
    help_text,
    withholds_map,
)
from kompass.simulation.faults.map_faults import MapFaults
from kompass.simulation.faults.robot_faults import RobotFaults
from kompass.simulation.robot import SimulatedRobot

SERVICE = "/simulator/set_fault"
TOPIC = "/simulator/faults"


class FaultService:
    """Offers ``/simulator/set_fault``, and tells on ``/simulator/faults`` which are on (JSON list).

    Parameters
    ----------
    node
        Of the simulator.
    robot
        Whose faults they are.
    orders
        Faults to begin by themselves.
    processes
        The faults of the stack's processes.
    """

    def __init__(
        self,
        node: Node,
        robot: SimulatedRobot,
        orders: Sequence[FaultOrder],
        processes: FaultKind,
    ) -> None:
        self._node = node
        self._published: tuple[str, ...] | None = None
        self._publisher = node.create_publisher(String, TOPIC, LATCHED_PROFILE)
        kinds = (
            RobotFaults(robot),
            processes,
            MapFaults(node, robot, withheld=withholds_map(orders)),
        )
        self._manager = FaultManager(kinds, orders, node.clock.monotonic(), self._publish)
        self._publish(())
        node.create_service(SetFault, SERVICE, self._on_request)

    def advance(self, now: float) -> None:
        """Begin and end what is due at ``now`` (monotonic seconds)."""
        try:
            self._manager.advance(now)
        except FaultRefused as refusal:
            self._node.get_logger().error(str(refusal), throttle_duration_sec=5.0)

    def close(self) -> None:
        """End all faults."""
        self._manager.close()

    def _on_request(
        self, request: SetFault.Request, response: SetFault.Response
    ) -> SetFault.Response:
        try:
            if request.fault:
                now = self._node.clock.monotonic()
                self._manager.switch(request.fault, request.on, request.duration, now)
                response.message = f"{request.fault} is {'on' if request.on else 'off'}"
            else:
                response.message = help_text()
            response.success = True
        except (UnknownFault, FaultRefused) as refusal:
            response.message = str(refusal)
        response.active = list(self._manager.active)
        return response

    def _publish(self, active: tuple[str, ...]) -> None:
        if active == self._published:
            return
        if self._published is not None:
            self._node.get_logger().warning(f"faults: {', '.join(active) or 'none'}")
        self._published = active
        self._publisher.publish(String(data=json.dumps(active)))
