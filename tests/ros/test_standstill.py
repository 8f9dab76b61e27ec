"""A robot whose programs die, or are held by a signal, comes to a standstill."""

import os
import signal
from collections.abc import Iterator
from contextlib import closing

import pytest
from geometry_msgs.msg import Twist

from kompass.components.drive.halt import HALT_NODE
from tests.support.driver import Driver
from tests.support.processes import held, wait_until
from tests.support.stack import Stack

pytestmark = pytest.mark.ros


@pytest.fixture
def robot(stack: Stack) -> Iterator[Driver]:
    with closing(Driver(stack.domain)) as client:
        client.ready()
        yield client


def test_somebody_sends_zero_for_a_drive_manager_that_a_signal_holds(
    stack: Stack, robot: Driver
) -> None:
    wait_until(lambda: f"{HALT_NODE} is up" in stack.output, 10, "who halts the robot")
    robot.drive()
    with held(stack.pid_of("drive_manager")):
        wait_until(robot.halts, 2, "a zero twist")
        wait_until(lambda: robot.speed < 0.01, 2, "a standstill")
        # It goes on for as long as nobody else can: a base may forget one command.
        for _ in range(3):
            robot.newest.pop("/cmd_vel")
            wait_until(robot.halts, 2, "another zero twist")


def test_the_robot_halts_when_the_drive_manager_is_killed_and_drives_on_with_the_next(
    stack: Stack, robot: Driver
) -> None:
    robot.drive()
    heard: list[Twist] = []
    robot.node.create_subscription(Twist, "/cmd_vel", heard.append, 10)
    wait_until(lambda: heard, 5, "commands")
    killed = stack.pid_of("drive_manager")
    heard.clear()
    os.kill(killed, signal.SIGKILL)
    wait_until(lambda: Twist() in heard, 5, "a zero twist")
    wait_until(lambda: stack.pid_of("drive_manager") != killed, 10, "another drive manager")
    wait_until(lambda: robot.speed > 0.1, 15, "motion again")


def test_the_drive_manager_halts_at_once_when_a_signal_holds_the_controller(
    stack: Stack, robot: Driver
) -> None:
    robot.drive()
    with held(stack.pid_of("controller")):
        stack.wait_for_line("halted: controller: the process was stopped by a signal", 2)
        wait_until(lambda: robot.speed < 0.01, 2, "a standstill")


def test_the_drive_manager_halts_at_once_when_the_controller_is_killed(
    stack: Stack, robot: Driver
) -> None:
    robot.drive()
    os.kill(stack.pid_of("controller"), signal.SIGKILL)
    stack.wait_for_line("halted: controller: the process was killed by SIGKILL", 2)
    wait_until(lambda: robot.speed < 0.01, 2, "a standstill")
