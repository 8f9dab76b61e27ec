import math
import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kompass.algorithms.mapping.local_map import LocalMapBuilder
from kompass.algorithms.mapping.scan_points import PlacedScan, scan_fault
from kompass.algorithms.transforms import matrix_of
from tests.support.properties import property_test

FULL_TURN = {"angle_min": 0.0, "angle_increment": 2 * math.pi / 360}
LIDAR = {**FULL_TURN, "range_min": 0.12, "range_max": 3.5}


def room(half: float, n: int = 720) -> np.ndarray:
    """Ranges to the walls of a square room around the sensor."""
    angles = 2 * math.pi / n * np.arange(n)
    ranges: np.ndarray = half / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    return ranges


@pytest.mark.parametrize("half", [0.52, 0.98, 1.02, 1.33])
def test_walls_at_the_same_distance_are_drawn_at_the_same_distance_on_all_sides(
    half: float,
) -> None:
    mapper = LocalMapBuilder(3.0, 3.0, 0.05)
    occupied = mapper.update(room(half), 0.0, 2 * math.pi / 720, 0.1, 5.0, (0.0, 0.0, 0.0)) == 100
    assert (occupied == occupied[::-1]).all()
    assert (occupied == occupied[:, ::-1]).all()
    assert (occupied == occupied.T).all()
    centre = (np.arange(60) + 0.5) * 0.05 - 1.5
    row = np.flatnonzero(occupied[30])
    assert len(row) == 2
    assert np.abs(centre[row]) == pytest.approx([half, half], abs=0.025 + 1e-6)


def test_the_room_is_free_inside_and_unknown_behind_its_walls() -> None:
    mapper = LocalMapBuilder(3.0, 3.0, 0.05)
    cells = mapper.update(room(1.02), 0.0, 2 * math.pi / 720, 0.1, 5.0, (0.0, 0.0, 0.0))
    assert (cells[11:49, 11:49] == 0).all()
    assert (cells[:9] == -1).all()
    assert (cells[:, 51:] == -1).all()


@pytest.mark.parametrize("nothing", [math.inf, math.nan, 0.0, 3.5, 100.0])
def test_no_return_leaves_no_obstacle_and_is_free_up_to_the_sensor_s_range(nothing: float) -> None:
    mapper = LocalMapBuilder(10.0, 10.0, 0.05)
    cells = mapper.update(np.full(360, nothing), **LIDAR)
    assert (cells != 100).all()
    centre = (np.arange(200) + 0.5) * 0.05 - 5.0
    away = np.hypot(*np.meshgrid(centre, centre))
    assert (cells[away < 3.4] == 0).all()
    assert (cells[away > 3.5] == -1).all()


@pytest.mark.parametrize("too_close", [-math.inf, 0.05])
def test_what_is_too_close_to_measure_says_nothing(too_close: float) -> None:
    cells = LocalMapBuilder(2.0, 2.0, 0.05).update(np.full(360, too_close), **LIDAR)
    assert (cells == -1).all()


@property_test(
    st.floats(0.2, 2.0), st.integers(0, 359), st.floats(-0.2, 0.2), st.floats(-3.1, 3.1), many=60
)
def test_a_lone_reading_marks_the_cell_it_ends_in(
    reading: float, ray: int, x: float, yaw: float
) -> None:
    ranges = np.full(360, np.inf)
    ranges[ray] = reading
    mapper = LocalMapBuilder(5.0, 4.5, 0.05)
    cells = mapper.update(ranges, **LIDAR, sensor_pose_in_base=(x, 0.1, yaw))
    angle = ray * math.pi / 180 + yaw
    px, py = x + reading * math.cos(angle), 0.1 + reading * math.sin(angle)
    rows, cols = np.nonzero(cells == 100)
    assert len(rows) == 1
    assert px == pytest.approx((cols[0] + 0.5) * 0.05 - 2.5, abs=0.0251)
    assert py == pytest.approx((rows[0] + 0.5) * 0.05 - 2.25, abs=0.0251)


def test_outside_a_sensor_s_field_of_view_nothing_is_known() -> None:
    n = 181
    mapper = LocalMapBuilder(3.0, 3.0, 0.05)
    cells = mapper.update(np.full(n, 1.0), -math.pi / 2, math.pi / (n - 1), 0.1, 5.0)
    assert (cells[:, :29] == -1).all()
    assert (cells[:, 31:45] != -1).any()
    assert cells[30, 40] == 0


def test_a_sensor_that_sweeps_clockwise_gives_the_mirrored_map() -> None:
    ranges = 0.5 + 0.3 * np.linspace(0, 1, 360)
    forward = LocalMapBuilder(3.0, 3.0, 0.05).update(ranges, 0.0, math.pi / 180, 0.1, 5.0)
    backward = LocalMapBuilder(3.0, 3.0, 0.05).update(ranges, 0.0, -math.pi / 180, 0.1, 5.0)
    assert (forward == 100).sum() == (backward == 100).sum()
    # Cells exactly between two rays may go to either.
    assert (forward != backward[::-1]).mean() < 0.01


def test_a_turned_sensor_gives_the_map_of_the_turned_scan() -> None:
    ranges = 0.5 + 0.3 * np.sin(np.linspace(0, 6, 360))
    straight = LocalMapBuilder(3.0, 3.0, 0.05).update(ranges, **LIDAR)
    turned = LocalMapBuilder(3.0, 3.0, 0.05).update(
        np.roll(ranges, 90), **LIDAR, sensor_pose_in_base=(0.0, 0.0, -math.pi / 2)
    )
    assert (straight != turned).mean() < 0.01


def test_large_and_oblong_maps_are_accepted() -> None:
    mapper = LocalMapBuilder(50.0, 30.0, 0.05)
    assert mapper.update(np.full(360, 2.0), **LIDAR).shape == (600, 1000)
    assert mapper.origin == (-25.0, -15.0, 0.0)


def test_readings_end_where_the_mapper_is_told_to_believe_them() -> None:
    cells = LocalMapBuilder(5.0, 5.0, 0.05, range_max=1.0).update(np.full(360, 2.0), **LIDAR)
    assert (cells != 100).all()
    assert cells[50, 75] == -1
    assert cells[50, 65] == 0


@pytest.mark.parametrize(
    "bad", [{"width": 0.0}, {"height": -1.0}, {"resolution": math.nan}, {"resolution": 5.0}]
)
def test_a_map_without_size_is_refused_by_name(bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        LocalMapBuilder(**{"width": 3.0, "height": 3.0, "resolution": 0.05, **bad})


def test_a_scan_without_rays_is_refused() -> None:
    with pytest.raises(ValueError, match="ranges"):
        LocalMapBuilder(3.0, 3.0, 0.05).update([], **LIDAR)
    with pytest.raises(ValueError, match="angle_increment"):
        LocalMapBuilder(3.0, 3.0, 0.05).update([1.0], 0.0, 0.0, 0.1, 3.5)


LEVEL = matrix_of((0.0, 0.0, 0.2), (0.0, 0.0, 0.0, 1.0))


def test_only_real_returns_become_points_in_the_base_frame() -> None:
    ranges = [1.0, math.inf, math.nan, 0.0, 0.05, 3.5, -math.inf, 2.0]
    half = math.sqrt(0.5)
    mounted = matrix_of((0.1, 0.0, 0.2), (0.0, 0.0, half, half))
    points = PlacedScan.of(ranges, 0.0, math.pi / 2, 0.12, 3.5, mounted).points
    too_near = (0.1, -0.12)  # of -inf: nearer than can be measured, and there
    assert points == pytest.approx(np.array([(0.1, 1.0), too_near, (2.1, 0.0)]), abs=1e-9)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"ranges": []}, "ranges is empty"),
        ({"ranges": [math.nan, math.nan]}, "ranges has no measurement"),
        ({"ranges": [0.0, 0.05]}, "ranges has no measurement"),
        ({"angle_min": math.nan}, "angle_min = nan"),
        ({"angle_increment": math.inf}, "angle_increment = inf"),
        ({"angle_increment": 0.0}, "angle_increment = 0.0"),
        ({"range_min": math.inf}, "range_min = inf"),
        ({"range_max": math.nan}, "range_max = nan"),
        ({"range_max": 0.1}, "range_max = 0.1 is not above range_min = 0.12"),
    ],
)
def test_a_scan_that_says_nothing_is_not_one_that_met_nothing(
    more: dict[str, Any], said: str
) -> None:
    scan: dict[str, Any] = {"ranges": [1.0, math.inf], "angle_min": 0.0, "angle_increment": 0.1}
    scan |= {"range_min": 0.12, "range_max": 3.5}
    assert scan_fault(**scan) == ""
    assert said in scan_fault(**(scan | more))
    with pytest.raises(ValueError, match=re.escape(said)):
        assert PlacedScan.of(**(scan | more), mounted=LEVEL).points is None


def test_in_the_open_a_scan_meets_nothing_and_is_a_scan() -> None:
    assert len(PlacedScan.of([math.inf] * 4, 0.0, 0.1, 0.12, 3.5, LEVEL).points) == 0
    assert len(PlacedScan.of([3.5] * 4, 0.0, 0.1, 0.12, 3.5, LEVEL).points) == 0


@given(st.floats(-math.pi, math.pi), st.floats(-3, 3), st.floats(-0.3, 0.3))
@settings(max_examples=60, deadline=None)
def test_a_scanner_is_where_it_is_mounted_also_upside_down(
    yaw: float, angle: float, tilt: float
) -> None:
    for roll in (tilt, math.pi + tilt):
        turn_x = np.array([math.sin(roll / 2), 0.0, 0.0, math.cos(roll / 2)])
        mounted = matrix_of((0.2, -0.1, 0.3), (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)))
        mounted = mounted @ matrix_of((0.0, 0.0, 0.0), tuple(turn_x.tolist()))
        found = PlacedScan.of([2.0], angle, 0.1, 0.1, 3.5, mounted)
        met = mounted @ np.array([2 * math.cos(angle), 2 * math.sin(angle), 0.0, 1.0])
        # As far as a scanner that is not quite level is taken for one that is.
        assert found.points == pytest.approx(met[None, :2], abs=2 * (1 - math.cos(tilt)) + 1e-9)
        assert found.height == pytest.approx(0.3)


@pytest.mark.parametrize("tilt", [25.0, 90.0, 155.0])
def test_a_scanner_that_looks_up_or_down_is_refused_with_the_remedy(tilt: float) -> None:
    half = math.radians(tilt) / 2
    mounted = matrix_of((0.0, 0.0, 0.3), (0.0, math.sin(half), 0.0, math.cos(half)))
    with pytest.raises(ValueError, match=r"mounted \d+ degrees out of the level.*a PointCloud2"):
        PlacedScan.of([2.0], 0.0, 0.1, 0.1, 3.5, mounted)
