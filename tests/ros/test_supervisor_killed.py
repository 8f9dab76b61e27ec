"""A robot whose supervisor dies comes to a standstill, and one that was stopped stays stopped."""

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from geometry_msgs.msg import Twist

from kompass.components.drive.halt import HALT_NODE
from tests.support.domains import give_back, next_domain
from tests.support.driver import Driver
from tests.support.patience import patient
from tests.support.processes import children, end_with_parent, wait_until
from tests.support.stack import Stack

pytestmark = pytest.mark.ros
GUARDED = Path(__file__).parents[1] / "recipes" / "guarded_robot.py"


@contextmanager
def driven_from_outside(**environment: str) -> Iterator[tuple[Stack, Driver]]:
    """A recipe on a robot that is no child of its supervisor, driven by commands of ours."""
    domain = next_domain(stack=True)
    base = subprocess.Popen(
        [sys.executable, "-m", "kompass.simulation", "hexagon"],
        env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
        preexec_fn=end_with_parent,
    )
    try:
        command = ("run", str(GUARDED), "--no-browser", "--port", "0")
        stack = Stack(*command, domain=domain, COMMAND_PUBLISHERS="2", **environment)
        robot = Driver(domain)
        try:
            stack.wait_for_line("all components active", 20)
            wait_until(lambda: "console is up" in stack.output, 20, "the console")
            wait_until(lambda: "guard is up" in stack.output, 20, "the guard")
            wait_until(lambda: f"{HALT_NODE} is up" in stack.output, 20, "who halts the robot")
            wait_until(lambda: "/simulator/ground_truth" in robot.newest, 20, "the robot's pose")
            commands = robot.node.create_publisher(Twist, "/control", 10)
            forward = Twist()
            forward.linear.x = 0.2
            robot.node.create_timer(0.05, lambda: commands.publish(forward))
            yield stack, robot
        finally:
            robot.close()
            stack.close()
    finally:
        base.terminate()
        base.wait(patient(10))
        give_back(domain)


def gone(pids: list[int]) -> Callable[[], bool]:
    return lambda: not [pid for pid in pids if Path(f"/proc/{pid}").exists()]


@pytest.mark.parametrize("stopped", ["drive_manager", "console", HALT_NODE, "guard"])
def test_nothing_outlives_a_killed_supervisor_and_the_robot_stands(stopped: str) -> None:
    with driven_from_outside() as (stack, robot):
        wait_until(lambda: robot.speed > 0.15, 20, "motion")
        port = urlsplit(stack.url).port
        pids = list(children(stack.process.pid))
        robot.newest.pop("/cmd_vel")
        os.kill(stack.pid_of(stopped), signal.SIGSTOP)
        os.kill(stack.process.pid, signal.SIGKILL)
        wait_until(robot.halts, 3, "a zero twist")
        wait_until(lambda: robot.speed < 0.01, 3, "a standstill")
        wait_until(gone(pids), 3, "the end of all children")
        with socket.create_server(("127.0.0.1", port)):
            pass  # free for the next console


def test_a_robot_that_was_stopped_comes_up_stopped_after_the_whole_stack_was_killed(
    tmp_path: Path,
) -> None:
    environment = {"KOMPASS_DATA_DIR": str(tmp_path)}
    with driven_from_outside(**environment) as (stack, robot):
        wait_until(lambda: robot.speed > 0.15, 20, "motion")
        robot.stop()
        (path,) = tmp_path.glob("*/stop-drive_manager.json")
        wait_until(lambda: '"stopped": true' in path.read_text(), 5, "the STOP on disk")
        for pid in [stack.process.pid, *children(stack.process.pid)]:
            os.kill(pid, signal.SIGKILL)
    with driven_from_outside(**environment) as (stack, robot):
        wait_until(lambda: "/drive_state" in robot.newest, 10, "the drive manager's word")
        state = robot.newest["/drive_state"]
        assert (state.stopped, state.stopped_by) == (True, "tester")
        assert state.reason.startswith("test (pressed ")
        robot.release()
        wait_until(lambda: robot.speed > 0.15, 10, "motion after the release")
