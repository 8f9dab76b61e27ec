"""What is in the way is named: what it is, where, in which direction, how far, since when."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.typing import NDArray

from kompass.algorithms.grid import FREE, OCCUPIED, Grid
from kompass.algorithms.mapping.scan_points import PlacedScan
from kompass.components.planner.hindrance import Hindrance, direction_in_words, find
from kompass.components.planner.live_map import LiveMap
from kompass.zones.in_force import ZonesInForce
from tests.zones.zones import zone

RAYS = 360
HERE = (0.0, 0.0, 0.0)
RADIUS, ROOM = 0.1, 0.05
ROUTE = np.stack([np.linspace(0.0, 2.0, 21), np.zeros(21), np.zeros(21)], axis=1)


def saw(live: LiveMap, ranges: NDArray[np.float64], now: float) -> None:
    """Let a robot that stands in the middle and faces along x take a scan in."""
    stamp = SimpleNamespace(sec=int(now), nanosec=round(1e9 * (now % 1.0)))
    header = SimpleNamespace(stamp=stamp, frame_id="lidar")
    live.wait_with("/scan", SimpleNamespace(header=header))
    scan = PlacedScan.of(ranges, 0.0, math.tau / RAYS, 0.05, 4.0, np.eye(4))
    for topic, message in live.locate(HERE, header):
        live.see(topic, message, lambda _: scan, now)


def disc(x: float, y: float, radius: float = 0.1) -> NDArray[np.float64]:
    """Ranges of a scan that meets a post, and nothing else."""
    away, bearing = math.hypot(x, y), math.atan2(y, x)
    angles = np.arange(RAYS) * math.tau / RAYS
    off = np.abs(np.remainder(angles - bearing + math.pi, math.tau) - math.pi)
    return np.where(off < math.asin(radius / away), away - radius, math.inf)


def found(
    live: LiveMap | None,
    now: float = 0.0,
    *,
    zones: ZonesInForce | None = None,
    held_by: str = "",
    before: Hindrance | None = None,
    route: NDArray[np.float64] = ROUTE,
) -> Hindrance:
    zones = zones or ZonesInForce()
    return find(live, zones, route, HERE, RADIUS, ROOM, held_by, before, now)


def test_what_closes_the_way_far_ahead_is_named_though_nothing_is_near() -> None:
    live = LiveMap(120.0)
    saw(live, disc(3.6, 0.0), 0.0)
    route = np.stack([np.linspace(0.0, 6.0, 61), np.zeros(61), np.zeros(61)], axis=1)
    far = found(live, 0.0, route=route)
    assert far.kind == "seen"
    assert far.place == pytest.approx((3.5, 0.0), abs=0.1)
    assert "m ahead" in far.told(HERE, RADIUS, 0.0)
    assert found(live, 0.0, route=ROUTE).kind == "unknown"


def test_what_the_lidar_sees_on_the_way_is_named_with_place_distance_and_direction() -> None:
    live = LiveMap(120.0)
    saw(live, disc(1.0, 0.05), 0.0)
    first = found(live, 0.0)
    assert first.kind == "seen"
    assert first.place == pytest.approx((0.9, 0.05), abs=0.06)
    later = found(live, 0.5, before=first)
    assert later.since == 0.0
    told = later.told(HERE, RADIUS, 23.0)
    assert told.startswith("In the way: something that the lidar sees at (0.")
    assert "m ahead, for 23 s." in told


def test_what_stands_beside_the_way_is_not_what_is_in_it() -> None:
    live = LiveMap(120.0)
    saw(live, np.minimum(disc(0.5, 0.4), disc(1.0, 0.0)), 0.0)
    assert found(live).place == pytest.approx((0.9, 0.0), abs=0.06)


def test_what_moved_is_told_from_what_stood_there() -> None:
    live = LiveMap(120.0)
    for step in range(20):
        saw(live, disc(1.0, 1.0 - 0.05 * step, 0.15), 0.1 * step)
    came = found(live, 2.0)
    assert came.kind == "moving"
    for step in range(50):  # and stays
        saw(live, disc(1.0, 0.05, 0.15), 2.0 + 0.1 * step)
    stays = found(live, 7.0, before=came)
    assert (stays.kind, stays.since) == ("moving", 2.0)
    assert "something that moved" in stays.told(HERE, RADIUS, 7.0)


def test_what_is_only_remembered_is_told_from_what_is_in_sight() -> None:
    live = LiveMap(120.0)
    saw(live, disc(1.0, 0.0), 0.0)
    saw(live, np.full(RAYS, -math.inf), 30.0)
    there = found(live, 30.0)
    assert there.kind == "remembered"
    assert there.since == pytest.approx(0.0)
    assert "30 s ago" in there.told(HERE, RADIUS, 30.0)


def test_an_obstacle_of_the_map_is_told_as_such_though_the_lidar_sees_it() -> None:
    live = LiveMap(120.0)
    cells = np.full((80, 80), FREE, dtype=np.int8)
    cells[38:42, 58:62] = OCCUPIED  # 1 m ahead
    live.set_map(Grid(cells, 0.05, (-2.0, -2.0, 0.0)))
    saw(live, disc(1.0, 0.0), 0.0)
    assert found(live).kind == "map"


def test_a_keep_out_zone_is_named() -> None:
    corners = ((0.8, -1.0), (1.5, -1.0), (1.5, 1.0), (0.8, 1.0))
    barred = found(None, zones=ZonesInForce((zone(corners=corners, name="stairs"),)))
    assert barred.kind == "keep-out zone"
    assert barred.place == pytest.approx((0.8, 0.0), abs=0.2)
    assert "the keep-out zone 'stairs'" in barred.told(HERE, RADIUS, 0.0)


def test_where_nothing_is_seen_that_is_said_with_the_place_of_the_robot() -> None:
    live = LiveMap(120.0)
    saw(live, np.full(RAYS, math.inf), 0.0)
    nothing = found(live)
    assert (nothing.kind, nothing.place) == ("unknown", (0.0, 0.0))
    assert "wheels and floor" in nothing.told(HERE, RADIUS, 0.0)


def test_what_holds_the_robot_is_told_before_what_is_not_in_its_way() -> None:
    assert found(None, held_by="scan stale").told(HERE, RADIUS, 0.0) == (
        "The drive manager holds the robot back: scan stale. "
        "Nothing is known to be in the way at (0.00, 0.00)."
    )
    assert found(None, held_by="obstacle").told(HERE, RADIUS, 0.0) == (
        "The drive manager holds the robot back: obstacle. What it is is not known yet."
    )
    assert found(None).told(HERE, RADIUS, 0.0).startswith("The planner has no scan to look at. ")


def test_a_robot_that_is_shut_in_hears_so_and_of_one_thing_at_a_time() -> None:
    live = LiveMap(120.0)
    away = np.full(RAYS, 0.30)
    away[::2] += 0.01
    saw(live, away, 0.0)
    saw(live, away, 0.1)
    first = found(live, 0.1, held_by="obstacle", route=np.empty((0, 3)))
    assert first.shut_in
    assert first.told(HERE, RADIUS, 0.1).endswith("Something stands on all sides of the robot.")
    saw(live, away[::-1].copy(), 0.3)
    second = found(live, 0.3, held_by="obstacle", route=np.empty((0, 3)), before=first)
    assert math.dist(first.place, second.place) <= 0.15
    one_side = LiveMap(120.0)
    saw(one_side, disc(0.4, 0.0), 0.0)
    assert not found(one_side, 0.0).shut_in


@pytest.mark.parametrize(
    ("degrees", "words"),
    [
        (0, "ahead"),
        (-29, "ahead"),
        (45, "ahead to the left"),
        (-90, "to the right"),
        (120, "behind to the left"),
        (180, "behind"),
    ],
)
def test_directions_are_told_as_people_say_them(degrees: float, words: str) -> None:
    assert direction_in_words(math.radians(degrees)) == words


@pytest.mark.parametrize("why", ["scan stale", "odometry stale", "second publisher"])
def test_what_stands_near_is_not_blamed_where_the_robot_is_held_for_something_else(
    why: str,
) -> None:
    live = LiveMap(60.0)
    saw(live, disc(0.6, 0.0), 0.0)
    saw(live, disc(0.6, 0.0), 0.1)
    assert found(live, held_by="obstacle").kind == "seen"
    told = found(live, held_by=why)
    assert told.kind == "unknown"
    assert why in told.what
