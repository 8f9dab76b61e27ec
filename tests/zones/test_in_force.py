"""What zones forbid: cells, edges in the way, and speed."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kompass.algorithms.grid import FREE, OCCUPIED, Grid
from kompass.zones.in_force import CREEP, SPACING, Polygon, ZonesInForce
from tests.zones.zones import SQUARE, zone

L_SHAPE = ((0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3))


def test_a_polygon_with_a_bay_does_not_contain_the_bay() -> None:
    shape = Polygon(L_SHAPE)
    inside = shape.contains([(0.5, 0.5), (2.5, 0.5), (0.5, 2.5), (2.0, 2.0), (-0.1, 0.5)])
    assert inside.tolist() == [True, True, True, False, False]
    assert shape.distance(0.5, 0.5) == 0.0
    assert shape.distance(2.0, 2.0) == pytest.approx(1.0)
    assert shape.distance(-1.0, -1.0) == pytest.approx(math.sqrt(2))


@given(st.floats(-1, 4), st.floats(-1, 4))
def test_the_outline_leaves_no_gap_to_slip_through(x: float, y: float) -> None:
    shape = Polygon(L_SHAPE)
    nearest = float(np.hypot(*(shape.outline() - (x, y)).T).min())
    if not shape.contains([(x, y)])[0]:
        away = shape.distance(x, y)
        assert away - 1e-9 <= nearest <= math.hypot(away, SPACING / 2) + 1e-9


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
    shape = Polygon(SQUARE)
    cells = ZonesInForce([zone()]).occupy(grid)
    for at, inside in zip(points, shape.contains(points), strict=True):
        col, row = cells.world_to_cell([at])[0]
        if inside:
            assert cells.cells[row, col] == OCCUPIED
        elif shape.distance(*at) > 2 * resolution:
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
