"""Makes a drive with real processes, over DDS, in real time.

``python -m kompass.bench.real PARENT MAP`` reads a :class:`BenchOrder` as JSON and runs the stack
with the embedded robot beside it, until SIGINT, or until the process PARENT ends.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from kompass.bench.drive import BenchDrive
from kompass.bench.runner import BenchOrder, map_file, measured, scenario_of
from kompass.bench.stack import COMPONENTS, bring_up
from kompass.drills.runner.lifeline import end_with
from kompass.drills.runner.pool import ENVIRONMENT
from kompass.drills.runner.run import AFTERWARDS, SETTLED, NotUp, Observed
from kompass.drills.runner.worker import DriveFailed, stack_by
from kompass.simulation.physics.robot_model import robot_model
from kompass.simulation.worlds.registry import add_world
from kompass.supervisor.process import ProcessSpec, Report

if TYPE_CHECKING:
    from kompass.rclpy_ext.executor import TaskExecutor
    from kompass.rclpy_ext.node import PlainNode

BRINGUP = 60.0  # s in which the stack must be up
ENDING = 15.0  # s that it may take to end
LONGEST_LOG = 2000  # characters of it that are told


def make_real_drives(
    orders: Sequence[BenchOrder],
) -> Generator[tuple[int, BenchDrive], None, None]:
    """Make drives, one after the other.

    Yields
    ------
    index : int
        Of the order.
    drive : BenchDrive

    Raises
    ------
    DriveFailed
        When one cannot be made.
    """
    for index, order in enumerate(orders):
        with tempfile.TemporaryDirectory(prefix="kompass-bench-") as folder:
            yield index, _drive(order, Path(folder))


def _drive(order: BenchOrder, folder: Path) -> BenchDrive:
    add_world(order.world.place(order.start, order.goal))
    given = map_file(order, folder)
    with (folder / "log").open("w+", encoding="utf-8") as log:
        environment = ENVIRONMENT | {"KOMPASS_DATA_DIR": str(folder)}
        stack = subprocess.Popen(
            [sys.executable, "-m", "kompass.bench.real", str(os.getpid()), str(given or "")],
            stdin=subprocess.PIPE,
            stdout=log,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, **environment},
            start_new_session=True,
        )
        try:
            assert stack.stdin is not None
            stack.stdin.write(order.model_dump_json())
            stack.stdin.close()
            return measured(order, _observe(order, stack))
        except NotUp as error:
            log.seek(0)
            told = log.read()[-LONGEST_LOG:]
            raise DriveFailed(f"drive through {order.world.name}: {error}\n{told}") from error
        finally:
            _end(stack)


def _end(stack: subprocess.Popen[str]) -> None:
    if stack.poll() is None:
        stack.send_signal(signal.SIGINT)
    try:
        stack.wait(ENDING)
    except subprocess.TimeoutExpired:
        os.killpg(stack.pid, signal.SIGKILL)
        stack.wait()


def _observe(order: BenchOrder, stack: subprocess.Popen[str]) -> Observed:
    """Watch the stack, and send it the goal, as the people of a drill do."""
    from kompass_interfaces.msg import StackState

    from kompass.drills.facts import DriveEnded
    from kompass.drills.judge import judge
    from kompass.drills.runner.observer import Observer
    from kompass.drills.runner.operator import Operator
    from kompass.rclpy_ext.qos import LATCHED_PROFILE

    robot = robot_model(order.robot)
    described = stack_by(lambda: bring_up(robot, order.follower), "the benchmark's stack")
    scenario = scenario_of(order)
    with _node() as (node, executor):
        observer = Observer(node, COMPONENTS)
        operator = Operator(node, scenario, described.components, observer)
        states: list[set[str]] = [set()]

        def note(message: StackState) -> None:
            states[0] = {process.state for process in message.processes}

        node.create_subscription(StackState, "monitor/stack_state", note, LATCHED_PROFILE)
        late = time.monotonic() + BRINGUP
        while states[0] != {"active"}:
            if stack.poll() is not None or time.monotonic() > late:
                raise NotUp("the stack did not come up")
            executor.spin_once(timeout_sec=0.1)
        _spin(executor, SETTLED)
        observer.begin()
        while not operator.is_done and observer.now < scenario.limit:
            if stack.poll() is not None:
                raise NotUp("the stack ended in the middle of the drive")
            executor.spin_once(timeout_sec=0.1)
        _spin(executor, AFTERWARDS)
        observer.note(DriveEnded)
    facts = tuple(observer.facts)
    return Observed(facts, judge(scenario, facts), ())


@contextmanager
def _node() -> Iterator[tuple[PlainNode, TaskExecutor]]:
    import rclpy
    from rclpy.signals import SignalHandlerOptions

    from kompass.rclpy_ext.executor import TaskExecutor
    from kompass.rclpy_ext.node import PlainNode

    context = rclpy.Context()
    rclpy.init(args=[], context=context, signal_handler_options=SignalHandlerOptions.NO)
    node = PlainNode("bench", context=context)
    executor = TaskExecutor(context)
    executor.add_node(node)
    try:
        yield node, executor
    finally:
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()


def _spin(executor: TaskExecutor, seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=min(0.1, max(0.0, end - time.monotonic())))


def main(parent: int, given: str) -> None:
    """The stack's own process."""
    from kompass.launch.companions import add_companion

    end_with(parent)
    order = BenchOrder.model_validate_json(sys.stdin.read())
    place = order.world.place(order.start, order.goal)
    robot = robot_model(order.robot)

    def simulate(report: Report) -> None:
        from kompass.simulation.node import run_simulator

        report("active simulator")
        run_simulator(place, seed=order.seed, kind=robot)

    def serve_map(report: Report) -> None:
        from kompass.components import MapServer, MapServerConfig
        from kompass.launch.host import host

        server = MapServer("map_server", config=MapServerConfig(map_file_path=given or None))
        host([server], ["map_server"], report, first_start=False)

    add_companion(ProcessSpec("simulator", simulate, names=["simulator"]))
    add_companion(ProcessSpec("map_server", serve_map, names=["map_server"]))
    bring_up(robot, order.follower)


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2])
