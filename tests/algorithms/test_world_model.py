"""What is seen is marked, what rays pass through is cleared, and the map stays what it is."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.geometry import transform_points
from kompass.algorithms.grid import FREE, OCCUPIED, Grid
from kompass.algorithms.mapping.world_model import (
    HIT,
    MISS,
    MOST_OCCUPIED,
    Change,
    TooFar,
    WorldModel,
    pose_at,
)

RAYS, STEP = 180, math.tau / 180
HERE = (0.0, 0.0, 0.0)
Pose = tuple[float, float, float]
poses = st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.floats(-4, 4))
scans = st.lists(
    st.one_of(st.floats(0.2, 6.0), st.just(math.inf), st.just(math.nan), st.just(-math.inf)),
    min_size=RAYS,
    max_size=RAYS,
)


def look(model: WorldModel, ranges: ArrayLike, pose: Pose = HERE, now: float = 0.0) -> Change:
    return model.see(np.asarray(ranges, dtype=float), 0.0, STEP, 0.1, 5.0, pose, now)


def ends(ranges: NDArray[np.float64], pose: Pose, farthest: float = 5.0) -> NDArray[np.float64]:
    real = np.flatnonzero((ranges >= 0.1) & (ranges < farthest))
    r, angle = ranges[real], STEP * real
    return transform_points(pose, np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1))


def occupied(model: WorldModel, points: ArrayLike, now: float = 0.0) -> NDArray[np.bool_]:
    grid = model.grid(now)
    cols, rows = grid.world_to_cell(points).T
    return np.asarray(grid.cells[rows, cols] == OCCUPIED)


def ring(radius: float) -> NDArray[np.float64]:
    return np.full(RAYS, radius)


@given(scans, poses)
@settings(max_examples=60, deadline=None)
def test_wherever_a_ray_ends_there_is_an_obstacle(values: list[float], pose: Pose) -> None:
    ranges, model = np.array(values), WorldModel()
    change = look(model, ranges, pose)
    places = ends(ranges, pose)
    if len(places):
        assert occupied(model, places).all()
    # And nowhere else: each cell that is told of holds an end.
    cells = {tuple(cell) for cell in model.grid(0.0).world_to_cell(places)}
    told = {tuple(cell) for cell in model.grid(0.0).world_to_cell(change.marked)}
    assert told == cells


@given(scans, scans, poses)
@settings(max_examples=60, deadline=None)
def test_a_second_scan_clears_nothing_that_it_sees_or_that_lies_behind(
    first: list[float], second: list[float], pose: Pose
) -> None:
    model, seen = WorldModel(), np.array(second)
    look(model, first, pose)
    before = model.obstacles(0.0)
    look(model, second, pose)
    if len(ends(seen, pose)):
        assert occupied(model, ends(seen, pose)).all()
    cleared = before & ~model.obstacles(0.0)
    rows, cols = np.nonzero(cleared)
    gone = model.grid(0.0).cell_to_world(np.stack([cols, rows], axis=1))
    away = gone - pose[:2]
    ray = np.round((np.arctan2(away[:, 1], away[:, 0]) - pose[2]) / STEP).astype(int) % RAYS
    reaches = np.where(seen >= 5.0, 5.0, np.where(np.isfinite(seen), seen, 0.0))
    assert (np.hypot(away[:, 0], away[:, 1]) < reaches[ray]).all()


@pytest.mark.parametrize("nothing", [math.nan, 0.0, -math.inf, 0.05])
def test_a_reading_that_says_nothing_changes_nothing(nothing: float) -> None:
    model = WorldModel()
    look(model, ring(2.0))
    before = model.grid(0.0).cells
    for _ in range(50):
        change = look(model, ring(nothing))
        assert not len(change.marked)
        assert not change.cleared
    assert (model.grid(0.0).cells == before).all()


@pytest.mark.parametrize("stood", [1, 3, 1000])
def test_what_has_gone_is_cleared_in_a_second_however_long_it_stood(stood: int) -> None:
    model = WorldModel()
    for _ in range(stood):
        look(model, ring(2.0))
    scans = 0
    while occupied(model, ends(ring(2.0), HERE)).any():
        look(model, ring(math.inf))
        scans += 1
        assert scans <= math.ceil(MOST_OCCUPIED / -MISS)
    # And what comes back is there at once.
    look(model, ring(2.0))
    assert occupied(model, ends(ring(2.0), HERE)).all()


def test_one_stray_reading_does_not_outlast_three_scans() -> None:
    model, stray = WorldModel(), ring(math.inf)
    stray[10] = 1.5
    look(model, stray)
    assert occupied(model, ends(stray, HERE)).all()
    for _ in range(math.ceil(HIT / -MISS)):
        look(model, ring(math.inf))
    assert not model.obstacles(0.0).any()


def test_a_wall_is_not_cleared_by_rays_that_graze_it() -> None:
    model = WorldModel()
    wall = np.stack([np.arange(-1.0, 3.0, 0.02), np.full(200, 0.325)], axis=1)
    angles = STEP * np.arange(RAYS)
    with np.errstate(divide="ignore"):
        ranges = np.where(np.sin(angles) > 1e-6, 0.325 / np.sin(angles), math.inf)
    for tick in range(40):  # along it, at 0.3 m/s, until all of it was near
        look(model, ranges, (-1.0 + 0.1 * tick, 0.0, 0.0), 0.1 * tick)
    seen = occupied(model, wall)
    for tick in range(60):  # and away from it
        look(model, ranges, (3.0 + 0.05 * tick, 0.0, 0.0), 4.0 + 0.1 * tick)
    assert seen.mean() > 0.95
    assert occupied(model, wall[seen]).mean() > 0.95


def test_what_nobody_looks_at_is_forgotten_after_its_time() -> None:
    model = WorldModel(memory=60.0)
    look(model, ring(2.0), now=100.0)
    assert occupied(model, ends(ring(2.0), HERE), now=160.0).all()
    assert not model.obstacles(160.1).any()
    # What is looked at again begins anew.
    look(model, ring(2.0), now=200.0)
    look(model, ring(2.0), now=250.0)
    assert occupied(model, ends(ring(2.0), HERE), now=305.0).all()


def walled_map(yaw: float = 0.0) -> Grid:
    cells = np.full((120, 120), FREE, dtype=np.int8)
    cells[:, 80:84] = OCCUPIED
    cells[:10] = -1
    origin = transform_points((0.0, 0.0, yaw), [(-3.0, -3.0)])[0]
    return Grid(cells, 0.05, (float(origin[0]), float(origin[1]), yaw))


def test_what_the_map_has_stays_whatever_rays_say() -> None:
    model, given_map = WorldModel(memory=1.0), walled_map()
    model.set_map(given_map)
    assert (model.grid(0.0).cells == given_map.cells).all()
    look(model, ring(1.5))
    assert (model.grid(0.0).cells != given_map.cells).any()
    for _ in range(20):
        look(model, ring(math.inf))
    assert (model.grid(0.0).cells == given_map.cells).all()


def test_a_map_that_comes_later_keeps_what_was_seen_on_it() -> None:
    model = WorldModel()
    look(model, ring(1.52))
    model.set_map(walled_map(yaw=0.5))
    near = model.grid(0.0)
    rows, cols = np.nonzero(model.obstacles(0.0))
    places = near.cell_to_world(np.stack([cols, rows], axis=1))
    assert np.hypot(places[:, 0], places[:, 1]) == pytest.approx(1.52, abs=0.1)
    assert len(places) > 100


@given(st.floats(-3.1, 3.1))
@settings(max_examples=30, deadline=None)
def test_a_turned_map_shows_the_same_obstacles_in_the_world(yaw: float) -> None:
    model = WorldModel()
    model.set_map(walled_map(yaw))
    look(model, ring(1.52), (0.2, -0.1, 0.7))
    assert occupied(model, ends(ring(1.52), (0.2, -0.1, 0.7))).all()
    for _ in range(10):
        look(model, ring(2.4), (0.2, -0.1, 0.7))
    seen = model.obstacles(0.0)
    rows, cols = np.nonzero(seen)
    places = model.grid(0.0).cell_to_world(np.stack([cols, rows], axis=1)) - (0.2, -0.1)
    assert (np.hypot(places[:, 0], places[:, 1]) > 2.3).all()


def test_without_a_map_it_grows_and_keeps_what_it_knows() -> None:
    model = WorldModel()
    look(model, ring(1.52))
    model.include([(-7.3, 4.1), (9.0, -2.0)], 1.0)
    assert occupied(model, ends(ring(1.52), HERE)).all()
    assert model.grid(0.0).contains([(-8.2, 5.0), (9.9, -2.9)]).all()
    with pytest.raises(TooFar, match="more than 4000000 cells"):
        model.include([(5000.0, 5000.0)], 1.0)
    assert occupied(model, ends(ring(1.52), HERE)).all()


@pytest.mark.parametrize(
    ("settings_", "said"),
    [
        ({"reach": 0.0}, "reach: 0.0 m; give a finite number above 0"),
        ({"memory": -1.0}, "memory: -1.0 s; give a finite number above 0"),
        ({"resolution": math.nan}, "resolution: nan m"),
    ],
)
def test_what_cannot_be_meant_is_refused(settings_: dict[str, float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        WorldModel(**settings_)


def test_a_pose_between_two_is_found_the_short_way_round() -> None:
    x, y, yaw = pose_at(10.25, (10.0, (0.0, 0.0, 3.0)), (10.5, (1.0, 2.0, -3.0)))
    assert (x, y) == (0.5, 1.0)
    assert abs(yaw) == pytest.approx(math.pi)
    assert pose_at(9.0, (10.0, (1.0, 0.0, 0.0)), (11.0, (2.0, 0.0, 0.0))) == (1.0, 0.0, 0.0)


def test_what_is_out_of_sight_is_forgotten_on_request_and_what_is_in_sight_is_not() -> None:
    model = WorldModel()
    behind = np.full(RAYS, math.inf)
    behind[80:100] = 1.0
    look(model, behind, now=0.0)
    ahead = np.full(RAYS, math.nan)  # nothing looks behind any more
    ahead[:5] = 1.0
    look(model, ahead, now=10.0)
    seen, ages, known = model.near((0.0, 0.0), 3.0, now=10.0)
    assert len(known) == 0
    assert sorted(set(ages.round(1))) == [0.0, 10.0]
    assert model.grid(10.0, seen_within=1.0).occupied().sum() == (ages < 1.0).sum()
    assert model.forget(1.0, now=10.0) == (ages > 1.0).sum() > 0
    left, ages, _ = model.near((0.0, 0.0), 3.0, now=10.0)
    assert (left[:, 0] > 0.9).all()
    assert len(left) < len(seen)
    assert (ages < 1.0).all()


def test_near_a_place_the_map_and_what_was_seen_are_told_apart() -> None:
    model = WorldModel()
    cells = np.full((40, 40), FREE, dtype=np.int8)
    cells[20, 38] = OCCUPIED
    model.set_map(Grid(cells, 0.05, (-1.0, -1.0, 0.0)))
    ranges = np.full(RAYS, math.inf)
    ranges[45] = 0.5  # to the left
    look(model, ranges)
    seen, _, known = model.near((0.0, 0.0), 2.0, now=0.0)
    assert known == pytest.approx(np.array([[0.925, 0.025]]))
    assert np.hypot(*(seen - (0.0, 0.5)).T).max() < 0.06
    assert len(model.near((0.0, 0.0), 0.2, now=0.0)[2]) == 0
    assert [len(part) for part in model.near((90.0, 0.0), 2.0, now=0.0)] == [0, 0, 0]


@pytest.mark.parametrize("yaw", [0.0, 0.7])
@pytest.mark.parametrize("with_map", [True, False])
def test_what_is_around_a_place_is_the_same_piece_of_the_whole(yaw: float, with_map: bool) -> None:
    model = WorldModel(memory=10.0)
    if with_map:
        cells = np.zeros((200, 300), dtype=np.int8)
        cells[::17, ::13] = OCCUPIED
        cells[50:60] = -1
        model.set_map(Grid(cells, 0.05, (-4.0, -3.0, yaw)))
    look(model, np.full(RAYS, 2.0), HERE, now=0.0)
    look(model, np.full(RAYS, 1.0), (2.0, 1.0, 0.3), now=9.0)
    for now in (9.0, 15.0):
        for place in ((0.0, 0.0), (2.5, 1.0), (-3.9, -2.5)):
            piece = model.grid_around(place, 1.5, now)
            whole = model.grid(now)
            rows, cols = np.indices(piece.cells.shape)
            centres = piece.cell_to_world(np.stack([cols.ravel(), rows.ravel()], axis=1))
            at = whole.world_to_cell(centres)
            assert (whole.cells[at[:, 1], at[:, 0]] == piece.cells.ravel()).all()
            assert piece.contains([place])[0] == whole.contains([place])[0]


def test_around_a_place_that_it_does_not_have_there_is_nothing() -> None:
    model = WorldModel()
    model.set_map(Grid(np.zeros((20, 20), dtype=np.int8), 0.05))
    with pytest.raises(ValueError, match="is no map"):
        model.grid_around((50.0, 0.0), 1.0, 0.0)
