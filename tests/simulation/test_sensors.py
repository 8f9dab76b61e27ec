"""What the sensors say agrees with the world, as far as their data sheets promise."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from kompass.simulation.physics.motion import BodyMotion
from kompass.simulation.physics.robot_model import TURTLEBOT3
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.sensors.bumper import Bumper
from kompass.simulation.sensors.localizer import HEADING_ERROR, POSITION_ERROR, Localizer
from kompass.simulation.sensors.wheel_odometry import WheelOdometry
from kompass.simulation.worlds.registry import world, world_names
from kompass.simulation.worlds.shapes import Box
from kompass.simulation.worlds.world import World
from tests.simulation.hall import HALL, PERIOD

LIDAR = TURTLEBOT3.lidar


def ray_lengths(place: World, pose: tuple[float, float, float]) -> NDArray[np.float64]:
    """Distances (360,) by intersecting rays with circles and edges, apart from the physics."""
    x, y, yaw = pose
    bearing = yaw + np.arange(360) * math.tau / 360
    rays = np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
    nearest = np.full(360, np.inf)
    for shape in place.solids:
        offset = np.array(shape.center) - (x, y)
        if isinstance(shape, Box):
            axis = np.array([math.cos(shape.yaw), math.sin(shape.yaw)])
            normal = np.array([-axis[1], axis[0]])
            hits = []
            for half, along, other in (
                (shape.size[0] / 2, axis, (normal, shape.size[1] / 2)),
                (shape.size[1] / 2, normal, (axis, shape.size[0] / 2)),
            ):
                for side in (-half, half):
                    with np.errstate(divide="ignore", invalid="ignore"):
                        length = (offset @ along + side) / (rays @ along)
                        across = np.abs(length * (rays @ other[0]) - offset @ other[0])
                    hits.append(np.where((length > 0) & (across <= other[1]), length, np.inf))
            nearest = np.minimum(nearest, np.min(hits, axis=0))
        else:
            middle = rays @ offset
            under = middle**2 - offset @ offset + shape.radius**2
            length = middle - np.sqrt(np.maximum(under, 0.0))
            nearest = np.minimum(nearest, np.where((under >= 0) & (length > 0), length, np.inf))
    return nearest


@pytest.mark.parametrize("name", world_names())
def test_scan_matches_the_geometry_in_every_direction(name: str) -> None:
    place = world(name)
    robot = SimulatedRobot(place)
    x, y, _ = place.start
    for yaw in (0.0, 0.7, -2.0):
        robot.place((x, y, yaw))
        x_now, y_now, yaw_now = robot.truth().pose
        expected = ray_lengths(place, (x_now, y_now, yaw_now))
        scans = np.array([robot.scan() for _ in range(20)])
        # A ray that grazes an edge may honestly go either way.
        beside = [ray_lengths(place, (x_now, y_now, yaw_now + turn)) for turn in (-3e-4, 3e-4)]
        certain = np.all(np.abs(np.minimum(beside, 9.0) - np.minimum(expected, 9.0)) < 0.1, axis=0)
        assert certain.sum() > 350
        within = certain & (expected < LIDAR.range_max - 5 * LIDAR.noise)
        assert within.sum() > 60
        error = scans[:, within] - expected[within]
        assert np.abs(error).max() < 5.5 * LIDAR.noise
        assert error.std() == pytest.approx(LIDAR.noise, rel=0.05)
        beyond = certain & (expected > LIDAR.range_max + 5 * LIDAR.noise)
        assert np.all(np.isposinf(scans[:, beyond]))


def test_what_touches_the_robot_is_seen_and_not_taken_for_free_space() -> None:
    robot = SimulatedRobot(world("hexagon"))
    robot.place((-1.1 - 0.15 - 0.101, 0.0, 0.0))
    assert LIDAR.range_min < robot.scan()[0] < LIDAR.range_min + 0.005


def test_lidar_sees_neither_the_floor_nor_the_robot() -> None:
    assert np.all(np.isposinf(SimulatedRobot(HALL).scan()))


def test_imu_feels_gravity_and_the_turn_rate() -> None:
    robot = SimulatedRobot(world("hexagon"))
    for _ in range(60):
        robot.command(0.0, 1.0)
        robot.step(PERIOD)
    readings = [robot.imu() for _ in range(100)]
    acceleration = np.mean([reading.linear_acceleration for reading in readings], axis=0)
    np.testing.assert_allclose(acceleration[2], 9.81, atol=0.1)
    rate = np.mean([reading.angular_velocity for reading in readings], axis=0)
    np.testing.assert_allclose(rate, [0.0, 0.0, 1.0], atol=0.03)
    yaws = [2 * math.atan2(reading.orientation[2], reading.orientation[3]) for reading in readings]
    assert np.mean(yaws) == pytest.approx(robot.truth().pose[2], abs=0.002)


def test_localizer_errs_by_millimetres_smoothly_and_within_bounds() -> None:
    localizer = Localizer(np.random.default_rng(2), PERIOD)
    still = BodyMotion((1.0, -2.0, math.pi), (0.0, 0.0, 0.0))
    errors = []
    for _ in range(20_000):
        localizer.update(still)
        x, y, yaw = localizer.read().pose
        errors.append((x - 1.0, y + 2.0, math.remainder(yaw - math.pi, math.tau)))
    scale = np.array([POSITION_ERROR, POSITION_ERROR, HEADING_ERROR])
    in_deviations = np.array(errors) / scale
    np.testing.assert_allclose(in_deviations.std(axis=0), 1.0, rtol=0.3)
    assert np.abs(in_deviations).max() <= 3.0 + 1e-9
    apparent_speed = np.abs(np.diff(errors, axis=0)) / PERIOD
    assert apparent_speed[:, :2].max() < 0.015
    assert apparent_speed[:, 2].max() < 0.02


def test_wheel_odometry_follows_an_exact_circle() -> None:
    class Exact(np.random.Generator):
        def standard_normal(self, *_args: object, **_kwargs: object) -> float:  # type: ignore[override]
            return 0.0

    wheels = WheelOdometry(Exact(np.random.PCG64()))
    for tick in range(1001):
        share = tick / 1000
        # A circle of 0.5 m radius, anticlockwise: the wheels run on radii 0.42 m and 0.58 m.
        wheels.update(math.tau * 0.42 / 0.033 * share, math.tau * 0.58 / 0.033 * share, PERIOD)
        if tick == 500:
            np.testing.assert_allclose(wheels.read().pose[:2], [0.0, 1.0], atol=2e-3)
    x, y, yaw = wheels.read().pose
    assert math.hypot(x, y) < 2e-3
    assert yaw == pytest.approx(0.0, abs=0.02)


def test_wheel_odometry_drifts_within_its_own_covariance() -> None:
    drifts, surprises = [], []
    for seed in range(6):
        robot = SimulatedRobot(HALL, seed)
        before = robot.wheel_odometry()
        for tick in range(3000):
            robot.command(0.2, 0.0 if tick % 500 < 350 else 0.5)
            robot.step(PERIOD)
        after, truth = robot.wheel_odometry(), robot.truth()
        assert robot.contacts == 0
        assert np.linalg.det(after.pose_covariance) > np.linalg.det(before.pose_covariance)
        error = np.array(after.pose) - truth.pose  # both frames begin at the start
        error[2] = math.remainder(error[2], math.tau)
        drifts.append(math.hypot(error[0], error[1]))
        surprises.append(error @ np.linalg.solve(after.pose_covariance, error))
    assert max(drifts) > 0.01
    assert max(drifts) < 0.5
    assert np.median(surprises) < 7.8  # 95th percentile of chi-square with 3 degrees of freedom


def test_reading_one_sensor_more_often_leaves_the_others_unchanged() -> None:
    def run(scans: int) -> tuple[float, float, float]:
        robot = SimulatedRobot(world("hexagon"), seed=9)
        for _ in range(50):
            robot.command(0.1, 0.2)
            robot.step(PERIOD)
            for _ in range(scans):
                robot.scan()
        return robot.filtered().pose

    assert run(0) == run(3)


def test_contact_lost_for_a_moment_counts_once() -> None:
    bumper = Bumper()
    for touching, now in [(True, 1.0), (False, 1.1), (True, 1.15), (False, 1.2), (True, 1.34)]:
        bumper.update(touching, now)
    assert bumper.episodes == 1
    bumper.update(True, 1.55)
    assert bumper.episodes == 2


def test_contact_at_the_first_moment_counts() -> None:
    bumper = Bumper()
    bumper.update(True, 0.0)
    assert bumper.episodes == 1
