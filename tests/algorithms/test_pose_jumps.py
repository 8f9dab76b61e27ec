"""A pose that two say in turn is told from one that a robot drives, or a localiser corrects."""

from __future__ import annotations

from kompass.algorithms.safety.pose_jumps import TIMES, WITHIN, PoseJumps


def test_what_a_fast_robot_does_is_no_jump() -> None:
    jumps = PoseJumps()
    for step in range(200):
        jumps.heard((0.15 * step, 0.0, 0.2 * step), 0.05 * step, 0.5)
    assert jumps.told == ""


def test_a_localiser_that_has_found_itself_jumps_once() -> None:
    jumps = PoseJumps()
    for step in range(100):
        jumps.heard((8.0 if step > 50 else 0.0, 0.0, 0.0), 0.05 * step, 0.5)
    assert jumps.told == ""


def test_two_who_contradict_each_other_are_told_of_until_one_is_silent() -> None:
    jumps = PoseJumps()
    for step in range(TIMES + 1):
        jumps.heard((3.0 * (step % 2), 0.0, 0.0), 0.1 * step, 0.5)
    assert "it jumps to and fro, 3.0 m" in jumps.told
    jumps.heard((3.0, 0.0, 0.0), 0.1 * TIMES + WITHIN + 0.1, 0.5)
    assert jumps.told == ""


def test_headings_contradict_each_other_too() -> None:
    jumps = PoseJumps()
    for step in range(TIMES + 1):
        jumps.heard((0.0, 0.0, 1.5 * (step % 2)), 0.01 * step, 0.5)
    assert jumps.told != ""


def test_what_is_allowed_to_jump_may() -> None:
    jumps = PoseJumps()
    for step in range(TIMES + 1):
        jumps.heard((3.0 * (step % 2), 0.0, 0.0), 0.1 * step, 4.0)
    assert jumps.told == ""
