"""Every goal comes to an end, and for the right reason."""

import math

import numpy as np
import pytest

from kompass.components.planner.goal_progress import GoalProgress, Tolerance

STRAIGHT = np.stack([np.linspace(0, 2, 21), np.zeros(21), np.zeros(21)], axis=1)


def progress(heading: float = 0.2, distance: float = 0.05) -> GoalProgress:
    made = GoalProgress((2.0, 0.0, 0.0), Tolerance(distance, heading), patience=10.0)
    made.planned(STRAIGHT, now=0.0)
    return made


def test_a_robot_that_stands_within_both_tolerances_has_arrived() -> None:
    assert progress().arrived((1.97, 0.01, 0.1), standing=True, now=1.0)


@pytest.mark.parametrize("pose", [(1.9, 0.0, 0.0), (2.0, 0.0, 0.3), (2.0, 0.0, math.pi)])
def test_a_robot_outside_a_tolerance_has_not_arrived(pose: tuple[float, float, float]) -> None:
    assert not progress().arrived(pose, standing=True, now=1.0)


def test_heading_does_not_matter_when_none_is_asked_for() -> None:
    assert progress(heading=math.pi).arrived((2.0, 0.0, 3.0), standing=True, now=1.0)


def test_a_robot_still_moving_through_the_goal_gets_time_to_settle() -> None:
    made = progress()
    assert not made.arrived((2.0, 0.0, 0.0), standing=False, now=1.0)
    assert not made.arrived((2.0, 0.0, 0.0), standing=False, now=2.0)
    assert made.arrived((2.0, 0.0, 0.0), standing=False, now=3.0)


def test_leaving_the_tolerance_starts_the_settling_anew() -> None:
    made = progress()
    made.arrived((2.0, 0.0, 0.0), standing=False, now=1.0)
    made.arrived((1.5, 0.0, 0.0), standing=False, now=2.0)
    assert not made.arrived((2.0, 0.0, 0.0), standing=False, now=3.1)


def test_without_a_path_no_more_is_looked_at_than_can_be_seen_however_far_the_goal_is() -> None:
    far = GoalProgress((1e6, 0.0, 0.0), Tolerance(0.05, 0.2), patience=10.0)
    ahead = far.ahead((1.0, 0.0, 0.0))
    assert len(ahead) <= 1000
    assert ahead[0] == pytest.approx((1.0, 0.0, 0.0))
    near = GoalProgress((2.0, 1.0, 0.5), Tolerance(0.05, 0.2), patience=10.0)
    assert near.ahead((1.0, 1.0, 0.0))[-1] == pytest.approx((2.0, 1.0, 0.5))


def test_distance_left_is_the_length_of_the_path_ahead() -> None:
    assert progress().distance_left((0.5, 0.3, 0.0)) == pytest.approx(1.5)
    assert progress().distance_left((2.0, 0.0, 0.0)) == 0.0


def test_a_robot_that_comes_no_nearer_is_stuck_after_its_patience() -> None:
    made = progress()
    assert not made.stuck((0.5, 0.0, 0.0), now=1.0)
    assert not made.stuck((0.5, 0.0, 0.0), now=10.9)
    assert made.stuck((0.5, 0.0, 0.0), now=11.0)


def test_slow_progress_is_not_being_stuck() -> None:
    made = progress()
    for second in range(60):
        assert not made.stuck((second * 0.02, 0.0, 0.0), now=float(second))


def test_turning_to_the_goals_heading_is_progress() -> None:
    made = progress()
    for second in range(30):
        assert not made.stuck((2.0, 0.0, 3.0 - 0.1 * second), now=float(second))


def test_turning_towards_a_path_that_leads_straight_back_is_progress() -> None:
    made = progress()
    for second in range(40):  # half a turn in 39 s, with a patience of 10
        yaw = math.pi - 0.08 * second
        assert not made.stuck((0.0, 0.0, max(yaw, 0.0)), now=float(second))
    # It faces the path by now, and does not drive.
    assert not made.stuck((0.0, 0.0, 0.0), now=45.0)
    assert made.stuck((0.0, 0.0, 0.0), now=50.0)


def test_turning_to_and_fro_is_no_progress() -> None:
    made = progress()
    stuck = [made.stuck((0.0, 0.0, 2.0 + math.sin(0.7 * s)), now=float(s)) for s in range(25)]
    assert any(stuck)


def test_turning_away_from_the_path_is_no_progress() -> None:
    made = progress()
    stuck = [made.stuck((0.0, 0.0, 0.25 * second), now=float(second)) for second in range(12)]
    assert stuck[-1]


def test_patience_without_a_path_counts_from_the_first_failure() -> None:
    made = progress()
    assert not made.unplanned(now=100.0)
    assert not made.unplanned(now=109.0)
    assert made.unplanned(now=110.0)
    made.planned(STRAIGHT, now=111.0)
    assert not made.unplanned(now=112.0)


def test_a_robot_far_from_its_path_has_strayed() -> None:
    assert progress().strayed((1.0, 0.6, 0.0), limit=0.5)
    assert not progress().strayed((1.0, 0.4, 0.0), limit=0.5)


def test_another_path_is_no_progress_by_itself() -> None:
    made = progress()
    pose = (0.5, 0.0, 0.0)
    detour = np.array([[0.5, 0.0, 0.0], [0.5, 3.0, 0.0], [2.0, 3.0, 0.0], [2.0, 0.0, 0.0]])
    assert not made.stuck(pose, now=1.0)
    for second in range(2, 11):  # it stands, and its paths take turns
        made.replanned(detour if second % 2 else STRAIGHT, pose)
        assert not made.stuck(pose, now=float(second))
    assert made.stuck(pose, now=11.5)


def test_driving_along_another_path_is_progress_though_it_is_longer() -> None:
    made = progress()
    assert not made.stuck((0.5, 0.0, 0.0), now=1.0)
    ways = np.linspace(0.0, 3.0, 31)
    out = np.stack([np.full(31, 0.5), ways, np.zeros(31)], axis=1)
    made.replanned(np.concatenate([out, [[2.0, 3.0, 0.0], [2.0, 0.0, 0.0]]]), (0.5, 0.0, 0.0))
    for second in range(1, 30):  # away from the goal, at 0.1 m/s
        assert not made.stuck((0.5, 0.1 * second, 0.0), now=1.0 + second)


def test_the_time_that_help_takes_does_not_count() -> None:
    made, pose = progress(), (0.5, 0.0, 0.0)
    assert not made.stuck(pose, now=1.0)
    assert made.patience_used(pose, now=6.0) == pytest.approx(0.5)
    assert made.is_hindered
    made.pause(20.0)
    assert not made.stuck(pose, now=26.0)
    assert made.patience_used(pose, now=26.0) == pytest.approx(0.5)
    assert made.stuck(pose, now=31.0)
    assert made.patience_used(pose, now=31.0) == 1.0


def test_who_is_helped_at_one_place_again_and_again_does_not_try_for_ever() -> None:
    made, now = progress(), 0.0
    used = []
    for _ in range(5):
        made.unplanned(now)
        made.patience_used((0.5, 0.0, 0.0), now)
        made.pause(1.0)
        now += 5.0
        used.append(made.patience_used((0.5, 0.0, 0.0), now))
        made.planned(STRAIGHT, now)
        made.patience_used((0.5, 0.0, 0.0), now)
    assert used[:3] == [pytest.approx(0.4)] * 3
    assert used[3] == 1.0


def test_who_is_not_helped_is_not_given_up_for_being_hindered_often() -> None:
    made, now = progress(), 0.0
    for _ in range(10):
        made.unplanned(now)
        now += 5.0
        assert made.patience_used((0.5, 0.0, 0.0), now) == pytest.approx(0.5)
        made.planned(STRAIGHT, now)
        made.patience_used((0.5, 0.0, 0.0), now)


def test_without_a_path_the_way_ahead_is_that_of_the_last_one_or_straight_to_the_goal() -> None:
    made = progress()
    made.unplanned(now=1.0)
    assert made.ahead((1.0, 0.0, 0.0))[0] == pytest.approx((1.0, 0.0, 0.0))
    new = GoalProgress((2.0, 1.0, 0.0), Tolerance(0.05, 0.2), patience=10.0)
    straight = new.ahead((0.0, 0.0, 0.0))
    assert straight[0] == pytest.approx((0.0, 0.0, 0.0))
    assert straight[-1] == pytest.approx((2.0, 1.0, 0.0))
