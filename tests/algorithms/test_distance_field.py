import math

import numpy as np
import pytest
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from kompass.algorithms.distance_field import DistanceField
from kompass.algorithms.geometry import transform_points
from kompass.algorithms.grid import Grid
from tests.support.properties import property_test

from .worlds import brute_force_distance, empty

maps = arrays(np.int8, (9, 11), elements=st.sampled_from([0, 0, 0, 0, 0, 0, 0, 100]))


@property_test(maps, st.integers(0, 2**31), many=60)
def test_it_never_overstates_and_hardly_understates(cells: np.ndarray, seed: int) -> None:
    cells[4, 5] = 100
    field = DistanceField(Grid(cells, 0.1), unknown_is_obstacle=False)
    points = np.random.default_rng(seed).uniform((0, 0), (1.1, 0.9), (200, 2))
    true = brute_force_distance(cells > 0, 0.1, points)
    measured = field.at(points)
    assert (measured <= true + 1e-6).all()
    assert (measured >= true - 0.034).all()


def test_distances_to_a_cell_s_edge_are_exact_at_cells_centres() -> None:
    cells = np.zeros((40, 40), np.int8)
    cells[:, 20] = 100
    field = DistanceField(Grid(cells, 0.05), unknown_is_obstacle=False)
    assert field.at([(0.525, 1.025)])[0] == pytest.approx(0.475, abs=0.001)


@property_test(st.floats(-3, 3), st.integers(0, 2**31), many=20)
def test_a_turned_and_shifted_map_gives_the_same_distances(yaw: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    cells = np.where(rng.random((20, 30)) < 0.1, 100, 0).astype(np.int8)
    points = rng.uniform((0.01, 0.01), (1.49, 0.99), (50, 2))
    plain = DistanceField(Grid(cells, 0.05)).at(points)
    origin = (3.0, -2.0, yaw)
    turned = DistanceField(Grid(cells, 0.05, origin)).at(transform_points(origin, points))
    assert turned == pytest.approx(plain, abs=1e-5)


@property_test(maps, st.floats(-0.2, 1.3), st.floats(-0.2, 1.1), many=30)
def test_the_scalar_look_up_is_the_array_look_up(cells: np.ndarray, x: float, y: float) -> None:
    field = DistanceField(Grid(cells, 0.1))
    assert field.at_xy(x, y) == pytest.approx(field.at([(x, y)])[0], abs=1e-6)


def test_obstacles_and_what_lies_outside_are_at_distance_zero() -> None:
    cells = np.zeros((10, 10), np.int8)
    cells[5, 5] = 100
    for unknown in (True, False):
        field = DistanceField(Grid(cells, 0.1), unknown_is_obstacle=unknown)
        inside_and_out = [(0.55, 0.55), (-0.01, 0.5), (1.01, 0.5), (0.5, 7), (math.nan, 0)]
        assert field.at(inside_and_out).tolist() == [0, 0, 0, 0, 0]
        assert [field.at_xy(x, y) for x, y in inside_and_out] == [0, 0, 0, 0, 0]


def test_unknown_cells_count_only_when_asked() -> None:
    cells = np.zeros((40, 40), np.int8)
    cells[:, 20:] = -1
    grid = Grid(cells, 0.05)
    assert DistanceField(grid, True).at_xy(0.9, 1.0) == pytest.approx(0.1, abs=0.005)
    assert DistanceField(grid, False).at_xy(0.9, 1.0) > 1.0


def test_a_map_without_obstacles_is_free_everywhere() -> None:
    field = DistanceField(empty(border=False), unknown_is_obstacle=False)
    assert field.at([(5, 5), (0.01, 0.01), (9.99, 9.99)]).min() >= 10.0
    assert field.segment_clear(0.1, 0.1, 9.9, 9.9, 1.0)


@property_test(maps, st.integers(0, 2**31), st.floats(0.02, 0.25), many=40)
def test_motions_are_clear_exactly_when_every_point_on_them_is(
    cells: np.ndarray, seed: int, required: float
) -> None:
    field = DistanceField(Grid(cells, 0.1))
    ends = np.random.default_rng(seed).uniform((0, 0), (1.1, 0.9), (40, 2, 2))
    at_once = field.segments_clear(ends[:, 0], ends[:, 1], required)
    for (a, b), clear in zip(ends, at_once, strict=True):
        share = np.linspace(0, 1, 400)[:, None]
        lowest = field.at(a + (b - a) * share).min()
        # Between two looks at most a quarter cell apart the distance may dip by an eighth.
        assert clear <= (lowest >= required - 0.0125)
        assert clear >= (lowest >= required)
        assert clear == field.segment_clear(a[0], a[1], b[0], b[1], required)
