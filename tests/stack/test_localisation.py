"""A robot that is lost is told so by its scan, and finds its way once it was told where it is."""

import math
from collections.abc import Iterator
from contextlib import closing

import pytest
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.qos import qos_profile_sensor_data as SENSOR
from sensor_msgs.msg import LaserScan

from kompass_console.link.graph import convert
from kompass_console.link.localisation import LOST_AFTER, Localisation
from kompass_console.schema.models import LocalisationInfo
from kompass_console.schema.world import Pose, RobotMotion, WorldModel
from tests.support.tester import LATCHED, pose
from tests.support.virtual_robot import VirtualRobot

SUCCEEDED = 4
FAULT = "localizer_jump:0.6"
GOAL = (0.5, 0.5)


class Watched(VirtualRobot):
    """A robot with what a console makes of its scan, in the robot's own time."""

    def __init__(self, seed: int = 0) -> None:
        super().__init__(seed=seed)
        self.seen = WorldModel(self.clock.monotonic)
        self.localisation = Localisation(self.seen, self.clock.monotonic)
        listen = self.node.create_subscription
        listen(OccupancyGrid, "/map", lambda m: self.seen.map.set(convert.grid(m)), LATCHED)
        listen(LaserScan, "/scan", lambda m: self.seen.scan.set(convert.scan(m)), SENSOR)
        listen(Odometry, "/odometry/filtered", lambda m: self._moved(convert.motion(m)), 1)
        self._places = self.node.create_publisher(PoseWithCovarianceStamped, "/initialpose", 1)

    def _moved(self, motion: RobotMotion) -> None:
        self.seen.history.add(motion.stamp, motion.pose)
        self.seen.motion.set(motion)

    def comes_to(self, lost: bool) -> LocalisationInfo:
        """Wait until the robot counts as lost, or as found."""

        def judged() -> bool:
            self.localisation.update()
            info = self.localisation.info()
            return info.agreement is not None and info.lost is lost

        self.wait_until(judged, 20, "lost" if lost else "found")
        return self.localisation.info()

    def is_at(self, x: float, y: float, yaw: float) -> None:
        """Say where it is, as a person does."""
        message = PoseWithCovarianceStamped()
        message.header.frame_id = "map"
        message.pose.pose = pose(x, y, yaw)
        self._places.publish(message)

    def off(self) -> float:
        """How far from the truth it thinks that it is [m]."""
        motion = self.seen.motion.get()
        return math.inf if motion is None else self.distance_to(*motion.value.pose[:2])


@pytest.fixture
def robot() -> Iterator[Watched]:
    with closing(Watched(seed=2)) as client:
        client.ready()
        yield client


def test_a_jump_is_seen_in_the_scan_and_healed_by_a_person_s_hand(robot: Watched) -> None:
    well = robot.comes_to(lost=False)
    assert well.agreement is not None
    assert well.agreement > 0.9
    began = robot.clock.monotonic()
    robot.fault(FAULT)
    ill = robot.comes_to(lost=True)
    assert robot.clock.monotonic() - began >= LOST_AFTER, "no moment alarms"
    assert ill.agreement is not None
    assert ill.agreement < 0.5
    assert robot.off() > 0.5

    # A hand is wrong by a hand's breadth; the scan knows better.
    x, y, yaw = robot.truth
    hand = Pose(x + 0.2, y - 0.15, yaw + 0.15)
    found = robot.localisation.fit(hand, search=True)
    assert isinstance(found, tuple)
    here, best = found
    assert best is not None
    assert best.agreement is not None
    assert best.agreement > (here.agreement or 0.0)
    robot.is_at(*best.robot)
    robot.comes_to(lost=False)
    assert robot.off() < 0.1

    ended = robot.result(robot.send_goal(*GOAL))
    assert ended.status == SUCCEEDED, ended.result.message
    assert robot.distance_to(*GOAL) < 0.15
    assert robot.contacts == 0


def test_what_is_no_place_is_left_alone_and_the_log_says_why(robot: Watched) -> None:
    robot.comes_to(lost=False)
    message = PoseWithCovarianceStamped()
    message.header.frame_id = "odom"
    message.pose.pose = pose(1.0, 1.0, 0.0)
    robot._places.publish(message)
    robot.wait_for_line("its frame is 'odom'; send it in 'map'", 5)
    message.header.frame_id = "map"
    message.pose.pose.position.x = math.nan
    robot._places.publish(message)
    robot.wait_for_line("its pose is none", 5)
    message.pose.pose.position.x = 1e300
    robot._places.publish(message)
    robot.wait_for_line("x = 1e+300 m, y = 1 m is farther than", 5)
    assert robot.off() < 0.05


def test_the_same_seed_is_lost_and_found_the_same_way() -> None:
    def drive() -> list[str]:
        with closing(Watched(seed=5)) as robot:
            robot.ready()
            robot.fault(FAULT)
            ill = robot.comes_to(lost=True)
            robot.is_at(*robot.truth)
            well = robot.comes_to(lost=False)
            return [repr(ill), repr(well), repr(robot.truth)]

    assert drive() == drive()
