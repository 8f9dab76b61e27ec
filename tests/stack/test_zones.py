"""Zones on a whole robot in virtual time: kept out of, slower in, at once and after a restart."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from kompass_interfaces.srv import ChangeZones, CheckGoal
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import String

from kompass.components.base.convert import grid_of
from kompass.components.drive.zones_file import load_zones
from kompass.places.map_identity import identify
from kompass.zones.change import DeleteZone, EditZone, RestoreZone, SaveZone, ZoneChange
from kompass.zones.in_force import CREEP, Outlines
from kompass.zones.zone import Corner, Zone, ZoneBook, ZonePlan, ZonesNow
from tests.support.client import LATCHED
from tests.support.hand import Hand
from tests.support.tester import pose
from tests.support.virtual_robot import VirtualRobot

SUCCEEDED = 4
RADIUS = 0.105  # m, of the robot
SLACK = 0.03  # m; edges are points, and what is seen of the robot is a step old
# Across the straight way from the start to the goal, between two rows of pillars.
ACROSS = ((-1.4, -0.8), (-0.9, -0.8), (-0.9, -0.25), (-1.4, -0.25))
BEYOND = (-0.3, -0.55)


class ZonedRobot(VirtualRobot):
    """A robot, and what is done with its zones."""

    def __init__(self) -> None:
        super().__init__(remembers=True)
        self.subscribe(OccupancyGrid, "/map", LATCHED)
        self.subscribe(String, "/zones", LATCHED)
        self.subscribe(String, "/monitor/zones", LATCHED)
        self.ready()
        self.wait_until(lambda: "/map" in self.newest, 10, "the map")
        self.map = identify(grid_of(self.newest["/map"]))

    def asks(self, change: ZoneChange, role: str = "operator") -> Any:
        """The answer to a change."""
        request = ChangeZones.Request(change=change.model_dump_json(), author="ava", role=role)
        return self.call(ChangeZones, "/monitor/change_zones", request)

    def change(self, change: ZoneChange) -> Zone:
        answer = self.asks(change)
        assert answer.success, answer.message
        return Zone.model_validate_json(answer.answer)

    def plan(self, corners: tuple[Corner, ...] = ACROSS, **fields: object) -> ZonePlan:
        given = {"name": "Wet floor", "kind": "keep_out", "map": self.map, "corners": corners}
        return ZonePlan.model_validate(given | fields)

    def zone(self, corners: tuple[Corner, ...] = ACROSS, **fields: object) -> Zone:
        return self.change(SaveZone(plan=self.plan(corners, **fields)))

    @property
    def in_force(self) -> list[str]:
        """What counts, as everybody is told."""
        told = ZonesNow.model_validate_json(self.newest["/zones"].data)
        return [zone.name for zone in told.zones]

    def looks_at(self, x: float, y: float) -> CheckGoal.Response:
        request = CheckGoal.Request(goal=pose(x, y, 0.0))
        return self.call(CheckGoal, "/planner/check_goal", request)

    @property
    def file(self) -> Path:
        """Where the drive manager keeps what is in force."""
        return next(iter(self.folder.rglob("zones-drive_manager.json")), self.folder / "none")

    @property
    def kept(self) -> list[str]:
        """What is in that file; nothing where it cannot be read."""
        try:
            told = load_zones(self.file)
        except ValueError:
            return []
        return [] if told is None else [zone.name for zone in told.zones]

    def is_held_at_the_zone(self) -> None:
        """Drive it towards the zone by hand, until the gate holds it there."""
        ava = Hand(self, "ava")
        self.wait_until(lambda: ava.ask().success, 20, "the wheel")
        ava.take()
        self.rest(0.5)
        ava.vx = 0.2
        self.wait_until(
            lambda: self.newest["/drive_state"].limited_by == "keep-out zone", 20, "its edge"
        )

    def clearance(self, corners: tuple[Corner, ...] = ACROSS) -> float:
        """Between the body and a polygon [m]."""
        return float(Outlines([corners]).distance(*self.truth[:2])[0]) - RADIUS


@pytest.fixture
def robot() -> Iterator[ZonedRobot]:
    with closing(ZonedRobot()) as client:
        yield client


def least_clearance(robot: ZonedRobot, handle: Any) -> float:
    """Between body and zone on the way to a goal, which must be reached [m]."""
    least = [math.inf]

    def look() -> bool:
        least[0] = min(least[0], robot.clearance())
        return math.dist(robot.truth[:2], BEYOND) < 0.1

    robot.wait_until(look, 120, "the robot behind the zone")
    ended = robot.result(handle, timeout=30)
    assert ended.status == SUCCEEDED, ended.result.message
    return least[0]


def test_it_drives_round_a_keep_out_zone(robot: ZonedRobot) -> None:
    robot.zone()
    assert least_clearance(robot, robot.send_goal(*BEYOND)) > 0.0
    assert robot.contacts == 0


def test_a_zone_that_is_drawn_before_it_while_it_drives_is_driven_round(robot: ZonedRobot) -> None:
    handle = robot.send_goal(*BEYOND)
    robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
    robot.zone()
    assert least_clearance(robot, handle) > -SLACK


def test_a_goal_in_a_zone_is_refused_by_its_name_and_taken_when_it_is_deleted(
    robot: ZonedRobot,
) -> None:
    zone = robot.zone()
    refused = robot.looks_at(-1.15, -0.5)
    assert not refused.reachable
    assert "inside the keep-out zone 'Wet floor'" in refused.message
    assert refused.has_nearest
    robot.change(DeleteZone(id=zone.id, version=zone.version))
    assert robot.looks_at(-1.15, -0.5).reachable
    robot.change(RestoreZone(id=zone.id))
    assert not robot.looks_at(-1.15, -0.5).reachable


def test_no_hand_drives_it_in_and_whoever_is_in_is_driven_out_slowly(robot: ZonedRobot) -> None:
    robot.zone()
    ava = Hand(robot, "ava")
    ava.take()
    robot.rest(0.5)
    ava.vx = 0.2
    robot.wait_until(
        lambda: robot.newest["/drive_state"].limited_by == "keep-out zone", 20, "the zone's edge"
    )
    zone = Outlines([ACROSS])
    least = min(float(zone.distance(*at[:2])[0]) for at in robot.watch(5.0)) - RADIUS
    assert -SLACK < least < 0.3
    ava.vx = -0.2
    robot.wait_until(lambda: robot.clearance() > 0.3, 20, "a way back")
    ava.vx = 0.0
    robot.rest(1.0)

    x, y, _ = robot.truth
    around = ((x - 0.5, y - 0.5), (x + 0.5, y - 0.5), (x + 0.5, y + 0.5), (x - 0.5, y + 0.5))
    robot.zone(around, name="Around it")
    refused = robot.looks_at(0.5, 0.5)
    assert "The robot is inside the keep-out zone 'Around it'; drive it away by hand." in (
        refused.message
    )
    ava.vx = 0.26
    robot.wait_until(lambda: robot.speed > 0.5 * CREEP, 5, "motion")
    speeds = []
    for _ in range(20):
        robot.rest(0.05)
        speeds.append(robot.speed)
    assert max(speeds) < CREEP + 0.02


def test_in_a_speed_zone_it_is_slower_from_its_edge_on(robot: ZonedRobot) -> None:
    robot.zone(kind="speed", speed=0.1)
    handle = robot.send_goal(*BEYOND)
    inside: list[float] = []

    def look() -> bool:
        if robot.clearance() < -0.02:
            inside.append(robot.speed)
        return math.dist(robot.truth[:2], BEYOND) < 0.1

    robot.wait_until(look, 120, "the robot behind the zone")
    assert robot.result(handle, timeout=30).status == SUCCEEDED
    assert len(inside) > 20
    assert max(inside) < 0.12


def test_a_drive_manager_comes_up_with_the_zones_though_the_monitor_is_dead(
    robot: ZonedRobot,
) -> None:
    robot.zone()
    robot.wait_until(lambda: robot.kept == ["Wet floor"], 10, "the drive manager's file")
    robot.stack.stop("monitor")
    robot.stack.kill("drive_manager")
    robot.is_held_at_the_zone()


def test_a_drive_manager_whose_file_is_damaged_says_so_and_writes_what_it_hears(
    robot: ZonedRobot,
) -> None:
    robot.zone()
    robot.wait_until(lambda: robot.kept == ["Wet floor"], 10, "the drive manager's file")
    robot.file.write_text("{")
    robot.stack.kill("drive_manager")
    robot.wait_for_line("zones-drive_manager.json is damaged", 10)
    robot.wait_until(lambda: robot.kept == ["Wet floor"], 10, "a file that can be read")
    robot.is_held_at_the_zone()


def test_zones_that_were_lost_stay_in_force_until_somebody_draws_one(robot: ZonedRobot) -> None:
    robot.zone()
    robot.stack.stop("monitor")
    (store,) = robot.folder.rglob("zones.db")
    store.write_bytes(b"no database")
    for left in store.parent.glob("zones.db-*"):
        left.unlink()
    for problem in ("damaged", ""):  # its second start finds an empty store, and nothing wrong
        robot.newest.pop("/monitor/zones")
        robot.stack.kill("monitor")
        robot.wait_until(lambda: "/monitor/zones" in robot.newest, 30, "a new monitor")
        told = ZoneBook.model_validate_json(robot.newest["/monitor/zones"].data)
        assert problem in told.problem
        assert bool(told.problem) == bool(problem)
        robot.rest(12.0)  # longer than it waits for a map
        assert not robot.looks_at(-1.15, -0.5).reachable
    far = ((1.5, 1.5), (1.7, 1.5), (1.7, 1.7))
    robot.zone(far, name="Far away")
    robot.wait_until(lambda: robot.in_force == ["Far away"], 5, "the new ones")
    assert robot.looks_at(-1.15, -0.5).reachable


def test_who_looks_at_the_zones_is_told_of_both_files_that_cannot_be_read(
    robot: ZonedRobot,
) -> None:
    robot.zone()
    robot.wait_until(lambda: robot.kept == ["Wet floor"], 10, "the drive manager's file")
    robot.stack.stop("monitor")
    (store,) = robot.folder.rglob("zones.db")
    store.write_bytes(b"no database")
    for left in store.parent.glob("zones.db-*"):
        left.unlink()
    robot.file.write_text("{")
    for named in ("zones.db was damaged", ""):  # the drive manager's file is so after that, too
        robot.newest.pop("/monitor/zones")
        robot.stack.kill("monitor")
        robot.wait_until(lambda: "/monitor/zones" in robot.newest, 30, "a new monitor")
        told = ZoneBook.model_validate_json(robot.newest["/monitor/zones"].data)
        assert named in told.problem
        assert "zones-drive_manager.json is damaged" in told.problem
        assert "draw them again" in told.problem
    robot.zone()
    robot.wait_until(lambda: robot.kept == ["Wet floor"], 10, "a file that can be read")
    told = ZoneBook.model_validate_json(robot.newest["/monitor/zones"].data)
    assert not told.problem


def test_a_monitor_that_starts_again_keeps_them_in_force(robot: ZonedRobot) -> None:
    robot.zone()
    robot.rest(1.0)
    robot.newest.pop("/zones")
    robot.stack.kill("monitor")
    robot.wait_until(lambda: "/zones" in robot.newest, 30, "zones from the new monitor")
    assert robot.in_force == ["Wet floor"]
    assert not robot.looks_at(-1.15, -0.5).reachable


def test_zones_of_a_folder_that_cannot_be_written_hold_and_cannot_be_changed(
    robot: ZonedRobot,
) -> None:
    robot.zone()
    robot.wait_until(lambda: robot.kept == ["Wet floor"], 10, "the drive manager's file")
    robot.stack.stop("monitor")
    (lock,) = robot.folder.rglob("zones.lock")
    lock.unlink()
    lock.mkdir()  # not even the superuser opens it for writing
    robot.file.unlink()
    robot.newest.clear()
    robot.stack.kill("monitor")
    robot.wait_until(lambda: "/zones" in robot.newest, 30, "zones from the new monitor")
    assert robot.in_force == ["Wet floor"]
    told = ZoneBook.model_validate_json(robot.newest["/monitor/zones"].data)
    assert [zone.name for zone in told.zones] == ["Wet floor"]
    assert not told.available
    assert "cannot write" in told.problem
    assert "hold" in told.problem
    robot.wait_until(lambda: not robot.looks_at(-1.15, -0.5).reachable, 10, "the planner's no")
    assert "cannot write" in robot.asks(DeleteZone(id=1, version=1)).message


def test_who_is_no_operator_changes_none_and_none_is_of_another_map(robot: ZonedRobot) -> None:
    zone = robot.zone()
    assert "viewer" in robot.asks(DeleteZone(id=1, version=1), role="viewer").message
    other = robot.map.model_copy(update={"id": "0" * 32})
    robot.wait_until(lambda: robot.in_force == ["Wet floor"], 5, "zones")
    stray = robot.asks(EditZone(id=zone.id, version=1, plan=robot.plan(map=other)))
    assert "another map" in stray.message
    assert robot.in_force == ["Wet floor"]


def test_zones_that_close_every_way_are_named(robot: ZonedRobot) -> None:
    # From wall to wall, between the robot and all the rest.
    robot.zone(((-1.5, -1.9), (-1.35, -1.9), (-1.35, 1.9), (-1.5, 1.9)), name="Night shift")
    robot.wait_until(lambda: not robot.looks_at(*BEYOND).reachable, 10, "no way there")
    told = robot.looks_at(*BEYOND).message
    assert "No way leads" in told
    assert told.endswith("Keep-out zones close it: 'Night shift'.")
