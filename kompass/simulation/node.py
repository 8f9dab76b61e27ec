"""The embedded robot as a ROS 2 node, in real time."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from types import FrameType
from typing import TYPE_CHECKING

from kompass.simulation.faults.fault_names import parse_faults
from kompass.simulation.pacer import Pacer
from kompass.simulation.worlds.registry import world

if TYPE_CHECKING:
    from kompass.bus.node import Node
    from kompass.simulation.broadcast import Broadcast
    from kompass.simulation.command_input import CommandInput
    from kompass.simulation.faults.fault_service import FaultService
    from kompass.simulation.robot import SimulatedRobot

PERIOD = 0.02  # of odometry and transforms, s
SCAN_PERIODS = 5  # a scan every 0.1 s
GRAPH_PERIODS = 10  # look for publishers of commands every 0.2 s
REPORT_PERIODS = 50  # rate and contacts every second
SLOW = 0.95  # below this rate the node complains


def run_simulator(
    world_name: str,
    *,
    seed: int = 0,
    node_name: str = "simulator",
    stop: Callable[[], bool] | None = None,
    faults: Sequence[str] = (),
) -> None:
    """Run the robot until SIGTERM, SIGINT, or until ``stop`` returns true.

    Meant to be the whole life of a forked child: it loads MuJoCo and initialises ROS 2 in a
    context of its own. It returns within 0.1 s of being told to stop. Signals are watched only
    when it runs in the main thread, and SIGINT only where the caller has not ignored it.

    Parameters
    ----------
    world_name
        One of ``kompass.simulation.worlds.registry.world_names()``.
    seed
        Of the sensors' noise and of the base's calibration.
    node_name
        Of the ROS 2 node.
    stop
        Asked after every event, at least ten times a second, whether to end.
    faults
        To begin by themselves, each as ``NAME`` or ``NAME:SECONDS[:DURATION]`` after the start; see
        ``kompass.simulation.faults.fault_names``. More come from ``/simulator/set_fault``.

    Raises
    ------
    ValueError
        There is no such world, or no such fault in it.
    """
    place = world(world_name)
    orders = parse_faults(faults, place)
    # Imported here, so that the process that forks this one stays small and without threads.
    import rclpy
    from rclpy.signals import SignalHandlerOptions

    from kompass.rclpy_ext.executor import TaskExecutor
    from kompass.rclpy_ext.node import PlainNode
    from kompass.simulation.broadcast import Broadcast
    from kompass.simulation.command_input import CommandInput
    from kompass.simulation.costmap import Costmap
    from kompass.simulation.faults.fault_service import FaultService
    from kompass.simulation.robot import SimulatedRobot

    robot = SimulatedRobot(place, seed)
    context = rclpy.Context()
    rclpy.init(args=[], context=context, signal_handler_options=SignalHandlerOptions.NO)
    node = PlainNode(node_name, context=context)
    executor = TaskExecutor(context)
    try:
        with _signals() as told_to_stop, ExitStack() as undo:
            broadcast = Broadcast(node, robot)
            commands = CommandInput(node, robot.command)
            broken = FaultService(node, robot, orders)
            undo.callback(broken.close)
            Costmap(node)
            loop = _Loop(node, robot, broadcast, commands, broken)
            node.create_timer(PERIOD, loop.tick)
            executor.add_node(node)
            node.get_logger().info(f"robot in {place.name!r}: {place.title}")
            while not (told_to_stop() or (stop is not None and stop())):
                executor.spin_once(timeout_sec=0.1)
    finally:
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()


class _Loop:
    """What the node does once per period, in order."""

    def __init__(
        self,
        node: Node,
        robot: SimulatedRobot,
        broadcast: Broadcast,
        commands: CommandInput,
        faults: FaultService,
    ) -> None:
        self._node = node
        self._robot = robot
        self._broadcast = broadcast
        self._commands = commands
        self._faults = faults
        self._pacer = Pacer(PERIOD, node.clock.monotonic())
        self._ticks = 0

    def tick(self) -> None:
        """Simulate up to now and publish the result once."""
        now = self._node.clock.monotonic()
        self._faults.advance(now)
        self._robot.step(self._pacer.due(now) * PERIOD)
        self._broadcast.motion()
        self._ticks += 1
        if self._ticks % SCAN_PERIODS == 0:
            self._broadcast.scan(SCAN_PERIODS * PERIOD)
        if self._ticks % GRAPH_PERIODS == 0:
            self._commands.follow_publishers(now)
        if self._ticks % REPORT_PERIODS == 0:
            self._report(now)

    def _report(self, now: float) -> None:
        rate, lost = self._pacer.report(now)
        self._broadcast.rate(rate)
        self._broadcast.contacts()
        if rate < SLOW:
            self._node.get_logger().warning(
                f"the simulation runs at {rate:.2f} of real time ({lost:.2f} s lost): "
                "the machine is too busy for it"
            )


@contextmanager
def _signals() -> Iterator[Callable[[], bool]]:
    """Collect SIGTERM and SIGINT while it lasts; yields whether one has come."""
    told = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield told.is_set
        return

    def note(_number: int, _frame: FrameType | None) -> None:
        told.set()

    watched = [signal.SIGTERM]
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        watched.append(signal.SIGINT)
    before = {number: signal.signal(number, note) for number in watched}
    try:
        yield told.is_set
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
