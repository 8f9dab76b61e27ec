"""A robot that gets nowhere is noticed; one that turns, or goes slowly, is left alone."""

import math

from kompass.components.controller.progress import Progress


def stalled(poses: list[tuple[float, float, float]], *, turning: bool = False) -> float:
    """After a pose each second."""
    progress = Progress()
    return [progress.stalled(pose, float(i), turning=turning) for i, pose in enumerate(poses)][-1]


def test_who_stands_still_is_stalled_since_then() -> None:
    assert stalled([(0.0, 0.0, 0.0)] * 6) == 5.0


def test_noise_is_no_progress() -> None:
    assert stalled([(0.01 * (-1) ** i, 0.0, 0.05 * (-1) ** i) for i in range(6)]) == 5.0


def test_slow_is_not_stalled() -> None:
    assert stalled([(0.02 * i, 0.0, 0.0) for i in range(8)]) < 3.0


def test_a_turn_on_the_spot_counts_where_one_is_meant() -> None:
    spin = [(0.0, 0.0, math.remainder(0.3 * i, math.tau)) for i in range(30)]
    assert stalled(spin, turning=True) == 0.0
    assert stalled(spin) == 29.0


def test_who_turns_for_ever_gets_nowhere() -> None:
    spin = [(0.0, 0.0, math.remainder(0.3 * i, math.tau)) for i in range(100)]
    assert stalled(spin, turning=True) > 50.0


def test_who_turns_to_and_fro_gets_nowhere() -> None:
    rocking = [(0.0, 0.0, 0.3 * math.sin(0.7 * i)) for i in range(40)]
    assert stalled(rocking, turning=True) > 30.0


def test_a_turn_back_beyond_where_it_began_is_progress() -> None:
    turns = [0.0, 0.3, 0.0, -0.3, -0.6]
    assert stalled([(0.0, 0.0, turn) for turn in turns], turning=True) == 0.0


def test_waiting_is_not_stalling() -> None:
    progress = Progress()
    progress.stalled((0.0, 0.0, 0.0), 0.0, turning=False)
    progress.reset()
    assert progress.stalled((0.0, 0.0, 0.0), 9.0, turning=False) == 0.0
