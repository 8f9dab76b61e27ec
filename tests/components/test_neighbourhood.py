"""A path is cut where it leaves the neighbourhood of the robot."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kompass.components.planner.neighbourhood import cut
from tests.algorithms.worlds import polyline

THERE_AND_BACK = polyline((0, 0), (6, 0), (6, 1), (-6, 1), (-6, 2), (6, 2))


def test_it_ends_where_the_path_first_leaves_it() -> None:
    parts = cut(polyline((0, 0), (10, 0)), (0.0, 0.0, 0.0), 4.0)
    assert parts.near[-1, 0] == pytest.approx(4.0, abs=0.1)
    assert parts.rest[-1, 0] == 10.0
    assert parts.visits == []


def test_each_time_that_the_path_comes_back_is_a_visit() -> None:
    parts = cut(THERE_AND_BACK, (0.0, 0.0, 0.0), 3.0)
    assert [sorted({float(value) for value in piece[:, 1]}) for piece in parts.visits] == [[1], [2]]


def test_of_a_path_that_stays_there_nothing_is_left() -> None:
    parts = cut(polyline((0, 0), (1, 0)), (0.0, 0.0, 0.0), 3.0)
    assert len(parts.near) == 11
    assert len(parts.rest) == 0


@given(st.floats(-7, 7), st.floats(-1, 3), st.floats(0.0, 9.0))
def test_nothing_of_the_path_is_lost_and_none_of_it_is_judged_twice(
    x: float, y: float, radius: float
) -> None:
    parts = cut(THERE_AND_BACK, (x, y, 0.0), radius)
    assert np.array_equal(np.concatenate([parts.near, parts.rest]), THERE_AND_BACK)
    judged = np.concatenate([parts.near, *parts.visits])
    inside = np.hypot(THERE_AND_BACK[:, 0] - x, THERE_AND_BACK[:, 1] - y) <= radius
    assert np.array_equal(judged, THERE_AND_BACK[inside])
