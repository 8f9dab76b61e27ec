"""Each embedded robot has the body, the speed and the lidar that its model says."""

import math
from dataclasses import replace

import numpy as np
import pytest

from kompass.algorithms.transforms import matrix_of
from kompass.simulation.physics.robot_model import (
    ACKERMANN,
    JACKAL,
    OMNI,
    TURTLEBOT3,
    RobotModel,
    robot_model,
)
from kompass.simulation.physics.robot_model import TURTLEBOT3_PLUS as PLUS
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.shapes import Box
from kompass.simulation.worlds.world import World

PERIOD = 0.02
LONG = World(
    name="long",
    title="A long hall with a wall at its end",
    floor=((-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)),
    start=(0.0, 0.0, 0.0),
    obstacles=(Box("end", (6.0, 0.0), (0.2, 4.0)),),
)


def drive(robot: SimulatedRobot, v: float, omega: float, seconds: float, vy: float = 0.0) -> None:
    for _ in range(round(seconds / PERIOD)):
        robot.command(v, omega, vy)
        robot.step(PERIOD)


ALL = [TURTLEBOT3, JACKAL, ACKERMANN, OMNI]
TURN_ON_THE_SPOT = [TURTLEBOT3, JACKAL, OMNI]


@pytest.mark.parametrize("model", ALL, ids=lambda model: model.name)
def test_it_reaches_its_top_speed_and_no_more(model: RobotModel) -> None:
    robot = SimulatedRobot(LONG, kind=model)
    drive(robot, 100.0, 0.0, 1.2)
    x, y, yaw = robot.truth().pose
    assert robot.truth().twist[0] == pytest.approx(model.max_speed, rel=0.03)
    assert (y, yaw) == pytest.approx((0.0, 0.0), abs=0.02)
    # It is level: a robot that nods sees floor and ceiling.
    assert x > 0.5 * model.max_speed


@pytest.mark.parametrize("model", TURN_ON_THE_SPOT, ids=lambda model: model.name)
def test_it_turns_as_it_is_told_and_stands_when_nobody_tells_it(model: RobotModel) -> None:
    robot = SimulatedRobot(LONG, kind=model)
    drive(robot, 0.0, 1.0, 1.0)
    assert robot.truth().pose[2] == pytest.approx(1.0, rel=0.15)
    robot.step(2.0)
    assert robot.truth().twist == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)


def test_a_car_stands_when_it_is_told_to_turn_on_the_spot() -> None:
    robot = SimulatedRobot(LONG, kind=ACKERMANN)
    drive(robot, 0.0, 1.0, 2.0)
    assert robot.truth().pose == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)


@pytest.mark.parametrize("v", [0.5, -0.5])
def test_a_car_turns_as_it_is_told_and_no_tighter_than_its_steering_lets_it(v: float) -> None:
    assert ACKERMANN.steering is not None
    radius = ACKERMANN.steering.turning_radius
    robot = SimulatedRobot(LONG, kind=ACKERMANN)
    drive(robot, v, 0.4, 1.5)
    assert robot.truth().twist == pytest.approx((v, 0.0, 0.4), abs=0.01)
    drive(robot, v, 5.0, 1.5)
    speed, aside, turn = robot.truth().twist
    assert speed == pytest.approx(v, abs=0.01)
    assert aside == pytest.approx(0.0, abs=0.01)
    # Backwards its wheels are steered the other way, and it turns the same.
    assert turn == pytest.approx(abs(v) / radius, rel=0.02)


@pytest.mark.parametrize("direction", [0.0, 1.0, 2.5, -2.0])
def test_an_omni_goes_any_way_and_turns_meanwhile(direction: float) -> None:
    robot = SimulatedRobot(LONG, kind=OMNI)
    vx, vy = 0.5 * math.cos(direction), 0.5 * math.sin(direction)
    drive(robot, vx, 0.0, 2.0, vy)
    assert robot.truth().twist == pytest.approx((vx, vy, 0.0), abs=0.01)
    drive(robot, vx, 0.8, 2.0, vy)
    assert robot.truth().twist == pytest.approx((vx, vy, 0.8), abs=0.01)


def test_only_an_omni_goes_sideways() -> None:
    for model in (TURTLEBOT3, JACKAL, ACKERMANN):
        robot = SimulatedRobot(LONG, kind=model)
        drive(robot, 0.0, 0.0, 1.0, vy=0.5)
        assert robot.truth().pose == pytest.approx((0.0, 0.0, 0.0), abs=1e-3), model.name


@pytest.mark.parametrize("model", [ACKERMANN, OMNI], ids=lambda model: model.name)
def test_its_encoders_tell_where_it_went_to_a_few_percent(model: RobotModel) -> None:
    robot = SimulatedRobot(LONG, kind=model)
    drive(robot, 0.5, 0.3, 3.0, vy=0.2)
    drive(robot, -0.3, 0.2, 2.0, vy=-0.1)
    told, truth = robot.wheel_odometry(), robot.truth()
    assert told.pose == pytest.approx(truth.pose, abs=0.05)
    assert told.twist == pytest.approx(truth.twist, abs=0.03)
    assert np.diag(told.pose_covariance).min() > 0.0


def test_the_body_of_a_car_reaches_further_ahead_than_behind() -> None:
    # The wall's face is at x = 5.9, and the nose half a metre before the axle that drives.
    robot = SimulatedRobot(LONG, kind=ACKERMANN)
    robot.place((5.2, 0.0, 0.0))
    while robot.contacts == 0:
        drive(robot, 0.2, 0.0, PERIOD)
        assert robot.time < 3.0
    assert robot.truth().pose[0] == pytest.approx(5.4, abs=0.01)
    wall = np.array([[5.9, 0.0]])
    facing = np.array([[5.4, 0.0, 0.0], [5.4, 0.0, math.pi]])
    assert ACKERMANN.gap(facing, wall)[:, 0] == pytest.approx([0.0, 0.4], abs=1e-6)


def test_a_jackal_brakes_from_full_speed_within_a_metre() -> None:
    robot = SimulatedRobot(LONG, kind=JACKAL)
    drive(robot, 2.0, 0.0, 1.2)
    at = robot.truth().pose[0]
    drive(robot, 0.0, 0.0, 1.5)
    assert robot.truth().pose[0] - at < 1.0
    assert robot.contacts == 0


def test_a_box_touches_a_wall_with_its_front_and_not_before() -> None:
    # The wall's face is at x = 5.9.
    robot = SimulatedRobot(LONG, kind=JACKAL)
    robot.place((5.5, 0.0, 0.0))
    while robot.contacts == 0:
        drive(robot, 0.2, 0.0, PERIOD)
        assert robot.time < 3.0
    assert robot.truth().pose[0] == pytest.approx(5.9 - 0.254, abs=0.01)


def test_a_box_fits_sideways_where_its_corner_does_not() -> None:
    robot = SimulatedRobot(LONG, kind=JACKAL)
    robot.place((5.9 - 0.24, 0.0, math.pi / 2))
    robot.step(0.5)
    assert robot.contacts == 0
    drive(robot, 0.0, 1.0, 1.0)
    assert robot.contacts >= 1


def test_the_jackal_sees_270_degrees_to_10_m() -> None:
    robot = SimulatedRobot(LONG, kind=JACKAL)
    ranges = robot.scan()
    angles = JACKAL.lidar.angles
    assert len(ranges) == len(angles) == 541
    assert (math.degrees(angles[0]), math.degrees(angles[-1])) == pytest.approx((-135.0, 135.0))
    ahead = np.abs(angles) < math.radians(15.0)
    assert ranges[ahead] == pytest.approx(5.9 / np.cos(angles[ahead]), abs=0.03)
    assert np.isinf(ranges[np.abs(angles) > math.radians(30.0)]).all()


def test_a_box_lower_than_the_lidar_is_seen_by_the_camera_ahead_and_the_scanner_behind() -> None:
    low = Box("low", (0.6, 0.0), (0.2, 0.4), height=0.1)
    robot = SimulatedRobot(replace(LONG, obstacles=(low,), start=(0.0, 0.0, 0.0)), kind=PLUS)
    assert robot.camera is not None
    assert robot.rear is not None
    camera, rear = PLUS.camera, PLUS.rear
    assert camera is not None
    assert rear is not None

    points = robot.camera.points().reshape(-1, 3).astype(float)
    points = points[np.isfinite(points).all(axis=1)]
    pitch = camera.down / 2
    mounted = matrix_of(
        (camera.ahead, 0.0, camera.height), (0.0, math.sin(pitch), 0.0, math.cos(pitch))
    )
    points = points @ mounted[:3, :3].T + mounted[:3, 3]
    high = points[(points[:, 2] > 0.03) & (points[:, 0] < 1.0)]
    assert high[:, 2].max() == pytest.approx(0.1, abs=0.02)
    assert high[:, 0].min() == pytest.approx(0.5, abs=0.02)
    assert np.abs(high[:, 1]).max() == pytest.approx(0.2, abs=0.03)
    floor = points[points[:, 2] < 0.03]
    assert floor[:, 2].min() == pytest.approx(0.0, abs=0.02)
    assert floor[:, 0].min() == pytest.approx(0.24, abs=0.03)
    ahead = PLUS.lidar.rays // 2
    assert robot.scan()[ahead] > 2.0  # the lidar looks over it
    robot.place((0.0, 0.0, math.pi))
    assert robot.rear.scan()[rear.lidar.rays // 2] == pytest.approx(0.5 - rear.behind, abs=0.03)


def test_gaps_are_those_of_the_body() -> None:
    pose = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, math.pi / 2]])
    points = np.array([[1.0, 0.0], [0.0, 1.0], [0.1, 0.1]])
    assert TURTLEBOT3.gap(pose, points[:2]) == pytest.approx(0.9)
    gaps = JACKAL.gap(pose, points)
    assert gaps[:, :2] == pytest.approx(np.array([[0.746, 0.785], [0.785, 0.746]]))
    assert (gaps[:, 2] < 0.0).all()


def test_a_robot_that_there_is_not_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(
        ValueError, match=r"robot is 'husky'.* choose one of: turtlebot3, jackal, turt"
    ):
        robot_model("husky")


def test_the_camera_shows_what_stands_ahead_in_other_colours_than_the_floor() -> None:
    post = Box("post", (1.5, 0.0), (0.3, 0.3), height=0.5)
    free = SimulatedRobot(replace(LONG, start=(0.0, 0.0, 0.0)), kind=PLUS)
    both = replace(LONG, obstacles=(*LONG.obstacles, post), start=(0.0, 0.0, 0.0))
    seeing = SimulatedRobot(both, kind=PLUS)
    assert free.picture_camera is not None
    assert seeing.picture_camera is not None
    before, after = free.picture_camera.picture(), seeing.picture_camera.picture()
    assert before.shape == (120, 160, 3)
    changed = (before != after).any(axis=2)
    columns = np.flatnonzero(changed.any(axis=0))
    # From the camera 1.27 m ahead, and 0.3 m across.
    half = 80 * (0.15 / 1.27) / math.tan(math.radians(43.5))
    assert columns.min() == pytest.approx(80 - half, abs=4)
    assert columns.max() == pytest.approx(79 + half, abs=4)
    seeing.place((0.0, 0.0, math.pi))
    behind = seeing.picture_camera.picture()
    free.place((0.0, 0.0, math.pi))
    assert (behind == free.picture_camera.picture()).all()


def test_a_picture_takes_nothing_from_the_chance_of_the_other_sensors() -> None:
    looked_at, alone = (SimulatedRobot(LONG, seed=3, kind=PLUS) for _ in range(2))
    assert looked_at.picture_camera is not None
    looked_at.picture_camera.picture()
    assert (looked_at.scan() == alone.scan()).all()
    assert looked_at.camera is not None
    assert alone.camera is not None
    np.testing.assert_array_equal(looked_at.camera.points(), alone.camera.points())
