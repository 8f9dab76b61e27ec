"""Paths for a body with corners: nothing under them, and through where its circle would not fit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import strategies as st

from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, inverse, transform_points, wrap_angle
from kompass.algorithms.grid import Grid
from kompass.algorithms.planning.failure import PlanningFailure
from kompass.algorithms.planning.outline_planner import OutlinePlanner
from kompass.algorithms.planning.planner import Plan
from tests.support.properties import property_test

from .worlds import empty, walls

BOX = Footprint(np.array([[0.254, 0.215], [-0.254, 0.215], [-0.254, -0.215], [0.254, -0.215]]))
LONG = Footprint(np.array([[0.6, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.6, -0.2]]))


def gap_under(body: Footprint, plan: Plan, grid: Grid) -> float:
    """Least distance from the body to obstacle cells on the way, turning included [m].

    By an implementation of its own: the corners and edges of cells against the polygon.
    """
    rows, cols = np.nonzero(grid.occupied())
    steps = np.array([(u, v) for u in (0.0, 0.5, 1.0) for v in (0.0, 0.5, 1.0)])
    cells = (np.column_stack([cols, rows])[:, None] + steps[None]).reshape(-1, 2) * grid.resolution
    cells = np.unique(cells, axis=0)
    least = math.inf
    for here, there in zip(plan.poses[:-1], plan.poses[1:], strict=True):
        ways = [(*(here[:2] + s * (there[:2] - here[:2])), here[2]) for s in (0.0, 0.5, 1.0)]
        turn = wrap_angle(there[2] - here[2])
        ways += [(*there[:2], here[2] + s * turn) for s in (0.5, 1.0)]
        near = cells[np.hypot(*(cells - here[:2]).T) < body.radius + 0.5]
        for pose in ways:
            if len(near):
                least = min(
                    least, float(body.distance(transform_points(inverse(pose), near)).min())
                )
    return least


def door(width: float) -> Grid:
    """Two rooms of 4 m and a wall of 0.1 m between them, with a gap in it."""
    grid = empty(8.0, 0.05)
    half = round(width / 0.05 / 2)
    grid.cells[79:81, : 80 - half] = 100
    grid.cells[79:81, 80 + half :] = 100
    return grid


@pytest.mark.parametrize("width", [0.6, 0.7, 1.0])
def test_it_passes_a_gap_that_its_circle_would_not_fit(width: float) -> None:
    planner = OutlinePlanner(door(width), footprint=BOX, clearance=0.1, least=0.0)
    plan = planner.plan((2.0, 2.0, 0.0), (6.0, 6.0, None))
    assert 0.0 < gap_under(BOX, plan, planner.grid) <= (width - 0.43) / 2
    assert plan.length < 1.15 * math.hypot(4.0, 4.0)


def test_a_gap_that_is_too_narrow_for_the_body_is_no_way() -> None:
    planner = OutlinePlanner(door(0.4), footprint=BOX, clearance=0.1, least=0.0)
    with pytest.raises(PlanningFailure) as caught:
        planner.plan((2.0, 2.0, 0.0), (6.0, 6.0, None))
    assert caught.value.reason in ("unreachable", "no_path")


def test_less_than_the_clearance_is_only_kept_where_that_is_allowed() -> None:
    strict = OutlinePlanner(door(0.6), footprint=BOX, clearance=0.15)
    with pytest.raises(PlanningFailure):
        strict.plan((2.0, 2.0, 0.0), (6.0, 6.0, None))
    wide = OutlinePlanner(door(1.0), footprint=BOX, clearance=0.15)
    plan = wide.plan((2.0, 2.0, 0.0), (6.0, 6.0, None))
    assert gap_under(BOX, plan, wide.grid) >= 0.15 - 1e-3
    assert plan.room >= 0.15 - 1e-3


def test_a_wide_way_is_taken_rather_than_a_narrow_one_that_is_little_shorter() -> None:
    grid = door(0.6)
    grid.cells[79:81, 110:140] = 0  # 1.5 m wide, 2.2 m beside
    planner = OutlinePlanner(grid, footprint=BOX, clearance=0.1, least=0.0)
    plan = planner.plan((4.4, 2.0, 1.57), (4.4, 6.0, None))
    at_wall = plan.poses[np.argmin(np.abs(plan.poses[:, 1] - 4.0))]
    assert 5.5 < at_wall[0] < 7.0


@property_test(st.integers(0, 2**31), many=25)
def test_no_pose_of_a_path_overlaps_with_an_obstacle(seed: int) -> None:
    random = np.random.default_rng(seed)
    grid = empty(6.0, 0.05)
    for x, y in random.integers(8, 112, (40, 2)):
        grid.cells[y : y + 3, x : x + 3] = 100
    body = BOX if seed % 2 else LONG
    planner = OutlinePlanner(grid, footprint=body, clearance=0.08, least=0.0)
    start, goal = random.uniform(0.7, 5.3, (2, 2))
    heading = float(random.uniform(-3.0, 3.0)) if seed % 3 == 0 else None
    if planner.field.at_xy(*start) < body.radius:
        return
    try:
        plan = planner.plan((*start, 0.0), (*goal, heading))
    except PlanningFailure:
        return
    assert gap_under(body, plan, grid) > 0.0
    assert plan.room <= gap_under(body, plan, grid) + 0.01
    assert not planner.blocked(plan.poses)
    assert plan.poses[0, :2] == pytest.approx(start)
    assert plan.poses[-1, :2] == pytest.approx(goal)


def test_a_path_is_blocked_when_the_body_no_longer_passes() -> None:
    planner = OutlinePlanner(door(1.0), footprint=BOX, clearance=0.1)
    plan = planner.plan((4.0, 2.0, 1.57), (4.0, 6.0, None))
    assert not planner.blocked(plan.poses)
    assert not planner.blocked(plan.poses, 0.1)
    assert planner.blocked(plan.poses, 0.4)
    narrower = OutlinePlanner(door(0.4), footprint=BOX, clearance=0.1)
    assert narrower.blocked(plan.poses)
    cells: Floats = plan.poses.copy()
    assert planner.cost(cells) >= plan.length


def test_a_robot_that_stands_too_near_is_led_away() -> None:
    grid = empty(6.0, 0.05)
    grid.cells[60, 60] = 100
    beside = (3.025, 3.05 + 0.215 + 0.02, 0.0)
    planner = OutlinePlanner(grid, footprint=BOX, clearance=0.1, start_slack=0.075)
    plan = planner.plan(beside, (5.0, 4.5, None))
    away = [planner.field.at_xy(x, y) for x, y, _ in plan.poses]
    assert away[-1] > away[0]
    assert min(away) >= away[0] - 0.01


def test_the_same_question_gets_the_same_answer() -> None:
    planner = OutlinePlanner(walls(), footprint=BOX, clearance=0.1)
    first = planner.plan((5.0, 1.0, 0.0), (5.0, 9.0, None))
    planner.plan((5.0, 1.0, 0.0), (2.0, 4.0, None))
    assert (planner.plan((5.0, 1.0, 0.0), (5.0, 9.0, None)).poses == first.poses).all()
    assert first.length < 1.1 * 20.5
