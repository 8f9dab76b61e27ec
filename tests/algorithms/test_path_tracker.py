import math

import numpy as np
import pytest
from hypothesis import strategies as st

from kompass.algorithms.following.path_tracker import PathTracker
from tests.support.properties import property_test

from .worlds import CIRCLE, EIGHT, HAIRPIN, PATHS, SINE, U, polyline


@pytest.mark.parametrize("name", PATHS)
def test_driving_along_a_path_passes_all_of_it_once(name: str) -> None:
    tracker = PathTracker(PATHS[name])
    for s in np.arange(0.0, tracker.length, 0.02):
        assert tracker.advance(*tracker.point_at(float(s))) == pytest.approx(s, abs=0.06)
    assert tracker.advance(*tracker.goal) == pytest.approx(tracker.length, abs=0.06)


@pytest.mark.parametrize("name", PATHS)
def test_many_directions_and_places_are_told_at_once_as_one_by_one(name: str) -> None:
    tracker = PathTracker(PATHS[name])
    at = np.linspace(-0.1, tracker.length + 0.5, 50)
    assert tracker.headings_at(at).tolist() == [tracker.heading_at(float(s)) for s in at]
    assert tracker.points_at(at) == pytest.approx(
        np.array([tracker.point_at(float(s)) for s in at])
    )


@property_test(st.sampled_from(sorted(PATHS)), st.integers(0, 2**31), many=40)
def test_progress_never_goes_back_nor_past_the_end(name: str, seed: int) -> None:
    tracker = PathTracker(PATHS[name])
    before = 0.0
    for x, y in np.random.default_rng(seed).uniform(-3, 3, (30, 2)):
        progress = tracker.advance(float(x), float(y))
        assert before <= progress <= tracker.length + 1e-9
        assert tracker.remaining == pytest.approx(tracker.length - progress)
        before = progress


def test_the_other_leg_of_a_u_is_not_mistaken_for_this_one() -> None:
    tracker = PathTracker(U)
    tracker.advance(0.0, 0.0)
    # Pushed nearer to the leg that comes back than to its own.
    assert tracker.advance(0.3, 0.6) == pytest.approx(0.3, abs=0.01)


def test_a_closed_loop_begins_at_its_beginning() -> None:
    tracker = PathTracker(CIRCLE)
    assert tracker.advance(0.0, 0.0) < 0.05
    assert tracker.remaining == pytest.approx(2 * math.pi, abs=0.06)


def test_a_figure_8_goes_straight_on_over_its_crossing() -> None:
    tracker = PathTracker(EIGHT)
    half = tracker.length / 2
    for s in np.arange(0.0, half, 0.05):
        tracker.advance(*tracker.point_at(float(s)))
    assert tracker.advance(0.0, 0.0) == pytest.approx(half, abs=0.02)


def test_a_hairpin_is_driven_to_its_tip() -> None:
    tracker = PathTracker(HAIRPIN)
    for x in np.arange(0.0, 1.8, 0.1):
        tracker.advance(float(x), 0.02)
    assert tracker.progress == pytest.approx(1.7, abs=0.01)


def test_a_path_is_joined_where_the_robot_is() -> None:
    assert PathTracker(U).advance(2.9, 0.8) == pytest.approx(3.8, abs=0.15)


def test_a_robot_that_left_the_path_finds_it_again_further_on() -> None:
    tracker = PathTracker(SINE)
    tracker.advance(0.0, 0.0)
    place = tracker.point_at(3.0)
    for _ in range(10):
        tracker.advance(*place)
    assert tracker.progress == pytest.approx(3.0, abs=0.05)


def test_the_sharpest_curvature_is_one_over_the_radius_to_either_side() -> None:
    for path in (CIRCLE, CIRCLE * (1, -1, -1)):
        assert PathTracker(path).sharpest(1.0, 4.0) == pytest.approx(1.0, abs=0.02)


def test_points_and_headings_follow_the_legs_and_go_straight_on_beyond_the_end() -> None:
    tracker = PathTracker(polyline((0, 0), (2, 0), (2, 2)))
    assert tracker.point_at(1.0) == pytest.approx((1.0, 0.0))
    assert tracker.point_at(3.0) == pytest.approx((2.0, 1.0))
    assert tracker.point_at(4.5) == pytest.approx((2.0, 2.5))
    assert tracker.heading_at(0.0) == pytest.approx(0.0)
    assert tracker.heading_at(3.0) == pytest.approx(math.pi / 2)


def test_cross_track_error_is_positive_left_of_the_path() -> None:
    tracker = PathTracker(polyline((0, 0), (2, 0)))
    tracker.advance(1.0, 0.1)
    assert tracker.cross_track(1.0, 0.1) == pytest.approx(0.1)
    assert tracker.cross_track(1.0, -0.1) == pytest.approx(-0.1)


def test_a_single_pose_and_repeated_poses_are_paths_too() -> None:
    single = PathTracker([(1.0, 2.0, 0.5)])
    assert single.advance(0.0, 0.0) == 0.0
    assert (single.length, single.goal, single.goal_yaw) == (0.0, (1.0, 2.0), 0.5)
    repeated = PathTracker([(0, 0, 0), (0, 0, 0), (1, 0, 0), (1, 0, 1.5)])
    assert repeated.length == 1.0
    assert repeated.goal_yaw == 1.5
    assert repeated.advance(0.5, 0.1) == pytest.approx(0.5)


@pytest.mark.parametrize("poses", [[], np.zeros((3, 1)), [(0, 0, 0), (math.nan, 0, 0)]])
def test_what_is_no_path_is_refused(poses: object) -> None:
    with pytest.raises(ValueError, match="poses"):
        PathTracker(poses)  # type: ignore[arg-type]
