"""The deformable virtual zone: what reaches into it, and where the robot is pushed."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from kompass.algorithms.following.dvz import DVZ, DVZParams
from kompass.algorithms.following.follower import NoCommand
from kompass.algorithms.following.stanley import Stanley, StanleyParams
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, inverse, transform_points
from kompass.algorithms.motion_model import MotionModel

from .worlds import PATHS, STRAIGHT, drive

RADIUS = 0.105
ROBOT: dict[str, Any] = {
    "max_v": 0.22,
    "max_omega": 1.5,
    "acc": 1.0,
    "decel": 2.0,
    "omega_acc": 3.0,
}
AT = math.radians(10.0)


def dvz(body: Footprint | None = None, **params: Any) -> DVZ:
    return DVZ(DVZParams(**params), footprint=body or Footprint.circle(RADIUS), **ROBOT)


def around(obstacles: Floats) -> Callable[[Floats], Floats]:
    return lambda pose: transform_points(inverse(pose), obstacles)


def posts(*centres: tuple[float, float], radius: float = 0.05) -> Floats:
    turn = np.linspace(0, 2 * math.pi, 24, endpoint=False)
    ring = radius * np.column_stack([np.cos(turn), np.sin(turn)])
    return np.concatenate([ring + centre for centre in centres])


def gap(poses: Floats, obstacles: Floats) -> float:
    """The least distance between body and obstacles [m]; below 0 is a collision."""
    apart = np.linalg.norm(poses[:, None, :2] - obstacles, axis=2)
    return float(apart.min()) - RADIUS


def at(*bearings: float, distance: float = 0.3) -> Floats:
    return distance * np.array([(math.cos(each), math.sin(each)) for each in bearings])


def test_what_is_on_both_sides_of_straight_ahead_is_ahead() -> None:
    found = dvz().deformation(at(AT, -AT), 0.1)
    assert found.bearing == pytest.approx(0.0, abs=0.05)
    assert found.depth > 0.0
    behind = dvz(side_margin_width_ratio=0.3).deformation(at(math.pi - AT, AT - math.pi), 0.1)
    assert abs(behind.bearing) == pytest.approx(math.pi, abs=0.05)


def test_the_nearer_and_the_faster_the_deeper_and_outside_nothing_counts() -> None:
    follower = dvz()
    depths = [
        follower.deformation(at(0.0, distance=each), 0.0).depth for each in (0.35, 0.25, 0.15)
    ]
    assert 0.0 < depths[0] < depths[1] < depths[2]
    far = at(0.0, distance=0.6)
    assert follower.deformation(far, 0.0).depth == 0.0
    assert follower.deformation(far, 0.22).depth > 0.0
    assert follower.deformation(at(math.pi / 2, distance=0.4), 0.22).depth == 0.0
    ring = posts((0, 0), radius=0.12)
    assert follower.deformation(ring[ring[:, 0] > 0], 0.0).depth <= 1.0


@pytest.mark.parametrize("name", PATHS)
def test_with_an_untouched_zone_it_is_stanley(name: str) -> None:
    path, far = PATHS[name], np.array([(50.0, 50.0)])
    one = dvz(wheel_base=0.2)
    other = Stanley(StanleyParams(wheel_base=0.2), **ROBOT)
    runs = []
    for follower in (one, other):
        follower.set_path(path)
        runs.append(drive(follower, (0, 0, float(path[0, 2])), points=around(far)))
    assert np.array_equal(runs[0].commands, runs[1].commands)


@pytest.mark.parametrize(
    "centres",
    [[(2.5, 0.1)], [(2.5, -0.06)], [(2.5, -0.15), (1.2, 0.1)], [(2, 0.3), (2, -0.3)], [(2.5, 0.0)]],
)
def test_posts_beside_and_on_the_path_are_passed_without_touching(
    centres: list[tuple[float, float]],
) -> None:
    obstacles = posts(*centres)
    follower = dvz()
    follower.set_path(STRAIGHT)
    run = drive(follower, (0, 0, 0), points=around(obstacles))
    assert run.arrived
    assert run.error_to(STRAIGHT[-1])[0] <= 0.03
    assert gap(run.poses, obstacles) > 0.0


def test_along_walls_on_both_sides_it_keeps_to_the_middle() -> None:
    along = np.linspace(-1.0, 6.0, 300)
    walls = np.concatenate([np.column_stack([along, np.full(300, y)]) for y in (-0.25, 0.25)])
    follower = dvz()
    follower.set_path(STRAIGHT)
    run = drive(follower, (0, 0.05, 0), points=around(walls))
    assert run.arrived
    assert gap(run.poses, walls) > 0.08
    assert run.duration < 40.0


def test_before_a_wall_across_the_path_it_never_touches() -> None:
    wall = np.column_stack([np.full(400, 1.5), np.linspace(-4, 4, 400)])
    follower = dvz()
    follower.set_path(STRAIGHT)
    run = drive(follower, (0, 0, 0), points=around(wall), limit=30)
    assert not run.arrived
    assert run.poses[:, 0].max() > 1.0
    assert gap(run.poses, wall) > 0.0


def test_a_robot_hemmed_in_has_no_command() -> None:
    follower = dvz(clearance=0.06)
    follower.set_path(STRAIGHT)
    with pytest.raises(NoCommand, match=r"No way ahead is free; the nearest obstacle is 0\.0\d m"):
        follower.step((1, 0, 0), 0.0, 0.0, 0.1, posts((0, 0), radius=0.13))


def test_a_car_before_a_wall_has_no_command_and_asks_for_no_turn_on_the_spot() -> None:
    wall = np.column_stack([np.full(80, 0.54), np.linspace(-0.4, 0.4, 80)])
    body = Footprint(np.array([[0.5, -0.2], [0.5, 0.2], [-0.1, 0.2], [-0.1, -0.2]]))
    follower = DVZ(DVZParams(clearance=0.06), footprint=body, motion=MotionModel(0.6), **ROBOT)
    follower.set_path(STRAIGHT)
    with pytest.raises(NoCommand, match="No way ahead is free"):
        follower.step((0, 0, 0), 0.0, 0.0, 0.1, wall)


def test_a_robot_too_close_to_something_may_leave_it() -> None:
    behind = np.array([(-0.11, y) for y in np.linspace(-0.1, 0.1, 9)])
    for obstacles, ahead in ((behind, True), (-behind, False)):
        follower = dvz()
        follower.set_path(STRAIGHT)
        command = follower.step((1, 0, 0), 0.0, 0.0, 0.1, obstacles).command
        assert (command.vx > 0.0) == ahead
        assert ahead or abs(command.omega) >= 0.1, "it turns away"


def test_the_outline_counts_and_not_a_circle_around_it() -> None:
    """A long body passes between posts that a circle around it would touch."""
    body = Footprint(np.array([[0.3, -0.1], [0.3, 0.1], [-0.3, 0.1], [-0.3, -0.1]]))
    obstacles = posts((2.0, 0.25), (2.0, -0.25))
    follower = dvz(body)
    follower.set_path(STRAIGHT)
    run = drive(follower, (0, 0, 0), points=around(obstacles))
    assert run.arrived
    for pose in run.poses:
        assert body.distance(transform_points(inverse(pose), obstacles)).min() > 0.0


def test_a_goal_beside_a_wall_is_reached() -> None:
    wall = np.column_stack([np.linspace(-1, 6, 400), np.full(400, -RADIUS - 0.05)])
    follower = dvz()
    follower.set_path(STRAIGHT)
    run = drive(follower, (0, 0.3, 0), points=around(wall))
    assert run.arrived
    assert run.error_to(STRAIGHT[-1])[0] <= 0.03
    assert gap(run.poses, wall) > 0.0


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 5, 7])
def test_commands_keep_the_limits_among_posts(seed: int) -> None:
    chance = np.random.default_rng(seed)
    obstacles = posts(*(tuple(each) for each in chance.uniform((0.5, -0.6), (4.5, 0.6), (8, 2))))
    follower = dvz()
    follower.set_path(STRAIGHT)
    run = drive(follower, (0, 0, 0), points=around(obstacles), limit=80)
    assert run.arrived
    assert gap(run.poses, obstacles) > 0.0
    v, omega = run.commands.T
    assert v.min() >= 0.0
    assert v.max() <= 0.22 + 1e-9
    assert np.abs(omega).max() <= 1.5 + 1e-9
    dv = np.diff(v, prepend=0.0)
    assert dv.max() <= 1.0 * 0.1 + 1e-9
    assert dv.min() >= -2.0 * 0.1 - 1e-9
    assert np.abs(np.diff(omega, prepend=0.0)).max() <= 3.0 * 0.1 + 1e-9


@pytest.mark.parametrize(
    ("field", "value"),
    [("min_front_margin", 0.0), ("side_margin_width_ratio", -1.0), ("K_I", 0.0), ("K_linear", 11)],
)
def test_parameters_out_of_range_are_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        DVZParams(**{field: value})
