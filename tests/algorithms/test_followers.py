import math
from typing import Any

import numpy as np
import pytest

from kompass.algorithms.following.dvz import DVZ
from kompass.algorithms.following.path_tracker import PathTracker
from kompass.algorithms.following.pure_pursuit import PurePursuit, PurePursuitParams
from kompass.algorithms.following.stanley import Stanley, StanleyParams
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats

from .worlds import HAIRPIN, PATHS, SINE, STRAIGHT, L, U, distance_to_polyline, drive, polyline

ROBOT: dict[str, Any] = {
    "max_v": 0.22,
    "max_omega": 1.5,
    "acc": 1.0,
    "decel": 2.0,
    "omega_acc": 3.0,
    "footprint": Footprint.circle(0.105),
}
FOLLOWERS = [PurePursuit, Stanley, DVZ]


def length(path: Floats) -> float:
    return float(np.hypot(*np.diff(path[:, :2], axis=0).T).sum())


@pytest.fixture(params=FOLLOWERS)
def follower(request: pytest.FixtureRequest) -> Any:
    return request.param(**ROBOT)


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("lag", [0.05, 0.15])
def test_every_path_is_driven_to_its_very_end_and_heading(
    follower: Any, name: str, lag: float
) -> None:
    path = PATHS[name]
    follower.set_path(path)
    run = drive(follower, (0, 0, float(path[0, 2])), lag=lag)
    assert run.arrived
    distance, heading = run.error_to(path[-1])
    assert distance <= 0.03
    assert heading <= 0.05
    # Close to the path, all of it, without dawdling. A sharp corner is cut a little; a hairpin by
    # half the lookahead distance, and it costs the turn on the spot.
    assert distance_to_polyline(run.poses[:, :2], path).max() <= 0.09
    covered = distance_to_polyline(path[:, :2], run.poses[:, :2])
    assert covered.max() <= (0.18 if name == "hairpin" else 0.11)
    assert run.duration <= 1.15 * length(path) / 0.22 + 2.0 + (2.5 if name == "hairpin" else 0.0)
    assert run.steps[-1].phase == "arrived"


@pytest.mark.parametrize("yaw", [math.pi, 3.0, -2.0, 1.5])
def test_a_robot_that_faces_away_turns_on_the_spot_first(follower: Any, yaw: float) -> None:
    follower.set_path(STRAIGHT)
    run = drive(follower, (0, 0, yaw))
    assert run.arrived
    assert run.steps[0].phase == "turning"
    turning = np.array([step.phase == "turning" for step in run.steps])
    assert np.hypot(*run.poses[1 : turning.sum() + 1, :2].T).max() < 0.02
    assert distance_to_polyline(run.poses[:, :2], STRAIGHT).max() < 0.05


def test_a_robot_beside_the_path_joins_it(follower: Any) -> None:
    follower.set_path(STRAIGHT)
    run = drive(follower, (0.0, 0.5, 0.0))
    assert run.arrived
    late = run.poses[run.poses[:, 0] > 2.5]
    assert np.abs(late[:, 1]).max() < 0.02


@pytest.mark.parametrize("goal_yaw", [0.0, 2.0, math.pi, -1.0])
def test_the_goal_s_heading_is_taken_up_on_the_spot(follower: Any, goal_yaw: float) -> None:
    path = polyline((0, 0), (1, 0))
    path[-1, 2] = goal_yaw
    follower.set_path(path)
    run = drive(follower, (0, 0, 0))
    assert run.arrived
    distance, heading = run.error_to(path[-1])
    assert distance <= 0.03
    assert heading <= 0.05


def test_the_goal_is_not_overshot(follower: Any) -> None:
    follower.set_path(STRAIGHT)
    run = drive(follower, (0, 0, 0), lag=0.15)
    assert run.poses[:, 0].max() <= 5.0 + 0.01
    assert run.commands[:, 0].min() >= 0.0


@pytest.mark.parametrize("name", ["L", "U", "sine", "figure 8"])
def test_commands_keep_the_limits_of_velocity_and_acceleration(follower: Any, name: str) -> None:
    follower.set_path(PATHS[name])
    run = drive(follower, (0, 0, 1.2))
    v, omega = run.commands.T
    assert np.abs(v).max() <= 0.22 + 1e-9
    assert np.abs(omega).max() <= 1.5 + 1e-9
    dv = np.diff(np.concatenate([[0.0], v]))
    assert dv.max() <= 1.0 * 0.1 + 1e-9
    assert dv[:-1].min() >= -2.0 * 0.1 - 1e-9
    dw = np.abs(np.diff(np.concatenate([[0.0], omega])))
    assert dw.max() <= 3.0 * 0.1 + 1e-9


def test_curves_are_driven_slower_than_straights(follower: Any) -> None:
    follower.set_path(L)
    run = drive(follower, (0, 0, 0))
    corner = np.hypot(run.poses[1:, 0] - 2, run.poses[1:, 1]) < 0.12
    assert run.commands[corner, 0].min() < 0.19
    assert run.commands[:, 0].max() == pytest.approx(0.22)


def test_the_same_path_can_be_driven_again_by_the_same_object(follower: Any) -> None:
    for _ in range(2):
        follower.set_path(L)
        run = drive(follower, (0, 0, 0))
        assert run.arrived
        assert distance_to_polyline(run.poses[:, :2], L).max() <= 0.09
        assert distance_to_polyline(L[:, :2], run.poses[:, :2]).max() <= 0.11


@pytest.mark.parametrize("name", ["U", "figure 8", "circle", "sine"])
def test_planning_again_every_second_does_not_disturb_the_drive(follower: Any, name: str) -> None:
    path = PATHS[name]
    follower.set_path(path)
    tracker = PathTracker(path)

    def replan(n: int, pose: Floats) -> None:
        tracker.advance(pose[0], pose[1])
        if n % 10 == 0 and n > 0 and tracker.remaining > 0.3:
            # What a planner returns: from where the robot was a moment ago along the rest.
            rest = np.arange(tracker.progress, tracker.length, 0.1)[1:]
            points = np.vstack(
                [pose[:2], *(tracker.point_at(float(s)) for s in rest), tracker.goal]
            )
            follower.set_path(np.column_stack([points, np.full(len(points), path[-1, 2])]))

    run = drive(follower, (0, 0, float(path[0, 2])), at_step=replan)
    assert run.arrived
    assert run.error_to(path[-1])[0] <= 0.03
    assert distance_to_polyline(run.poses[:, :2], path).max() <= 0.12
    assert distance_to_polyline(path[:, :2], run.poses[:, :2]).max() <= 0.12
    # No stop and no jerk at the hand-over.
    middle = run.commands[10:-20, 0]
    assert middle.min() > 0.08


def test_setting_the_path_being_followed_again_keeps_the_progress(follower: Any) -> None:
    follower.set_path(HAIRPIN)

    def again(n: int, _pose: Floats) -> None:
        if n % 10 == 0:
            follower.set_path(HAIRPIN.copy())

    run = drive(follower, (0, 0, 0), at_step=again)
    assert run.arrived
    assert run.poses[:, 0].max() > 1.8
    assert run.error_to(HAIRPIN[-1])[0] <= 0.03


def test_progress_only_grows_and_errors_are_reported_in_their_directions(follower: Any) -> None:
    follower.set_path(SINE)
    run = drive(follower, (0, 0.1, 0.5))
    assert run.steps[0].cross_track_error > 0
    progress = [step.progress for step in run.steps]
    assert (np.diff(progress) >= 0).all()
    total = length(SINE)
    assert all(
        step.progress + step.remaining == pytest.approx(total, abs=1e-6) for step in run.steps
    )
    follower.set_path(STRAIGHT)
    step = follower.step((1.0, 0.0, -0.3), 0.1, 0.0, 0.1)
    assert step.heading_error == pytest.approx(0.3)


def test_a_robot_held_up_on_the_way_goes_on_gently(follower: Any) -> None:
    follower.set_path(STRAIGHT)
    drive(follower, (0, 0, 0), limit=5.0)
    for _ in range(20):
        step = follower.step((0.8, 0.0, 0.0), 0.0, 0.0, 0.1)
    # From standstill it may not ask for more than the acceleration allows.
    assert step.command.vx <= 1.0 * 0.1 * 3 + 1e-9
    assert drive(follower, (0.8, 0, 0)).arrived


def test_a_robot_pushed_off_the_goal_while_aligning_comes_back(follower: Any) -> None:
    path = polyline((0, 0), (1, 0))
    path[-1, 2] = math.pi
    follower.set_path(path)
    run = drive(follower, (0, 0, 0), limit=6.5)
    assert run.steps[-1].phase == "aligning"
    run = drive(follower, (0.9, 0.15, 1.0))
    assert run.arrived
    assert run.error_to(path[-1])[0] <= 0.03


def test_a_goal_where_the_robot_stands_is_only_a_turn(follower: Any) -> None:
    follower.set_path([(0.0, 0.0, 1.0), (0.0, 0.0, 1.0)])
    run = drive(follower, (0.0, 0.0, 0.0))
    assert run.arrived
    assert run.error_to(np.array([0, 0, 1.0]))[1] <= 0.05
    assert run.duration < 4.0


def test_arrived_stays_arrived_until_a_new_path(follower: Any) -> None:
    follower.set_path(polyline((0, 0), (0.5, 0)))
    assert drive(follower, (0, 0, 0)).arrived
    step = follower.step((0.3, 0.2, 0.0), 0.0, 0.0, 0.1)
    assert step.phase == "arrived"
    assert (step.command.vx, step.command.omega) == (0.0, 0.0)
    follower.set_path(U)
    assert follower.step((0.0, 0.0, 0.0), 0.0, 0.0, 0.1).phase == "driving"


def test_without_a_path_or_with_a_pose_that_is_no_number_it_says_so(follower: Any) -> None:
    with pytest.raises(RuntimeError, match="set_path"):
        follower.step((0, 0, 0), 0.0, 0.0, 0.1)
    follower.set_path(STRAIGHT)
    with pytest.raises(ValueError, match="pose"):
        follower.step((math.nan, 0, 0), 0.0, 0.0, 0.1)
    with pytest.raises(ValueError, match="dt"):
        follower.step((0, 0, 0), 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: PurePursuitParams(lookahead_distance=0.0), "lookahead_distance"),
        (lambda: PurePursuitParams(goal_tolerance=-1.0), "goal_tolerance"),
        (lambda: PurePursuitParams(turn_done_angle=2.0), "turn_done_angle"),
        (lambda: StanleyParams(wheel_base=0.0), "wheel_base"),
        (
            lambda: PurePursuit(None, **{**ROBOT, "max_v": 0.0}),
            "max_v",
        ),
    ],
)
def test_parameters_out_of_range_are_refused_by_name(make: Any, field: str) -> None:
    with pytest.raises(ValueError, match=field):
        make()
