"""People step into the way, wait for nobody to be hurt, and go; doors close and open again."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from kompass.simulation.faults.fault_manager import FaultManager, NotYet
from kompass.simulation.faults.fault_names import FaultOrder, UnknownFault
from kompass.simulation.faults.robot_faults import RobotFaults
from kompass.simulation.physics.person import RADIUS, Walk, cross, step_in
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.registry import world, world_names
from kompass.simulation.worlds.shapes import Box
from kompass.simulation.worlds.world import World
from tests.simulation.hall import HALL, PERIOD, drive

CLOSET = World(
    name="closet",
    title="No room for a second one",
    floor=((-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)),
    start=(0.0, 0.0, 0.0),
    obstacles=(),
)
SEEDS = range(6)


def bearings(robot: SimulatedRobot) -> list[int]:
    """The directions in which something is seen, degrees anticlockwise from ahead, -180…179."""
    seen: list[int] = np.flatnonzero(np.isfinite(robot.scan())).tolist()
    return [ray - 360 if ray >= 180 else ray for ray in seen]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_person_steps_in_from_the_side_and_stands_ahead_until_the_fault_ends(seed: int) -> None:
    robot = SimulatedRobot(HALL, seed)
    faults = RobotFaults(robot)
    faults.begin("person_ahead")
    assert min(map(abs, bearings(robot))) > 15, "nobody is suddenly there"
    robot.step(2.0)
    assert 0 in bearings(robot)
    assert 0.45 < robot.scan()[0] < 1.1
    assert max(map(abs, bearings(robot))) < 35, "one person and nothing else"
    robot.step(5.0)
    assert 0 in bearings(robot)
    faults.end("person_ahead")
    assert bearings(robot) == []


def test_who_drives_backwards_has_the_person_behind() -> None:
    robot = SimulatedRobot(HALL)
    drive(robot, 1.0, v=-0.2)
    RobotFaults(robot).begin("person_ahead")
    robot.step(2.0)
    assert all(abs(bearing) > 140 for bearing in bearings(robot))


def test_running_into_a_person_is_counted_apart_from_walls() -> None:
    robot = SimulatedRobot(HALL)
    faults = RobotFaults(robot)
    faults.begin("person_ahead")
    drive(robot, 8.0)
    assert (robot.contacts, robot.person_contacts) == (1, 1)
    assert robot.truth().pose[0] < 1.2, "a person is solid"
    robot.step(1.0)
    robot.place((4.7, 0.0, 0.0))
    drive(robot, 3.0)
    assert (robot.contacts, robot.person_contacts) == (2, 1), (
        "with a person about, a wall is a wall"
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_people_do_not_walk_into_a_robot(seed: int) -> None:
    robot = SimulatedRobot(HALL, seed)
    faults = RobotFaults(robot)
    faults.begin("person_crossing")
    faults.begin("person_ahead")
    ranges = robot.scan()
    nearest = float(ranges.min())
    # Set down where the person is about to pass, in whose way it stands.
    ahead = int(np.argmin(ranges)) * math.tau / 360
    robot.place((nearest * math.cos(ahead), 0.4 * math.copysign(1.0, math.sin(ahead)), 0.0))
    robot.step(8.0)
    assert robot.person_contacts == 0


@pytest.mark.parametrize("seed", SEEDS)
def test_a_person_crosses_from_one_side_to_the_other_and_the_fault_ends_with_that(
    seed: int,
) -> None:
    robot = SimulatedRobot(HALL, seed)
    told: list[tuple[str, ...]] = []
    made = FaultManager(
        [RobotFaults(robot)], [FaultOrder("person_crossing", 1.0)], 0.0, told.append
    )
    sides = []
    for tick in range(500):
        made.advance(tick * PERIOD)
        robot.step(PERIOD)
        seen = bearings(robot)
        sides += [float(np.sign(np.mean(seen)))] if seen else []
    assert told == [("person_crossing",), ()]
    assert sides[0] == -sides[-1] != 0.0
    assert bearings(robot) == []


def test_a_person_who_cannot_get_through_goes_back() -> None:
    robot = SimulatedRobot(HALL)
    faults = RobotFaults(robot)
    faults.begin("person_crossing")
    robot.step(0.5)
    # Stands in the way from here on, wherever in its range the crossing is.
    ray = int(np.argmin(robot.scan()))
    distance, bearing = float(robot.scan()[ray]) + 0.2, ray * math.tau / 360
    robot.place((distance * math.cos(bearing), 0.0, 0.0))
    ended: list[str] = []
    for _ in range(500):
        robot.step(PERIOD)
        ended += faults.ended()
    assert ended == ["person_crossing"]
    assert faults.active == ()
    assert robot.person_contacts == 0
    assert bearings(robot) == []


def test_without_room_for_a_person_nobody_comes_until_there_is() -> None:
    robot = SimulatedRobot(CLOSET)
    faults = RobotFaults(robot)
    for name in ("person_ahead", "person_crossing"):
        with pytest.raises(NotYet, match="no room for a person ahead"):
            faults.begin(name)
    assert faults.active == ()


@pytest.mark.parametrize("find_way", [step_in, cross])
@pytest.mark.parametrize("name", world_names())
def test_people_walk_where_there_is_floor_and_stand_where_the_robot_sees_them(
    name: str, find_way: Callable[..., Walk | None]
) -> None:
    place = world(name)
    found = 0
    for seed in range(40):
        random = np.random.default_rng(seed)
        x, y = random.uniform(place.bounds[:2], place.bounds[2:])
        spot = np.array([[x, y]])
        if not place.on_floor(spot)[0] or place.distance(spot)[0] < 0.15:
            continue
        yaw = random.uniform(0.0, math.tau)
        walk = find_way(place, (x, y, yaw), random)
        if walk is None:
            continue
        found += 1
        way = np.linspace(walk.start, walk.goal, 200)
        assert place.on_floor(way).all()
        assert place.distance(way).min() > RADIUS - 0.02
        ahead = (walk.goal[0] - x) * math.cos(yaw) + (walk.goal[1] - y) * math.sin(yaw)
        assert 0.69 < ahead < 1.21
        path = np.linspace((x, y), (x + ahead * math.cos(yaw), y + ahead * math.sin(yaw)), 200)
        assert place.distance(path).min() > -0.02
    assert found > 5


def test_nobody_comes_behind_a_wall() -> None:
    wall = Box("wall", (0.4, 0.0), (0.1, 9.0))
    halves = World(
        name="halves",
        title="Two halves",
        floor=HALL.floor,
        start=(0.0, 0.0, 0.0),
        obstacles=(wall,),
    )
    for name in ("person_ahead", "person_crossing"):
        with pytest.raises(NotYet, match="no room for a person"):
            RobotFaults(SimulatedRobot(halves)).begin(name)


def test_a_closed_door_is_seen_stops_the_robot_and_opens_again() -> None:
    robot = SimulatedRobot(world("apartment"))
    faults = RobotFaults(robot)
    robot.place((2.45, 3.6, -math.pi / 2))
    open_range = robot.scan()[0]
    faults.begin("door_closed:living")
    assert robot.scan()[0] == pytest.approx(3.6 - 2.87, abs=0.03)
    drive(robot, 5.0)
    assert robot.contacts == 1
    assert robot.person_contacts == 0
    assert robot.truth().pose[1] > 2.9
    faults.end("door_closed:living")
    robot.place((2.45, 3.6, -math.pi / 2))
    assert robot.scan()[0] == pytest.approx(open_range, abs=0.05)
    drive(robot, 7.0)
    assert robot.truth().pose[1] < 2.6


@pytest.mark.parametrize("name", ["living", "kitchen", "bedroom", "study"])
def test_a_closed_door_leaves_no_gap(name: str) -> None:
    place = world("apartment")
    (door,) = (door for door in place.doorways if door.name == name)
    robot = SimulatedRobot(place)
    x, y = door.center
    robot.place((x, y + math.copysign(0.6, 3.6 - y), math.copysign(math.pi / 2, y - 3.6)))
    faults = RobotFaults(robot)
    faults.begin(f"door_closed:{name}")
    beside = [abs(0.6 / math.cos(math.radians(degree))) + 0.1 for degree in range(-35, 36)]
    ahead = np.roll(robot.scan(), 35)[:71]
    assert (ahead < beside).all()


def test_a_door_does_not_close_on_the_robot() -> None:
    robot = SimulatedRobot(world("apartment"))
    faults = RobotFaults(robot)
    robot.place((2.45, 2.85, 0.0))
    with pytest.raises(NotYet, match="stands in the doorway"):
        faults.begin("door_closed:living")
    robot.place((2.45, 3.6, 0.0))
    faults.begin("door_closed:living")
    assert faults.active == ("door_closed:living",)


def test_a_world_without_that_doorway_refuses_to_close_it() -> None:
    faults = RobotFaults(SimulatedRobot(world("hexagon")))
    with pytest.raises(UnknownFault, match="'hexagon' has no doorway 'living'"):
        faults.begin("door_closed:living")
    assert faults.active == ()
