"""A point of the picture means the point of the floor that is drawn there."""

import math

import numpy as np
import pytest
import viser.transforms as tf
from hypothesis import given, settings
from hypothesis import strategies as st

from kompass_console.scene.camera import FIELD_OF_VIEW, framing
from kompass_console.scene.picking import Camera, floor_point


def camera_at(position: np.ndarray, look_at: np.ndarray, aspect: float) -> Camera:
    """The camera as viser would report it: +z towards `look_at`, +y down."""
    z = (look_at - position) / np.linalg.norm(look_at - position)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    rotation = np.column_stack([x, np.cross(z, x), z])
    wxyz = tf.SO3.from_matrix(rotation).wxyz.tolist()
    return Camera(tuple(position), tuple(wxyz), FIELD_OF_VIEW, aspect)


def project(camera: Camera, point: tuple[float, float]) -> tuple[float, float]:
    """Picture point (u, v) of a floor point, by the textbook's pinhole camera."""
    rotation = tf.SO3(np.array(camera.wxyz)).as_matrix()
    x, y, z = rotation.T @ (np.array([*point, 0.0]) - np.array(camera.position))
    focal = 0.5 / math.tan(camera.fov / 2.0)
    return 0.5 + focal / camera.aspect * x / z, 0.5 + focal * y / z


def test_the_middle_of_the_picture_is_the_point_looked_at() -> None:
    camera = camera_at(np.array([1.0, -6.0, 5.0]), np.array([1.0, 2.0, 0.0]), 1.6)
    assert floor_point(camera, 0.5, 0.5) == pytest.approx((1.0, 2.0))


def test_right_is_right_and_down_is_nearer() -> None:
    camera = camera_at(np.array([0.0, -6.0, 5.0]), np.array([0.0, 0.0, 0.0]), 1.6)
    right, nearer = floor_point(camera, 0.7, 0.5), floor_point(camera, 0.5, 0.7)
    assert right is not None
    assert nearer is not None
    assert right[0] > 0.5
    assert nearer[1] < -0.5


def test_above_the_horizon_there_is_no_floor() -> None:
    camera = camera_at(np.array([0.0, -6.0, 1.0]), np.array([0.0, 6.0, 0.9]), 1.6)
    assert floor_point(camera, 0.5, 0.1) is None
    assert floor_point(camera, 0.5, 0.9) is not None


def test_from_below_the_floor_there_is_none_to_press() -> None:
    camera = camera_at(np.array([0.0, -6.0, -1.0]), np.array([0.0, 6.0, -3.0]), 1.6)
    assert floor_point(camera, 0.5, 0.5) is None


@settings(deadline=None)  # the machine's, not the promise's
@given(
    x=st.floats(-8.0, 8.0),
    y=st.floats(-8.0, 8.0),
    height=st.floats(0.5, 40.0),
    aspect=st.floats(0.4, 2.5),
)
def test_what_is_drawn_at_a_point_is_picked_there(
    x: float, y: float, height: float, aspect: float
) -> None:
    camera = camera_at(np.array([0.3, -9.0, height]), np.array([0.0, 0.5, 0.0]), aspect)
    assert floor_point(camera, *project(camera, (x, y))) == pytest.approx((x, y), abs=1e-6)


@settings(deadline=None)  # the machine's, not the promise's
@given(
    x0=st.floats(-100.0, 100.0),
    y0=st.floats(-100.0, 100.0),
    width=st.floats(2.0, 300.0),
    height=st.floats(2.0, 300.0),
    aspect=st.floats(0.4, 2.5),
    top=st.booleans(),
)
def test_the_first_view_shows_all_of_the_map(
    x0: float, y0: float, width: float, height: float, aspect: float, top: bool
) -> None:
    position, look_at = framing((x0, y0, x0 + width, y0 + height), aspect, top=top)
    camera = camera_at(position, look_at, aspect)
    seen = [project(camera, (x, y)) for x in (x0, x0 + width) for y in (y0, y0 + height)]
    assert all(0.0 <= u <= 1.0 and 0.0 <= v <= 1.0 for u, v in seen)
    largest = max(abs(c - 0.5) for uv in seen for c in uv)
    assert largest > 0.4  # and not from far away


def test_straight_down_has_north_at_the_top() -> None:
    position, look_at = framing((-2.0, -3.0, 2.0, 3.0), 1.5, top=True)
    camera = camera_at(position, look_at, 1.5)
    u, v = project(camera, (0.0, 2.5))
    assert u == pytest.approx(0.5, abs=1e-6)
    assert v < 0.2
