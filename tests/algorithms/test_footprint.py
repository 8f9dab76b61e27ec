import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats


def box(length: float, width: float) -> Footprint:
    x, y = length / 2, width / 2
    return Footprint(np.array([[x, y], [-x, y], [-x, -y], [x, -y]]))


sizes = st.floats(0.05, 3.0)
places = st.lists(st.tuples(st.floats(-4, 4), st.floats(-4, 4)), min_size=1, max_size=40)


@given(length=sizes, width=sizes)
def test_the_discs_leave_no_part_of_the_outline_bare(length: float, width: float) -> None:
    body = box(length, width)
    centres, radius = body.discs
    along = np.linspace(0.0, 1.0, 40)[:, None]
    ends = np.roll(body.corners, -1, axis=0)
    outline = np.concatenate([a + along * (b - a) for a, b in zip(body.corners, ends, strict=True)])
    away = np.linalg.norm(outline[:, None] - centres, axis=2).min(axis=1)
    assert away.max() <= radius + 1e-9


def test_the_discs_stick_out_by_less_than_the_circle_does() -> None:
    body = box(0.508, 0.430)
    centres, radius = body.discs
    assert len(centres) <= 12
    assert (np.abs(centres).max(axis=0) + radius <= np.array([0.254, 0.215]) + 0.04).all()


@given(length=sizes, width=sizes, points=places)
def test_the_distance_from_a_box_is_what_geometry_says(
    length: float, width: float, points: list[tuple[float, float]]
) -> None:
    given_points: Floats = np.array(points)
    gap = np.abs(given_points) - (length / 2, width / 2)
    outside = np.hypot(*np.maximum(gap, 0.0).T)
    expected = np.where((gap < 0).all(axis=1), gap.max(axis=1), outside)
    assert box(length, width).distance(given_points) == pytest.approx(expected, abs=1e-9)


def test_circles_around_and_within_are_those_of_the_outline() -> None:
    body = box(0.508, 0.430)
    assert body.radius == pytest.approx(math.hypot(0.254, 0.215))
    assert body.inscribed_radius == pytest.approx(0.215)
    assert Footprint.circle(0.1).radius == pytest.approx(0.1)
    assert len(Footprint.circle(0.1).discs[0]) == 1


@pytest.mark.parametrize(
    ("corners", "what"),
    [
        ([[1, 0], [0, 1]], "at least three"),
        ([[1, 0], [0, 1], [float("nan"), 0]], "finite"),
        ([[1, 1], [1, -1], [-1, -1], [-1, 1]], "anticlockwise"),
        ([[1, 1], [-1, 1], [0, 0.5], [-1, -1], [1, -1]], "convex"),
        ([[2, 1], [1, 1], [1, -1], [2, -1]], "origin must lie inside"),
    ],
)
def test_outlines_that_are_none_are_refused(corners: list[list[float]], what: str) -> None:
    with pytest.raises(ValueError, match=what):
        Footprint(np.array(corners))


def test_a_radius_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="radius: 0"):
        Footprint.circle(0.0)
