"""The console says how well scan and map agree, and warns of what lasts, where it can know."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from kompass.algorithms.grid import Grid
from kompass_console.link.localisation import (
    FOUND,
    FOUND_AFTER,
    LOST,
    LOST_AFTER,
    OLD,
    Localisation,
)
from kompass_console.schema.world import Pose, RobotMotion, Scan, WorldModel

HERE = Pose(2.0, 1.5, 0.5)
RAYS = 180
PERIOD = 0.5  # s
MOUNT = Pose(0.1, 0.0, math.pi / 2)


def room() -> Grid:
    """4 m by 3 m, its walls a cell thick."""
    cells = np.zeros((60, 80), dtype=np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return Grid(cells, 0.05)


class Clock:
    """Monotonic seconds that a test lets pass."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


class Robot:
    """What the console hears of a robot in the room, as time passes."""

    def __init__(self) -> None:
        self.clock = Clock()
        self.world = WorldModel(self.clock)
        self.localisation = Localisation(self.world, self.clock)
        self.thinks = HERE

    def hears_all(self) -> None:
        self.world.scan_mount = {"lidar": MOUNT}
        self.world.map.set(room())
        self.sees()

    def sees(self) -> None:
        """A pose and the scan of that moment, made where the robot really is."""
        stamp = self.clock()
        self.world.motion.set(RobotMotion(self.thinks, 0.0, 0.0, stamp))
        self.world.history.add(stamp, self.thinks)
        sensor = self.world.sensor_at(HERE, Scan(np.zeros(0, np.float32), 0, 0, 0, 0, 0, "lidar"))
        angles = np.arange(RAYS) * math.tau / RAYS
        c, s = np.cos(angles + sensor.yaw), np.sin(angles + sensor.yaw)
        to_x = np.where(c > 0, 3.975 - sensor.x, 0.025 - sensor.x) / c
        to_y = np.where(s > 0, 2.975 - sensor.y, 0.025 - sensor.y) / s
        ranges = np.minimum(to_x, to_y).astype(np.float32)
        self.world.scan.set(Scan(ranges, 0.0, math.tau / RAYS, 0.1, 6.0, stamp, "lidar"))

    def goes_on(self, seconds: float, *, seeing: bool = True) -> bool:
        """Let time pass; whether the robot counts as lost then."""
        for _ in range(round(seconds / PERIOD)):
            self.clock.now += PERIOD
            if seeing:
                self.sees()
            self.localisation.update()
        return self.localisation.info().lost


@pytest.fixture
def robot() -> Robot:
    made = Robot()
    made.hears_all()
    made.localisation.update()
    return made


ELSEWHERE = Pose(2.6, 1.1, 0.2)


def test_a_robot_that_knows_its_place_agrees_with_the_map(robot: Robot) -> None:
    info = robot.localisation.info()
    assert (info.problem, info.lost) == (None, False)
    assert info.agreement is not None
    assert info.agreement > 0.95
    robot.clock.now += 1.2
    assert robot.localisation.info().age == pytest.approx(1.2)


def test_what_lasts_is_told_and_what_passes_is_not(robot: Robot) -> None:
    robot.thinks = ELSEWHERE
    assert not robot.goes_on(LOST_AFTER - PERIOD)
    robot.thinks = HERE
    assert not robot.goes_on(1.0)
    robot.thinks = ELSEWHERE
    assert not robot.goes_on(LOST_AFTER), "it counts from anew"
    assert robot.goes_on(PERIOD)
    agreement = robot.localisation.info().agreement
    assert agreement is not None
    assert agreement < LOST
    robot.thinks = HERE
    assert robot.goes_on(FOUND_AFTER)
    assert not robot.goes_on(PERIOD)


def test_in_between_it_stays_as_it_was(robot: Robot) -> None:
    between = next(
        pose
        for pose in (Pose(HERE.x + 0.005 * n, HERE.y, HERE.yaw) for n in range(200))
        if isinstance(found := robot.localisation.fit(pose, search=False), tuple)
        and LOST < (found[0].agreement or 0.0) < FOUND
    )
    robot.thinks = between
    assert not robot.goes_on(20.0)
    robot.thinks = ELSEWHERE
    assert robot.goes_on(2 * LOST_AFTER)
    robot.thinks = between
    assert robot.goes_on(20.0)


def test_who_hears_nothing_new_says_so_and_warns_of_nothing(robot: Robot) -> None:
    robot.thinks = ELSEWHERE
    assert robot.goes_on(2 * LOST_AFTER)
    assert not robot.goes_on(OLD + PERIOD, seeing=False)
    info = robot.localisation.info()
    assert (info.agreement, info.problem) == (None, "no_scan")


@pytest.mark.parametrize("missing", ["map", "scan", "motion"])
def test_what_is_missing_is_named(missing: str) -> None:
    robot = Robot()
    robot.hears_all()
    getattr(robot.world, missing).clear()
    robot.localisation.update()
    problem = {"map": "no_map", "scan": "no_scan", "motion": "no_pose"}[missing]
    assert robot.localisation.info().problem == problem


def test_a_scan_that_measures_nothing_is_none(robot: Robot) -> None:
    robot.thinks = ELSEWHERE
    assert robot.goes_on(2 * LOST_AFTER)
    heard = robot.world.scan.get()
    assert heard is not None
    robot.world.scan.set(replace(heard.value, ranges=np.full(RAYS, np.nan, np.float32)))
    robot.localisation.update()
    info = robot.localisation.info()
    assert (info.agreement, info.lost, info.problem) == (None, False, "no_scan")
    assert robot.localisation.fit(HERE, search=True) == "no_scan"


def test_what_is_too_near_to_be_measured_is_held_against_no_place(robot: Robot) -> None:
    heard = robot.world.scan.get()
    assert heard is not None
    before = robot.localisation.info().agreement
    ranges = heard.value.ranges.copy()
    ranges[::3] = -np.inf
    robot.world.scan.set(replace(heard.value, ranges=ranges))
    robot.localisation.update()
    assert robot.localisation.info().agreement == pytest.approx(before, abs=0.02)


def test_a_map_of_another_place_counts_at_once(robot: Robot) -> None:
    robot.world.map.set(Grid(np.full((60, 80), -1, dtype=np.int8), 0.05))
    robot.goes_on(PERIOD)
    assert robot.localisation.info().problem == "too_little"


def test_a_place_that_a_hand_has_pointed_at_is_put_right(robot: Robot) -> None:
    found = robot.localisation.fit(Pose(2.2, 1.4, 0.6), search=True)
    assert isinstance(found, tuple)
    here, best = found
    assert here.robot == (2.2, 1.4, 0.6)
    assert best is not None
    assert best.robot == pytest.approx(HERE, abs=0.06), "of the robot, and not of its sensor"
    assert (best.agreement or 0.0) > (here.agreement or 0.0)
