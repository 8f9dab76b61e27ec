import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from kompass.algorithms.following.command import Command
from kompass.algorithms.following.limits import Limits, stopping_distance, stopping_speed
from kompass.algorithms.safety.stop_zone import StopZone
from kompass.algorithms.safety.velocity_limiter import VelocityLimiter, VelocityLimits
from tests.support.properties import property_test

R = 0.1
ZONE = StopZone(R, 0.05, 0.2, max_decel=2.0, reaction_time=0.1)
BRAKING = 0.2 * 0.1 + 0.2**2 / 4


def ahead(gap: float, angle: float = 0.0) -> list[tuple[float, float]]:
    return [((R + gap) * math.cos(angle), (R + gap) * math.sin(angle))]


def test_ahead_it_stops_slows_and_lets_pass_by_distance_left_after_braking() -> None:
    assert ZONE.factor(ahead(BRAKING + 0.049), 0.2, 0, 0) == 0.0
    assert ZONE.factor(ahead(BRAKING + 0.125), 0.2, 0, 0) == pytest.approx(0.5)
    assert ZONE.factor(ahead(BRAKING + 0.201), 0.2, 0, 0) == 1.0
    assert ZONE.factor(np.empty((0, 2)), 0.2, 0, 0) == 1.0


@pytest.mark.parametrize("direction", np.linspace(0, 2 * math.pi, 7).tolist())
def test_it_looks_where_the_motion_goes_sideways_and_back_included(direction: float) -> None:
    v, vy = 0.2 * math.cos(direction), 0.2 * math.sin(direction)
    assert ZONE.factor(ahead(0.05, direction), v, vy, 0) == 0.0
    assert ZONE.factor(ahead(0.05, direction + math.pi), v, vy, 0) == 1.0


def test_what_is_passed_beside_does_not_stop_it() -> None:
    wall = [(x, 0.11) for x in np.linspace(-1, 1, 200)] + [
        (x, -0.11) for x in np.linspace(-1, 1, 99)
    ]
    assert ZONE.factor(wall, 0.2, 0, 0) == 1.0
    assert ZONE.factor(wall, -0.2, 0, 0) == 1.0
    assert ZONE.factor(wall, 0.2, 0, 0.5) < 1.0


def test_turning_on_the_spot_sweeps_only_itself() -> None:
    ring = [ahead(0.01, angle)[0] for angle in np.linspace(0, 6.28, 60)]
    assert ZONE.factor(ring, 0.0, 0.0, 1.0) == 1.0


@property_test(
    st.floats(0.001, 0.3),
    st.floats(-1.57, 1.57),
    st.floats(-math.pi, math.pi),
    st.floats(0.02, 0.3),
    st.floats(-1.0, 1.0),
    many=150,
)
def test_motion_that_makes_room_is_never_blocked_however_close_the_obstacle(
    distance: float, off: float, direction: float, speed: float, bend: float
) -> None:
    behind = direction + math.pi + off
    point = (distance * math.cos(behind), distance * math.sin(behind))
    # On a tighter circle one would come back to what one leaves.
    omega = bend * 0.5 * speed / (R + 0.3)
    v, vy = speed * math.cos(direction), speed * math.sin(direction)
    assert ZONE.factor([point], v, vy, omega) == 1.0


@property_test(
    st.floats(-0.6, 0.6), st.floats(-0.6, 0.6), st.floats(-0.3, 0.3), st.floats(-2, 2), many=100
)
def test_the_swept_arc_is_the_one_a_simulation_drives(
    x: float, y: float, v: float, omega: float
) -> None:
    """First contact of the body along the commanded arc, by small steps."""
    assume(abs(v) > 0.02 and math.hypot(x, y) > R + 1e-3)
    zone = StopZone(R, 0.1, 0.5, max_decel=1000.0, reaction_time=0.0)
    ds = 0.0005
    s = np.arange(0.0, 0.52, ds)
    k = omega / abs(v)
    sign = math.copysign(1.0, v)
    if abs(k) > 1e-6:
        px, py = sign * np.sin(k * s) / k, sign * (1 - np.cos(k * s)) / k
    else:
        px, py = sign * s, 0 * s
    touches = np.flatnonzero(np.hypot(x - px, y - py) <= R)
    grazing = abs(np.hypot(x - px, y - py).min() - R) < 2e-4
    assume(not grazing)
    travel = s[touches[0]] if touches.size else math.inf
    expected = min(1.0, max(0.0, (travel - 0.1) / 0.4))
    assert zone.factor([(x, y)], v, 0.0, omega) == pytest.approx(expected, abs=0.01)


@property_test(st.integers(0, 2**31), st.floats(-0.3, 0.3), st.floats(-1, 1), many=60)
def test_more_obstacles_never_make_it_faster(seed: int, v: float, omega: float) -> None:
    points = np.random.default_rng(seed).uniform(-0.8, 0.8, (30, 2))
    few, all_ = ZONE.factor(points[:15], v, 0, omega), ZONE.factor(points, v, 0, omega)
    assert 0.0 <= all_ <= few <= 1.0


def test_a_robot_driven_at_a_wall_through_the_zone_stops_short_of_it() -> None:
    x, v, dt = 0.0, 0.0, 0.05
    for _ in range(400):
        factor = ZONE.factor([(1.0 - x, y) for y in np.linspace(-0.2, 0.2, 21)], 0.3, 0, 0)
        v = Limits(0.3, 1.0, 2.0).approach(v, 0.3 * factor, dt)
        x += v * dt
    gap = 1.0 - x - R
    assert 0.05 <= gap <= 0.2
    assert ZONE.factor([(1.0 - x, 0)], -0.3, 0, 0) == 1.0


def test_points_that_are_no_numbers_are_no_obstacles_but_such_commands_are_errors() -> None:
    assert ZONE.factor([(math.nan, 0.0), (math.inf, 0.0)], 0.2, 0, 0) == 1.0
    with pytest.raises(ValueError, match="command"):
        ZONE.factor([], math.nan, 0, 0)


@pytest.mark.parametrize(
    ("field", "options"),
    [
        ("robot_radius", {"robot_radius": 0.0}),
        ("critical_distance", {"critical_distance": -0.1}),
        ("slowdown_distance", {"slowdown_distance": 0.05}),
        ("max_decel", {"max_decel": 0.0}),
    ],
)
def test_a_zone_out_of_range_is_refused_by_name(field: str, options: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=field):
        StopZone(**{"robot_radius": 0.1, **options})  # type: ignore[arg-type]


LIMITS = VelocityLimits(vx=Limits(0.22, 1.0, 2.0), omega=Limits(1.5, 3.0, 4.0))
OMNI = VelocityLimits(Limits(0.5, 1.0, 2.0), Limits(1.5, 3.0, 4.0), Limits(0.3, 0.5, 0.5))
value = st.floats(-3, 3)


@given(value, value, value, st.floats(0.01, 0.2))
def test_velocity_and_acceleration_stay_within_limits_from_any_allowed_motion(
    vx: float, vy: float, omega: float, dt: float
) -> None:
    limiter = VelocityLimiter(OMNI)
    before = Command()
    for command in (Command(vx, vy, omega), Command(-omega, vx, vy), Command()):
        after = limiter.limit(command, before, dt)
        for axis, old, new in (
            (OMNI.vx, before.vx, after.vx),
            (OMNI.vy, before.vy, after.vy),
            (OMNI.omega, before.omega, after.omega),
        ):
            assert abs(new) <= axis.max_vel + 1e-9
            assert abs(new) - abs(old) <= axis.max_acc * dt + 1e-9
            assert abs(old) - abs(new) <= axis.max_decel * dt + 1e-9
        before = after


@given(st.floats(0.01, 3), value)
def test_a_command_too_fast_keeps_its_curvature(v: float, omega: float) -> None:
    limited = VelocityLimiter(LIMITS).limit(Command(v, 0, omega), Command(), 10.0)
    assert limited.vx * omega == pytest.approx(limited.omega * v, abs=1e-9)
    assert limited.vx > 0


@given(st.floats(0.05, 0.2), st.floats(-1, 1))
def test_speeding_up_from_rest_keeps_the_curvature_too(v: float, omega: float) -> None:
    limited = VelocityLimiter(LIMITS).limit(Command(v, 0, omega), Command(), 0.05)
    assert limited.vx * omega == pytest.approx(limited.omega * v, abs=1e-9)


@given(v=st.floats(0.05, 0.3), omega=st.floats(-2.0, 2.0), dt=st.floats(0.005, 0.1))
def test_a_standstill_is_come_to_along_the_curve_that_is_driven(
    v: float, omega: float, dt: float
) -> None:
    limiter, sent = VelocityLimiter(LIMITS), Command(v, 0.0, omega)
    while sent != Command():
        before = sent
        sent = limiter.limit(Command(), before, dt)
        assert sent.vx < before.vx or abs(sent.omega) < abs(before.omega), "it brakes"
        assert sent.vx * omega == pytest.approx(sent.omega * v, abs=1e-9), "on the same circle"
        assert before.vx - sent.vx <= LIMITS.vx.max_decel * dt + 1e-9
        assert abs(before.omega - sent.omega) <= LIMITS.omega.max_decel * dt + 1e-9


def test_repeated_limiting_reaches_the_command_and_zero_is_reached_by_braking() -> None:
    limiter, command = VelocityLimiter(LIMITS), Command(0.2, 0, -1.0)
    now = Command(-0.2, 0, 1.0)
    for _ in range(40):
        now = limiter.limit(command, now, 0.05)
    assert (now.vx, now.omega) == pytest.approx((0.2, -1.0))
    steps = 0
    while now != Command():
        now = limiter.limit(Command(), now, 0.05)
        steps += 1
    assert steps <= 6


def test_a_robot_that_cannot_move_sideways_is_not_told_to() -> None:
    assert VelocityLimiter(LIMITS).limit(Command(0.1, 0.2, 0), Command(), 1.0) == Command(0.1, 0, 0)


@given(st.floats(0.0, 5.0), st.floats(0.1, 5.0), st.floats(0.0, 0.5))
def test_the_stopping_speed_is_the_one_that_stops_in_time(
    distance: float, decel: float, delay: float
) -> None:
    speed = stopping_speed(distance, decel, delay)
    assert stopping_distance(speed, decel, delay) == pytest.approx(distance, abs=1e-9)


def test_reversing_spends_the_time_left_after_braking_on_speeding_up() -> None:
    low, high = Limits(1.0, 1.0, 2.0).reachable(0.1, 0.1)
    assert (low, high) == pytest.approx((-0.05, 0.2))
    assert Limits(1.0, 1.0, 2.0).reachable(-0.1, 0.1) == pytest.approx((-0.2, 0.05))


def test_a_negative_limit_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="max_acc: -1"):
        Limits(1.0, -1.0, 1.0)
