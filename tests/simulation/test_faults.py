"""Faults break the robot as named, overlap, and leave nothing behind when they end."""

import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from kompass.simulation.faults.fault_manager import FaultManager, FaultRefused, NotYet
from kompass.simulation.faults.fault_names import (
    FAULTS,
    FaultOrder,
    UnknownFault,
    check_fault,
    parse_fault,
    parse_faults,
    withholds_map,
)
from kompass.simulation.faults.fault_parameters import PARAMETERS
from kompass.simulation.faults.robot_faults import RobotFaults
from kompass.simulation.physics.parts import NoReading
from kompass.simulation.physics.robot_model import TURTLEBOT3, TURTLEBOT3_PLUS
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.registry import world
from tests.simulation.hall import PERIOD, drive


@pytest.fixture
def robot() -> SimulatedRobot:
    return SimulatedRobot(world("hexagon"))


@pytest.fixture
def faults(robot: SimulatedRobot) -> RobotFaults:
    return RobotFaults(robot)


def test_an_unplugged_lidar_says_nothing_until_it_is_plugged_in_again(
    robot: SimulatedRobot, faults: RobotFaults
) -> None:
    faults.begin("lidar_unplugged")
    with pytest.raises(NoReading):
        robot.scan()
    faults.end("lidar_unplugged")
    assert robot.scan().shape == (360,)


def test_a_frozen_scan_stays_the_same_while_the_robot_moves(
    robot: SimulatedRobot, faults: RobotFaults
) -> None:
    faults.begin("scan_frozen")
    first = robot.scan()
    drive(robot, 1.0)
    assert np.array_equal(robot.scan(), first)
    faults.end("scan_frozen")
    assert not np.array_equal(robot.scan(), first)


def test_a_halved_rate_leaves_out_every_other_scan(
    robot: SimulatedRobot, faults: RobotFaults
) -> None:
    faults.begin("scan_rate_halved")
    said = []
    for _ in range(6):
        try:
            robot.scan()
            said.append(True)
        except NoReading:
            said.append(False)
    assert said == [True, False] * 3


def test_frozen_odometry_repeats_itself_and_jumps_to_the_truth_at_its_end(
    robot: SimulatedRobot, faults: RobotFaults
) -> None:
    before = robot.filtered().pose
    rolled = robot.wheel_odometry().pose
    faults.begin("odometry_frozen")
    drive(robot, 1.0)
    assert robot.filtered().pose == before
    assert robot.wheel_odometry().pose == rolled
    faults.end("odometry_frozen")
    assert math.dist(robot.filtered().pose[:2], robot.truth().pose[:2]) < 0.02
    assert robot.wheel_odometry().pose[0] > 0.1


def test_silent_odometry_says_nothing(robot: SimulatedRobot, faults: RobotFaults) -> None:
    faults.begin("odometry_silent")
    with pytest.raises(NoReading):
        robot.filtered()
    with pytest.raises(NoReading):
        robot.wheel_odometry()


def test_with_a_blocked_wheel_the_robot_turns_about_it(
    robot: SimulatedRobot, faults: RobotFaults
) -> None:
    faults.begin("wheel_blocked")
    drive(robot, 1.0)
    assert robot.truth().pose[2] > 0.5
    faults.end("wheel_blocked")
    drive(robot, 1.0)
    assert robot.truth().twist[0] == pytest.approx(0.2, abs=0.02)


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.0])
def test_a_boxed_in_robot_sees_walls_all_around_and_gets_nowhere(
    robot: SimulatedRobot, faults: RobotFaults, yaw: float
) -> None:
    x, y, _ = robot.truth().pose
    robot.place((x, y, yaw))
    free = robot.scan()
    faults.begin("boxed_in")
    robot.step(PERIOD)
    assert robot.contacts == 0
    assert robot.scan().max() < 0.25
    drive(robot, 2.0)
    assert math.dist(robot.truth().pose[:2], (x, y)) < 0.08
    faults.end("boxed_in")
    robot.place((x, y, yaw))
    after = robot.scan()
    assert np.array_equal(np.isinf(after), np.isinf(free))


def test_a_wall_across_the_way_stands_ahead_and_nowhere_else(
    robot: SimulatedRobot, faults: RobotFaults
) -> None:
    drive(robot, 1.0)
    faults.begin("way_blocked")
    ranges = robot.scan()
    assert ranges[0] == pytest.approx(0.25, abs=0.03)
    assert ranges[180] > 0.5
    faults.end("way_blocked")
    assert robot.scan()[0] > 1.0


def test_a_low_box_is_for_robots_that_have_a_camera(
    robot: SimulatedRobot, faults: RobotFaults
) -> None:
    with pytest.raises(UnknownFault, match=r"robot turtlebot3 has no camera.*take.*-plus"):
        faults.begin("low_box")
    assert faults.active == ()
    with pytest.raises(UnknownFault, match="turtlebot3 has no camera"):
        parse_faults(["low_box:2"], world("hexagon"), TURTLEBOT3)
    assert parse_faults(["low_box:2"], world("hexagon"), TURTLEBOT3_PLUS)
    seeing = SimulatedRobot(world("hexagon"), kind=TURTLEBOT3_PLUS)
    assert seeing.camera is not None

    def low() -> int:
        """Points that are nearer than the floor would be, along the middle of the image."""
        assert seeing.camera is not None
        return int((np.nan_to_num(seeing.camera.points()[:, 36, 0], nan=9.0) < before).sum())

    before = np.nan_to_num(seeing.camera.points()[:, 36, 0], nan=9.0) - 0.03
    scan = seeing.scan()
    broken = RobotFaults(seeing)
    broken.begin("low_box")
    assert low() >= 3
    assert seeing.scan() == pytest.approx(scan, abs=0.05)  # looks over it
    broken.end("low_box")
    assert low() == 0


def test_faults_overlap_and_end_in_any_order(robot: SimulatedRobot, faults: RobotFaults) -> None:
    for name in ("scan_frozen", "lidar_unplugged", "scan_rate_halved", "wheel_blocked"):
        faults.begin(name)
    with pytest.raises(NoReading):
        robot.scan()
    faults.end("lidar_unplugged")
    assert np.array_equal(robot_next(robot), robot_next(robot)), "it is still frozen"
    faults.end("scan_frozen")
    faults.end("scan_rate_halved")
    faults.end("wheel_blocked")
    assert faults.active == ()
    sound = SimulatedRobot(world("hexagon"))
    assert [type(part) for part in (robot.lidar, robot.drive, robot.localizer, robot.wheels)] == [
        type(part) for part in (sound.lidar, sound.drive, sound.localizer, sound.wheels)
    ]


def robot_next(robot: SimulatedRobot) -> np.ndarray:
    """The next scan that is not left out."""
    while True:
        try:
            return robot.scan()
        except NoReading:
            continue


class LateFaults:
    """Faults of a target that shows up late."""

    def __init__(self) -> None:
        self.there = False
        self.begun: list[str] = []
        self.switched_off: list[str] = []
        self.over: list[str] = []

    def knows(self, name: str) -> bool:
        return name.startswith(("stop:", "kill:"))

    def begin(self, name: str) -> bool:
        if not self.there:
            raise NotYet("no such process")
        self.begun.append(name)
        return name.startswith("stop:")

    def end(self, name: str) -> None:
        self.switched_off.append(name)

    def ended(self) -> Iterable[str]:
        return self.over


def manager(
    robot: SimulatedRobot, *orders: FaultOrder
) -> tuple[FaultManager, LateFaults, list[tuple[str, ...]]]:
    told: list[tuple[str, ...]] = []
    late = LateFaults()
    return (
        FaultManager([RobotFaults(robot), late], orders, 100.0, told.append),
        late,
        told,
    )


def test_a_fault_with_a_duration_ends_by_itself(robot: SimulatedRobot) -> None:
    made, _, told = manager(robot)
    made.switch("lidar_unplugged", True, 2.0, 100.0)
    made.advance(101.9)
    assert made.active == ("lidar_unplugged",)
    made.advance(102.0)
    assert told == [("lidar_unplugged",), ()]
    robot.scan()


def test_a_parameter_may_be_written_in_more_than_one_way(robot: SimulatedRobot) -> None:
    made, _, told = manager(robot)
    made.switch("scan_noise:0.050", True, 0.0, 100.0)
    made.switch("scan_noise:5e-2", False, 0.0, 101.0)
    assert told == [("scan_noise:0.05",), ()]


def test_a_fault_that_is_ordered_with_a_duration_ends_by_itself(robot: SimulatedRobot) -> None:
    made, _, told = manager(robot, FaultOrder("wheel_blocked", 5.0, 10.0))
    made.advance(105.0)
    made.advance(114.9)
    assert told == [("wheel_blocked",)]
    made.advance(115.0)
    assert told == [("wheel_blocked",), ()]


def test_a_fault_is_ordered_for_later_and_waits_for_its_target(robot: SimulatedRobot) -> None:
    made, late, _ = manager(robot, FaultOrder("wheel_blocked", 5.0), FaultOrder("stop:mapper"))
    made.advance(104.9)
    assert made.active == ()
    late.there = True
    made.advance(105.0)
    assert set(made.active) == {"wheel_blocked", "stop:mapper"}
    made.advance(106.0)
    assert late.begun == ["stop:mapper"]


def test_a_kill_is_over_at_once_and_may_be_repeated(robot: SimulatedRobot) -> None:
    made, late, _ = manager(robot)
    late.there = True
    made.switch("kill:mapper", True, 0.0, 100.0)
    made.switch("kill:mapper", True, 0.0, 101.0)
    assert late.begun == ["kill:mapper"] * 2
    assert made.active == ()


def test_a_fault_that_passes_by_itself_is_told(robot: SimulatedRobot) -> None:
    made, late, told = manager(robot)
    late.there = True
    made.switch("stop:mapper", True, 0.0, 100.0)
    late.over.append("stop:mapper")
    made.advance(101.0)
    assert told[-1] == made.active == ()


def test_nothing_is_left_broken_when_the_simulator_ends(robot: SimulatedRobot) -> None:
    made, late, _ = manager(robot)
    late.there = True
    made.switch("lidar_unplugged", True, 0.0, 100.0)
    made.switch("stop:mapper", True, 0.0, 100.0)
    made.close()
    assert late.switched_off == ["stop:mapper"]
    robot.scan()


@pytest.mark.parametrize("duration", [-1.0, math.nan, math.inf])
def test_a_duration_that_is_no_time_is_refused(robot: SimulatedRobot, duration: float) -> None:
    made, _, _ = manager(robot)
    with pytest.raises(FaultRefused, match="duration"):
        made.switch("lidar_unplugged", True, duration, 100.0)
    assert made.active == ()


@pytest.mark.parametrize(
    ("text", "order"),
    [
        ("lidar_unplugged", FaultOrder("lidar_unplugged")),
        ("lidar_unplugged:2.5", FaultOrder("lidar_unplugged", 2.5)),
        ("kill:mapper", FaultOrder("kill:mapper")),
        ("stop:mapper:20", FaultOrder("stop:mapper", 20.0)),
        ("stop:mapper:20:5", FaultOrder("stop:mapper", 20.0, 5.0)),
        ("boxed_in:60:60", FaultOrder("boxed_in", 60.0, 60.0)),
        ("map_withheld:0:9", FaultOrder("map_withheld", 0.0, 9.0)),
        ("scan_noise:0.050", FaultOrder("scan_noise:0.05")),
        ("scan_noise:0.05:20", FaultOrder("scan_noise:0.05", 20.0)),
        ("scan_late:1:20:5", FaultOrder("scan_late:1", 20.0, 5.0)),
        ("wheel_slip:both:20", FaultOrder("wheel_slip:both", 20.0)),
        ("door_closed:kitchen:20:5", FaultOrder("door_closed:kitchen", 20.0, 5.0)),
    ],
)
def test_an_order_is_a_name_and_perhaps_times(text: str, order: FaultOrder) -> None:
    assert parse_fault(text) == order


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("lidar_unpluged", "did you mean 'lidar_unplugged'?"),
        ("unplugged", "did you mean 'lidar_unplugged'?"),
        ("nothing like it", "known are lidar_unplugged"),
        ("kill", "kill:mapper"),
        ("stop:", "stop:mapper"),
        ("boxed_in:-1", "0 or more"),
        ("boxed_in:inf", "0 or more"),
        ("boxed_in:1:-1", "-1 s is no time; give seconds of 0 or more"),
        ("boxed_in:1:2:3", "there is no fault 'boxed_in:1'"),
        ("map_withheld:5", "leave out 5"),
        ("kill:mapper:1:5", "it is over at once; leave out 5"),
        ("stop:20", "20 names no process; write for example stop:mapper"),
        ("scan_noise", "needs METRES behind a colon; write for example scan_noise:0.05"),
        ("scan_noise:", "needs METRES behind a colon"),
        ("scan_noise:20", "20 is out of range; give metres (standard deviation), above 0 and up"),
        ("scan_noise:nan", "above 0 and up to 1"),
        ("scan_noise:much", "'much' is no number; give metres"),
        ("scan_noise:0.05:20:5:1", "'0.05:20' is no number"),
        ("glass:30", "give a share of the walls, above 0 and up to 1"),
        ("scan_late:0", "give seconds, above 0 and up to 10"),
        ("wheel_slip:20", "'20' is no wheel; choose of left, right, both"),
        ("wheel_slip:lefft", "did you mean 'left'?"),
        ("door_closed:kitchn", "did you mean 'kitchen'?"),
        ("person_ahead:1:2:3", "there is no fault 'person_ahead:1'"),
    ],
)
def test_an_order_that_cannot_be_read_names_the_remedy(text: str, hint: str) -> None:
    with pytest.raises(UnknownFault) as refusal:
        parse_fault(text)
    assert hint in str(refusal.value)


def test_every_fault_can_be_ordered_and_is_known_to_somebody(robot: SimulatedRobot) -> None:
    known = RobotFaults(robot)
    elsewhere = {"map_withheld", "start_occupied", "stop", "kill"}
    for shown in FAULTS:
        kind, colon, _ = shown.partition(":")
        assert bool(colon) == (kind in PARAMETERS), "a parameter is shown in capitals"
        name = f"{kind}:{PARAMETERS[kind].example}" if colon else kind
        assert check_fault(name) == name
        assert known.knows(name) == (kind not in elsewhere)
    assert withholds_map([FaultOrder("boxed_in"), FaultOrder("map_withheld")])
    assert not withholds_map([FaultOrder("boxed_in")])


def test_a_door_that_the_world_does_not_have_is_refused_before_the_start() -> None:
    order = ["door_closed:kitchen:20"]
    assert parse_faults(order, world("apartment"), TURTLEBOT3) == [
        FaultOrder("door_closed:kitchen", 20.0)
    ]
    with pytest.raises(UnknownFault, match="'hexagon' has no doorway 'kitchen'; take a world that"):
        parse_faults(order, world("hexagon"), TURTLEBOT3)


def test_the_recipes_tell_newcomers_of_every_fault() -> None:
    text = (Path(__file__).parents[2] / "recipes" / "README.md").read_text()
    assert [name for name in FAULTS if f"`{name}`" not in text] == []
