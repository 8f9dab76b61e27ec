"""What is drawn of a message: bounded, finite, and where its frame says."""

from __future__ import annotations

import contextlib
import math
from itertools import product

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Point, Pose, PoseArray, Quaternion, Vector3
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import LaserScan
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from kompass_console.link.on_demand import shapes
from kompass_console.link.on_demand.markers import MOST_MARKERS, MarkerBoard, marker_shape
from kompass_console.link.on_demand.shapes import (
    MOST_AREAS,
    MOST_POINTS,
    MOST_SEGMENTS,
    combined,
    moved,
)
from kompass_console.schema.world import Shape
from tests.console.test_extras import cloud_of, path_of

ODD = (math.nan, math.inf, -math.inf, 1e308, -1e308, 0.0, 1.0)


def marker(**fields: object) -> Marker:
    made = Marker(type=Marker.CUBE, scale=Vector3(x=1.0, y=1.0, z=1.0), color=ColorRGBA(a=1.0))
    for name, value in fields.items():
        setattr(made, name, value)
    return made


def test_of_a_million_points_no_more_are_drawn_than_a_page_can_take_and_none_that_is_nowhere() -> (
    None
):
    points = np.random.default_rng(1).normal(size=(1_000_000, 3))
    points[::7] = math.nan
    part = shapes.cloud_part(cloud_of(points))
    assert 0.8 * MOST_POINTS < len(part.shape.points) <= MOST_POINTS
    assert np.isfinite(part.shape.points).all()
    assert part.note == "One in 125 of 1000000 points is drawn."


def test_a_long_path_keeps_its_ends() -> None:
    part = shapes.path_part(path_of([(0.01 * i, 0.0) for i in range(10_000)]))
    lines = part.shape.segments
    assert len(lines) < MOST_SEGMENTS
    assert lines[0, 0, 0] == 0.0
    assert lines[-1, 1, 0] == pytest.approx(99.99)


def test_a_large_grid_is_drawn_coarser_and_loses_no_obstacle() -> None:
    grid = OccupancyGrid()
    grid.info.width, grid.info.height, grid.info.resolution = 2000, 1500, 0.05
    cells = np.zeros((1500, 2000), np.int8)
    cells[777, 1234] = 100
    grid.data = cells.ravel().tolist()
    part = shapes.grid_part(grid)
    (corners,) = part.shape.areas
    low, high = corners[0, :2], corners[2, :2]
    assert (low <= (1234 * 0.05, 777 * 0.05)).all()
    assert (high >= (1235 * 0.05 - 1e-6, 778 * 0.05 - 1e-6)).all()
    assert np.allclose(high - low, 0.25)
    assert part.note == "It is drawn 5 times as coarse as it is."


def test_a_grid_of_noise_is_cut() -> None:
    grid = OccupancyGrid()
    grid.info.width = grid.info.height = 300
    grid.info.resolution = 0.05
    noise = np.random.default_rng(1).random((300, 300)) < 0.3
    grid.data = (noise * 100).astype(np.int8).ravel().tolist()
    part = shapes.grid_part(grid)
    assert len(part.shape.areas) == MOST_AREAS
    assert "the first 2000 are drawn" in part.note


def test_a_shape_is_taken_to_another_frame_whole_and_without_what_is_too_far() -> None:
    quarter = shapes.pose_matrix(
        Pose(
            position=Point(x=2.0, y=1.0), orientation=Quaternion(z=math.sqrt(0.5), w=math.sqrt(0.5))
        )
    )
    shape = Shape(
        points=np.array([[1, 0, 0], [1e9, 0, 0]], np.float32),
        point_colours=np.array([[1, 2, 3], [4, 5, 6]], np.uint8),
    )
    there = moved(shape, quarter)
    np.testing.assert_allclose(there.points, [[2.0, 2.0, 0.0]], atol=1e-6)
    assert there.point_colours is not None
    assert there.point_colours.tolist() == [[1, 2, 3]]


@pytest.mark.parametrize("kind", range(-1, 13))
def test_no_marker_whatever_it_says_is_drawn_nowhere_or_fails(kind: int) -> None:
    for a, b in product(ODD, ODD):
        odd = marker(
            type=kind,
            scale=Vector3(x=a, y=b, z=1.0),
            pose=Pose(position=Point(x=b), orientation=Quaternion(x=a, w=b)),
            color=ColorRGBA(r=math.nan, g=math.inf, a=1.0),
            points=[Point(x=a), Point(y=b), Point(x=b, z=a), Point()],
            colors=[ColorRGBA(r=-1.0, g=7.0)],
            text="a" * 500,
        )
        board = MarkerBoard()
        with np.errstate(all="ignore"):
            board.take([odd], 0.0)
            drawn = combined([part.shape for part in board.parts(0.0)])
        assert np.isfinite(drawn.points).all()
        assert np.isfinite(drawn.segments).all()
        assert all(len(label.text) <= 60 for label in drawn.labels)


def test_no_scan_poses_or_quaternion_of_nonsense_fails() -> None:
    for a, b in product(ODD, ODD):
        scan = LaserScan(angle_min=0.0, angle_increment=np.float32(min(max(a, -3e38), 3e38)).item())
        scan.range_max, scan.ranges = 30.0, [1.0, math.nan, math.inf, 2.0]
        poses = PoseArray(poses=[Pose(position=Point(x=1.0), orientation=Quaternion(x=a, y=b))])
        with np.errstate(all="ignore"):
            assert np.isfinite(shapes.scan_part(scan).shape.points).all()
            with contextlib.suppress(ValueError):  # it says that none of them is finite
                assert np.isfinite(shapes.poses_part(poses).shape.segments).all()


def test_markers_are_so_many_and_no_more() -> None:
    board = MarkerBoard()
    board.take([marker(id=i, type=Marker.POINTS, points=[Point()]) for i in range(2000)], 0.0)
    parts = board.parts(0.0)
    assert sum(len(part.shape.points) for part in parts) == MOST_MARKERS
    assert parts[-1].note == f"Not drawn: more than {MOST_MARKERS} markers."
    heavy = [marker(id=i, type=Marker.LINE_STRIP, points=[Point()] * 3000) for i in range(3)]
    board.take([marker(action=Marker.DELETEALL), *heavy], 1.0)
    parts = board.parts(1.0)
    assert sum(len(part.shape.segments) for part in parts) <= MOST_SEGMENTS
    assert "all after the first 1" in parts[-1].note


def test_a_marker_that_shows_a_file_is_told_of_and_nothing_is_fetched() -> None:
    board = MarkerBoard()
    board.take([marker(type=Marker.MESH_RESOURCE, mesh_resource="http://elsewhere/a.dae")], 0.0)
    assert board.parts(0.0)[-1].note == "Not drawn: 1 that show a file."


def test_a_marker_ends_when_it_said_it_would() -> None:
    board = MarkerBoard()
    board.take([marker(lifetime=Duration(sec=2)), marker(id=1)], 10.0)
    assert board.next_end() == 12.0
    assert sum(len(part.shape.segments) for part in board.parts(11.9)) == 24
    assert sum(len(part.shape.segments) for part in board.parts(12.0)) == 12
    assert math.isinf(board.next_end())


def test_lines_have_the_colours_that_their_marker_gives_them() -> None:
    ends = [ColorRGBA(r=1.0), ColorRGBA(g=1.0), ColorRGBA(b=1.0), ColorRGBA(r=1.0, g=1.0)]
    lines = marker(type=Marker.LINE_LIST, points=[Point(x=float(i)) for i in range(4)], colors=ends)
    drawn = marker_shape(lines)
    assert drawn.segment_colours is not None
    assert drawn.segment_colours.tolist() == [[255, 0, 0], [0, 0, 255]]
