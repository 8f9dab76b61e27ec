"""Components that share a process."""

import pytest

from kompass.components.drive.halt import HALT_NODE
from tests.support.driver import Driver
from tests.support.processes import held, wait_until
from tests.support.stack import Stack

pytestmark = pytest.mark.ros


def test_components_that_share_a_process_are_spoken_for_when_it_dies() -> None:
    stack = Stack.simulated("--single-process")
    robot = Driver(stack.domain)
    try:
        robot.ready()
        wait_until(lambda: f"{HALT_NODE} is up" in stack.output, 10, "who halts the robot")
        robot.drive()
        robot.newest.pop("/cmd_vel")
        with held(stack.pid_of("components")):
            wait_until(robot.halts, 2, "a zero twist")
            wait_until(lambda: robot.speed < 0.01, 2, "a standstill")
    finally:
        robot.close()
        stack.close()
