"""The robot goes where it is sent, and every goal ends with its reason."""

import math
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from tests.support.virtual_robot import VirtualRobot

ROOT = Path(__file__).parents[2]
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
ARRIVED, PREEMPTED = 0, 4
FOLLOWED = ROOT / "benchmarks" / "recipes" / "followed.py"


@pytest.fixture
def robot() -> Iterator[VirtualRobot]:
    with closing(VirtualRobot()) as client:
        client.ready()
        yield client


def test_a_goal_with_a_heading_is_reached_around_the_pillars(robot: VirtualRobot) -> None:
    ended = robot.result(robot.send_goal(0.5, 0.5, 0.5))
    assert (ended.status, ended.result.outcome) == (SUCCEEDED, ARRIVED), ended.result.message
    assert robot.distance_to(0.5, 0.5) < 0.10
    assert abs(math.remainder(robot.truth[2] - 0.5, 2 * math.pi)) < 0.2
    assert robot.contacts == 0


@pytest.mark.parametrize("follower", ["DVZ", "DWA", "MPPI", "PurePursuit", "Stanley"])
def test_every_follower_ends_at_the_goal_with_its_heading(follower: str) -> None:
    with closing(VirtualRobot(FOLLOWED, FOLLOWER=follower)) as robot:
        robot.ready()
        # Where pillars push away, and a turn on the spot ends the way.
        for x, y, yaw in ((-0.35, 1.36, -3.13), (-1.02, 0.46, 2.4), (0.05, -0.63, -1.0)):
            ended = robot.result(robot.send_goal(x, y, yaw))
            assert ended.status == SUCCEEDED, ended.result.message
            assert robot.distance_to(x, y) < 0.05
            assert abs(math.remainder(robot.truth[2] - yaw, 2 * math.pi)) < 0.15
        assert robot.contacts == 0


def test_a_canceled_goal_is_reported_as_canceled_and_the_robot_halts(robot: VirtualRobot) -> None:
    handle = robot.send_goal(-1.5, 0.5)
    robot.wait_until(lambda: robot.speed > 0.1, 10, "motion")
    robot.cancel(handle)
    assert robot.result(handle, timeout=5).status == CANCELED
    robot.wait_until(lambda: robot.speed < 0.01, 3, "a halt")


def test_a_newer_goal_takes_over(robot: VirtualRobot) -> None:
    first = robot.send_goal(-1.5, 0.5)
    robot.wait_until(lambda: robot.speed > 0.05, 10, "motion")
    second = robot.send_goal(-0.5, -0.55)
    ended = robot.result(first, timeout=5)
    assert (ended.status, ended.result.outcome) == (ABORTED, PREEMPTED)
    assert robot.result(second).status == SUCCEEDED
    assert robot.contacts == 0
