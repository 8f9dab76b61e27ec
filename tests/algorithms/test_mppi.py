import math
from typing import Any

import numpy as np
import pytest

from kompass.algorithms.following.follower import NoCommand
from kompass.algorithms.following.mppi import MPPI, MPPIParams
from kompass.algorithms.following.point_field import Singles
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, inverse, transform_points
from kompass.algorithms.mapping.moving import seen_from

from .worlds import PATHS, STRAIGHT, Run, distance_to_polyline, drive

SMALL: dict[str, Any] = {
    "max_v": 0.22,
    "max_omega": 1.5,
    "acc": 1.0,
    "decel": 2.0,
    "omega_acc": 3.0,
}
LARGE: dict[str, Any] = {
    "max_v": 2.0,
    "max_omega": 4.0,
    "acc": 4.0,
    "decel": 4.0,
    "omega_acc": 10.0,
}
BOX = Footprint(np.array([[0.254, 0.215], [-0.254, 0.215], [-0.254, -0.215], [0.254, -0.215]]))
NOTHING = np.empty((0, 2))


def small() -> MPPI:
    return MPPI(footprint=Footprint.circle(0.105), **SMALL)


def large() -> MPPI:
    return MPPI(footprint=BOX, **LARGE)


class Thorough(MPPI):
    """Looks at the outline everywhere."""

    def _room(self, *args: Any, **kwargs: Any) -> Singles:
        free, self._free = self._free, np.float32(np.inf)
        room = super()._room(*args, **kwargs)
        self._free = free
        return room


def posts(*centres: tuple[float, float], radius: float = 0.075) -> Floats:
    turn = np.linspace(0, 2 * math.pi, 24, endpoint=False)
    ring = radius * np.column_stack([np.cos(turn), np.sin(turn)])
    return np.concatenate([ring + centre for centre in centres])


def among(follower: MPPI, obstacles: Floats, *, limit: float = 60.0, dt: float = 0.05) -> Run:
    follower.set_path(STRAIGHT)
    return drive(
        follower,
        (0, 0, 0),
        dt=dt,
        limit=limit,
        points=lambda pose: transform_points(inverse(pose), obstacles),
    )


def gap(footprint: Footprint, run: Run, obstacles: Floats) -> float:
    """The least distance between body and obstacles [m]; below 0 is a collision."""
    return min(
        float(footprint.distance(transform_points(inverse(pose), obstacles)).min())
        for pose in run.poses
    )


@pytest.mark.parametrize("name", PATHS)
def test_without_obstacles_every_path_is_driven_to_its_very_end(name: str) -> None:
    path = PATHS[name]
    follower = small()
    follower.set_path(path)
    run = drive(follower, (0, 0, float(path[0, 2])), points=lambda _pose: NOTHING)
    assert run.arrived
    distance, heading = run.error_to(path[-1])
    assert distance <= 0.03
    assert heading <= 0.05
    assert distance_to_polyline(run.poses[:, :2], path).max() <= 0.12


@pytest.mark.parametrize(
    "centres",
    [[(2.5, 0.1)], [(2.5, 0.06)], [(2.5, -0.15), (1.2, 0.1)], [(2, 0.5), (2, -0.2), (3.5, 0.1)]],
)
def test_posts_on_the_path_are_passed_without_touching(centres: list[tuple[float, float]]) -> None:
    obstacles = posts(*centres)
    run = among(small(), obstacles, dt=0.1)
    assert run.arrived
    assert run.error_to(STRAIGHT[-1])[0] <= 0.03
    assert gap(Footprint.circle(0.105), run, obstacles) > 0.0


def test_what_fills_the_way_is_stood_before_without_touching() -> None:
    obstacles = posts((2.5, 0.0))
    run = among(small(), obstacles, dt=0.1)
    assert gap(Footprint.circle(0.105), run, obstacles) > 0.0


def test_a_long_body_passes_a_gap_that_its_circle_would_not_fit() -> None:
    # 0.58 m between the posts: 0.15 m more than it is wide, 0.09 m less than its circle.
    obstacles = posts((2.5, 0.365), (2.5, -0.365))
    run = among(large(), obstacles)
    assert run.arrived
    assert gap(BOX, run, obstacles) > 0.0
    assert BOX.radius * 2 > 0.58


def test_at_full_speed_it_stops_before_a_wall_without_touching() -> None:
    wall = np.column_stack([np.full(400, 4.0), np.linspace(-4, 4, 400)])
    run = among(large(), wall, limit=8.0)
    assert not run.arrived
    assert run.commands[:, 0].max() > 1.5
    assert gap(BOX, run, wall) > 0.0


def test_it_turns_round_though_the_path_begins_behind_it() -> None:
    follower = small()
    follower.set_path(STRAIGHT)
    run = drive(follower, (0, 0, math.pi), points=lambda _pose: NOTHING)
    assert run.arrived
    assert distance_to_polyline(run.poses[:, :2], STRAIGHT).max() <= 0.25


def test_where_it_is_too_late_to_stop_it_brakes_as_hard_as_it_can_and_turns_aside() -> None:
    post = np.array([(0.6, y) for y in np.linspace(0.1, 0.3, 9)])
    follower = large()
    follower.set_path(STRAIGHT)
    command = follower.step((0, 0, 0), 2.0, 0.0, 0.05, post).command
    assert command.vx == pytest.approx(2.0 - 0.05 * LARGE["decel"])
    assert command.omega < 0.0, "most of it lies to the left"


def test_a_robot_too_close_to_something_may_leave_it() -> None:
    behind = np.array([(-0.12, y) for y in np.linspace(-0.1, 0.1, 9)])
    follower = small()
    follower.set_path(STRAIGHT)
    assert follower.step((1, 0, 0), 0.0, 0.0, 0.1, behind).command.vx > 0.0
    # And what is right ahead is not driven into.
    other = small()
    other.set_path(STRAIGHT)
    assert other.step((1, 0, 0), 0.0, 0.0, 0.1, -behind).command.vx <= 0.02


@pytest.mark.parametrize(("begin", "speed"), [(-1.4, 0.6), (-1.0, 0.4), (-2.2, 1.0)])
def test_whoever_crosses_is_let_pass_and_not_touched_while_it_moves(
    begin: float, speed: float
) -> None:
    body, person = Footprint.circle(0.105), 0.2
    follower = small()
    follower.set_path(STRAIGHT[:30])
    pose, v, omega = (0.0, 0.0, 0.0), 0.0, 0.0
    for step in range(400):
        # He walks over its way, 0.6 m ahead of where it sets out, and is gone.
        here = (0.6, begin + speed * 0.1 * step)
        movers = np.array([[*here, 0.0, speed, person]])
        done = follower.step(
            pose,
            v,
            omega,
            0.1,
            transform_points(inverse(pose), posts(here, radius=person)),
            seen_from(pose, movers),
        )
        v, omega = done.command.vx, done.command.omega
        yaw = pose[2] + 0.05 * omega
        pose = (
            pose[0] + 0.1 * v * math.cos(yaw),
            pose[1] + 0.1 * v * math.sin(yaw),
            yaw + 0.05 * omega,
        )
        apart = math.hypot(pose[0] - here[0], pose[1] - here[1]) - body.radius - person
        assert apart > 0.0 or v <= 0.02
        if done.phase == "arrived":
            break
    assert done.phase == "arrived"


def test_what_is_only_looked_at_near_something_is_judged_as_under_the_whole_outline() -> None:
    obstacles = posts((1.2, 0.4), (1.9, -0.45), (2.6, 0.5), (3.2, -0.3))
    thorough = Thorough(footprint=BOX, **LARGE)
    first, second = (among(each, obstacles, limit=4.0) for each in (large(), thorough))
    assert first.commands == pytest.approx(second.commands, abs=1e-4)
    assert gap(BOX, first, obstacles) < 0.25, "or the outline would not have mattered"


def test_a_speed_that_no_robot_has_is_braked_from_and_nothing_else() -> None:
    follower = large()
    follower.set_path(STRAIGHT)
    command = follower.step((0, 0, 0), 300.0, 0.0, 0.05, posts((2.5, 0.1))).command
    assert 0.0 <= command.vx < 300.0


def test_who_is_enclosed_says_that_there_is_no_way_and_who_can_turn_to_one_does() -> None:
    turn = np.linspace(0.0, 2.0 * math.pi, 90)
    ring = 0.145 * np.column_stack([np.cos(turn), np.sin(turn)])
    follower = small()
    follower.set_path(STRAIGHT)
    with pytest.raises(NoCommand, match=r"the nearest is at 0\.04 m"):
        follower.step((0, 0, 0), 0.0, 0.0, 0.1, ring)
    # Open where it came from, and where nobody wants it to go.
    pocket = ring[ring[:, 0] > 0.0]
    follower.step((0, 0, 0), 0.0, 0.0, 0.1, pocket)


def test_the_end_of_the_path_in_sight_does_not_slow_it_down_before_it_has_to_brake() -> None:
    run = among(small(), NOTHING)
    assert run.arrived
    far = run.poses[:-1, 0] < 5.0 - 0.35
    assert run.commands[far, 0][5:].min() > 0.95 * SMALL["max_v"]


@pytest.mark.parametrize("aside", [0.0, 0.5, -0.8])
def test_a_wall_right_behind_the_goal_is_neither_touched_nor_a_reason_to_miss_it(
    aside: float,
) -> None:
    along = np.linspace(-1.5, 1.5, 200)
    wall = np.column_stack([5.0 + 0.105 + 0.08 + aside * along, along])
    run = among(small(), wall[wall[:, 0] > 5.12])
    assert run.arrived
    assert run.error_to(STRAIGHT[-1])[0] <= 0.03
    assert gap(Footprint.circle(0.105), run, wall[wall[:, 0] > 5.12]) > 0.0


def test_the_same_inputs_give_the_same_commands() -> None:
    obstacles = posts((2.5, 0.1), (1.2, -0.2))
    first, second = (among(small(), obstacles, limit=5.0, dt=0.1) for _ in range(2))
    assert first.commands.tobytes() == second.commands.tobytes()


@pytest.mark.parametrize(
    ("field", "value"),
    [("rollouts", 1), ("temperature", 0.0), ("resolution", 0.0), ("clearance", -1.0)],
)
def test_parameters_out_of_range_are_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        MPPIParams(**{field: value})  # type: ignore[arg-type]


def test_more_places_than_any_robot_has_time_for_are_refused() -> None:
    with pytest.raises(ValueError, match="fewer rollouts or a longer step"):
        MPPIParams(rollouts=20000, prediction_time=10.0, time_step=0.02)
    with pytest.raises(ValueError, match="at least four times"):
        MPPIParams(prediction_time=0.2, time_step=0.1)
