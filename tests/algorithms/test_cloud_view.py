"""What a cloud shows counts where the robot would meet it, and goes when it was looked through."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from kompass.algorithms.grid import OCCUPIED
from kompass.algorithms.mapping.cloud_memory import CloudMemory
from kompass.algorithms.mapping.cloud_view import CELL, REACH, CloudView, HeightBand
from kompass.algorithms.mapping.world_model import WorldModel
from kompass.algorithms.transforms import matrix_of

BAND = HeightBand(0.05, 0.4)
HERE = (0.0, 0.0, 0.0)
EYE = 0.3  # m above the floor
Points = NDArray[np.float64]

lengths = st.one_of(st.floats(-9, 9, width=32), st.sampled_from([math.nan, math.inf, -math.inf]))
quaternions = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: math.hypot(*q) > 0.1)


def view(points: Points, height: float = EYE, band: HeightBand = BAND) -> CloudView:
    """Of points (N, 3) in the robot's frame, seen from a sensor above its axis."""
    mounted = matrix_of((0.0, 0.0, height), (0.0, 0.0, 0.0, 1.0))
    return CloudView((points - (0.0, 0.0, height)).T.astype(np.float32), mounted, band)


def looked_at(box: tuple[float, float, float] | None = None) -> Points:
    """What a camera ahead sees of the floor, and of a box from (near, far) x, half a metre across,
    as high as the third."""
    bearings = np.radians(np.arange(-40.0, 40.0, 0.5))
    downs = np.radians(np.arange(2.0, 50.0, 0.5))
    bearing, down = (each.ravel() for each in np.meshgrid(bearings, downs))
    ray = np.stack(
        [np.cos(down) * np.cos(bearing), np.cos(down) * np.sin(bearing), -np.sin(down)], axis=1
    )
    way = EYE / np.sin(down)
    if box is not None:
        near, far, top = box
        with np.errstate(divide="ignore"):
            front, above = near / ray[:, 0], (EYE - top) / np.sin(down)
        for reach in (front, above):
            x, y, z = (reach[:, None] * ray).T + np.array([[0.0], [0.0], [EYE]])
            on = (x >= near - 1e-9) & (x <= far) & (np.abs(y) < 0.25) & (z <= top + 1e-9)
            way = np.where(on & (reach < way), reach, way)
    return np.asarray(way[:, None] * ray + (0.0, 0.0, EYE))


@given(
    st.lists(st.tuples(lengths, lengths, lengths), max_size=60),
    st.tuples(*[st.floats(-1, 1)] * 3),
    quaternions,
)
@settings(max_examples=150, deadline=None)
def test_each_point_in_the_band_is_shown_by_one_that_is_near_it_and_nothing_else_is(
    points: list[tuple[float, float, float]],
    place: tuple[float, float, float],
    turned: tuple[float, float, float, float],
) -> None:
    cloud = np.array(points, dtype=np.float32).reshape(-1, 3)
    mounted = matrix_of(place, turned)
    shown = CloudView(cloud.T, mounted, BAND)
    finite = cloud[np.isfinite(cloud).all(axis=1)].astype(np.float64)
    placed = finite @ mounted[:3, :3].T + mounted[:3, 3]
    slack = 1e-4  # of float32
    edge = np.abs(placed[:, 2, None] - np.array(BAND)).min(axis=1, initial=9.0) < slack
    reached = (np.abs(placed[:, :2]) < REACH - slack).all(axis=1)
    barring = (placed[:, 2] > BAND.low) & (placed[:, 2] < BAND.high) & reached & ~edge
    assert shown.measured == len(finite)
    for point in placed[barring]:
        away = np.hypot(*(shown.points - point[:2]).T)
        assert away.min() < CELL * math.sqrt(2.0) + slack
    for point, bottom, top in zip(shown.points, shown.bottoms, shown.tops, strict=True):
        assert np.hypot(*(placed[:, :2] - point).T).min() < slack
        assert BAND.low - slack <= bottom <= top <= BAND.high + slack


def test_of_a_cell_the_nearest_to_the_robot_counts() -> None:
    shown = view(np.array([[1.04, 0.01, 0.2], [1.01, 0.01, 0.1], [1.03, 0.02, 0.3]]))
    assert shown.points == pytest.approx(np.array([[1.01, 0.01]]), abs=1e-6)
    assert (shown.bottoms[0], shown.tops[0]) == pytest.approx((0.1, 0.3), abs=1e-6)


def test_a_tilted_camera_sees_the_floor_as_the_floor() -> None:
    down = math.radians(30.0)
    mounted = matrix_of((0.1, 0.0, EYE), (0.0, math.sin(down / 2), 0.0, math.cos(down / 2)))
    floor = looked_at()
    in_camera = (np.linalg.inv(mounted) @ np.c_[floor, np.ones(len(floor))].T)[:3]
    assert not len(CloudView(in_camera.astype(np.float32), mounted, BAND).points)


def test_no_points_show_nothing_and_look_through_nothing() -> None:
    nothing = view(np.empty((0, 3)))
    assert nothing.measured == 0
    assert nothing.points.shape == (0, 2)
    at, low, high = np.array([[1.0, 0.0]]), np.array([0.0]), np.array([0.3])
    assert not nothing.sees_through(at, low, high).any()


def test_a_huge_cloud_shows_no_more_than_there_are_cells() -> None:
    random = np.random.default_rng(0)
    points = random.uniform((-6.0, -6.0, -0.5), (6.0, 6.0, 1.0), (300_000, 3))
    assert len(view(points).points) <= (2 * REACH / CELL) ** 2


# -- what is remembered --------------------------------------------------------------------------


def model_with_a_box() -> WorldModel:
    model = WorldModel()
    model.look(view(looked_at((1.5, 1.8, 0.15))), HERE, 0.0, "camera")
    return model


def stands(model: WorldModel, x: float = 1.52, y: float = 0.0) -> bool:
    grid = model.grid(0.0)
    ((col, row),) = grid.world_to_cell([[x, y]])
    return bool(grid.cells[row, col] == OCCUPIED)


def test_a_low_box_is_marked_and_the_floor_is_not() -> None:
    model = model_with_a_box()
    assert stands(model)
    rows, cols = np.nonzero(model.obstacles(0.0))
    x, y = model.grid(0.0).cell_to_world(np.stack([cols, rows], axis=1)).T
    assert ((x > 1.4) & (x < 1.9) & (np.abs(y) < 0.35)).all()


def test_a_lidar_that_looks_over_it_does_not_clear_it() -> None:
    model = model_with_a_box()
    free = np.full(360, np.inf)
    for _ in range(30):
        model.see(free, 0.0, math.tau / 360, 0.1, 5.0, HERE, 0.0, 0.3)
    assert stands(model)


def test_the_camera_clears_it_once_it_has_gone_and_only_then() -> None:
    model = model_with_a_box()
    for _ in range(10):
        model.look(view(looked_at((1.5, 1.8, 0.15))), HERE, 0.0, "camera")
    assert stands(model)
    looks = 0
    while model.obstacles(0.0).any():
        assert model.look(view(looked_at()), HERE, 0.0, "camera").marked.shape == (0, 2)
        looks += 1
        assert looks <= 9


def test_a_camera_that_has_come_near_and_looks_over_it_keeps_it() -> None:
    model = model_with_a_box()
    near = looked_at()
    # From 1.4 m on the camera sees what is behind: the lines pass over the box, at 15 cm and more.
    passes = EYE * (1.0 - 1.9 / np.maximum(np.hypot(near[:, 0], near[:, 1]), 1e-6))
    over = view(near[passes > 0.16])
    for _ in range(30):
        model.look(over, HERE, 0.0, "camera")
    assert stands(model)


def test_what_a_camera_turns_away_from_is_kept_as_long_as_the_memory() -> None:
    model = WorldModel(memory=60.0)
    model.look(view(looked_at((1.5, 1.8, 0.15))), HERE, 0.0, "camera")
    for now in (10.0, 50.0):
        model.look(view(looked_at()), (0.0, 0.0, math.pi), now, "camera")
        assert model.obstacles(now).any()
    assert not model.obstacles(61.0).any()


def test_what_was_seen_stays_when_a_map_comes_and_when_the_model_grows() -> None:
    model = model_with_a_box()
    model.include([(-9.0, -9.0)], 1.0)
    assert stands(model)
    for _ in range(9):
        model.look(view(looked_at()), HERE, 0.0, "camera")
    assert not model.obstacles(0.0).any()  # its heights have moved with it


def test_beside_the_robot_it_is_remembered_until_it_is_looked_through() -> None:
    memory = CloudMemory(0.1, 20.0)
    memory.see(view(looked_at((1.0, 1.3, 0.15))), HERE, 0.0)
    assert len(memory.points(0.0))
    turned = (0.0, 0.0, math.pi)
    for now in (1.0, 5.0, 19.0):
        memory.see(view(looked_at()), turned, now)
        assert len(memory.points(now))
    before = len(memory.points(19.0))
    memory.see(view(looked_at()), HERE, 19.5)
    assert len(memory.points(19.5)) == before  # one look may be a flicker
    memory.see(view(looked_at()), HERE, 19.6)
    assert not len(memory.points(19.6))


def test_after_its_time_it_is_forgotten_and_what_is_far_is_not_remembered() -> None:
    memory = CloudMemory(0.1, 20.0)
    memory.see(view(looked_at((1.0, 1.3, 0.15))), HERE, 0.0)
    assert not len(memory.points(20.1))
    far = CloudMemory(0.1, 20.0)
    far.see(view(looked_at((2.5, 2.8, 0.15))), HERE, 0.0)
    assert not len(far.points(0.0))


def test_nothing_is_remembered_where_the_robot_stands_itself() -> None:
    memory = CloudMemory(0.2, 20.0)
    memory.see(view(np.array([[0.5, 0.0, 0.1]])), HERE, 0.0)
    assert len(memory.points(0.0)) == 1
    memory.see(view(np.empty((0, 3))), (0.45, 0.0, 0.0), 1.0)
    assert not len(memory.points(1.0))
