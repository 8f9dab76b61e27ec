"""Who takes the wheel has the robot for himself; goals wait for the wheel to be given up."""

import math
from collections.abc import Iterator
from contextlib import closing

import pytest
from kompass_interfaces.srv import TakeWheel

from tests.support.hand import Hand
from tests.support.virtual_robot import VirtualRobot

SUCCEEDED, ABORTED = 4, 6
REFUSED, PREEMPTED = 1, 4


@pytest.fixture
def robot() -> Iterator[VirtualRobot]:
    with closing(VirtualRobot()) as client:
        client.ready()
        yield client


def farthest(robot: VirtualRobot, seconds: float) -> float:
    """How far the robot gets from here in a while [m]."""
    x, y, _ = robot.truth
    return max(math.hypot(at[0] - x, at[1] - y) for at in robot.watch(seconds))


def test_the_wheel_ends_a_goal_refuses_the_next_and_is_given_up_before_another(
    robot: VirtualRobot,
) -> None:
    under_way = robot.send_goal(0.5, 0.5)
    robot.wait_until(lambda: robot.speed > 0.1, 20, "motion")
    ava = Hand(robot, "ava")
    ava.take()
    ended = robot.result(under_way, timeout=5)
    assert (ended.status, ended.result.outcome) == (ABORTED, PREEMPTED)
    assert ended.result.message == "Driven by hand: ava took the wheel."
    robot.wait_until(lambda: robot.speed < 0.01, 3, "a standstill")
    assert farthest(robot, 1.0) < 0.01

    refused = robot.result(robot.send_goal(0.5, 0.5), timeout=5)
    assert (refused.status, refused.result.outcome) == (ABORTED, REFUSED)
    assert "ava drives by hand; the wheel must be given up" in refused.result.message

    ava.vx = 0.15
    robot.wait_until(lambda: robot.speed > 0.1, 5, "motion by hand")
    assert ava.ask(TakeWheel.Request.GIVE).success
    robot.wait_until(lambda: robot.speed < 0.01, 3, "a standstill")
    assert farthest(robot, 2.0) < 0.01
    assert robot.result(robot.send_goal(-1.5, 0.5)).status == SUCCEEDED


def test_a_drive_manager_that_wakes_up_does_not_drive_by_what_lay_in_its_socket(
    robot: VirtualRobot,
) -> None:
    ava = Hand(robot, "ava")
    ava.take()
    robot.rest(0.5)
    ava.vx = 0.15
    robot.wait_until(lambda: robot.speed > 0.1, 5, "motion by hand")
    robot.stack.stop("drive_manager")
    robot.rest(0.5)
    ava.sends = False
    robot.rest(0.3)
    robot.stack.go_on("drive_manager")
    robot.wait_until(lambda: robot.speed < 0.01, 3, "a standstill")
    assert farthest(robot, 2.0) < 0.01


def test_another_drive_manager_starts_with_nobody_at_the_wheel(robot: VirtualRobot) -> None:
    ava = Hand(robot, "ava")
    ava.take()
    robot.rest(0.5)
    ava.vx = 0.15
    robot.wait_until(lambda: robot.speed > 0.1, 5, "motion by hand")
    robot.stack.kill("drive_manager")
    robot.wait_until(lambda: robot.newest["/drive_state"].driven_by == "", 10, "a free wheel")
    robot.wait_until(lambda: robot.speed < 0.01, 3, "a standstill")
    assert farthest(robot, 2.0) < 0.01
