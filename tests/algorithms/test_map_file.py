from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from PIL import Image

from kompass.algorithms.grid import Grid
from kompass.algorithms.map_file import MapFileError, load_map, save_map

GOOD = "image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\n"


@settings(
    max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    arrays(
        np.int8,
        array_shapes(min_dims=2, max_dims=2, max_side=12),
        elements=st.sampled_from([-1, 0, 100]),
    )
)
def test_a_saved_map_is_loaded_identical(tmp_path: Path, cells: np.ndarray) -> None:
    grid = Grid(cells, 0.05, (-1.25, 3.5, 0.3))
    save_map(grid, tmp_path / "map.yaml")
    again = load_map(tmp_path / "map.yaml")
    assert (again.cells == cells).all()
    assert (again.resolution, again.origin) == (grid.resolution, grid.origin)


def write(folder: Path, text: str, pixels: object = ((0, 205, 254),)) -> Path:
    Image.fromarray(np.array(pixels, np.uint8)).save(folder / "map.png")
    file = folder / "map.yaml"
    file.write_text(text)
    return file


def test_the_image_s_top_row_is_the_map_s_highest_y(tmp_path: Path) -> None:
    grid = load_map(write(tmp_path, GOOD, [[0, 0], [254, 254]]))
    assert grid.cells.tolist() == [[0, 0], [100, 100]]


def test_dark_is_occupied_grey_is_unknown_bright_is_free_and_negate_swaps_them(
    tmp_path: Path,
) -> None:
    assert load_map(write(tmp_path, GOOD)).cells.tolist() == [[100, -1, 0]]
    negated = load_map(write(tmp_path, GOOD + "negate: 1\n", [[255, 100, 1]]))
    assert negated.cells.tolist() == [[100, -1, 0]]


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("resolution: 0.05\norigin: [0, 0, 0]\n", r"map\.yaml: image: None"),
        (GOOD.replace("map.png", "none.png"), r"image: .*none\.png does not exist"),
        (GOOD.replace("map.png", "map.yaml"), r"image: .*map\.yaml is no readable image"),
        (GOOD.replace("0.05", "0"), "resolution: 0"),
        (GOOD.replace("0.05", "fine"), "resolution: 'fine'; give a number"),
        (GOOD.replace("[0, 0, 0]", "[0, 0]"), r"origin: \[0, 0\]; give \[x, y, yaw\]"),
        (GOOD + "negate: 2\n", "negate: 2; give 0"),
        (GOOD + "mode: raw\n", "mode: 'raw' is not supported; use 'trinary'"),
        (GOOD + "free_thresh: 0.9\n", "free_thresh: 0.9, occupied_thresh: 0.65"),
        ("just text", "holds no fields"),
        ("a: [", "not valid YAML"),
    ],
)
def test_a_bad_map_file_is_named_with_field_value_and_remedy(
    tmp_path: Path, text: str, complaint: str
) -> None:
    with pytest.raises(MapFileError, match=complaint):
        load_map(write(tmp_path, text))


def test_a_missing_map_file_is_a_map_file_error(tmp_path: Path) -> None:
    with pytest.raises(MapFileError, match=r"none\.yaml: cannot be read"):
        load_map(tmp_path / "none.yaml")


def test_saving_where_there_is_no_folder_says_so(tmp_path: Path) -> None:
    with pytest.raises(MapFileError, match="does not exist; create it first"):
        save_map(Grid(np.zeros((1, 1), np.int8), 0.1), tmp_path / "none" / "map.yaml")
