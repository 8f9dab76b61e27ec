import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kompass.algorithms.grid import Grid


@given(
    st.integers(1, 9),
    st.integers(1, 9),
    st.sampled_from([0.05, 0.25, 0.5]),
    st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-3, 3)),
)
def test_every_cell_is_found_again_from_its_centre(
    width: int, height: int, resolution: float, origin: tuple[float, float, float]
) -> None:
    grid = Grid(np.zeros((height, width), np.int8), resolution, origin)
    cells = np.array([(c, r) for r in range(height) for c in range(width)])
    assert (grid.world_to_cell(grid.cell_to_world(cells)) == cells).all()
    assert grid.contains(grid.cell_to_world(cells)).all()


def test_the_message_s_first_cell_is_the_lowest_corner_and_x_runs_fastest() -> None:
    grid = Grid.from_row_major([0, 100, -1, 0, 0, 0], 3, 2, 0.5, (1.0, 2.0, 0.0))
    assert grid.cells[0].tolist() == [0, 100, -1]
    assert grid.world_to_cell([(1.6, 2.1)]).tolist() == [[1, 0]]


def test_points_beyond_any_side_are_not_on_the_grid() -> None:
    grid = Grid(np.zeros((2, 3), np.int8), 1.0)
    outside = [(-0.1, 1), (3.1, 1), (1, -0.1), (1, 2.1)]
    assert not grid.contains(outside).any()


def test_unknown_cells_are_obstacles_only_when_asked() -> None:
    grid = Grid(np.array([[-1, 0, 64, 65, 100]], np.int8), 0.1)
    assert grid.occupied()[0].tolist() == [False, False, False, True, True]
    assert grid.occupied(unknown_is_obstacle=True)[0].tolist() == [True, False, False, True, True]


def test_a_truncated_message_is_refused_by_name_and_number() -> None:
    with pytest.raises(ValueError, match="data: 5 cells, but width 3 × height 2 needs 6"):
        Grid.from_row_major([0] * 5, 3, 2, 0.05, (0, 0, 0))


@pytest.mark.parametrize("resolution", [0.0, -1.0, float("nan"), float("inf"), 1e-9, 0.00099, 50.0])
def test_a_grid_whose_cells_are_none_to_drive_by_is_refused(resolution: float) -> None:
    with pytest.raises(ValueError, match=r"resolution: .* give cells of 0\.001 to 10 m"):
        Grid(np.zeros((2, 2), np.int8), resolution)


@pytest.mark.parametrize("x", [1e308, -1e10, math.nan, math.inf])
def test_a_map_that_lies_nowhere_is_refused(x: float) -> None:
    with pytest.raises(ValueError, match=r"origin: .*of at most 1e\+09"):
        Grid(np.zeros((2, 2), np.int8), 0.05, (x, 0.0, 0.0))
