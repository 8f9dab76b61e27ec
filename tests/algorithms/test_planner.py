import math
import time
from collections import deque
from typing import TypedDict

import numpy as np
import pytest
from hypothesis import strategies as st

from kompass.algorithms.distance_field import DistanceField
from kompass.algorithms.grid import Grid
from kompass.algorithms.planning import planner as planner_module
from kompass.algorithms.planning import sampling
from kompass.algorithms.planning.failure import PlanningFailure, Reason
from kompass.algorithms.planning.planner import GlobalPlanner
from kompass.algorithms.planning.sampling import planner_names
from tests.support.properties import property_test

from .worlds import brute_force_distance, empty, hexagon, walls

RADIUS, CLEARANCE = 0.105, 0.1
REQUIRED = RADIUS + CLEARANCE


@pytest.fixture(scope="module")
def in_hexagon() -> GlobalPlanner:
    return GlobalPlanner(hexagon(), robot_radius=RADIUS, clearance=CLEARANCE)


@pytest.fixture(scope="module")
def among_walls() -> GlobalPlanner:
    return GlobalPlanner(walls(), robot_radius=0.1, clearance=0.1)


def fails(
    planner: GlobalPlanner, start: tuple[float, ...], goal: tuple[float, ...]
) -> PlanningFailure:
    with pytest.raises(PlanningFailure) as caught:
        planner.check(start, goal)
    return caught.value


def random_free(planner: GlobalPlanner, rng: np.random.Generator, n: int) -> np.ndarray:
    """Places in the first large region of the map."""
    low, high = (-2.4, 2.4) if planner.grid.origin[0] else (0.3, 9.7)
    found: list[np.ndarray] = []
    while len(found) < n:
        point = rng.uniform(low, high, 2)
        if planner.field.at_xy(*point) >= planner.required:
            found.append(point)
    return np.array(found)


def dijkstra_optimum(planner: GlobalPlanner, start: np.ndarray, goal: np.ndarray) -> float:
    """The shortest 8-connected way over clear cells, by an implementation of its own."""
    import heapq

    clear = planner.field.lattice[1::2, 1::2] >= planner.required
    resolution = planner.grid.resolution
    (c0, r0), (c1, r1) = planner.grid.world_to_cell([start, goal]).tolist()
    assert clear[r0, c0]
    assert clear[r1, c1]
    best = {(r0, c0): 0.0}
    queue = [(0.0, r0, c0)]
    while queue:
        cost, r, c = heapq.heappop(queue)
        if (r, c) == (r1, c1):
            return cost * resolution
        if cost > best[r, c]:
            continue
        for dr in (-1, 0, 1):
            for dc in (-1, 0, 1):
                if (dr or dc) and clear[r + dr, c + dc]:
                    onward = cost + math.hypot(dr, dc)
                    if onward < best.get((r + dr, c + dc), math.inf):
                        best[r + dr, c + dc] = onward
                        heapq.heappush(queue, (onward, r + dr, c + dc))
    raise AssertionError("not connected")


def snap(planner: GlobalPlanner, points: np.ndarray) -> np.ndarray:
    return planner.grid.cell_to_world(planner.grid.world_to_cell(points))


@pytest.mark.parametrize("name", ["in_hexagon", "among_walls"])
def test_paths_are_as_short_as_the_optimum_over_the_grid(
    name: str, request: pytest.FixtureRequest
) -> None:
    planner: GlobalPlanner = request.getfixturevalue(name)
    ends = snap(planner, random_free(planner, np.random.default_rng(3), 60))
    ends = ends[planner.field.at(ends) >= planner.required + 0.002][:24].reshape(-1, 2, 2)
    for start, goal in ends:
        plan = planner.plan((*start, 0.0), (*goal, None))
        optimum = dijkstra_optimum(planner, start, goal)
        # Rounded corners may cost a little where the way is only a few cells long.
        assert plan.length <= 1.05 * optimum + 0.01, (start, goal)


@pytest.mark.parametrize("name", ["in_hexagon", "among_walls"])
def test_poses_and_the_motions_between_keep_radius_and_clearance(
    name: str, request: pytest.FixtureRequest
) -> None:
    planner: GlobalPlanner = request.getfixturevalue(name)
    # What lies beyond the map is an obstacle as well.
    occupied = np.pad(planner.grid.occupied(), 1, constant_values=True)
    ends = random_free(planner, np.random.default_rng(5), 8).reshape(-1, 2, 2)
    for start, goal in ends:
        plan = planner.plan((*start, 0.0), (*goal, None))
        share = np.linspace(0, 1, 11)[:, None, None]
        legs = plan.poses[:-1, :2] + (plan.poses[1:, :2] - plan.poses[:-1, :2]) * share
        points = legs.reshape(-1, 2) - planner.grid.origin[:2] + planner.grid.resolution
        near = brute_force_distance(occupied, planner.grid.resolution, points)
        assert near.min() >= planner.required - 0.002
        assert plan.min_clearance == pytest.approx(near.min(), abs=0.01)


def test_poses_are_equally_spaced_and_head_along_the_path(in_hexagon: GlobalPlanner) -> None:
    plan = in_hexagon.plan((-1.7, -0.55, 2.0), (1.6, 0.5, None))
    steps = np.diff(plan.poses[:, :2], axis=0)
    lengths = np.hypot(*steps.T)
    assert lengths.max() <= 0.1 + 1e-9
    assert lengths.min() >= 0.09
    assert plan.poses[:-1, 2] == pytest.approx(np.arctan2(steps[:, 1], steps[:, 0]))
    assert plan.poses[-1, 2] == plan.poses[-2, 2]
    assert plan.length == pytest.approx(lengths.sum())
    assert plan.poses[0, :2] == pytest.approx([-1.7, -0.55])
    assert plan.poses[-1, :2] == pytest.approx([1.6, 0.5])


def test_the_last_pose_has_the_goal_s_heading(in_hexagon: GlobalPlanner) -> None:
    plan = in_hexagon.plan((-1.7, -0.55, 0.0), (1.6, 0.5, 2.5))
    assert plan.poses[-1, 2] == 2.5
    assert plan.poses[-2, 2] != 2.5


def test_corners_are_rounded(among_walls: GlobalPlanner) -> None:
    plan = among_walls.plan((5, 1, 0), (5, 9, None))
    turns = np.abs(np.diff(np.unwrap(plan.poses[:-1, 2])))
    # Turning about a wall's end at 0.2 m, 0.1 m is half a radian.
    assert turns.max() < 0.6


def test_the_same_question_gets_the_same_answer(in_hexagon: GlobalPlanner) -> None:
    ends = ((-1.7, -0.55, 0.0), (1.6, 0.5, 0.0))
    first = in_hexagon.plan(*ends)
    in_hexagon.plan((0.55, 0.55, 0), (-0.55, -0.55, None))
    again = GlobalPlanner(hexagon(), robot_radius=RADIUS, clearance=CLEARANCE).plan(*ends)
    assert (in_hexagon.plan(*ends).poses == first.poses).all()
    assert (again.poses == first.poses).all()


def test_a_goal_where_the_robot_stands_is_a_plan_of_two_poses(in_hexagon: GlobalPlanner) -> None:
    plan = in_hexagon.plan((0.55, 0.55, 0.3), (0.55, 0.55, 1.0))
    assert plan.length == 0
    assert plan.poses.tolist() == [[0.55, 0.55, 0.3], [0.55, 0.55, 1.0]]


@pytest.mark.parametrize("resolution", [0.05, 0.25, 0.5])
def test_a_closed_wall_is_never_crossed(resolution: float) -> None:
    n = round(10 / resolution)
    cells = np.zeros((n, n), np.int8)
    cells[:, n // 2] = 100
    planner = GlobalPlanner(Grid(cells, resolution), robot_radius=0.1, clearance=0.05)
    failure = fails(planner, (2, 5, 0), (8, 5))
    assert failure.reason == "unreachable"
    assert failure.nearest is not None
    assert failure.nearest[0] < 5
    with pytest.raises(PlanningFailure):
        planner.plan((2, 5, 0), (8, 5, None))


def test_a_diagonal_wall_of_touching_cells_is_closed() -> None:
    n = 60
    cells = np.zeros((n, n), np.int8)
    cells[np.arange(n), np.arange(n)] = 100
    planner = GlobalPlanner(Grid(cells, 0.05), robot_radius=0.01, clearance=0.0)
    assert fails(planner, (2, 1, 0), (1, 2)).reason == "unreachable"


@property_test(st.integers(0, 2**31), many=25)
def test_what_is_said_to_be_reachable_is_planned_and_the_rest_is_not(seed: int) -> None:
    """Against a flood fill over the same clear cells, on random clutter."""
    rng = np.random.default_rng(seed)
    cells = np.where(rng.random((40, 40)) < 0.12, 100, 0).astype(np.int8)
    grid = Grid(cells, 0.1)
    planner = GlobalPlanner(grid, robot_radius=0.08, clearance=0.02)
    field = DistanceField(grid)
    clear = field.lattice[1::2, 1::2] >= 0.1
    places = np.argwhere(clear)
    start, goal = places[rng.integers(len(places), size=2)]
    reached = {tuple(start)}
    queue = deque([tuple(start)])
    while queue:
        r, c = queue.popleft()
        for dr, dc in ((0, 1), (1, 0), (0, -1), (-1, 0)):
            onward = (r + dr, c + dc)
            if (
                onward not in reached
                and clear[onward]
                and field.at_xy((c + 0.5 + dc / 2) * 0.1, (r + 0.5 + dr / 2) * 0.1) >= 0.105
            ):
                reached.add(onward)
                queue.append(onward)
    a = ((start[1] + 0.5) * 0.1, (start[0] + 0.5) * 0.1, 0.0)
    b = ((goal[1] + 0.5) * 0.1, (goal[0] + 0.5) * 0.1)
    try:
        planner.check(a, b)
    except PlanningFailure as failure:
        assert tuple(goal) not in reached
        if failure.nearest is not None:
            planner.check(a, failure.nearest)
    else:
        plan = planner.plan(a, (*b, None))
        assert planner.field.at(plan.poses[:, :2]).min() >= 0.1 - 1e-4
        assert not planner.blocked(plan.poses)


@pytest.mark.parametrize(
    ("goal", "reason", "words"),
    [
        ((20.0, 3.0), "outside_map", r"\(20\.00, 3\.00\) is outside the map"),
        ((0.0, 0.0), "occupied", "inside an obstacle"),
        ((0.25, 0.0), "too_close", r"0\.10 m from an obstacle; the robot needs 0\.2"),
    ],
)
def test_a_bad_goal_is_refused_with_the_nearest_reachable_place(
    in_hexagon: GlobalPlanner, goal: tuple[float, float], reason: Reason, words: str
) -> None:
    failure = fails(in_hexagon, (0.55, 0.55, 0), goal)
    assert failure.reason is reason
    assert failure.nearest is not None
    in_hexagon.check((0.55, 0.55, 0), failure.nearest)
    with pytest.raises(PlanningFailure, match=words):
        in_hexagon.plan((0.55, 0.55, 0), (*goal, None))


def test_unexplored_space_is_closed_unless_opened() -> None:
    cells = np.zeros((100, 100), np.int8)
    cells[:, 60:] = -1
    closed = GlobalPlanner(Grid(cells, 0.05), robot_radius=0.1)
    failure = fails(closed, (1, 1, 0), (4, 1))
    assert failure.reason == "occupied"
    assert "unexplored" in failure.message
    GlobalPlanner(Grid(cells, 0.05), robot_radius=0.1, unknown_is_obstacle=False).check(
        (1, 1, 0), (4, 1)
    )


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (50.0, 0.0, 0.0)])
def test_a_start_in_an_obstacle_or_off_the_map_is_said_to_be_blocked(
    in_hexagon: GlobalPlanner, start: tuple[float, float, float]
) -> None:
    assert fails(in_hexagon, start, (0.55, 0.55)).reason == "start_blocked"


@pytest.mark.parametrize("angle", np.linspace(0, 2 * np.pi, 8, endpoint=False).tolist())
def test_a_start_inside_the_clearance_is_left_without_coming_closer(
    in_hexagon: GlobalPlanner, angle: float
) -> None:
    away = 0.15 + RADIUS + 0.03
    start = (away * math.cos(angle), away * math.sin(angle), 0.0)
    here = in_hexagon.field.at_xy(start[0], start[1])
    assert RADIUS < here < REQUIRED
    plan = in_hexagon.plan(start, (1.6, 0.5, None))
    distances = in_hexagon.field.at(plan.poses[:, :2])
    assert distances.min() >= here - 1e-4
    out = np.hypot(plan.poses[:, 0] - start[0], plan.poses[:, 1] - start[1]) > 0.4
    assert distances[out].min() >= REQUIRED - 1e-4
    assert plan.min_clearance == pytest.approx(here, abs=0.01)


def test_a_path_is_blocked_when_the_body_no_longer_passes(in_hexagon: GlobalPlanner) -> None:
    plan = in_hexagon.plan((-1.7, -0.55, 0.0), (1.6, -0.55, None))
    assert not in_hexagon.blocked(plan.poses)
    grid = hexagon()
    cells = grid.cells.copy()
    middle = plan.poses[len(plan.poses) // 2]
    col, row = grid.world_to_cell([middle[:2]])[0]
    cells[row, col] = 100
    changed = GlobalPlanner(
        Grid(cells, grid.resolution, grid.origin), robot_radius=RADIUS, clearance=CLEARANCE
    )
    assert changed.blocked(plan.poses)
    assert not changed.blocked(changed.plan((-1.7, -0.55, 0.0), (1.6, -0.55, None)).poses)


def test_an_obstacle_nearer_than_the_clearance_but_not_the_body_does_not_block() -> None:
    cells = np.zeros((100, 100), np.int8)
    cells[53, 50] = 100
    planner = GlobalPlanner(Grid(cells, 0.05), robot_radius=0.1, clearance=0.2)
    assert not planner.blocked([(1, 2.5, 0), (4, 2.5, 0)])
    assert planner.blocked([(1, 2.56, 0), (4, 2.56, 0)])
    assert planner.blocked([(1, 2.5, 0), (9, 2.5, 0)])


def test_a_reachable_goal_is_planned_even_when_sampling_finds_nothing(
    monkeypatch: pytest.MonkeyPatch, among_walls: GlobalPlanner
) -> None:
    monkeypatch.setattr(planner_module, "search", lambda *_args, **_options: None)
    plan = among_walls.plan((5, 1, 0), (5, 9, None))
    assert among_walls.field.at(plan.poses[:, :2]).min() >= 0.2 - 1e-4


@pytest.mark.parametrize("name", ["RRTConnect", "RRTstar"])
def test_a_busy_machine_finds_the_same_path_as_an_idle_one(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def way() -> np.ndarray | None:
        return sampling.search(
            field,
            0.2,
            (5, 1),
            (5, 9),
            bounds=(np.array([0.3, 0.3]), np.array([9.7, 9.7])),
            planner=name,
            timeout=0.05,
            seed=1,
        )

    field = DistanceField(walls())
    idle = way()
    clear = field.segment_clear

    def slowly(*motion: float) -> bool:
        time.sleep(0.0002)
        return clear(*motion)

    monkeypatch.setattr(field, "segment_clear", slowly)
    starved = way()
    assert (idle is None) == (starved is None)
    if idle is not None and starved is not None:
        np.testing.assert_array_equal(idle, starved)


@pytest.mark.parametrize("name", ["KPIECE1", "ompl.geometric.RRT", "BFMT"])
def test_planners_are_chosen_by_name_with_or_without_the_library_s(name: str) -> None:
    planner = GlobalPlanner(hexagon(), robot_radius=RADIUS, planner_id=name, timeout=0.3)
    assert planner.plan((-1.7, -0.55, 0), (1.6, 0.5, None)).length < 4.2


def test_an_unknown_planner_is_refused_with_the_nearest_name() -> None:
    assert "RRTConnect" in planner_names()
    with pytest.raises(ValueError, match="'RRTConect' is not in this OMPL; did you mean 'RRTConn"):
        GlobalPlanner(empty(1.0), robot_radius=0.1, planner_id="RRTConect")


def test_a_map_turned_and_shifted_is_planned_on_as_well() -> None:
    planner = GlobalPlanner(Grid(walls().cells, 0.05, (2.0, 1.0, 0.5)), robot_radius=0.1)
    start, goal = planner.grid.cell_to_world([(100, 20), (100, 180)])
    plan = planner.plan((*start, 0.0), (*goal, None))
    assert plan.length < 19.5
    assert plan.min_clearance >= 0.2 - 1e-3


class Arguments(TypedDict, total=False):
    robot_radius: float
    clearance: float
    points_per_meter: float
    timeout: float


@pytest.mark.parametrize(
    "bad", [{"robot_radius": 0}, {"clearance": -1}, {"points_per_meter": 0}, {"timeout": math.nan}]
)
def test_an_argument_out_of_range_is_refused_by_name(bad: Arguments) -> None:
    arguments: Arguments = {"robot_radius": 0.1, **bad}
    with pytest.raises(ValueError, match=next(iter(bad))):
        GlobalPlanner(empty(1.0), **arguments)


@pytest.mark.parametrize("points_per_meter", [1.5, 3, 10, 40])
def test_however_few_poses_the_chords_between_them_cut_no_corner(points_per_meter: float) -> None:
    planner = GlobalPlanner(walls(), robot_radius=0.1, points_per_meter=points_per_meter)
    plan = planner.plan((5, 1, 0), (5, 9, None))
    legs = plan.poses[:, :2]
    assert planner.field.segments_clear(legs[:-1], legs[1:], planner.required).all()
    assert np.hypot(*np.diff(legs, axis=0).T).max() <= 1.0 / points_per_meter + 1e-9


def test_another_clearance_gives_what_a_planner_made_with_it_gives() -> None:
    wide = GlobalPlanner(walls(), robot_radius=0.1, clearance=0.4)
    narrow = GlobalPlanner(walls(), robot_radius=0.1, clearance=0.05)
    ends = (np.array([1.0, 1.0, 0.0]), (9.0, 9.0, None))
    changed = wide.with_clearance(0.05).plan(*ends)
    np.testing.assert_array_equal(changed.poses, narrow.plan(*ends).poses)
    assert changed.min_clearance < wide.required
    assert wide.plan(*ends).min_clearance >= wide.required - 0.01, "the first is as it was"


def test_a_robot_a_little_too_near_to_what_it_sees_is_led_out_when_that_is_allowed() -> None:
    grid = empty(4.0, 0.05)
    grid.cells[40, 42] = 100
    beside = (2.02, 2.025, 0.0)  # 0.08 m from the cell's edge
    strict = GlobalPlanner(grid, robot_radius=0.1, clearance=0.1)
    assert fails(strict, beside, (0.5, 2.0)).reason == "start_blocked"
    lenient = GlobalPlanner(grid, robot_radius=0.1, clearance=0.1, start_slack=0.075)
    plan = lenient.plan(beside, (0.5, 2.0, None))
    assert plan.min_clearance == pytest.approx(0.08, abs=0.02)
    inside = (2.09, 2.025, 0.0)
    assert fails(lenient, inside, (0.5, 2.0)).reason == "start_blocked"
    with pytest.raises(ValueError, match=r"start_slack: -1 m; give 0 or more"):
        GlobalPlanner(grid, robot_radius=0.1, start_slack=-1)
