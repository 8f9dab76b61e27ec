"""Followers ask of steered wheels only what these can do, and of a robot that slides, a slide."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

from kompass.algorithms.following.dvz import DVZ, DVZParams
from kompass.algorithms.following.dwa import DWA
from kompass.algorithms.following.limits import Limits
from kompass.algorithms.following.mppi import MPPI
from kompass.algorithms.following.pure_pursuit import PurePursuit
from kompass.algorithms.following.stanley import Stanley, StanleyParams
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats
from kompass.algorithms.motion_model import MotionModel
from kompass.algorithms.planning.car_planner import CarPlanner

from .worlds import STRAIGHT, distance_to_polyline, drive, empty

RADIUS = 0.6
BODY = Footprint(np.array([[0.5, -0.2], [0.5, 0.2], [-0.1, 0.2], [-0.1, -0.2]]))
CAR: dict[str, Any] = {
    "max_v": 0.8,
    "max_omega": 2.0,
    "acc": 1.5,
    "decel": 2.5,
    "omega_acc": 5.0,
    "footprint": BODY,
    "motion": MotionModel(RADIUS),
}
FOLLOWERS = [PurePursuit, Stanley, DVZ, MPPI]
GOALS = [(6.0, 4.0, None), (3.0, 5.0, math.pi), (1.5, 3.2, 0.0), (2.0, 3.0, math.pi)]


@pytest.fixture(params=FOLLOWERS)
def follower(request: pytest.FixtureRequest) -> Any:
    if request.param is Stanley:
        return Stanley(StanleyParams(wheel_base=0.4, max_steer=0.588), **CAR)
    if request.param is DVZ:
        return DVZ(DVZParams(wheel_base=0.4, max_steer=0.588), **CAR)
    return request.param(**CAR)


def planned(goal: tuple[float, float, float | None]) -> Floats:
    made = CarPlanner(empty(8.0), footprint=BODY, turning_radius=1.1 * RADIUS)
    return made.plan((2.0, 3.0, 0.0), goal).poses


@pytest.mark.parametrize("goal", GOALS)
def test_a_path_ahead_and_back_is_driven_to_its_end(
    follower: Any, goal: tuple[float, float, float | None]
) -> None:
    path = planned(goal)
    follower.set_path(path)
    run = drive(follower, (2.0, 3.0, 0.0), limit=60.0)
    assert run.arrived
    distance, heading = run.error_to(path[-1])
    assert distance <= 0.08
    assert heading <= 0.3
    assert distance_to_polyline(run.poses[:, :2], path).max() <= 0.15
    v, omega = run.commands.T
    assert (np.abs(omega) * RADIUS <= np.abs(v) + 1e-9).all()
    assert np.abs(v).max() <= 0.8 + 1e-9
    assert v.min() >= -0.4 - 1e-6, "backwards it takes its time"


def test_wheels_are_turned_round_only_at_rest(follower: Any) -> None:
    follower.set_path(planned((2.0, 3.0, math.pi)))
    run = drive(follower, (2.0, 3.0, 0.0), limit=60.0)
    v = run.commands[:, 0]
    assert (np.sign(v) < 0).any()
    assert (np.sign(v) > 0).any()
    turned = v[1:] * v[:-1] < 0.0
    assert not turned.any(), "between ahead and back it is told to stand"


def test_a_car_that_faces_away_never_turns_on_the_spot(follower: Any) -> None:
    follower.set_path(STRAIGHT)
    run = drive(follower, (0.0, 0.0, 2.5), limit=5.0)
    v, omega = run.commands.T
    assert (np.abs(omega) * RADIUS <= np.abs(v) + 1e-9).all()
    assert all(step.phase != "turning" for step in run.steps)


def test_another_path_on_the_way_makes_it_brake_before_it_drives_back(follower: Any) -> None:
    follower.set_path(STRAIGHT)
    pose, v = (1.0, 0.0, 0.0), 0.6
    for _ in range(5):
        follower.step(pose, v, 0.0, 0.1)
    back = np.array([[x, 0.0, 0.0] for x in np.arange(1.0, 0.0, -0.1)])
    follower.set_path(back)
    speeds = []
    for _ in range(20):
        v = follower.step(pose, v, 0.0, 0.1).command.vx
        speeds.append(v)
    assert max(abs(b - a) for a, b in zip([0.6, *speeds], speeds, strict=False)) <= 0.25 + 1e-9
    assert speeds[-1] < -0.1


def test_dwa_is_no_follower_of_steered_wheels() -> None:
    with pytest.raises(ValueError, match=r"DWA turns on the spot .* take MPPI"):
        DWA(**CAR)


def test_mppi_slides_past_what_stands_in_the_way() -> None:
    slides = MotionModel(aside=Limits(0.8, 1.5, 2.5))
    body = Footprint.circle(0.2)
    robot = {**CAR, "footprint": body, "motion": slides}
    follower = MPPI(**robot)
    # Half a metre to the left of the path, facing along it.
    follower.set_path(STRAIGHT)
    asked = [follower.step((1.0, 0.5, 0.0), 0.3, 0.0, 0.1, (), (), 0.0).command for _ in range(5)]
    assert asked[-1].vy < -0.05
    for before, after in itertools.pairwise(asked):
        assert abs(after.vy - before.vy) <= 2.5 * 0.1 + 1e-6
    assert all(math.hypot(each.vx, each.vy) <= 0.8 + 1e-6 for each in asked)
