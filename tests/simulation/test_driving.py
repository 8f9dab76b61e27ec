"""The robot goes where it is told, no faster than it can, and stops when nobody tells it."""

import math

import numpy as np
import pytest

from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.registry import world, world_names
from kompass.simulation.worlds.shapes import Cylinder
from kompass.simulation.worlds.world import World

PERIOD = 0.02
HALL = World(
    name="hall",
    title="An empty hall with one pillar",
    floor=((-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)),
    start=(0.0, 0.0, 0.0),
    obstacles=(Cylinder("pillar", (3.0, 0.0), 0.15),),
)


def drive(robot: SimulatedRobot, v: float, omega: float, seconds: float) -> None:
    for _ in range(round(seconds / PERIOD)):
        robot.command(v, omega)
        robot.step(PERIOD)


@pytest.mark.parametrize("v", [0.25, 0.1, -0.2])
def test_drives_one_metre_in_the_commanded_time_and_straight(v: float) -> None:
    robot = SimulatedRobot(HALL)
    drive(robot, v, 0.0, 1.0 / abs(v))
    drive(robot, 0.0, 0.0, 0.5)
    x, y, yaw = robot.truth().pose
    assert x == pytest.approx(math.copysign(1.0, v), rel=0.03)
    assert y == pytest.approx(0.0, abs=0.005)
    assert yaw == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("omega", [1.0, -1.0, 0.3])
def test_turns_ninety_degrees_on_the_spot(omega: float) -> None:
    robot = SimulatedRobot(HALL)
    drive(robot, 0.0, omega, math.radians(90) / abs(omega))
    drive(robot, 0.0, 0.0, 0.5)
    x, y, yaw = robot.truth().pose
    assert yaw == pytest.approx(math.copysign(math.radians(90), omega), rel=0.03)
    assert math.hypot(x, y) < 0.005


def test_drives_a_square_back_to_where_it_began() -> None:
    robot = SimulatedRobot(HALL)
    for _ in range(4):
        drive(robot, 0.25, 0.0, 4.0)
        drive(robot, 0.0, 0.0, 0.3)
        drive(robot, 0.0, 1.0, math.pi / 2)
        drive(robot, 0.0, 0.0, 0.3)
    x, y, yaw = robot.truth().pose
    assert math.hypot(x, y) < 0.05
    assert yaw == pytest.approx(0.0, abs=0.05)


def test_circle_has_the_commanded_radius() -> None:
    robot = SimulatedRobot(HALL)
    drive(robot, 0.2, 0.4, 0.5)
    places = []
    for _ in range(50):
        drive(robot, 0.2, 0.4, math.tau / 0.4 / 50)
        places.append(robot.truth().pose[:2])
    span = np.ptp(np.array(places), axis=0)
    np.testing.assert_allclose(span, 2 * 0.2 / 0.4, rtol=0.03)


def test_command_beyond_the_limits_is_cut_to_them() -> None:
    robot = SimulatedRobot(HALL)
    drive(robot, 5.0, 0.0, 1.0)
    assert robot.truth().twist[0] == pytest.approx(0.3, rel=0.03)
    drive(robot, 0.0, -9.0, 1.0)
    assert robot.truth().twist[2] == pytest.approx(-1.9, rel=0.03)


def test_without_commands_it_stops_after_half_a_second() -> None:
    robot = SimulatedRobot(HALL)
    drive(robot, 0.25, 0.0, 1.0)
    robot.step(0.45)
    assert robot.truth().twist[0] == pytest.approx(0.25, rel=0.03)
    robot.step(0.25)
    assert robot.truth().twist[0] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(("v", "omega"), [(math.nan, 0.0), (0.0, math.inf)])
def test_command_that_is_no_number_is_refused_and_changes_nothing(v: float, omega: float) -> None:
    robot = SimulatedRobot(HALL)
    drive(robot, 0.2, 0.0, 1.0)
    with pytest.raises(ValueError, match=r"command (v|omega) is .*finite"):
        robot.command(v, omega)
    robot.step(0.1)
    assert robot.truth().twist[0] == pytest.approx(0.2, rel=0.03)


def test_stands_perfectly_still_at_rest() -> None:
    robot = SimulatedRobot(HALL)
    robot.step(1.0)
    before, odometry = np.array(robot.truth().pose), robot.wheel_odometry().pose
    for _ in range(500):
        robot.step(PERIOD)
        assert np.abs(robot.truth().twist).max() < 1e-4
        assert robot.wheel_odometry().twist == (0.0, 0.0, 0.0)
        assert np.abs(robot.filtered().twist).max() < 0.01
    assert np.abs(np.array(robot.truth().pose) - before).max() < 1e-4
    assert robot.wheel_odometry().pose == odometry


def test_hard_stop_does_not_nod() -> None:
    robot = SimulatedRobot(HALL)
    for direction in (1, -1):
        drive(robot, direction * 0.3, 0.0, 1.0)
        for _ in range(25):
            robot.command(0.0, 0.0)
            robot.step(PERIOD)
            x, y, _, _ = robot.imu().orientation
            assert 2 * math.hypot(x, y) < math.radians(0.2)


def test_pillar_stops_it_and_counts_once_per_touch() -> None:
    robot = SimulatedRobot(HALL)
    robot.place((2.4, 0.0, 0.0))
    drive(robot, 0.2, 0.0, 3.0)
    assert robot.truth().pose[0] == pytest.approx(3.0 - 0.15 - 0.10, abs=0.005)
    assert robot.truth().twist[0] == pytest.approx(0.0, abs=0.01)
    assert robot.contacts == 1
    drive(robot, -0.2, 0.0, 1.0)
    assert robot.contacts == 1
    drive(robot, 0.2, 0.0, 2.0)
    assert robot.contacts == 2


def test_wall_stops_it() -> None:
    robot = SimulatedRobot(HALL)
    robot.place((0.0, 4.5, math.pi / 2))
    drive(robot, 0.3, 0.0, 3.0)
    assert robot.truth().pose[1] == pytest.approx(4.9, abs=0.005)
    assert robot.contacts == 1


def test_passing_close_is_no_contact() -> None:
    robot = SimulatedRobot(HALL)
    robot.place((2.0, 0.27, 0.0))
    drive(robot, 0.3, 0.0, 6.0)
    assert robot.truth().pose[0] > 3.5
    assert robot.contacts == 0


def test_starts_where_the_world_says_without_touching_anything() -> None:
    for name in world_names():
        place = world(name)
        robot = SimulatedRobot(place)
        robot.step(0.5)
        np.testing.assert_allclose(robot.truth().pose, place.start, atol=1e-3)
        assert robot.contacts == 0


def test_same_seed_repeats_the_run_and_another_does_not() -> None:
    def run(seed: int) -> list[float]:
        robot = SimulatedRobot(world("hexagon"), seed)
        drive(robot, 0.2, 0.3, 2.0)
        return [*robot.filtered().pose, *robot.wheel_odometry().pose, *robot.scan().tolist()]

    assert run(3) == run(3)
    assert run(3) != run(4)


def test_time_adds_up_whatever_the_steps() -> None:
    robot = SimulatedRobot(HALL)
    for _ in range(300):
        robot.step(1 / 300)
    assert robot.time == pytest.approx(1.0, abs=0.002)
    with pytest.raises(ValueError, match=r"dt is -1.0; give a finite time"):
        robot.step(-1.0)
