"""Who walks about is told from what stands, and where he will be."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import strategies as st

from kompass.algorithms.geometry import Floats, Pose2D
from kompass.algorithms.mapping.moving import MovingObstacles, predicted, seen_from
from tests.support.properties import property_test

RAYS, RANGE = 360, 8.0
ANGLES = np.arange(RAYS) * math.tau / RAYS
PERIOD = 0.1


def scan(pose: Pose2D, discs: Floats, random: np.random.Generator) -> Floats:
    """Ranges of a lidar all around, with noise of 5 mm, among discs (N, 3): x, y, radius."""
    x, y, yaw = pose
    ray = np.stack([np.cos(ANGLES + yaw), np.sin(ANGLES + yaw)], axis=1)
    to = discs[:, :2] - (x, y)
    along = ray @ to.T
    beside = np.abs(ray[:, :1] * to[:, 1] - ray[:, 1:] * to[:, 0])
    hits = (along > 0) & (beside < discs[:, 2])
    depth = np.sqrt(np.maximum(discs[:, 2] ** 2 - beside**2, 0.0))
    ranges = np.where(hits, along - depth, np.inf).min(axis=1) + random.normal(0.0, 0.005, RAYS)
    return np.where(ranges < RANGE, ranges, np.inf)


def watch(
    seen: MovingObstacles, pose: Pose2D, discs: Floats, now: float, random: np.random.Generator
) -> None:
    measured = scan(pose, discs, random)
    seen.see(measured, 0.0, math.tau / RAYS, 0.1, RANGE, pose, now)


@property_test(st.floats(0.4, 1.5), st.floats(-math.pi, math.pi), st.integers(0, 2**31), many=25)
def test_a_walker_is_seen_where_he_is_and_goes_on_as_he_goes(
    speed: float, course: float, seed: int
) -> None:
    random = np.random.default_rng(seed)
    posts = np.array([[3.0, 2.0, 0.075], [-2.5, 2.8, 0.075], [0.5, -3.2, 0.2]])
    velocity = speed * np.array([math.cos(course), math.sin(course)])
    begin = np.array([2.0 * math.cos(course + 1.9), 2.0 * math.sin(course + 1.9)])
    seen = MovingObstacles()
    for step in range(15):
        now = step * PERIOD
        here = begin + velocity * now
        discs = np.vstack([posts, [*here, 0.2]])
        watch(seen, (0.1 * now, 0.0, 0.3 * now), discs, now, random)
    moving = seen.at(now)
    away = np.hypot(*(moving[:, :2] - here).T)
    assert len(moving) >= 1
    assert away.min() < 0.3
    found = moving[int(np.argmin(away))]
    assert found[2:4] == pytest.approx(velocity, abs=0.35)
    assert 0.1 < found[4] < 0.35


def test_who_crosses_where_the_turn_of_the_scanner_begins_is_not_lost() -> None:
    random = np.random.default_rng(0)
    seen = MovingObstacles()
    for step in range(20):
        now = step * PERIOD
        here = (1.5, 0.6 * now - 0.6)  # over the first ray, right ahead, after a second
        watch(seen, (0.0, 0.0, 0.0), np.array([[*here, 0.2]]), now, random)
        if step >= 6:
            [found] = seen.at(now)
            assert math.dist(found[:2], here) < 0.3
            assert found[2:4] == pytest.approx((0.0, 0.6), abs=0.3)


@property_test(st.integers(0, 2**31), st.floats(0.0, 2.0), st.floats(-2.0, 2.0), many=25)
def test_what_stands_does_not_move_however_the_robot_does(
    seed: int, speed: float, turn: float
) -> None:
    random = np.random.default_rng(seed)
    places = random.uniform(-5, 5, (30, 2))
    places = places[np.hypot(places[:, 0], places[:, 1]) > 0.8]
    discs = np.column_stack([places, random.choice([0.075, 0.2, 0.5], len(places))])
    seen = MovingObstacles()
    x = y = yaw = 0.0
    for step in range(20):
        watch(seen, (x, y, yaw), discs, step * PERIOD, random)
        x, y = x + PERIOD * speed * math.cos(yaw), y + PERIOD * speed * math.sin(yaw)
        yaw += PERIOD * turn
        if np.hypot(discs[:, 0] - x, discs[:, 1] - y).min() < 0.7:
            break
        assert len(seen.at(step * PERIOD)) == 0


def test_who_has_stopped_is_an_obstacle_like_any_other_and_who_is_gone_is_forgotten() -> None:
    random = np.random.default_rng(1)
    seen = MovingObstacles()
    for step in range(60):
        now = step * PERIOD
        here = (2.0, min(1.0, -0.5 + now))
        watch(seen, (0.0, 0.0, 0.0), np.array([[*here, 0.2]]), now, random)
        if step == 14:
            assert len(seen.at(now)) == 1
    assert len(seen.at(now)) == 0
    assert len(seen.at(now + 10.0)) == 0


def test_for_a_second_he_goes_straight_on_and_then_he_stands() -> None:
    movers = np.array([[1.0, 2.0, 0.5, -1.0, 0.2]])
    x, y = predicted(movers, np.array([0.0, 0.5, 1.0, 3.0]))
    assert x[0] == pytest.approx([1.0, 1.25, 1.5, 1.5])
    assert y[0] == pytest.approx([2.0, 1.5, 1.0, 1.0])


def test_a_robot_sees_him_from_where_it_is() -> None:
    seen = seen_from((1.0, 0.0, math.pi / 2), np.array([[1.0, 3.0, 0.0, 0.5, 0.2]]))
    assert seen[0] == pytest.approx([3.0, 0.0, 0.5, 0.0, 0.2])


def test_scans_that_say_nothing_change_nothing() -> None:
    seen = MovingObstacles()
    for ranges in (np.full(RAYS, np.nan), np.zeros(RAYS), np.full(RAYS, np.inf), [], [1.0]):
        seen.see(ranges, 0.0, math.tau / RAYS, 0.1, RANGE, (0.0, 0.0, 0.0), 1.0)
    assert seen.at(1.0).shape == (0, 5)
