import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kompass.algorithms.geometry import (
    compose,
    inverse,
    quaternion_from_yaw,
    transform_points,
    wrap_angle,
    yaw_from_quaternion,
)

coordinate = st.floats(-100, 100)
angle = st.floats(-50, 50)
poses = st.tuples(coordinate, coordinate, angle)


@given(angle)
def test_a_wrapped_angle_points_the_same_way_within_half_a_turn(a: float) -> None:
    wrapped = wrap_angle(a)
    assert -math.pi <= wrapped < math.pi
    assert math.cos(wrapped - a) == pytest.approx(1.0)
    assert wrap_angle(np.array([a]))[0] == wrapped


@given(poses)
def test_a_pose_and_its_inverse_cancel_out(pose: tuple[float, float, float]) -> None:
    same = compose(pose, inverse(pose))
    assert same[:2] == pytest.approx([0, 0], abs=1e-9)
    assert math.cos(same[2]) == pytest.approx(1.0)


@given(poses, poses, coordinate, coordinate)
def test_composing_poses_is_transforming_one_after_the_other(
    a: tuple[float, float, float], b: tuple[float, float, float], x: float, y: float
) -> None:
    at_once = transform_points(compose(a, b), [(x, y)])
    in_turn = transform_points(a, transform_points(b, [(x, y)]))
    assert at_once == pytest.approx(in_turn, abs=1e-6)


@given(st.floats(-3.14, 3.14))
def test_yaw_survives_the_quaternion(yaw: float) -> None:
    assert yaw_from_quaternion(*quaternion_from_yaw(yaw)) == pytest.approx(yaw)


def test_yaw_is_read_from_a_tilted_and_unnormalised_quaternion() -> None:
    # 90° about the vertical after a roll of 0.2 rad, at twice unit length.
    half = math.sqrt(0.5)
    c, s = math.cos(0.1), math.sin(0.1)
    x, y, z, w = half * s, half * s, half * c, half * c
    assert yaw_from_quaternion(2 * x, 2 * y, 2 * z, 2 * w) == pytest.approx(math.pi / 2)
