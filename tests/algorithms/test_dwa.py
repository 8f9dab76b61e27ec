import math

import numpy as np
import pytest

from kompass.algorithms.following.dwa import DWA, DWAParams
from kompass.algorithms.following.follower import NoCommand
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, inverse, transform_points

from .worlds import PATHS, STRAIGHT, distance_to_polyline, drive

ROBOT = {"max_v": 0.22, "max_omega": 1.5, "acc": 1.0, "decel": 2.0, "omega_acc": 3.0}
RADIUS = 0.105


def dwa() -> DWA:
    return DWA(DWAParams(), footprint=Footprint.circle(RADIUS), **ROBOT)


def posts(*centres: tuple[float, float], radius: float = 0.05) -> Floats:
    turn = np.linspace(0, 2 * math.pi, 24, endpoint=False)
    ring = radius * np.column_stack([np.cos(turn), np.sin(turn)])
    return np.concatenate([ring + centre for centre in centres])


def gap(poses: Floats, obstacles: Floats) -> float:
    """The least distance between body and obstacles [m]; below 0 is a collision."""
    apart = np.linalg.norm(poses[:, None, :2] - obstacles, axis=2)
    return float(apart.min()) - RADIUS


@pytest.mark.parametrize("name", PATHS)
def test_without_obstacles_every_path_is_driven_to_its_very_end(name: str) -> None:
    path = PATHS[name]
    follower = dwa()
    follower.set_path(path)
    run = drive(follower, (0, 0, float(path[0, 2])), points=lambda _pose: np.empty((0, 2)))
    assert run.arrived
    distance, heading = run.error_to(path[-1])
    assert distance <= 0.03
    assert heading <= 0.05
    assert distance_to_polyline(run.poses[:, :2], path).max() <= 0.09


@pytest.mark.parametrize(
    "centres", [[(2.5, 0.1)], [(2.5, -0.06)], [(2.5, -0.15), (1.2, 0.1)], [(2, 0.25), (2, -0.25)]]
)
def test_posts_beside_and_partly_on_the_path_are_passed_without_touching(
    centres: list[tuple[float, float]],
) -> None:
    obstacles = posts(*centres)
    follower = dwa()
    follower.set_path(STRAIGHT)
    run = drive(follower, (0, 0, 0), points=lambda pose: transform_points(inverse(pose), obstacles))
    assert run.arrived
    assert run.error_to(STRAIGHT[-1])[0] <= 0.03
    assert gap(run.poses, obstacles) > 0.0


@pytest.mark.parametrize("turn", np.linspace(0.0, 1.5, 7))
def test_what_a_grid_rounds_holds_up_no_robot_that_keeps_the_planners_distance(
    turn: float,
) -> None:
    """A wall as a local map has it, in cells of 5 cm that turn with the robot."""
    cell, keeps = 0.05, RADIUS + 0.1
    wall = np.column_stack([np.linspace(-0.2, 2.2, 500), np.full(500, keeps)])
    cos, sin = math.cos(turn), math.sin(turn)
    to_grid = np.array([[cos, -sin], [sin, cos]])

    def local_map(pose: Floats) -> Floats:
        seen = transform_points(inverse(pose), wall) @ to_grid
        cells = np.unique(np.floor(seen / cell), axis=0)
        return np.asarray((cells + 0.5) * cell @ to_grid.T)

    follower = dwa()
    follower.set_path(STRAIGHT[STRAIGHT[:, 0] <= 2.0])
    run = drive(follower, (0, 0, 0), points=local_map, limit=15)
    assert run.arrived
    assert gap(run.poses, wall) > 0.0


def test_before_a_wall_across_the_path_it_stops_without_touching() -> None:
    wall = np.column_stack([np.full(200, 1.5), np.linspace(-2, 2, 200)])
    follower = dwa()
    follower.set_path(STRAIGHT)
    run = drive(
        follower, (0, 0, 0), points=lambda pose: transform_points(inverse(pose), wall), limit=30
    )
    assert not run.arrived
    assert gap(run.poses, wall) > 0.0


def test_a_robot_hemmed_in_has_no_command() -> None:
    follower, ring = dwa(), posts((1, 0), radius=0.2)
    follower.set_path(STRAIGHT)
    poses: list[Floats] = []
    with pytest.raises(NoCommand, match=r"No direction keeps 0\.1. m .* the nearest is at 0\.1"):
        drive(
            follower,
            (1, 0, 0),
            points=lambda pose: transform_points(inverse(pose), ring),
            at_step=lambda _, pose: poses.append(pose),
        )
    assert gap(np.array(poses), ring) > 0.0


def test_a_robot_too_close_to_something_may_leave_it() -> None:
    follower = dwa()
    follower.set_path(STRAIGHT)
    behind = np.array([(-0.11, y) for y in np.linspace(-0.1, 0.1, 9)])
    step = follower.step((1, 0, 0), 0.0, 0.0, 0.1, behind)
    assert step.command.vx > 0.0
    # And what is right ahead is turned away from, not driven into.
    step = dwa_at_rest().step((1, 0, 0), 0.0, 0.0, 0.1, -behind)
    assert step.command.vx == 0.0
    assert step.command.omega != 0.0


def dwa_at_rest() -> DWA:
    follower = dwa()
    follower.set_path(STRAIGHT)
    return follower


@pytest.mark.parametrize(
    ("field", "value"), [("linear_samples", 1), ("resolution", 0.0), ("clearance", -1.0)]
)
def test_parameters_out_of_range_are_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        DWAParams(**{field: value})  # type: ignore[arg-type]
