"""A car's path can be driven by steered wheels, all of it, and its body fits along it."""

import math

import numpy as np
import pytest

from kompass.algorithms.following.gears import legs_of
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, wrap_angle
from kompass.algorithms.grid import Grid
from kompass.algorithms.planning.car_planner import CarPlanner
from kompass.algorithms.planning.failure import PlanningFailure

from .worlds import empty, walls

RADIUS = 0.6
BODY = Footprint(np.array([[0.5, -0.2], [0.5, 0.2], [-0.1, 0.2], [-0.1, -0.2]]))


def planner(grid: Grid, *, radius: float = RADIUS, clearance: float = 0.1) -> CarPlanner:
    return CarPlanner(grid, footprint=BODY, turning_radius=radius, clearance=clearance)


def bends(poses: Floats) -> float:
    """The tightest curve of a path [1/m]."""
    way = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    turn = np.abs(wrap_angle(np.diff(poses[:, 2])))
    assert turn[way < 1e-6].sum() == 0.0, "it turns on the spot"
    return float((turn[way >= 1e-6] / way[way >= 1e-6]).max())


def gaps(grid: Grid, poses: Floats) -> float:
    """Least distance of the body from the middle of an occupied cell [m]."""
    rows, columns = np.nonzero(grid.occupied())
    cells = grid.cell_to_world(np.column_stack([columns, rows]))
    least = math.inf
    for x, y, yaw in poses:
        away = cells - (x, y)
        cos, sin = math.cos(yaw), math.sin(yaw)
        turned = np.column_stack([away @ (cos, sin), away @ (-sin, cos)])
        least = min(least, float(BODY.distance(turned).min()))
    return least


@pytest.mark.parametrize("goal", [(2.0, 8.5, None), (8.0, 8.8, 0.0), (2.0, 3.8, math.pi)])
def test_a_path_round_walls_fits_and_is_bent_no_tighter_than_the_wheels_steer(
    goal: tuple[float, float, float | None],
) -> None:
    grid = walls()
    start = (1.0, 1.0, 0.0)
    plan = planner(grid).plan(start, goal)
    assert plan.poses[0] == pytest.approx(start)
    assert plan.poses[-1, :2] == pytest.approx(goal[:2], abs=1e-6)
    if goal[2] is not None:
        assert abs(wrap_angle(plan.poses[-1, 2] - goal[2])) < 1e-3
    assert bends(plan.poses) <= 1.02 / RADIUS
    # The border of a cell is nearer than its middle.
    assert gaps(grid, plan.poses) >= 0.1 - 0.02
    assert plan.room >= 0.1 - 1e-6


def test_to_face_the_other_way_it_goes_ahead_and_back() -> None:
    plan = planner(empty(4.0)).plan((2.0, 2.0, 0.0), (2.0, 2.0, math.pi))
    legs = legs_of(plan.poses)
    assert len({leg.backward for leg in legs}) == 2
    assert bends(plan.poses) <= 1.02 / RADIUS


def test_a_goal_beside_it_is_no_slide() -> None:
    plan = planner(empty(6.0)).plan((3.0, 3.0, 0.0), (3.0, 3.1, 0.0))
    assert bends(plan.poses) <= 1.02 / RADIUS
    assert plan.length > 0.3


def test_where_it_would_have_to_turn_on_the_spot_there_is_no_path() -> None:
    # A corridor that ends behind the car, just wide enough for it.
    cells = np.full((40, 120), 100, dtype=np.int8)
    cells[14:26, 4:116] = 0
    grid = Grid(cells, 0.05)
    with pytest.raises(PlanningFailure, match=r"its tightest turn has a radius of 0\.60 m") as told:
        planner(grid, clearance=0.0).plan((3.0, 1.0, 0.0), (4.0, 1.0, math.pi))
    assert told.value.reason == "no_path"
    # Straight back it can.
    back = planner(grid, clearance=0.0).plan((3.0, 1.0, 0.0), (1.0, 1.0, 0.0))
    assert [leg.backward for leg in legs_of(back.poses)] == [True]


def test_a_path_is_looked_at_as_the_body_faces_along_it() -> None:
    grid = empty(6.0)
    made = planner(grid)
    along = np.array([[x, 3.0, 0.0] for x in np.arange(1.0, 4.0, 0.1)])
    assert not made.blocked(along)
    ahead = along.copy()
    ahead[:, 0] += 1.6  # its nose would be in the wall
    assert made.blocked(ahead)
    turned = ahead[::-1].copy()
    turned[:, 2] = math.pi
    assert not made.blocked(turned), "its tail reaches less far"


def test_driving_back_is_dearer_than_driving_ahead() -> None:
    made = planner(empty(8.0))
    ahead = np.array([[x, 4.0, 0.0] for x in np.arange(2.0, 5.0, 0.1)])
    back = ahead[::-1].copy()
    assert made.cost(back) > 1.5 * made.cost(ahead)


def test_the_same_input_gives_the_same_path() -> None:
    first, second = (planner(walls()).plan((1, 1, 0), (2.0, 8.5, None)) for _ in range(2))
    assert np.array_equal(first.poses, second.poses)


@pytest.mark.parametrize("radius", [0.0, -1.0, math.nan, math.inf])
def test_a_turning_radius_that_none_has_is_refused(radius: float) -> None:
    with pytest.raises(ValueError, match=r"turning_radius: .* give a finite number above 0"):
        planner(empty(), radius=radius)


def test_a_path_is_told_apart_by_how_it_is_driven() -> None:
    ahead = np.array([[x, 0.0, 0.0] for x in np.arange(0.0, 1.01, 0.1)])
    back = np.array([[x, 0.0, 0.0] for x in np.arange(0.9, 0.49, -0.1)])
    legs = legs_of(np.concatenate([ahead, back]))
    assert [leg.backward for leg in legs] == [False, True]
    assert legs[0].poses[-1] == pytest.approx(ahead[-1])
    # It begins where the other ends, and faces as the car's tail does.
    assert legs[1].poses[0, :2] == pytest.approx((1.0, 0.0))
    assert np.cos(legs[1].poses[:, 2]) == pytest.approx(-1.0)
    # Of a path whose poses do not say how it faces, all of it is driven ahead.
    without = np.column_stack([ahead[:, 0], 0.3 * ahead[:, 0], 0.0 * ahead[:, 0] + 1.2])
    assert [leg.backward for leg in legs_of(without)] == [False]


def test_a_path_dearer_than_one_that_is_known_is_not_looked_for() -> None:
    made = planner(walls())
    start, goal = (1.0, 1.0, 0.0), (2.0, 8.5, None)
    cost = made.cost(made.plan(start, goal).poses)
    assert made.plan(start, goal, 1.2 * cost).length > 0.0
    with pytest.raises(PlanningFailure) as told:
        made.plan(start, goal, 0.7 * cost)
    assert told.value.reason == "no_path"


def bend_in_a_round_room() -> tuple[Grid, Floats]:
    """A room in which a car that turns about its middle as tight as it can has 0.1 m left."""
    cells = np.full((80, 80), 100, dtype=np.int8)
    grid = Grid(cells, 0.05)
    middle = (2.0, 2.0 + 1.1 * RADIUS)
    rows, columns = np.indices(cells.shape)
    centres = grid.cell_to_world(np.column_stack([columns.ravel(), rows.ravel()]))
    inside = np.hypot(*(centres - middle).T) < 1.15
    cells[inside.reshape(cells.shape)] = 0
    turn = np.linspace(0.0, math.pi, 25)
    path = np.column_stack(
        [
            middle[0] + 1.1 * RADIUS * np.sin(turn),
            middle[1] - 1.1 * RADIUS * np.cos(turn),
            turn,
        ]
    )
    return Grid(cells, 0.05), path


@pytest.mark.parametrize("facing", [0.0, math.pi])
def test_a_car_that_faces_off_a_curve_beside_a_wall_is_lost_although_the_path_is_free(
    facing: float,
) -> None:
    grid, path = bend_in_a_round_room()
    path[:, 2] += facing
    made = planner(grid, clearance=0.0)
    assert not made.blocked(path)
    x, y, yaw = path[0]
    assert not made.loses((x, y, yaw), path, RADIUS)
    assert not made.loses((x, y, yaw - 0.05), path, RADIUS)
    # Even with its wheels turned as far as they can be it would come out too wide.
    assert made.loses((x, y, yaw - 0.35), path, RADIUS)


def test_where_there_is_room_a_car_comes_back_to_its_path_from_anywhere() -> None:
    made = planner(empty(8.0))
    ahead = np.array([[x, 4.0, 0.0] for x in np.arange(2.0, 5.0, 0.1)])
    turned = ahead[::-1].copy()
    for path in (ahead, turned):
        for off in (-0.6, 0.6):
            x, y, yaw = path[0]
            assert not made.loses((x, y + off / 3.0, yaw + off), path, RADIUS)
