"""Sensors and wheels that lie do so as named: by so much, so late, and never for good."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from kompass.simulation.faults.robot_faults import SLIP, RobotFaults
from kompass.simulation.physics.parts import NoReading
from kompass.simulation.physics.robot_model import TURTLEBOT3
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.registry import world
from kompass.simulation.worlds.shapes import Box
from kompass.simulation.worlds.world import World
from tests.simulation.hall import HALL, PERIOD, drive

LIDAR = TURTLEBOT3.lidar

# A slab ahead, turned by 45 degrees: what it throws back comes from the left.
CORNER = World(
    name="corner",
    title="A room with a slab across its corner",
    floor=((-1.0, -1.5), (2.0, -1.5), (2.0, 1.5), (-1.0, 1.5)),
    start=(0.0, 0.0, 0.0),
    obstacles=(Box("slab", (1.0, 0.0), (0.6, 0.02), yaw=-math.pi / 4),),
)


def odometry_error(robot: SimulatedRobot) -> tuple[float, float]:
    """How far wheels and truth differ about distance [m] and turn [rad] since the start."""
    wheels, truth = robot.wheel_odometry().pose, robot.truth().pose
    start = robot.world.start
    return (
        math.hypot(*wheels[:2]) - math.dist(truth[:2], start[:2]),
        math.remainder(wheels[2] - (truth[2] - start[2]), math.tau),
    )


def test_with_both_wheels_slipping_the_robot_comes_less_far_than_its_odometry_says() -> None:
    robot = SimulatedRobot(HALL)
    faults = RobotFaults(robot)
    faults.begin("wheel_slip:both")
    drive(robot, 5.0)
    told, moved = robot.wheel_odometry().pose[0], robot.truth().pose[0]
    assert told == pytest.approx(1.0, abs=0.05)
    assert moved == pytest.approx((1.0 - SLIP) * told, rel=0.03)


@pytest.mark.parametrize(("wheel", "turns"), [("left", 1), ("right", -1)])
def test_with_one_wheel_slipping_it_turns_and_does_not_notice(wheel: str, turns: int) -> None:
    robot = SimulatedRobot(HALL)
    RobotFaults(robot).begin(f"wheel_slip:{wheel}")
    drive(robot, 1.0)
    assert turns * robot.truth().pose[2] > 0.3
    assert abs(robot.wheel_odometry().pose[2]) < 0.04


def test_after_the_slip_odometry_is_right_about_every_further_step() -> None:
    robot = SimulatedRobot(HALL)
    faults = RobotFaults(robot)
    faults.begin("wheel_slip:both")
    drive(robot, 2.0)
    robot.step(1.0)
    faults.end("wheel_slip:both")
    (error, turn), at = odometry_error(robot), robot.wheel_odometry().pose
    robot.step(PERIOD)
    assert math.dist(robot.wheel_odometry().pose[:2], at[:2]) < 1e-3, "it does not jump back"
    drive(robot, 2.0)
    later, turned = odometry_error(robot)
    assert (later, turned) == pytest.approx((error, turn), abs=0.01)


def test_a_localizer_that_lost_its_place_is_off_by_the_same_until_it_finds_it_again() -> None:
    robot = SimulatedRobot(world("hexagon"), 3)
    faults = RobotFaults(robot)

    def offset() -> NDArray[np.float64]:
        return np.array(robot.filtered().pose) - robot.truth().pose

    faults.begin("localizer_jump:0.5")
    first = offset()
    assert math.hypot(*first[:2]) == pytest.approx(0.5, abs=0.03)
    drive(robot, 2.0, v=0.1)
    assert offset() == pytest.approx(first, abs=0.04)
    faults.end("localizer_jump:0.5")
    assert offset() == pytest.approx(np.zeros(3), abs=0.03)
    faults.begin("localizer_jump:0.5")
    assert np.abs(offset() - first).max() > 0.1, "the next jump goes elsewhere"


def test_a_drift_grows_with_the_way_and_stands_while_the_robot_stands() -> None:
    robot = SimulatedRobot(HALL)
    faults = RobotFaults(robot)

    def error() -> float:
        return math.dist(robot.filtered().pose[:2], robot.truth().pose[:2])

    faults.begin("localizer_drift:0.5")
    assert error() < 0.03
    for metres in (1, 2):
        drive(robot, 5.0)
        drive(robot, 0.5, v=0.0)
        assert error() == pytest.approx(0.5 * metres, abs=0.04)
        robot.step(5.0)
        assert error() == pytest.approx(0.5 * metres, abs=0.04)
    faults.end("localizer_drift:0.5")
    assert error() < 0.03


def test_noise_scatters_what_is_seen_and_stays_within_what_a_lidar_can_say() -> None:
    robot = SimulatedRobot(world("hexagon"))
    faults = RobotFaults(robot)
    quiet = np.array([robot.scan() for _ in range(30)])
    seen = np.isfinite(quiet).all(axis=0) & (quiet.mean(axis=0) < 3.0) & (quiet.mean(axis=0) > 0.4)
    faults.begin("scan_noise:0.05")
    noisy = np.array([robot.scan() for _ in range(30)])
    assert noisy.dtype == np.float32
    assert noisy[:, seen].std(axis=0).mean() == pytest.approx(0.05, rel=0.1)
    assert noisy[:, seen].mean() == pytest.approx(quiet[:, seen].mean(), abs=0.01)
    faults.begin("scan_noise:1")
    wild = np.array([robot.scan() for _ in range(30)])
    finite = wild[np.isfinite(wild)]
    assert finite.min() > LIDAR.range_min
    assert finite.max() <= LIDAR.range_max
    faults.end("scan_noise:1")
    faults.end("scan_noise:0.05")
    assert robot.scan()[seen].std() == pytest.approx(quiet[0, seen].std(), rel=0.05)


def test_late_scans_are_those_of_then_and_say_so() -> None:
    robot, punctual = (SimulatedRobot(world("hexagon")) for _ in range(2))
    RobotFaults(robot).begin("scan_late:0.3")
    due, come, ages = [], [], []
    for _ in range(12):
        for each in (robot, punctual):
            drive(each, 0.1)
        due.append(punctual.scan())
        try:
            come.append(robot.scan())
            ages.append(robot.scan_age)
        except NoReading:
            assert not come, "once scans come, each turn brings one"
    assert len(come) == 9
    np.testing.assert_array_equal(come, due[:9])
    assert ages == pytest.approx([0.3] * 9)


def test_late_odometry_is_where_the_robot_was_and_says_when() -> None:
    robot, punctual = (SimulatedRobot(HALL) for _ in range(2))
    faults = RobotFaults(robot)
    faults.begin("odometry_late:0.4")
    with pytest.raises(NoReading):
        robot.filtered()
    drive(robot, 1.4)
    drive(punctual, 1.0)
    for late, then in (
        (robot.filtered(), punctual.filtered()),
        (robot.wheel_odometry(), punctual.wheel_odometry()),
    ):
        assert late.pose == then.pose
        assert late.twist == then.twist
        assert late.age == pytest.approx(0.4)
        assert then.age == 0.0
    faults.begin("odometry_late:0.2")
    drive(robot, 0.6)
    assert robot.filtered().age == pytest.approx(0.6), "delays add up"
    faults.end("odometry_late:0.4")
    faults.end("odometry_late:0.2")
    assert robot.filtered().age == 0.0
    assert robot.filtered().pose[0] == pytest.approx(robot.truth().pose[0], abs=0.02)


def test_a_gap_in_the_odometry_comes_late_as_well() -> None:
    robot = SimulatedRobot(HALL)
    faults = RobotFaults(robot)
    faults.begin("odometry_silent")
    faults.begin("odometry_late:0.2")
    drive(robot, 0.5)
    faults.end("odometry_silent")
    drive(robot, 0.1)
    with pytest.raises(NoReading):
        robot.filtered()
    drive(robot, 0.2)
    assert robot.filtered().age == pytest.approx(0.2)


def test_walls_of_glass_are_seen_through_and_stop_the_robot_all_the_same() -> None:
    robot = SimulatedRobot(CORNER)
    faults = RobotFaults(robot)
    assert robot.scan()[0] == pytest.approx(0.986, abs=0.03)
    faults.begin("glass:1")
    assert np.isinf(robot.scan()).all(), "nothing is left that is not of glass"
    drive(robot, 6.0)
    assert robot.contacts == 1
    assert robot.truth().pose[0] < 1.0
    faults.end("glass:1")
    assert np.isfinite(robot.scan()).all()


def test_some_of_the_walls_are_of_glass_and_the_seed_says_which() -> None:
    def blind(seed: int) -> NDArray[np.bool_]:
        robot = SimulatedRobot(CORNER, seed)
        RobotFaults(robot).begin("glass:0.4")
        return np.isinf(robot.scan())

    shares = [blind(seed).mean() for seed in range(8)]
    assert all(share < 0.9 for share in shares)
    assert max(shares) > 0.2
    assert np.array_equal(blind(1), blind(1))
    assert len(set(shares)) > 2


def test_a_mirror_shows_what_stands_beside_it() -> None:
    robot = SimulatedRobot(CORNER)
    faults = RobotFaults(robot)
    slab = robot.scan()[0]
    robot.set_surfaces((), ("slab",))
    wall = 1.5  # from the middle of the slab, across the way
    assert robot.scan()[0] == pytest.approx(slab + wall, abs=0.03)
    robot.set_surfaces((), ())
    assert robot.scan()[0] == pytest.approx(slab, abs=0.03)
    faults.begin("mirrors:1")
    before = robot.scan()
    faults.end("mirrors:1")
    after = robot.scan()
    assert (before > after - 0.05).all(), "a mirror never shows less than the way to it"
    assert (before > after + 0.5).mean() > 0.8


def test_an_odometry_that_was_silent_freezes_on_what_it_says_next() -> None:
    robot = SimulatedRobot(HALL)
    faults = RobotFaults(robot)
    faults.begin("odometry_silent")
    faults.begin("odometry_frozen")
    drive(robot, 1.0)
    faults.end("odometry_silent")
    kept = robot.filtered().pose
    assert kept[0] > 0.1
    drive(robot, 1.0)
    assert robot.filtered().pose == kept


def test_a_frozen_scan_stays_frozen_when_another_fault_ends() -> None:
    robot = SimulatedRobot(world("hexagon"))
    faults = RobotFaults(robot)
    faults.begin("lidar_unplugged")
    faults.begin("scan_noise:0.1")
    faults.end("lidar_unplugged")
    faults.begin("scan_frozen")
    frozen = robot.scan()
    drive(robot, 1.0)
    faults.end("scan_noise:0.1")
    assert np.array_equal(robot.scan(), frozen)


def told(robot: SimulatedRobot, dx: float = 0.0, dy: float = 0.0, turn: float = 0.0) -> None:
    """A person says where the robot is, and is wrong by so much."""
    x, y, yaw = robot.truth().pose
    robot.relocate((x + dx, y + dy, yaw + turn))


def off(robot: SimulatedRobot) -> NDArray[np.float64]:
    """What the localizer is wrong by."""
    x, y, yaw = np.array(robot.filtered().pose) - robot.truth().pose
    return np.array([x, y, math.remainder(yaw, math.tau)])


@pytest.mark.parametrize("fault", ["localizer_jump:0.5", "localizer_drift:0.5"])
def test_a_localizer_that_is_lost_is_found_by_who_says_where_the_robot_is(fault: str) -> None:
    robot = SimulatedRobot(HALL, 3)
    faults = RobotFaults(robot)
    faults.begin(fault)
    drive(robot, 5.0)
    drive(robot, 0.5, v=0.0)
    assert math.hypot(*off(robot)[:2]) > 0.4
    told(robot, 0.1, -0.05, 0.05)
    assert off(robot) == pytest.approx([0.1, -0.05, 0.05], abs=1e-6), "as the person was wrong"
    robot.step(2.0)
    assert off(robot) == pytest.approx([0.1, -0.05, 0.05], abs=0.04)
    faults.end(fault)
    assert off(robot) == pytest.approx(np.zeros(3), abs=0.03), "the fault takes all with it"


def test_a_drift_goes_on_from_where_it_was_put_right() -> None:
    robot = SimulatedRobot(HALL)
    faults = RobotFaults(robot)
    faults.begin("localizer_drift:0.5")
    drive(robot, 5.0)
    told(robot)
    drive(robot, 5.0)
    assert math.hypot(*off(robot)[:2]) == pytest.approx(0.5, abs=0.05)


def test_a_sound_localizer_believes_who_is_wrong_and_is_lost_by_that() -> None:
    robot = SimulatedRobot(HALL)
    told(robot, 1.0, 0.0, math.pi)
    drive(robot, 5.0)
    assert abs(off(robot)[2]) == pytest.approx(math.pi, abs=0.03)
    assert off(robot)[:2] == pytest.approx([1.0, 0.0], abs=0.03)
    told(robot)
    assert off(robot) == pytest.approx(np.zeros(3), abs=1e-6)


def test_a_frozen_localizer_is_told_behind_its_back_and_a_silent_one_hears_it_too() -> None:
    for fault in ("odometry_frozen", "odometry_silent", "odometry_late:1"):
        robot = SimulatedRobot(HALL)
        faults = RobotFaults(robot)
        faults.begin(fault)
        robot.step(0.1)
        told(robot, 0.5)
        faults.end(fault)
        assert off(robot) == pytest.approx([0.5, 0.0, 0.0], abs=0.03), fault
