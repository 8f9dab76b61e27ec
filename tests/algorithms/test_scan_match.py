"""A scan fits the map where it was made, less the further away, and says so when it cannot."""

from __future__ import annotations

import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kompass.algorithms.geometry import Floats, Pose2D, compose, inverse, transform_points
from kompass.algorithms.grid import OCCUPIED_FROM, Grid
from kompass.algorithms.mapping.scan_match import FEWEST_RAYS, REACH, TURN, ScanMatcher
from tests.algorithms.worlds import empty, hexagon

REACHES = 3.5  # m, of the lidar
ROOM = hexagon()
MATCHER = ScanMatcher(ROOM)
# Between the pillars of the room; none of them stands in a wall.
poses = st.tuples(st.floats(-0.9, 0.9), st.sampled_from([-0.5, 0.5]), st.floats(-3, 3))


def scan(grid: Grid, pose: Pose2D, rays: int = 180) -> Floats:
    """Where rays end, in the sensor's frame: by walking along them, a fifth of a cell at a time."""
    angles = np.arange(rays) * math.tau / rays
    way = np.arange(0.1, REACHES, grid.resolution / 5)
    walked = np.stack(
        [np.cos(angles)[:, None] * way, np.sin(angles)[:, None] * way], axis=-1
    ).reshape(-1, 2)
    cells = grid.world_to_cell(transform_points(pose, walked))
    inside = grid.contains(transform_points(pose, walked))
    col, row = (np.where(inside, each, 0) for each in cells.T)
    hit = ((grid.cells[row, col] >= 65) & inside).reshape(rays, -1)
    seen = hit.any(axis=1)
    r = way[hit.argmax(axis=1)][seen]
    return np.stack([r * np.cos(angles[seen]), r * np.sin(angles[seen])], axis=1)


def agreement(matcher: ScanMatcher, points: Floats, pose: Pose2D) -> float:
    found = matcher.agreement(points, pose)
    assert found is not None
    return found


@given(poses)
@settings(max_examples=40, deadline=None)
def test_where_it_was_made_a_scan_fits_and_half_a_metre_away_it_does_not(pose: Pose2D) -> None:
    points = scan(ROOM, pose)
    there = agreement(MATCHER, points, pose)
    assert there > 0.9
    x, y, yaw = pose
    for direction in np.arange(6) * math.tau / 6:
        elsewhere = (x + 0.5 * math.cos(direction), y + 0.5 * math.sin(direction), yaw)
        assert agreement(MATCHER, points, elsewhere) < min(0.6, there)


@given(poses, st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-0.25, 0.25))
@settings(max_examples=25, deadline=None)
def test_near_the_place_the_best_fit_finds_it(
    pose: Pose2D, dx: float, dy: float, turn: float
) -> None:
    points = scan(ROOM, pose)
    found = MATCHER.fit(points, (pose[0] + dx, pose[1] + dy, pose[2] + turn))
    # The walls of a map are as thick as its cells, and to stand anywhere within that fits as well.
    assert math.dist(found[:2], pose[:2]) < 0.08
    assert abs(math.remainder(found[2] - pose[2], math.tau)) < 0.06
    assert agreement(MATCHER, points, found) > 0.85


@given(poses, st.tuples(st.floats(-20, 20), st.floats(-20, 20), st.floats(-3, 3)))
@settings(max_examples=25, deadline=None)
def test_it_is_the_same_wherever_the_map_lies_in_the_world(pose: Pose2D, moved: Pose2D) -> None:
    points = scan(ROOM, pose)
    origin = tuple(compose(moved, ROOM.origin).tolist())
    elsewhere = ScanMatcher(Grid(ROOM.cells, ROOM.resolution, origin))
    there = compose(moved, pose)
    assert agreement(elsewhere, points, tuple(there.tolist())) == pytest.approx(
        agreement(MATCHER, points, pose), abs=0.02
    )
    near = (pose[0] + 0.2, pose[1] - 0.1, pose[2] + 0.1)
    back = compose(inverse(moved), elsewhere.fit(points, tuple(compose(moved, near).tolist())))
    assert math.dist(back[:2], pose[:2]) < 0.08


@given(poses, poses)
@settings(max_examples=25, deadline=None)
def test_the_best_fit_stays_within_its_reach_and_out_of_obstacles(
    pose: Pose2D, pressed: Pose2D
) -> None:
    """Both are told to people: so far from their hand, and a place that the robot can be at."""
    body = (-0.3, 0.1, 0.5)
    x, y, yaw = found = MATCHER.fit(scan(ROOM, pose), pressed, body)
    assert math.dist((x, y), pressed[:2]) <= REACH + 1e-6
    assert abs(math.remainder(yaw - pressed[2], math.tau)) <= TURN + 1e-6
    [[col, row]] = ROOM.world_to_cell(compose(found, body)[None, :2])
    stood = ROOM.cells[row, col]
    assert stood < OCCUPIED_FROM or found == pytest.approx(pressed), "unless all around is occupied"


def among_others() -> tuple[Grid, list[Pose2D]]:
    """A map with the room in its corner and in its midst, and walls elsewhere; where they lie."""
    cells = np.full((600, 900), -1, dtype=np.int8)
    cells[:, ::50] = 100
    places: list[Pose2D] = []
    for row, col in ((0, 0), (300, 420)):
        cells[row : row + ROOM.height, col : col + ROOM.width] = ROOM.cells
        x, y, yaw = ROOM.origin
        assert yaw == 0.0
        places.append((3.0 - x + col * ROOM.resolution, -2.0 - y + row * ROOM.resolution, 0.0))
    return Grid(cells, ROOM.resolution, (3.0, -2.0, 0.0)), places


@given(st.lists(st.tuples(poses, st.integers(0, 1)), min_size=2, max_size=4))
@settings(max_examples=15, deadline=None)
def test_of_a_large_map_only_the_surroundings_count(asked: list[tuple[Pose2D, int]]) -> None:
    large, places = among_others()
    matcher = ScanMatcher(large)
    for pose, room in asked:
        x, y, yaw = pose
        there = (x + places[room][0], y + places[room][1], yaw)
        points = scan(ROOM, pose)
        assert agreement(matcher, points, there) == pytest.approx(
            agreement(MATCHER, points, pose), abs=0.02
        )
        pressed = (there[0] + 0.2, there[1] - 0.1, yaw + 0.1)
        assert math.dist(matcher.fit(points, pressed)[:2], there[:2]) < 0.08


def test_a_large_map_is_not_read_whole() -> None:
    """Who is mapping sends a new one every few seconds."""
    points = scan(ROOM, (0.5, 0.5, 0.0))
    large = Grid(np.zeros((4000, 4000), dtype=np.int8), 0.05, (-100.0, -100.0, 0.0))
    tracemalloc.start()
    try:
        ScanMatcher(large).fit(points, (0.5, 0.5, 0.0))
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert most < 2 * large.cells.nbytes  # its distances alone would take 16 times as much


def test_what_fits_best_from_within_a_pillar_is_not_the_best_fit() -> None:
    points = scan(ROOM, (0.5, 0.5, 0.0))
    cells = ROOM.cells.copy()
    [[col, row]] = ROOM.world_to_cell(np.array([[0.5, 0.5]]))
    cells[row - 2 : row + 3, col - 2 : col + 3] = 100
    found = ScanMatcher(Grid(cells, ROOM.resolution, ROOM.origin)).fit(points, (0.6, 0.65, 0.0))
    [[col, row]] = ROOM.world_to_cell(np.array([found[:2]]))
    assert cells[row, col] < OCCUPIED_FROM


def test_along_a_corridor_the_best_fit_is_the_nearest() -> None:
    cells = np.zeros((40, 400), dtype=np.int8)
    cells[[0, -1], :] = 100
    corridor = Grid(cells, 0.05)
    points = scan(corridor, (10.0, 1.0, 0.0))
    x, y, yaw = ScanMatcher(corridor).fit(points, (10.3, 1.2, 0.1))
    assert (y, yaw) == pytest.approx((1.0, 0.0), abs=0.06)
    assert x == pytest.approx(10.3, abs=0.11), "nothing tells it apart, so it is not moved"


def test_who_would_have_to_see_through_a_wall_is_not_there() -> None:
    """Each end lies near a wall, as a likelihood field alone would have it."""
    cells = np.zeros((200, 200), dtype=np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[:, 60] = 100  # from 3.0 to 3.05 m
    angles = np.linspace(-0.8, 0.8, 60)
    r = 3.0 / np.cos(angles)  # to a wall 3 m ahead
    points = np.stack([r * np.cos(angles), r * np.sin(angles)], axis=1)
    hall = ScanMatcher(Grid(cells.copy(), 0.05))
    assert agreement(hall, points, (6.95, 5.0, 0.0)) > 0.95
    assert agreement(hall, points, (6.05, 5.0, math.pi)) > 0.95
    cells[:, 40] = 100  # and another one a metre before it
    divided = ScanMatcher(Grid(cells, 0.05))
    assert agreement(hall, points, (0.06, 5.0, 0.0)) > 0.95
    assert agreement(divided, points, (0.06, 5.0, 0.0)) < 0.05


def test_one_person_in_the_scan_takes_no_more_than_his_share() -> None:
    pose = (0.5, 0.5, 0.0)
    points = scan(ROOM, pose)
    before = agreement(MATCHER, points, pose)
    angle = np.arctan2(points[:, 1], points[:, 0])
    person = np.abs(angle - 1.0) < 0.2
    points[person] *= (0.3 / np.hypot(*points[person].T))[:, None]
    assert agreement(MATCHER, points, pose) > before - person.mean() - 0.01


def test_too_few_rays_say_nothing() -> None:
    pose = (0.5, 0.5, 0.0)
    points = scan(ROOM, pose)
    assert MATCHER.agreement(points[: FEWEST_RAYS - 1], pose) is None
    assert MATCHER.agreement(points[:FEWEST_RAYS], pose) is not None
    assert MATCHER.agreement(np.zeros((0, 2)), pose) is None
    assert MATCHER.fit(np.zeros((0, 2)), pose) == pose


def test_what_ends_where_nobody_has_explored_says_nothing() -> None:
    cells = np.full((200, 200), -1, dtype=np.int8)
    cells[50:150, 50:100] = 0
    points = scan(empty(), (5.0, 5.0, 0.0))
    ring = np.stack([np.cos(np.arange(100)), np.sin(np.arange(100))], axis=1) * 3.0
    assert not len(points), "the hall is wider than the lidar sees"
    matcher = ScanMatcher(Grid(cells, 0.05))
    beyond = ring[transform_points((5.0, 5.0, 0.0), ring)[:, 0] > 5.1]
    assert matcher.agreement(beyond, (5.0, 5.0, 0.0)) is None


@pytest.mark.parametrize("pose", [(50.0, 0.0, 0.0), (-2.9, -2.9, 0.3), (0.0, 0.0, 0.0)])
def test_outside_the_map_or_in_a_wall_nothing_fits(pose: Pose2D) -> None:
    """The last one is the middle of a pillar."""
    points = scan(ROOM, (0.5, 0.5, 0.0))
    assert (MATCHER.agreement(points, pose) or 0.0) < 0.4
