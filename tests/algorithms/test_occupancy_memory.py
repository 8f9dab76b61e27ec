"""What was seen stays where it was, however the robot turns and moves, until it is seen gone."""

import math

import numpy as np
import pytest
from hypothesis import strategies as st
from numpy.typing import NDArray

from kompass.algorithms.geometry import Pose2D, inverse, transform_points
from kompass.algorithms.mapping.local_map import LocalMapBuilder
from kompass.algorithms.mapping.occupancy_memory import OccupancyMemory, SensorModel
from tests.support.properties import property_test

RESOLUTION, SIZE = 0.05, 60
RAYS = 720
POST = (0.6, 0.35)
angles = st.floats(-math.pi, math.pi)
poses = st.tuples(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), angles)


def memory(model: SensorModel | None = None) -> OccupancyMemory:
    return OccupancyMemory(SIZE, SIZE, RESOLUTION, model or SensorModel())


def nothing() -> NDArray[np.int8]:
    """A scan's map of somebody who sees nothing."""
    return np.full((SIZE, SIZE), -1, dtype=np.int8)


def seen(place: tuple[float, float], pose: Pose2D, value: int) -> NDArray[np.int8]:
    """A scan's map with one cell that says something."""
    cells = nothing()
    (x, y), *_ = transform_points(inverse(pose), np.array([place]))
    cells[math.floor(y / RESOLUTION) + SIZE // 2, math.floor(x / RESOLUTION) + SIZE // 2] = value
    return cells


def occupied(cells: NDArray[np.int8], pose: Pose2D) -> NDArray[np.float64]:
    """Where in the world a map has obstacles, (N, 2)."""
    rows, cols = np.nonzero(cells == 100)
    middles = (np.stack([cols, rows], axis=1) + 0.5 - SIZE / 2) * RESOLUTION
    return transform_points(pose, middles)


@property_test(poses, st.lists(poses, min_size=1, max_size=5), many=300)
def test_a_single_cell_is_not_lost_at_any_angle(there: Pose2D, then: list[Pose2D]) -> None:
    known = memory()
    known.take(seen(POST, there, 100), there)
    for pose in then:
        known.take(nothing(), pose)
        found = occupied(known.cells(pose), pose)
        assert len(found)
        # Half a cell's diagonal for each of the three grids that it went through.
        assert np.hypot(*(found - POST).T).max() < 3 * 0.71 * RESOLUTION


@property_test(poses, poses, many=300)
def test_what_is_seen_through_often_enough_is_free(there: Pose2D, pose: Pose2D) -> None:
    known = memory()
    for _ in range(3):
        known.take(seen(POST, there, 100), there)
    for _ in range(6):
        known.take(np.zeros((SIZE, SIZE), dtype=np.int8), pose)
    assert not len(occupied(known.cells(pose), pose))
    assert (known.cells(pose)[1:-1, 1:-1] == 0).all()


def test_a_room_is_as_sharp_after_a_hundred_turns_as_at_first() -> None:
    builder, known = LocalMapBuilder(3.0, 3.0, RESOLUTION), memory()
    chance = np.random.default_rng(3)
    walls = 1.1
    for _ in range(100):
        pose = (*chance.uniform(-0.2, 0.2, 2).tolist(), float(chance.uniform(-math.pi, math.pi)))
        turned = pose[2] + math.tau / RAYS * np.arange(RAYS)
        cos, sin = np.cos(turned), np.sin(turned)
        ranges = np.minimum(
            np.where(cos > 0, walls - pose[0], walls + pose[0]) / np.maximum(np.abs(cos), 1e-9),
            np.where(sin > 0, walls - pose[1], walls + pose[1]) / np.maximum(np.abs(sin), 1e-9),
        )
        known.take(builder.update(ranges, 0.0, math.tau / RAYS, 0.1, 5.0), pose)
        found = known.cells(pose)
        off = np.abs(np.abs(occupied(found, pose)).max(axis=1) - walls)
        assert off.max() < 2 * RESOLUTION
        middles = (np.indices((SIZE, SIZE)).reshape(2, -1)[::-1].T + 0.5 - SIZE / 2) * RESOLUTION
        inside = np.abs(transform_points(pose, middles)).max(axis=1) < walls - 3 * RESOLUTION
        assert (found.ravel()[inside] == 0).all()


def test_what_is_behind_the_robot_is_remembered_and_what_is_far_behind_is_not() -> None:
    known = memory()
    known.take(seen(POST, (0.0, 0.0, 0.0), 100), (0.0, 0.0, 0.0))
    for step in range(100):
        pose = (0.1 * step, 0.0, 0.3 * step)
        known.take(nothing(), pose)
        there = occupied(known.cells(pose), pose)
        if math.dist(pose[:2], POST) < 1.3:
            assert len(there)
    back = (0.0, 0.0, 0.0)
    known.take(nothing(), back)
    assert not len(occupied(known.cells(back), back))


def test_of_what_was_never_seen_nothing_is_known() -> None:
    known = memory()
    known.take(nothing(), (0.0, 0.0, 0.7))
    assert (known.cells((0.1, 0.0, 0.0)) == -1).all()


def test_who_forgets_knows_nothing() -> None:
    known = memory()
    known.take(seen(POST, (0.0, 0.0, 0.0), 100), (0.0, 0.0, 0.0))
    known.forget()
    assert (known.cells((0.0, 0.0, 0.0)) == -1).all()


@pytest.mark.parametrize(
    ("model", "said"),
    [
        ({"p_empty": 0.7}, "p_empty = 0.7, p_prior = 0.6"),
        ({"p_occupied": 0.5}, "p_occupied = 0.5"),
        ({"p_occupied": 1.0}, "p_occupied = 1"),
        ({"p_prior": math.nan}, "p_prior = nan"),
    ],
)
def test_probabilities_out_of_order_are_refused(model: dict[str, float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        SensorModel(**model)
