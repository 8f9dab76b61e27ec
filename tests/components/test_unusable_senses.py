"""A robot whose sensors say nothing that can be used stands, and says what is wrong with it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import pytest
from kompass_interfaces.msg import TwistArray
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from kompass.components import DriveManager
from tests.components.alive import Alive, Virtual
from tests.components.test_by_hand import Scene

Run = Callable[..., Alive]


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"ranges": [math.nan] * 360}, "ranges has no measurement"),
        ({"ranges": []}, "ranges is empty"),
        ({"angle_increment": math.nan}, "angle_increment = nan"),
        ({"angle_increment": 0.0}, "angle_increment = 0.0"),
        ({"angle_min": math.nan}, "angle_min = nan"),
        ({"range_max": math.nan}, "range_max = nan"),
        ({"range_max": 0.0}, "range_max = 0"),
        ({"range_min": 10.0}, "range_max = 3.5 is not above range_min = 10"),
    ],
)
def test_nobody_drives_by_a_scan_that_says_nothing(
    run: Run, fields: dict[str, Any], said: str
) -> None:
    scene = Scene(run(DriveManager()))
    scene.driven()
    x = scene.robot.x
    make = scene.robot.make_scan

    def blinded() -> LaserScan:
        scan = make()
        for name, value in fields.items():
            setattr(scan, name, value)
        return scan

    scene.robot.make_scan = blinded  # type: ignore[method-assign]
    scene.wait(lambda: scene.state.limited_by == "scan stale", "that it is held back")
    assert scene.stands()
    assert scene.robot.x - x < 0.2
    scene.wait(lambda: said in scene.alive.statuses[-1].msg, "the reason")


def test_what_is_too_near_to_be_measured_is_in_the_way(run: Run) -> None:
    scene = Scene(run(DriveManager()))
    scene.driven()
    make = scene.robot.make_scan

    def too_near() -> LaserScan:
        scan = make()
        scan.ranges = [-math.inf if abs(ray - 180) < 5 else r for ray, r in enumerate(scan.ranges)]
        return scan

    scene.robot.make_scan = too_near  # type: ignore[method-assign]
    scene.wait(lambda: scene.state.limited_by == "obstacle", "that it is held back")
    assert scene.stands()


@pytest.mark.parametrize("field", ["x", "yaw", "vx"])
def test_nobody_drives_by_an_odometry_that_is_no_number(run: Run, field: str) -> None:
    scene = Scene(run(DriveManager()))
    scene.driven()

    def worsen(odometry: Odometry) -> None:
        pose = odometry.pose.pose
        if field == "x":
            pose.position.x = math.nan
        elif field == "yaw":
            pose.orientation.z = math.nan
        else:
            odometry.twist.twist.linear.x = math.inf

    scene.robot.worsen = worsen
    scene.wait(lambda: scene.state.limited_by == "odometry stale", "that it is held back")
    assert scene.stands()
    scene.wait(lambda: f"{field} = " in scene.alive.statuses[-1].msg, "the reason")
    assert not scene.state.standstill  # which was not measured


def test_nobody_drives_by_an_orientation_that_is_none(run: Run) -> None:
    scene = Scene(run(DriveManager()))
    scene.driven()

    def worsen(odometry: Odometry) -> None:
        odometry.pose.pose.orientation.w = odometry.pose.pose.orientation.z = 0.0

    scene.robot.worsen = worsen
    scene.wait(lambda: scene.state.limited_by == "odometry stale", "that it is held back")
    assert scene.stands()
    said = "its orientation (0, 0, 0, 0) is none"
    scene.wait(lambda: said in scene.alive.statuses[-1].msg, "the reason")


def test_nobody_drives_by_an_odometry_that_two_publish_who_contradict_each_other(run: Run) -> None:
    scene = Scene(run(DriveManager()))
    scene.driven()
    turns = itertools.cycle((False, True))

    def worsen(odometry: Odometry) -> None:
        if next(turns):
            odometry.pose.pose.position.x = 9.0

    scene.robot.worsen = worsen
    scene.wait(lambda: scene.state.limited_by == "odometry stale", "that it is held back")
    assert scene.stands()
    said = "the odometry cannot be used: it jumps to and fro, "
    scene.wait(lambda: said in scene.alive.statuses[-1].msg, "the reason")
    scene.robot.worsen = lambda _: None
    scene.wait(lambda: not scene.state.limited_by, "that it may drive again")


def test_one_list_of_commands_does_not_drive_for_ever(run: Callable[..., Virtual]) -> None:
    alive = run(DriveManager())
    scene = Scene(alive)
    publisher = scene.alive.publisher(TwistArray, "/control_list")
    message = TwistArray(time_step=1e9)
    message.linear_velocities.x = [0.2]
    publisher.publish(message)
    scene.alive.rest(1.0)
    assert scene.robot.x == 0.0
    assert alive.logged("time_step = 1e+09 s for 1 commands")


def test_what_a_sensor_calls_its_frame_does_not_steer_a_terminal(
    run: Callable[..., Virtual],
) -> None:
    alive = run(DriveManager())
    scene = Scene(alive)
    make = scene.robot.make_scan

    def named() -> LaserScan:
        scan = make()
        scan.header.frame_id = "lidar\x1b[2J"
        return scan

    scene.robot.make_scan = named  # type: ignore[method-assign]
    scene.wait(lambda: alive.logged("cannot be placed on the robot"), "the warning")
    assert alive.logged(r"lidar\x1b[2J")
    assert not alive.logged("\x1b")
