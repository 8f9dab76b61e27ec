"""What is drawn of a mask covers what it forbids, and no more than that by much."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kompass.zones.in_force import Outlines
from kompass.zones.outline import MOST_CORNERS, outlines


def inside(polygon: np.ndarray, x: float, y: float) -> bool:
    return bool(Outlines([polygon]).inside(x, y)[0])


def test_a_ring_is_drawn_with_its_hole() -> None:
    cells = np.ones((9, 9), dtype=bool)
    cells[3:6, 3:6] = False
    (ring,) = outlines(cells)
    assert inside(ring, 1.5, 1.5)
    assert not inside(ring, 4.5, 4.5)
    assert not inside(ring, 10.0, 4.5)


def test_patches_are_drawn_each_and_a_straight_edge_has_two_corners() -> None:
    cells = np.zeros((20, 30), dtype=bool)
    cells[2:8, 3:20] = True
    cells[12:15, 25:] = True
    large, small = outlines(cells)
    assert sorted(large.tolist()) == [[3, 2], [3, 8], [20, 2], [20, 8]]
    assert sorted(small.tolist()) == [[25, 12], [25, 15], [30, 12], [30, 15]]


@given(st.lists(st.booleans(), min_size=48, max_size=48))
def test_no_drawn_edge_is_farther_from_the_cells_than_one_of_them(drawn: list[bool]) -> None:
    cells = np.array(drawn).reshape(6, 8)
    corners = np.concatenate([np.empty((0, 2)), *outlines(cells)])
    rows, cols = np.nonzero(cells)
    for x, y in corners:
        assert ((np.abs(cols + 0.5 - x) <= 0.5) & (np.abs(rows + 0.5 - y) <= 0.5)).any()


@pytest.mark.parametrize("size", [500, 1500])
def test_a_large_circle_is_drawn_with_few_corners(size: int) -> None:
    rows, cols = np.indices((size, size))
    cells = np.hypot(rows - size / 2, cols - size / 2) < 0.4 * size
    (circle,) = outlines(cells)
    assert len(circle) <= MOST_CORNERS
    away = np.hypot(*(circle - size / 2).T)
    assert np.abs(away - 0.4 * size).max() < 0.02 * size
