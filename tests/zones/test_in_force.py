"""What zones forbid: cells, edges in the way, and speed."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kompass.algorithms.grid import FREE, OCCUPIED, Grid
from kompass.zones.in_force import CREEP, Outlines, ZonesInForce
from kompass.zones.mask import SPACING
from tests.zones.zones import SQUARE, zone

L_SHAPE = ((0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3))


def test_a_polygon_with_a_bay_does_not_contain_the_bay() -> None:
    shapes = Outlines([L_SHAPE, SQUARE])
    points = [(0.5, 0.5), (2.5, 0.5), (0.5, 2.5), (2.0, 2.0), (-0.1, 0.5), (1.5, 1.5)]
    inside = [shapes.inside(*point).tolist() for point in points]
    assert [one for one, _ in inside] == [True, True, True, False, False, False]
    assert [other for _, other in inside] == [False] * 5 + [True]
    assert shapes.distance(0.5, 0.5).tolist() == [0.0, pytest.approx(math.sqrt(0.5))]
    assert shapes.distance(-1.0, -1.0)[0] == pytest.approx(math.sqrt(2))
    assert len(Outlines([]).distance(0.0, 0.0)) == len(Outlines([]).inside(0.0, 0.0)) == 0


@given(st.floats(-1, 4), st.floats(-1, 4))
def test_the_edges_leave_no_gap_to_slip_through(x: float, y: float) -> None:
    shape = Outlines([L_SHAPE])
    away = float(shape.distance(x, y)[0])
    if away == 0.0:
        return
    points = shape.near(x, y, 1.0, np.array([True]))
    if away > 1.0:
        assert len(points) == 0
        return
    found = np.hypot(*(points - (x, y)).T)
    assert found.max() <= 1.0 + 1e-9
    assert away - 1e-9 <= found.min() <= math.hypot(away, SPACING / 2) + 1e-9


@given(st.floats(-2, 5), st.floats(-2, 5), st.floats(0.1, 3.0))
def test_all_of_the_edges_within_reach_are_told(x: float, y: float, reach: float) -> None:
    points = Outlines([L_SHAPE]).near(x, y, reach, np.array([True]))
    for (x0, y0), (x1, y1) in zip(L_SHAPE, [*L_SHAPE[1:], L_SHAPE[0]], strict=True):
        for share in np.linspace(0.0, 1.0, 41):
            at = (x0 + share * (x1 - x0), y0 + share * (y1 - y0))
            if math.dist(at, (x, y)) <= reach - 1e-9:
                assert np.hypot(*(points - at).T).min() <= SPACING / 2 + 1e-9


def test_edges_are_in_the_way_of_whoever_is_outside_and_no_one_inside() -> None:
    zones = ZonesInForce([zone()])
    seen = zones.in_the_way(0.5, 1.5, 1.0)
    assert len(seen)
    assert np.hypot(*(seen - (0.5, 1.5)).T).max() <= 1.0
    assert len(zones.in_the_way(1.5, 1.5, 5.0)) == 0
    assert len(zones.in_the_way(-5.0, 1.5, 1.0)) == 0


def test_inside_a_keep_out_zone_it_creeps_and_before_a_speed_zone_it_brakes_in_time() -> None:
    barred = ZonesInForce([zone()]).limit(1.5, 1.5, 0.1, 1.0)
    assert barred is not None
    assert barred.speed == CREEP
    slow = ZonesInForce([zone(kind="speed", speed=0.3)])
    at_edge = slow.limit(0.9, 1.5, 0.1, 1.0)
    assert at_edge is not None
    assert at_edge.speed == pytest.approx(0.3)
    before = slow.limit(0.0, 1.5, 0.1, 1.0)
    assert before is not None
    # From that speed, half of the braking ends at 0.3 m/s where the body comes in.
    assert (before.speed**2 - 0.3**2) / (2 * 0.5) == pytest.approx(0.9)


def test_of_two_speed_zones_the_slower_one_counts() -> None:
    both = [zone(kind="speed", speed=0.5), zone(2, name="Slow", kind="speed", speed=0.2)]
    found = ZonesInForce(both).limit(1.5, 1.5, 0.1, 1.0)
    assert found is not None
    assert (found.speed, found.zone.name) == (0.2, "Slow")


@given(
    st.floats(0.02, 0.3),
    st.floats(-math.pi, math.pi),
    st.lists(st.tuples(st.floats(0.0, 2.9), st.floats(0.0, 2.9)), min_size=1, max_size=20),
)
def test_every_point_of_a_keep_out_zone_is_in_an_occupied_cell(
    resolution: float, yaw: float, points: list[tuple[float, float]]
) -> None:
    size = math.ceil(9.0 / resolution)
    corner = -size * resolution / 2
    x = 1.5 + corner * (math.cos(yaw) - math.sin(yaw))
    y = 1.5 + corner * (math.sin(yaw) + math.cos(yaw))
    grid = Grid(np.full((size, size), FREE, dtype=np.int8), resolution, (x, y, yaw))
    shape = Outlines([SQUARE])
    cells = ZonesInForce([zone()]).occupy(grid)
    for at in points:
        col, row = cells.world_to_cell([at])[0]
        if shape.inside(*at)[0]:
            assert cells.cells[row, col] == OCCUPIED
        elif shape.distance(*at)[0] > 2 * resolution:
            assert cells.cells[row, col] == FREE
    assert (grid.cells == FREE).all()


def test_a_zone_beside_the_grid_changes_nothing() -> None:
    grid = Grid(np.zeros((10, 10), dtype=np.int8), 0.05, (-5.0, -5.0, 0.0))
    assert (ZonesInForce([zone()]).occupy(grid).cells == FREE).all()


def test_a_point_names_its_zone_and_one_nearby_that_of_its_neighbour() -> None:
    zones = ZonesInForce([zone(), zone(2, name="Far", corners=((5, 5), (6, 5), (6, 6)))])
    inside, beside = zones.barred(1.5, 1.5), zones.barred(0.9, 1.5, 0.2)
    assert inside is not None
    assert beside is not None
    assert inside.name == beside.name == "Stairs"
    assert zones.barred(0.9, 1.5) is None
