"""A robot does not drive by what is old, or stays the same: it stands, and says why."""

from collections.abc import Iterator
from contextlib import closing

import pytest
from automatika_ros_sugar.msg import ComponentStatus

from tests.support.tester import LATCHED
from tests.support.virtual_robot import VirtualRobot

SYSTEM = ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL
STATUS = "/drive_manager/status"
SUCCEEDED = 4


@pytest.fixture
def robot() -> Iterator[VirtualRobot]:
    with closing(VirtualRobot()) as client:
        client.subscribe(ComponentStatus, STATUS, LATCHED)
        client.ready()
        yield client


def says(robot: VirtualRobot, text: str) -> bool:
    status = robot.newest.get(STATUS)
    return status is not None and status.status == SYSTEM and text in status.msg


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("scan_frozen", "stays the same to the last bit while the robot moves"),
        ("scan_late:1", "the scan is too old: it comes 1.0 s after its stamp"),
        ("odometry_late:1", "the odometry is too old: it comes 1.0 s after its stamp"),
    ],
)
def test_a_robot_stands_while_a_sensor_lies_of_the_time_and_goes_on_after(
    robot: VirtualRobot, name: str, text: str
) -> None:
    handle = robot.send_goal(0.5, 0.5)
    robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
    robot.fault(name)
    robot.wait_until(lambda: says(robot, text), 5, f"a drive manager that says '{text}'")
    robot.wait_until(lambda: robot.speed < 0.01, 1, "a halt")
    before = robot.truth
    robot.watch(3.0)
    assert robot.distance_to(before[0], before[1]) < 0.01
    assert says(robot, text)
    robot.fault(name, on=False)
    assert robot.result(handle).status == SUCCEEDED
    assert robot.contacts == 0


def test_a_frozen_scan_stops_the_robot_within_a_hands_breadth(robot: VirtualRobot) -> None:
    robot.send_goal(0.5, 0.5)
    robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
    x, y, _ = robot.truth
    robot.fault("scan_frozen")
    robot.wait_until(lambda: says(robot, "frozen"), 5, "a drive manager that says so")
    robot.wait_until(lambda: robot.speed < 0.01, 1, "a halt")
    assert robot.distance_to(x, y) < 0.15


def test_what_is_a_third_of_a_second_late_is_driven_by(robot: VirtualRobot) -> None:
    robot.fault("scan_late:0.3")
    assert robot.result(robot.send_goal(-1.5, 0.5)).status == SUCCEEDED
    assert robot.contacts == 0
