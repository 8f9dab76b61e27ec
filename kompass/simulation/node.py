"""The embedded robot as a ROS 2 node, in real time."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from types import FrameType

from kompass.simulation.faults.fault_names import parse_faults
from kompass.simulation.physics.robot_model import TURTLEBOT3, RobotModel
from kompass.simulation.worlds.world import World


def run_simulator(
    place: World,
    *,
    seed: int = 0,
    node_name: str = "simulator",
    stop: Callable[[], bool] | None = None,
    faults: Sequence[str] = (),
    kind: RobotModel = TURTLEBOT3,
) -> None:
    """Run the robot until SIGTERM, SIGINT, or until ``stop`` returns true.

    Meant to be the whole life of a forked child: it loads MuJoCo and initialises ROS 2 in a
    context of its own. It returns within 0.1 s of being told to stop. Signals are watched only
    when it runs in the main thread, and SIGINT only where the caller has not ignored it.

    Parameters
    ----------
    place
        Where the robot is.
    seed
        Of the sensors' noise and of the base's calibration.
    node_name
        Of the ROS 2 node.
    stop
        Asked after every event, at least ten times a second, whether to end.
    faults
        To begin by themselves, each as ``NAME`` or ``NAME:SECONDS[:DURATION]`` after the start; see
        ``kompass.simulation.faults.fault_names``. More come from ``/simulator/set_fault``.
    kind
        Which of the embedded robots it is.

    Raises
    ------
    ValueError
        There is no such fault in this world, or for this robot.
    """
    orders = parse_faults(faults, place, kind)
    # Imported here, so that the process that forks this one stays small and without threads.
    import rclpy
    from rclpy.signals import SignalHandlerOptions

    from kompass.rclpy_ext.executor import TaskExecutor
    from kompass.rclpy_ext.node import PlainNode
    from kompass.simulation.faults.process_faults import ProcessFaults
    from kompass.simulation.simulator import Simulator

    context = rclpy.Context()
    rclpy.init(args=[], context=context, signal_handler_options=SignalHandlerOptions.NO)
    node = PlainNode(node_name, context=context)
    executor = TaskExecutor(context)
    try:
        with _signals() as told_to_stop, ExitStack() as undo:
            simulator = Simulator(node, place, seed, orders, ProcessFaults(node), kind)
            undo.callback(simulator.close)
            executor.add_node(node)
            while not (told_to_stop() or (stop is not None and stop())):
                executor.spin_on(node, 0.1)
    finally:
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()


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
