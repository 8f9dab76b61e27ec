"""Transforms connect frames, interpolate, and say which link is missing."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kompass.algorithms.transforms import TransformBuffer, TransformError, interpolate, matrix_of


def planar(x: float, y: float, yaw: float) -> np.ndarray:
    return matrix_of((x, y, 0.0), (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)))


def test_a_chain_of_frames_is_multiplied_in_order() -> None:
    buffer = TransformBuffer()
    buffer.add("map", "odom", 0.0, planar(1, 0, math.pi / 2))
    buffer.add("odom", "base", 0.0, planar(2, 0, 0))
    buffer.add("base", "scan", 0.0, planar(0, 0.1, 0), static=True)
    assert buffer.planar("map", "scan") == pytest.approx((0.9, 2.0, math.pi / 2))
    assert buffer.planar("scan", "map") == pytest.approx((-2.0, 0.9, -math.pi / 2))


def test_frames_of_one_parent_are_connected() -> None:
    buffer = TransformBuffer()
    buffer.add("base", "left", 0.0, planar(0, 1, 0), static=True)
    buffer.add("base", "right", 0.0, planar(0, -1, 0), static=True)
    assert buffer.planar("left", "right") == pytest.approx((0, -2, 0))


def test_between_two_samples_the_pose_is_interpolated() -> None:
    buffer = TransformBuffer()
    buffer.add("odom", "base", 1.0, planar(0, 0, 0))
    buffer.add("odom", "base", 2.0, planar(1, 2, 1.0))
    assert buffer.planar("odom", "base", 1.25) == pytest.approx((0.25, 0.5, 0.25))


def test_samples_may_arrive_out_of_order() -> None:
    buffer = TransformBuffer()
    for stamp in (2.0, 1.0, 3.0):
        buffer.add("odom", "base", stamp, planar(stamp, 0, 0))
    assert buffer.planar("odom", "base", 1.5)[0] == pytest.approx(1.5)


@pytest.mark.parametrize("stamp", [0.5, 2.5])
def test_nothing_is_extrapolated(stamp: float) -> None:
    buffer = TransformBuffer()
    buffer.add("odom", "base", 1.0, planar(0, 0, 0))
    buffer.add("odom", "base", 2.0, planar(1, 0, 0))
    with pytest.raises(TransformError, match=r"known from 1\.000 s to 2\.000 s"):
        buffer.lookup("odom", "base", stamp)


def test_old_samples_are_forgotten() -> None:
    buffer = TransformBuffer(history=5.0)
    for second in range(20):
        buffer.add("odom", "base", float(second), planar(second, 0, 0))
    with pytest.raises(TransformError):
        buffer.lookup("odom", "base", 10.0)
    assert buffer.planar("odom", "base", 15.0)[0] == 15.0


def test_a_missing_link_is_named() -> None:
    buffer = TransformBuffer()
    buffer.add("odom", "base", 0.0, planar(0, 0, 0))
    buffer.add("mast", "camera", 0.0, planar(0, 0, 0), static=True)
    with pytest.raises(TransformError, match="'camera' leads to 'mast', 'base' to 'odom'"):
        buffer.lookup("base", "camera")


def test_a_loop_of_frames_ends_in_an_error_and_not_in_a_loop() -> None:
    buffer = TransformBuffer()
    buffer.add("a", "b", 0.0, planar(0, 0, 0))
    buffer.add("b", "a", 0.0, planar(0, 0, 0))
    with pytest.raises(TransformError):
        buffer.lookup("c", "a")


angles = st.floats(-math.pi, math.pi)


@given(angles, angles, st.floats(0, 1))
def test_interpolated_rotations_turn_the_short_way(
    first: float, second: float, share: float
) -> None:
    between = interpolate(planar(0, 0, first), planar(0, 0, second), share)
    difference = math.remainder(second - first, 2 * math.pi)
    if abs(abs(difference) - math.pi) < 1e-3:
        return  # both ways are as short
    expected = first + share * difference
    yaw = math.atan2(between[1, 0], between[0, 0])
    assert math.remainder(yaw - expected, 2 * math.pi) == pytest.approx(0, abs=1e-6)
    assert np.allclose(between[:3, :3] @ between[:3, :3].T, np.eye(3), atol=1e-9)
