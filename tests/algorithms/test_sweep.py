"""The outline of a body along the arc of a twist: against driving it in small steps."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume
from hypothesis import strategies as st

from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import inverse, transform_points
from kompass.algorithms.safety.stop_zone import StopZone
from kompass.algorithms.safety.sweep import time_to_contact
from tests.support.properties import property_test

BOX = Footprint(np.array([[0.254, 0.215], [-0.254, 0.215], [-0.254, -0.215], [0.254, -0.215]]))
ZONE = StopZone(BOX.radius, 0.05, 0.2, max_decel=4.0, footprint=BOX, max_turn_decel=8.0)


@property_test(
    st.floats(-1.2, 1.2),
    st.floats(-1.2, 1.2),
    st.floats(-1.0, 1.0),
    st.floats(-1.0, 1.0),
    st.floats(-3.0, 3.0),
    many=60,
)
def test_contact_comes_when_driving_in_small_steps_meets_it(
    x: float, y: float, v: float, vy: float, omega: float
) -> None:
    assume(max(abs(v), abs(vy), abs(omega)) > 0.1)
    point = np.array([[x, y]])
    assume(float(BOX.distance(point)[0]) > 1e-3)
    dt = 0.002
    turned = omega * dt * np.arange(400)
    middle = turned + omega * dt / 2
    way = dt * np.cumsum(
        np.column_stack(
            [np.cos(middle) * v - np.sin(middle) * vy, np.sin(middle) * v + np.cos(middle) * vy]
        ),
        axis=0,
    )
    away = point - np.concatenate([np.zeros((1, 2)), way[:-1]])
    cos, sin = np.cos(turned), np.sin(turned)
    gap = BOX.distance(
        np.column_stack([cos * away[:, 0] + sin * away[:, 1], cos * away[:, 1] - sin * away[:, 0]])
    )
    assume(not (abs(gap.min()) < 5e-3))  # grazing: who touches is a question of rounding
    after = float(time_to_contact(BOX, point, v, vy, omega)[0])
    if gap.min() > 0.0:
        assert after > 0.75
    else:
        assert after == pytest.approx(np.flatnonzero(gap <= 0.0)[0] * dt, abs=0.004)


def test_between_walls_that_its_circle_would_touch_it_drives_on() -> None:
    along = np.linspace(-2, 2, 200)
    corridor = np.concatenate([np.column_stack([along, np.full(200, s * 0.25)]) for s in (-1, 1)])
    assert ZONE.factor(corridor, 1.0, 0.0, 0.0) == 1.0
    assert ZONE.factor(corridor, 0.0, 0.0, 1.0) < 1.0, "there is no room to turn"
    assert ZONE.way(corridor, 0.0) == math.inf


def test_turning_on_the_spot_is_free_only_where_the_corners_are() -> None:
    ring = 0.35 * np.column_stack([np.cos(np.arange(60) / 9.5), np.sin(np.arange(60) / 9.5)])
    assert ZONE.factor(ring, 0.0, 0.0, 2.0) == 1.0
    post = np.array([[0.0, 0.26]])
    assert 0.0 < ZONE.factor(post, 0.0, 0.0, 4.0) < 0.8
    assert ZONE.factor(np.array([[0.262, 0.205]]), 0.0, 0.0, -1.0) == 0.0, "a corner comes"
    assert not ZONE.turning_is_free


@property_test(st.floats(0.3, 2.0), st.floats(-2.0, 2.0), st.floats(-0.3, 0.3), many=15)
def test_whoever_obeys_stops_short_of_what_is_ahead(top: float, omega: float, side: float) -> None:
    post = np.array([[1.6, side]])
    pose, v = (0.0, 0.0, 0.0), 0.0
    bend = omega / 4.0
    for _ in range(200):
        seen = transform_points(inverse(pose), post)
        assert float(BOX.distance(seen)[0]) > 0.0
        factor = ZONE.factor(seen, top, 0.0, bend * top)
        target = factor * top
        v = min(v + 3.0 * 0.05, target) if target >= v else max(v - 4.0 * 0.05, target)
        yaw = pose[2] + bend * v * 0.05
        pose = (
            pose[0] + 0.05 * v * math.cos(yaw),
            pose[1] + 0.05 * v * math.sin(yaw),
            yaw,
        )


def test_a_point_within_the_body_holds_it_only_where_it_would_go_deeper() -> None:
    inside = np.array([[0.25, 0.0]])
    assert ZONE.factor(inside, 0.3, 0.0, 0.0) == 0.0
    assert ZONE.factor(inside, -0.3, 0.0, 0.0) == 1.0
