"""A scan that repeats itself is frozen when the robot has moved, and only then."""

import numpy as np

from kompass.algorithms.geometry import Pose2D
from kompass.algorithms.safety.frozen_scan import MOVED, TURNED, FrozenScan

ROOM = np.linspace(0.5, 3.0, 360, dtype=np.float32)


def after(*scans: tuple[np.ndarray, Pose2D | None]) -> bool:
    judge = FrozenScan()
    for ranges, pose in scans:
        judge.heard(ranges, pose)
    return judge.is_frozen


def test_the_same_ranges_from_another_place_or_heading_are_frozen() -> None:
    assert after((ROOM, (0, 0, 0)), (ROOM, (1.1 * MOVED, 0, 0)))
    assert after((ROOM, (0, 0, 3.1)), (ROOM, (0, 0, 3.1 + 1.1 * TURNED - 2 * np.pi)))


def test_a_robot_that_stands_sees_the_same_and_is_not_frozen() -> None:
    still = [(ROOM, (0.01 * (-1) ** n, 0.0, 0.01 * (-1) ** n)) for n in range(50)]
    assert not after(*still)


def test_slow_motion_counts_from_the_first_of_the_same_scans() -> None:
    assert after(*((ROOM, (0.2 * MOVED * n, 0.0, 0.0)) for n in range(8)))


def test_it_stays_frozen_where_the_robot_halts_and_until_something_else_is_seen() -> None:
    halted = [(ROOM, (MOVED, 0.0, 0.0))] * 3
    assert after((ROOM, (0, 0, 0)), *halted)
    assert not after((ROOM, (0, 0, 0)), *halted, (ROOM + np.float32(0.001), (MOVED, 0.0, 0.0)))


def test_nothing_within_reach_may_look_the_same_from_everywhere() -> None:
    nothing = np.full(360, np.inf, dtype=np.float32)
    assert not after((nothing, (0, 0, 0)), (nothing, (5.0, 0, 0)))


def test_a_robot_that_does_not_know_where_it_is_cannot_tell() -> None:
    assert not after((ROOM, None), (ROOM, None), (ROOM, (0, 0, 0)), (ROOM, (0.01, 0, 0)))
