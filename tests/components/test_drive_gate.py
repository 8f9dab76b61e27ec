"""The gate before the wheels, without ROS: what is sent, how much of it, and why not all."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kompass.algorithms.following.limits import Limits
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.motion_model import MotionModel
from kompass.algorithms.safety.velocity_limiter import VelocityLimits
from kompass.components.drive.command_queue import STILL, Twist2D
from kompass.components.drive.drive_gate import SETTLE, DriveGate, GateInput, GateLimits, Verdict

AHEAD: Twist2D = (0.2, 0.0, 0.0)
NOTHING = np.empty((0, 2))
WALL = np.array([[0.13, y] for y in np.linspace(-0.3, 0.3, 61)])
FARTHER = WALL + np.array([0.16, 0.0])
PERIOD = 0.05
SLUGGISH = VelocityLimits(vx=Limits(0.5, 1.0, 1.0), omega=Limits(1.0, 1.0, 1.0))


def limits(**changed: Any) -> GateLimits:
    axes = VelocityLimits(vx=Limits(0.5, 5.0, 5.0), omega=Limits(1.5, 10.0, 10.0))
    given: dict[str, Any] = {
        "velocity": axes,
        "radius": 0.1,
        "critical_distance": 0.05,
        "slowdown_distance": 0.2,
        "odometry_timeout": 0.5,
        "period": PERIOD,
    }
    return GateLimits(**{**given, **changed})


def known(wanted: Twist2D | None = AHEAD, **changed: Any) -> GateInput:
    given: dict[str, Any] = {
        "command_stale": False,
        "obstacles": NOTHING,
        "odometry_age": 0.0,
        "stopped": False,
    }
    return GateInput(wanted, **{**given, **changed})


def after(gate: DriveGate, given: GateInput, turns: int = 20, begin: float = 0.0) -> Verdict:
    for turn in range(turns):
        verdict = gate.judge(given, begin + turn * PERIOD)
    return verdict


def test_a_free_way_gives_the_whole_command() -> None:
    verdict = after(DriveGate(limits()), known())
    assert (verdict.factor, verdict.limited_by, verdict.emergency) == (1.0, "", False)
    assert verdict.twist == pytest.approx(AHEAD)


def test_a_command_is_approached_within_the_acceleration() -> None:
    gate = DriveGate(
        limits(velocity=VelocityLimits(vx=Limits(0.5, 1.0, 1.0), omega=Limits(1, 1, 1)))
    )
    speeds = [
        verdict.twist[0] for n in range(4) if (verdict := gate.judge(known(), n * PERIOD)).twist
    ]
    assert speeds == pytest.approx([0.05, 0.1, 0.15, 0.2])


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"stopped": True}, "stop"),
        ({"intruded": True}, "second publisher"),
        ({"intruded": True, "stopped": True}, "stop"),
        ({"intruded": True, "obstacles": None}, "second publisher"),
        ({"odometry_age": 0.51}, "odometry stale"),
        ({"obstacles": None}, "scan stale"),
        ({"obstacles": WALL}, "obstacle"),
        # STOP is named first: a person must know that it is what holds the robot.
        ({"stopped": True, "odometry_age": math.inf, "obstacles": None}, "stop"),
        ({"odometry_age": math.inf, "obstacles": None}, "odometry stale"),
        ({"obstacles": WALL, "command_stale": True}, "obstacle"),
    ],
)
def test_what_holds_the_robot_stops_it_at_once_and_is_named(
    changed: dict[str, Any], why: str
) -> None:
    gate = DriveGate(limits())
    after(gate, known())
    verdict = gate.judge(known(**changed), 1.0)
    assert (verdict.twist, verdict.factor, verdict.limited_by) == (STILL, 0.0, why)


def test_an_odometry_as_old_as_allowed_still_counts() -> None:
    assert DriveGate(limits()).judge(known(odometry_age=0.5), 0.0).limited_by == ""


def test_nearer_means_slower_and_the_curve_is_kept() -> None:
    wanted = (0.2, 0.0, 0.4)
    verdict = after(DriveGate(limits()), known(wanted, obstacles=FARTHER))
    assert 0.0 < verdict.factor < 1.0
    assert verdict.limited_by == "obstacle"
    assert verdict.twist is not None
    assert verdict.twist[2] / verdict.twist[0] == pytest.approx(2.0)


def test_a_blocked_way_still_allows_the_turn_that_leads_out_of_it() -> None:
    gate = DriveGate(limits())
    turning = after(gate, known((0.2, 0.0, 0.5), obstacles=WALL))
    assert turning.twist == pytest.approx((0.0, 0.0, 0.5))
    assert (turning.factor, turning.limited_by, turning.emergency) == (0.0, "obstacle", False)
    straight = gate.judge(known((0.2, 0.0, 0.05), obstacles=WALL), 2.0)
    assert (straight.twist, straight.emergency) == (STILL, True)


def test_the_emergency_is_a_level_that_ends_by_itself() -> None:
    gate = DriveGate(limits())
    assert gate.judge(known(obstacles=WALL), 0.0).emergency
    assert not gate.judge(known(), PERIOD).emergency


def test_with_nothing_wanted_the_way_that_the_robot_went_last_counts() -> None:
    gate = DriveGate(limits())
    assert not gate.judge(known(None, obstacles=WALL), 0.0).emergency
    after(gate, known((-0.2, 0.0, 0.0)), begin=1.0)
    assert not gate.judge(known(None, obstacles=WALL), 3.0).emergency
    assert gate.judge(known(None, obstacles=-WALL), 3.1).emergency
    after(gate, known(AHEAD), begin=4.0)
    assert gate.judge(known(None, obstacles=WALL), 6.0).emergency


def test_a_stale_command_is_named() -> None:
    verdict = DriveGate(limits()).judge(known(None, command_stale=True), 0.0)
    assert (verdict.factor, verdict.limited_by) == (1.0, "command stale")


def test_the_gate_falls_silent_when_nothing_moves_for_long() -> None:
    gate = DriveGate(limits())
    assert gate.judge(known(None), 0.0).twist is None
    after(gate, known(), begin=1.0)
    ended = 1.0 + 19 * PERIOD
    assert gate.judge(known(None), ended + SETTLE).twist is not None
    after(gate, known(None), begin=ended + SETTLE)
    assert gate.judge(known(None), 10.0).twist is None


def test_stop_is_repeated_however_long_it_lasts() -> None:
    gate = DriveGate(limits())
    assert all(gate.judge(known(None, stopped=True), t).twist == STILL for t in (0.0, 100.0))


def test_after_a_halt_of_somebody_else_the_robot_sets_out_from_rest() -> None:
    gate = DriveGate(
        limits(velocity=VelocityLimits(vx=Limits(0.5, 1.0, 1.0), omega=Limits(1, 1, 1)))
    )
    after(gate, known())
    gate.halted()
    assert gate.judge(known(), 2.0).twist == pytest.approx((0.05, 0.0, 0.0))


@pytest.mark.parametrize("wanted", [None, AHEAD])
def test_a_gate_that_was_held_up_does_not_set_the_robot_in_motion_again(
    wanted: Twist2D | None,
) -> None:
    gate = DriveGate(limits(velocity=SLUGGISH))
    after(gate, known())
    last = 19 * PERIOD
    late = gate.judge(known(wanted), last + 0.2).twist
    assert late is not None
    assert late[0] > 0.1  # a turn that came late is a turn
    held_up = gate.judge(known(wanted), last + 0.2 + 0.3).twist
    assert held_up == (pytest.approx((0.05, 0.0, 0.0)) if wanted else STILL)


def test_without_a_safety_stop_obstacles_do_not_count() -> None:
    gate = DriveGate(limits(safety_stop=False))
    for obstacles in (WALL, None):
        verdict = gate.judge(known(obstacles=obstacles), 0.0)
        assert (verdict.factor, verdict.limited_by, verdict.emergency) == (1.0, "", False)


def test_without_need_of_a_scan_one_that_is_there_still_counts() -> None:
    gate = DriveGate(limits(needs_scan=False))
    assert gate.judge(known(obstacles=None), 0.0).limited_by == ""
    assert gate.judge(known(obstacles=WALL), PERIOD).limited_by == "obstacle"


def test_other_limits_count_from_the_next_turn_on() -> None:
    gate = DriveGate(limits())
    assert gate.judge(known(obstacles=FARTHER), 0.0).factor < 1.0
    gate.set_limits(limits(critical_distance=0.01, slowdown_distance=0.02))
    assert gate.judge(known(obstacles=FARTHER), PERIOD).factor == 1.0


def test_a_command_that_is_not_finite_is_refused() -> None:
    with pytest.raises(ValueError, match="finite"):
        DriveGate(limits()).judge(known((math.nan, 0.0, 0.0)), 0.0)


speeds = st.floats(-2.0, 2.0)
places = st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)), max_size=8)


@given(st.lists(st.tuples(speeds, speeds, places, st.booleans()), min_size=1, max_size=12))
def test_no_command_is_ever_beyond_the_limits_or_through_a_stop(
    turns: list[tuple[float, float, list[tuple[float, float]], bool]],
) -> None:
    gate = DriveGate(limits())
    for n, (v, omega, points, stopped) in enumerate(turns):
        obstacles = np.array(points).reshape(-1, 2)
        verdict = gate.judge(
            known((v, 0.0, omega), obstacles=obstacles, stopped=stopped), n * PERIOD
        )
        assert verdict.twist is not None
        assert abs(verdict.twist[0]) <= 0.5 + 1e-9
        assert abs(verdict.twist[2]) <= 1.5 + 1e-9
        if verdict.factor == 0.0:
            assert verdict.twist[:2] == (0.0, 0.0)
        if stopped:
            assert verdict.twist == STILL


def test_before_a_keep_out_zone_it_stands_and_no_emergency_is_told() -> None:
    verdict = after(DriveGate(limits()), known(edges=WALL))
    assert (verdict.factor, verdict.limited_by, verdict.emergency) == (0.0, "keep-out zone", False)
    assert verdict.twist == STILL


def test_it_keeps_out_with_the_safety_stop_off() -> None:
    verdict = after(DriveGate(limits(safety_stop=False)), known(obstacles=None, edges=WALL))
    assert (verdict.factor, verdict.limited_by) == (0.0, "keep-out zone")


def test_it_may_turn_before_a_zone_and_drive_away_from_it() -> None:
    turning = after(DriveGate(limits()), known((0.2, 0.0, 1.0), edges=WALL))
    assert turning.twist == pytest.approx((0.0, 0.0, 1.0))
    leaving = after(DriveGate(limits()), known((-0.2, 0.0, 0.0), edges=WALL))
    assert (leaving.factor, leaving.limited_by) == (1.0, "")


def test_in_a_speed_zone_it_is_as_fast_as_the_zone_allows_on_the_same_curve() -> None:
    verdict = after(DriveGate(limits()), known((0.4, 0.0, 0.8), fastest=0.1))
    assert verdict.factor == pytest.approx(0.25)
    assert verdict.limited_by == "speed zone"
    assert verdict.twist == pytest.approx((0.1, 0.0, 0.2))
    assert after(DriveGate(limits()), known((0.0, 0.0, 1.0), fastest=0.1)).limited_by == ""


def test_the_nearer_of_obstacle_and_zone_is_named() -> None:
    both = known(obstacles=FARTHER, edges=WALL)
    assert after(DriveGate(limits()), both).limited_by == "keep-out zone"
    both = known(obstacles=WALL, edges=FARTHER)
    assert after(DriveGate(limits()), both).limited_by == "obstacle"


def test_with_zones_and_no_place_it_stands() -> None:
    verdict = after(DriveGate(limits()), known(edges=None))
    assert (verdict.factor, verdict.limited_by) == (0.0, "place unknown")


# A car of 0.6 x 0.4 m, the axle that drives a tenth before its tail.
CAR_BODY = Footprint(np.array([[0.5, -0.2], [0.5, 0.2], [-0.1, 0.2], [-0.1, -0.2]]))
CAR = {"radius": CAR_BODY.radius, "footprint": CAR_BODY, "motion": MotionModel(0.5)}


def test_steered_wheels_are_not_told_to_turn_on_the_spot_and_the_state_says_why() -> None:
    verdict = after(DriveGate(limits(**CAR)), known((0.0, 0.0, 1.0)))
    assert (verdict.twist, verdict.limited_by) == (STILL, "steered wheels")
    assert not verdict.emergency


@pytest.mark.parametrize("v", [0.4, -0.4])
def test_too_tight_a_turn_is_made_as_tight_as_the_wheels_steer(v: float) -> None:
    verdict = after(DriveGate(limits(**CAR)), known((v, 0.1, 1.5)))
    assert verdict.limited_by == ""
    assert verdict.twist == pytest.approx((v, 0.0, 0.8))


@given(
    wanted=st.lists(
        st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-3.0, 3.0), st.booleans()),
        min_size=1,
        max_size=20,
    )
)
def test_whatever_is_commanded_steered_wheels_can_do_what_is_sent(
    wanted: list[tuple[float, float, float, bool]],
) -> None:
    gate = DriveGate(limits(**CAR, velocity=SLUGGISH))
    for turn, (vx, vy, omega, blocked) in enumerate(wanted):
        obstacles = np.array([[0.52, 0.0]]) if blocked else NOTHING
        sent = gate.judge(known((vx, vy, omega), obstacles=obstacles), turn * PERIOD).twist
        assert sent is not None
        assert sent[1] == 0.0
        assert abs(sent[2]) * 0.5 <= abs(sent[0]) + 1e-9


def test_a_car_is_stopped_by_what_its_tail_would_meet_and_not_by_what_it_leaves() -> None:
    behind = np.array([[-0.13, 0.0]])
    assert after(DriveGate(limits(**CAR)), known((-0.3, 0.0, 0.0), obstacles=behind)).factor == 0.0
    assert after(DriveGate(limits(**CAR)), known((0.3, 0.0, 0.0), obstacles=behind)).factor == 1.0


def test_a_slide_is_stopped_by_what_lies_to_the_side() -> None:
    sideways = VelocityLimits(Limits(0.5, 5.0, 5.0), Limits(1.5, 10.0, 10.0), Limits(0.5, 5.0, 5.0))
    wall = WALL[:, ::-1]  # to the left
    gate = DriveGate(limits(velocity=sideways, motion=MotionModel(aside=sideways.vy)))
    verdict = after(gate, known((0.0, 0.3, 0.0), obstacles=wall))
    assert (verdict.factor, verdict.limited_by, verdict.emergency) == (0.0, "obstacle", True)
    assert after(gate, known((0.0, -0.3, 0.0), obstacles=wall)).twist == pytest.approx((0, -0.3, 0))


def test_on_the_way_to_another_curve_what_is_on_that_way_counts() -> None:
    slow_to_turn = VelocityLimits(vx=Limits(0.5, 2.0, 2.0), omega=Limits(1.5, 0.5, 0.5))
    gate = DriveGate(limits(velocity=slow_to_turn))
    after(gate, known((0.4, 0.0, 0.0)))
    # Sharply to the left is free at once, and straight on it would still be driven.
    post = np.array([[0.3, -0.02]])
    sharply = known((0.4, 0.0, 1.5), obstacles=post)
    quick = VelocityLimits(vx=Limits(0.5, 2.0, 2.0), omega=Limits(1.5, 99.0, 99.0))
    assert DriveGate(limits(velocity=quick)).judge(sharply, 0.0).limited_by == ""
    verdict = gate.judge(sharply, 20 * PERIOD)
    assert verdict.limited_by == "obstacle"
    assert verdict.twist
    assert verdict.twist[0] < 0.35
