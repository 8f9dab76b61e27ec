"""What the embedded robot does once per period, and who hears of it."""

from __future__ import annotations

import math
from collections.abc import Sequence

from kompass.bus.node import Node
from kompass.simulation.broadcast import Broadcast
from kompass.simulation.command_input import CommandInput
from kompass.simulation.costmap import Costmap
from kompass.simulation.faults.fault_manager import FaultKind
from kompass.simulation.faults.fault_names import FaultOrder
from kompass.simulation.faults.fault_service import FaultService
from kompass.simulation.pacer import Pacer
from kompass.simulation.physics.robot_model import TURTLEBOT3, RobotModel
from kompass.simulation.pose_input import PoseInput
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.world import World

PERIOD = 0.02  # of odometry and transforms, s
SCAN_PERIODS = 5  # a scan every 0.1 s
CLOUD_TICK = 2  # of these periods: scan and cloud are not made in one
PICTURE_PERIODS, PICTURE_TICK = 10, 4  # a picture every 0.2 s, neither with scan nor cloud
GRAPH_PERIODS = 10  # look for publishers of commands every 0.2 s
REPORT_PERIODS = 50  # rate and contacts every second
SLOW = 0.95  # below this rate the node complains
SLOW_AGAIN = 60.0  # s until it does so again; the rate itself is published all the time


class Simulator:
    """The embedded robot on a node, in the time of that node's clock.

    Parameters
    ----------
    node
        Publishes and listens; its executor does the work.
    place
        Where the robot is.
    seed
        Of the sensors' noise and of the base's calibration.
    orders
        Faults to begin by themselves.
    processes
        The faults of the stack's processes.
    kind
        Which of the embedded robots it is.
    always
        Whether it sends also what nobody has subscribed to.

    Attributes
    ----------
    robot
        As it is in truth.
    """

    def __init__(
        self,
        node: Node,
        place: World,
        seed: int,
        orders: Sequence[FaultOrder],
        processes: FaultKind,
        kind: RobotModel = TURTLEBOT3,
        *,
        always: bool = False,
    ) -> None:
        self.robot = SimulatedRobot(place, seed, kind)
        self._node = node
        self._broadcast = Broadcast(node, self.robot, always=always)
        self._commands = CommandInput(node, self.robot.command)
        PoseInput(node, self.robot.relocate)
        self._faults = FaultService(node, self.robot, orders, processes)
        Costmap(node)
        self._pacer = Pacer(PERIOD, node.clock.monotonic())
        self._ticks = 0
        self._complained = -math.inf
        node.create_timer(PERIOD, self._tick)
        node.get_logger().info(f"robot in {place.name!r}: {place.title} ({kind.name})")

    def close(self) -> None:
        """End all faults, so that none outlasts the robot."""
        self._faults.close()

    def _tick(self) -> None:
        """Simulate up to now and publish the result once."""
        now = self._node.clock.monotonic()
        self._faults.advance(now)
        self.robot.step(self._pacer.due(now) * PERIOD)
        self._broadcast.motion()
        self._ticks += 1
        if self._ticks % SCAN_PERIODS == 0:
            self._broadcast.scan(SCAN_PERIODS * PERIOD)
        if self._ticks % SCAN_PERIODS == CLOUD_TICK:
            self._broadcast.cloud()
        if self._ticks % PICTURE_PERIODS == PICTURE_TICK:
            self._broadcast.picture()
        if self._ticks % GRAPH_PERIODS == 0:
            self._commands.follow_publishers(now)
        if self._ticks % REPORT_PERIODS == 0:
            self._report(now)

    def _report(self, now: float) -> None:
        rate, lost = self._pacer.report(now)
        self._broadcast.rate(rate)
        self._broadcast.contacts()
        x, y, _ = self.robot.truth().pose
        self.robot.battery.step((x, y), REPORT_PERIODS * PERIOD)
        self._broadcast.battery()
        if rate < SLOW and now - self._complained >= SLOW_AGAIN:
            self._complained = now
            self._node.get_logger().warning(
                f"the simulation runs at {rate:.2f} of real time ({lost:.2f} s lost): "
                "the machine is too busy for it"
            )
