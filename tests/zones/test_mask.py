"""Masks forbid what their images say, wherever they lie, and are refused where they cannot."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from pydantic import ValidationError

from kompass.algorithms.grid import OCCUPIED, Grid
from kompass.algorithms.map_file import load_mask
from kompass.zones.in_force import CREEP, ZonesInForce
from kompass.zones.mask import Mask, MaskInForce
from tests.zones.masks import mask_file

# Of 5 × 4 cells of 0.5 m, from (-1, 0); written with the highest y on top.
L_SHAPE = """
.....
.##..
.#...
.....
"""
ORIGIN = (-1.0, 0.0, 0.0)


def laid(folder: Path, drawn: str = L_SHAPE, **fields: object) -> MaskInForce:
    return Mask(file=str(mask_file(folder, drawn, 0.5, ORIGIN)), **fields).in_force(2.0)  # type: ignore[arg-type]


def test_what_is_black_is_kept_out_of_where_it_lies_on_the_map(tmp_path: Path) -> None:
    zones = ZonesInForce(masks=[laid(tmp_path)])
    inside = [(-0.25, 0.75), (-0.25, 1.25), (0.25, 1.25), (-0.5, 0.5)]
    outside = [(0.25, 0.75), (-0.75, 0.75), (-0.25, 0.25), (50.0, 0.0), (0.75, 1.25)]
    assert all(zones.barred(*point) for point in inside)
    assert not any(zones.barred(*point) for point in outside)
    near = zones.barred(0.75, 1.25, near=0.3)
    assert near is not None
    assert near.name == "mask"
    assert zones.barred_names == ["mask"]
    assert zones.barred(0.85, 1.25, near=0.3) is None


@given(st.floats(-2, 2), st.floats(-1, 3))
def test_the_edges_leave_no_gap_to_slip_through(x: float, y: float) -> None:
    cells = np.array([[0, 0, 0], [0, 100, 100], [0, 100, 0]], dtype=np.int8)
    grid = Grid(cells, 0.5, (-0.7, 0.2, 0.6))
    mask = MaskInForce("turned", grid, cells == OCCUPIED)
    points, away = mask.edges(x, y, 1.0), mask.distance(x, y, 1.0)
    if mask.inside(x, y):
        assert away == 0.0
        assert len(points) == 0
    elif math.isinf(away):
        assert len(points) == 0
    else:
        found = np.hypot(*(points - (x, y)).T)
        assert found.max() <= 1.0
        assert away - 1e-9 <= found.min() <= math.hypot(away, 0.03) + 1e-9


def test_one_who_is_in_a_patch_is_let_out_slowly_and_not_into_another(tmp_path: Path) -> None:
    zones = ZonesInForce(masks=[laid(tmp_path, "#..#\n#..#\n")])
    points = zones.in_the_way(-0.75, 0.5, 5.0)
    assert points[:, 0].min() == pytest.approx(0.5)
    limit = zones.limit(-0.75, 0.5, 0.1, 1.0)
    assert limit is not None
    assert (limit.speed, limit.zone.kind) == (CREEP, "keep_out")


def test_planners_find_its_cells_occupied_on_grids_of_other_kinds(tmp_path: Path) -> None:
    mask = laid(tmp_path)
    zones = ZonesInForce(masks=[mask])
    same = zones.occupy(Grid(np.zeros((4, 5), np.int8), 0.5, ORIGIN))
    assert np.argwhere(same.cells == OCCUPIED).tolist() == [[1, 1], [2, 1], [2, 2]]
    fine = zones.occupy(Grid(np.zeros((60, 60), np.int8), 0.07, (-1.3, -0.4, 0.3)))
    rows, cols = np.indices(fine.cells.shape).reshape(2, -1)
    middles = fine.cell_to_world(np.column_stack([cols, rows]))
    occupied = (fine.cells == OCCUPIED).ravel()
    inside = np.array([mask.inside(float(x), float(y)) for x, y in middles])
    assert occupied[inside].all()
    far = np.array([mask.distance(float(x), float(y), 1.0) > 0.07 for x, y in middles])
    assert not occupied[far].any()
    coarse = zones.occupy(Grid(np.zeros((3, 3), np.int8), 2.0, (-3.0, -2.0, 0.0)))
    assert (coarse.cells == OCCUPIED).any()


def test_cells_of_a_mask_of_speeds_are_driven_no_faster_than_they_say(tmp_path: Path) -> None:
    drawn = ".....\n.48..\n.....\n"  # 40 and 80
    zones = ZonesInForce(masks=[laid(tmp_path, drawn, kind="speed", multiplier=0.01)])
    at = {x: zones.limit(x, 0.75, 0.1, 1.0) for x in (-0.25, 0.25, 0.95, 40.0)}
    speeds = {x: math.inf if limit is None else limit.speed for x, limit in at.items()}
    assert speeds[-0.25] == pytest.approx(0.4)
    # The body is in both, and half a metre of gentle braking away from the slower.
    assert speeds[0.25] == pytest.approx(math.sqrt(0.4**2 + 0.15))
    assert speeds[0.95] > 0.8
    assert speeds[40.0] == math.inf
    percent = laid(tmp_path, drawn, kind="speed_percent")
    assert percent.limit(-0.25, 0.75, 0.1, 1.0) == pytest.approx(0.8)  # 40 % of 2 m/s


def test_the_numbers_of_nav2_say_what_a_mask_is(tmp_path: Path) -> None:
    file = str(mask_file(tmp_path, ".4.", 0.5, ORIGIN))
    kinds = [Mask(file=file, kind=number, multiplier=0.01).kind for number in (2,)]  # type: ignore[arg-type]
    assert kinds == ["speed"]
    assert Mask(file=file, kind=1).kind == "speed_percent"  # type: ignore[arg-type]
    with pytest.raises(ValidationError, match="keep_out"):
        Mask(file=file, kind=3)  # type: ignore[arg-type]


def test_a_scaled_image_has_values_in_proportion_and_is_unknown_where_it_is_clear(
    tmp_path: Path,
) -> None:
    image = np.zeros((1, 5, 4), np.uint8)
    image[0, :, :3] = np.array([255, 204, 127, 0, 0])[:, None]
    image[0, :, 3] = [255, 255, 255, 255, 100]
    Image.fromarray(image).save(tmp_path / "mask.png")
    yaml = tmp_path / "mask.yaml"
    head = "image: mask.png\nresolution: 0.5\norigin: [0, 0, 0]\n"
    yaml.write_text(f"{head}mode: scale\noccupied_thresh: 1.0\nfree_thresh: 0.0\n")
    assert load_mask(yaml).cells.tolist() == [[0, 20, 50, 100, -1]]
    yaml.write_text(f"{head}mode: trinary\n")
    assert load_mask(yaml).cells.tolist() == [[0, -1, -1, 100, 100]]
    yaml.write_text(f"{head}mode: raw\n")
    assert load_mask(yaml).cells.tolist() == [[-1, -1, -1, 0, 0]]


@pytest.mark.parametrize(
    ("drawn", "fields", "told"),
    [
        (".5.", {}, "value 50; a keep-out mask is of 0 and 100 only"),
        (".#.", {"base": 1.0}, r"base = 1, multiplier = 1 are of speeds"),
        (".#.", {"kind": "speed"}, "comes to 100 m/s; speeds are from 0.05 to 10 m/s"),
        (".#.", {"kind": "speed_percent", "multiplier": 2.0}, "comes to 200 %"),
        (".#.", {"file": "none.yaml"}, "file = 'none.yaml' cannot be read: No such file"),
        (".#.", {"kind": "lanes"}, "keep_out"),
        (".#.", {"kind": True}, "keep_out"),
    ],
)
def test_a_mask_that_cannot_be_meant_is_refused(
    tmp_path: Path, drawn: str, fields: dict[str, object], told: str
) -> None:
    given = {"file": str(mask_file(tmp_path, drawn, 0.5, ORIGIN))} | fields
    with pytest.raises(ValidationError, match=told):
        Mask(**given)  # type: ignore[arg-type]


def test_an_image_that_is_none_is_refused(tmp_path: Path) -> None:
    file = mask_file(tmp_path, ".#.", 0.5, ORIGIN)
    file.with_suffix(".png").write_text("no picture", encoding="utf-8")
    with pytest.raises(ValidationError, match="is no readable image"):
        Mask(file=str(file))


def test_an_image_that_says_it_is_huge_is_refused_with_the_name_of_its_mask(
    tmp_path: Path,
) -> None:
    (tmp_path / "huge.pgm").write_bytes(b"P5\n100000 100000\n255\n")
    file = tmp_path / "mask.yaml"
    file.write_text("image: huge.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n", encoding="utf-8")
    told = r"file = '.*mask\.yaml': .*huge\.pgm has too many pixels to be read; cut it"
    with pytest.raises(ValidationError, match=told):
        Mask(file=str(file))


def test_a_mask_beside_the_map_is_found_out(tmp_path: Path) -> None:
    zones = ZonesInForce(masks=[laid(tmp_path)])
    assert zones.off(Grid(np.zeros((4, 4), np.int8), 0.5, (0.0, 0.0, 0.0))) == ""
    assert zones.off(Grid(np.zeros((400, 400), np.int8), 0.5, (-100.0, -100.0, 0.4))) == ""
    told = zones.off(Grid(np.zeros((4, 4), np.int8), 0.5, (20.0, 0.0, 0.0)))
    assert "The mask 'mask' does not lie on the map: its origin is (-1, 0) m" in told


def test_a_mask_stays_what_its_files_were_when_it_was_made(tmp_path: Path) -> None:
    file = mask_file(tmp_path, L_SHAPE, 0.5, ORIGIN)
    mask = Mask(file=str(file))
    file.unlink()
    (tmp_path / "mask.png").unlink()
    for each in (mask, mask.model_copy()):
        assert ZonesInForce(masks=[each.in_force(2.0)]).barred(-0.25, 0.75)
    with pytest.raises(ValidationError, match="cannot be read"):
        Mask(file=str(file))
