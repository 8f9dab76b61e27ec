import math

import numpy as np
import pytest

from kompass.algorithms.following.point_field import PointField, Singles
from kompass.algorithms.geometry import Floats

RESOLUTION = 0.04
LOW, HIGH = (-1.0, -2.0), (3.0, 2.0)
CENTRES = np.array([[0.2, 0.1], [0.2, -0.1], [-0.2, 0.1], [-0.2, -0.1]], dtype=np.float32)


def places(count: int, low: float, high: float, seed: int = 1) -> tuple[Singles, Singles]:
    x, y = np.random.default_rng(seed).uniform(low, high, (2, count)).astype(np.float32)
    return x, y


def one(value: float) -> Singles:
    return np.array([value], dtype=np.float32)


def some_points(count: int = 40) -> Floats:
    return np.random.default_rng(2).uniform(LOW, HIGH, (count, 2))


def test_it_is_as_far_as_to_the_nearest_point_to_a_cell() -> None:
    points = some_points()
    field = PointField(points, LOW, HIGH, RESOLUTION)
    x, y = places(2000, -0.9, 1.9)
    expected = np.hypot(x[:, None] - points[:, 0], y[:, None] - points[:, 1]).min(axis=1)
    assert np.abs(field.at(x, y) - expected).max() < RESOLUTION
    # Away from a point, where the field has no corner, by far less.
    assert np.median(np.abs(field.at(x, y) - expected)) < 0.02 * RESOLUTION


def test_places_may_have_any_shape() -> None:
    field = PointField(some_points(), LOW, HIGH, RESOLUTION)
    x, y = places(60, -0.9, 1.9)
    square = field.at(x.reshape(3, 20), y.reshape(3, 20))
    assert square.shape == (3, 20)
    assert np.array_equal(square.ravel(), field.at(x, y))


def test_beyond_the_border_it_is_as_at_the_border() -> None:
    field = PointField(np.array([[2.0, 0.0]]), LOW, HIGH, RESOLUTION)
    far, near = (field.at(one(x), one(0.0))[0] for x in (50.0, 3.0))
    assert far == near == pytest.approx(1.0, abs=RESOLUTION)


def test_of_a_body_the_centre_that_is_nearest_to_a_point_counts() -> None:
    field = PointField(some_points(), LOW, HIGH, RESOLUTION)
    x, y = places(500, -0.7, 1.7)
    yaw, _ = places(500, -math.pi, math.pi, seed=3)
    cos, sin = np.cos(yaw), np.sin(yaw)
    each = [field.at(x + px * cos - py * sin, y + px * sin + py * cos) for px, py in CENTRES]
    assert field.least(x, y, cos, sin, CENTRES) == pytest.approx(np.min(each, axis=0), abs=1e-4)


def test_a_body_that_sticks_out_over_the_border_is_seen_just_within_it() -> None:
    field = PointField(np.array([[2.9, 0.0]]), LOW, HIGH, RESOLUTION)
    y, cos, sin = one(0.0), one(1.0), one(0.0)
    seen = field.least(one(40.0), y, cos, sin, CENTRES)
    within = field.least(one(3.0 - math.hypot(0.2, 0.1)), y, cos, sin, CENTRES)
    assert seen == pytest.approx(within, abs=RESOLUTION)


def test_which_point_is_the_nearest_is_told_to_a_cell() -> None:
    points = some_points()
    field = PointField(points, LOW, HIGH, RESOLUTION)
    x, y = places(500, -0.9, 1.9)
    away = np.hypot(x[:, None] - points[:, 0], y[:, None] - points[:, 1])
    told = away[np.arange(500), field.index(x, y)]
    assert (told - away.min(axis=1)).max() < 2.0 * RESOLUTION


def test_without_points_everywhere_is_far_from_any() -> None:
    field = PointField(np.empty((0, 2)), LOW, HIGH, RESOLUTION)
    assert field.at(*places(10, -0.9, 1.9)).min() >= 8.0
