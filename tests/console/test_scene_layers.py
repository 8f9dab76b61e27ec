"""Layers: what the robot says becomes the right picture, and stays small."""

import io
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra import numpy as hnp
from PIL import Image

from kompass.algorithms.geometry import compose
from kompass.algorithms.grid import Grid
from kompass.algorithms.rectangles import rectangles
from kompass_console.scene.layers.local_map import local_map_drawing
from kompass_console.scene.layers.map import map_drawing
from kompass_console.scene.layers.palette import palette
from kompass_console.scene.layers.path import path_segments
from kompass_console.scene.layers.scan import scan_points
from kompass_console.scene.layers.trail import Trail
from kompass_console.schema.world import Pose, PoseHistory, Scan


@settings(deadline=None)
@given(hnp.arrays(np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=12)))
def test_rectangles_cover_every_occupied_cell_once(occupied: np.ndarray) -> None:
    covered = np.zeros(occupied.shape, int)
    for row, column, end_row, end_column in rectangles(occupied):
        covered[row:end_row, column:end_column] += 1
    assert np.array_equal(covered, occupied.astype(int))


def room() -> Grid:
    """3 m x 2 m: unknown outside, a wall around, free inside; rows go up with y."""
    cells = np.full((40, 60), -1, dtype=np.int8)
    cells[5:35, 10:50] = 100
    cells[6:34, 11:49] = 0
    return Grid(cells, 0.05, Pose(-1.0, 2.0, 0.0))


def test_the_map_is_drawn_the_right_way_up_in_its_theme() -> None:
    grid = room()
    grid.cells[6:10, 11:15] = 100  # something in the south-west corner
    drawing = map_drawing(grid)
    assert len(drawing.tiles) == 1
    picture = np.array(Image.open(io.BytesIO(drawing.images["dark"][0])).convert("RGB"))
    scale = picture.shape[0] // 40
    # viser puts a picture's first row at its lowest y, as a grid has it: nothing is turned over.
    assert tuple(picture[8 * scale, 12 * scale]) == palette("dark").occupied
    assert tuple(picture[30 * scale, 12 * scale]) == palette("dark").free


def test_every_cell_of_the_map_has_its_colour_in_its_theme() -> None:
    cells = np.random.default_rng(1).choice([-1, 0, 40, 64, 65, 100], (37, 53)).astype(np.int8)
    drawing = map_drawing(Grid(cells, 0.05))
    for theme, images in drawing.images.items():
        picture = np.array(Image.open(io.BytesIO(images[0])).convert("RGB"))
        scale = picture.shape[0] // 37
        middles = picture[scale // 2 :: scale, scale // 2 :: scale]
        colours = palette(theme)
        assert (middles[cells >= 65] == colours.occupied).all()
        assert (middles[(cells >= 0) & (cells < 65)] == colours.free).all()
        unknown = {tuple(colour) for colour in middles[cells < 0].tolist()}
        assert unknown <= {colours.unknown, colours.unknown_line}


def test_the_first_view_is_of_what_is_known() -> None:
    assert map_drawing(room()).bounds == pytest.approx((-0.5, 2.25, 1.5, 3.75))


def test_a_large_map_is_cut_into_tiles_that_meet() -> None:
    grid = Grid(np.zeros((1500, 2500), np.int8), 0.1, Pose(0.0, 0.0, 0.0))
    drawing = map_drawing(grid)
    assert sum(t.width * t.height for t in drawing.tiles) == pytest.approx(250.0 * 150.0)
    assert max(t.x + t.width / 2 for t in drawing.tiles) == pytest.approx(250.0)
    assert all(max(t.classes.shape) <= 1024 for t in drawing.tiles)


def test_walls_stand_on_the_occupied_cells() -> None:
    grid = room()
    standing = np.zeros(grid.cells.shape, int)
    for row, column, end_row, end_column in map_drawing(grid).walls:
        standing[row:end_row, column:end_column] += 1
    assert np.array_equal(standing == 1, grid.cells >= 65)


def test_the_local_map_turns_with_the_robot() -> None:
    cells = np.zeros((20, 20), np.int8)
    cells[9:11, 19] = 100  # straight ahead, at the far edge
    half = 0.5
    corner = compose((3.0, 4.0, math.pi / 2), (-half, -half, 0.0))
    drawing = local_map_drawing(Grid(cells, 0.05, Pose(*corner)))
    assert drawing.vertices[:, :2].mean(axis=0) == pytest.approx((3.0, 4.475), abs=1e-5)


def test_scan_points_lie_where_the_beams_ended() -> None:
    ranges = np.array([1.0, np.inf, 2.0, 0.01, np.nan], np.float32)
    scan = Scan(ranges, 0.0, math.pi / 2, 0.1, 5.0, 0.0, "laser")
    points = scan_points(scan, Pose(10.0, 0.0, math.pi / 2))
    assert points[:, :2] == pytest.approx(np.array([[10.0, 1.0], [10.0, -2.0]]), abs=1e-5)


def test_a_scan_is_drawn_from_where_it_was_taken() -> None:
    history = PoseHistory()
    history.add(10.0, Pose(0.0, 0.0, 3.0))
    history.add(11.0, Pose(1.0, 0.0, -3.0))
    pose = history.at(10.5)
    assert pose is not None
    assert pose.x == pytest.approx(0.5)
    assert abs(pose.yaw) == pytest.approx(math.pi)  # by the short way round
    assert history.at(12.0) == Pose(1.0, 0.0, -3.0)


def test_a_path_of_any_length_is_a_bounded_line() -> None:
    long = np.column_stack([np.linspace(0.0, 100.0, 50_000), np.zeros(50_000)])
    segments = path_segments(long)
    assert len(segments) < 1000
    assert segments[-1, 1, 0] == 100.0
    assert len(path_segments(np.zeros((1, 2)))) == 0


def test_the_trail_is_bounded_and_forgets_a_jump() -> None:
    trail = Trail()
    for i in range(2000):
        trail.add(Pose(i * 0.1, 0.0, 0.0), 0.1 * i)
    assert len(trail.segments()) < 300
    trail.add(Pose(0.0, 50.0, 0.0), 200.0)
    trail.add(Pose(0.1, 50.0, 0.0), 200.1)
    assert trail.segments()[:, :, 1].min() == 50.0


def test_the_trail_does_not_lead_to_where_the_robot_was_only_told_to_be() -> None:
    trail = Trail()
    trail.add(Pose(0.0, 0.0, 0.0), 0.0)
    trail.add(Pose(0.1, 0.0, 0.0), 0.1)
    trail.add(Pose(0.1, 0.0, 0.0), 60.0)  # it stands for a minute
    trail.add(Pose(0.8, 0.0, 0.0), 60.1)
    assert len(trail.segments()) == 0
    trail.add(Pose(2.4, 0.0, 0.0), 60.7)  # fast, and not heard of for half a second
    assert trail.segments()[-1, 1, 0] == pytest.approx(2.4)
