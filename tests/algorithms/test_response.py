"""The response of a base is found again from what it did, noise and odd moments included."""

import math

import numpy as np
import pytest

from kompass.algorithms.response import REACTION, Response, fit_response


def drive(
    gain: float, time_constant: float, delay: float, noise: float = 0.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Steps to and fro of a base that is just so, read at uneven moments."""
    random = np.random.default_rng(4)
    given_at = np.array([0.5, 2.5, 3.5, 5.5])
    given = np.array([0.3, 0.0, -0.3, 0.0])
    fine = np.arange(0.0, 7.0, 1e-3)
    wanted = np.zeros(len(fine))
    for at, value in zip(given_at, given, strict=True):
        wanted[fine >= at + delay] = gain * value
    speed = np.zeros(len(fine))
    for index in range(1, len(fine)):
        speed[index] = wanted[index] + (speed[index - 1] - wanted[index]) * math.exp(
            -1e-3 / time_constant
        )
    at = np.sort(random.uniform(0.0, 7.0, 250))
    return given_at, given, at, np.interp(at, fine, speed) + noise * random.standard_normal(250)


@pytest.mark.parametrize(
    ("gain", "time_constant", "delay"),
    [(1.0, 0.2, 0.1), (0.8, 0.5, 0.0), (1.1, 0.03, 0.25), (1.0, 0.02, 0.02)],
)
def test_what_the_base_is_like_is_found_again(
    gain: float, time_constant: float, delay: float
) -> None:
    found = fit_response(*drive(gain, time_constant, delay, noise=0.005))
    assert found.gain == pytest.approx(gain, rel=0.02)
    assert found.time_constant == pytest.approx(time_constant, abs=0.015)
    assert found.delay == pytest.approx(delay, abs=0.015)
    assert found.residual == pytest.approx(0.005, rel=0.3)
    assert found.explained > 0.99


def test_what_a_model_of_first_order_does_not_explain_is_in_the_residual() -> None:
    given_at, given, at, speeds = drive(1.0, 0.2, 0.1)
    found = fit_response(given_at, given, at, speeds + 0.1 * np.sin(9.0 * at))
    assert found.residual > 0.05
    assert found.explained < 0.95


def test_a_recording_may_begin_while_the_robot_drives() -> None:
    given_at, given, at, speeds = drive(1.0, 0.3, 0.1)
    late = at >= 1.5
    found = fit_response(given_at, given, at[late], speeds[late])
    assert found.time_constant == pytest.approx(0.3, abs=0.02)


def test_commands_that_do_not_change_teach_nothing() -> None:
    given_at, _, at, speeds = drive(1.0, 0.2, 0.1)
    with pytest.raises(ValueError, match=r"the commands change by 0\.000 only"):
        fit_response(given_at, np.zeros(4), at, speeds)
    with pytest.raises(ValueError, match="3 readings"):
        fit_response(given_at, np.ones(4), at[:3], speeds[:3])
    with pytest.raises(ValueError, match="finite"):
        fit_response(given_at, np.ones(4), at, np.where(at > 3.0, math.nan, speeds))


@pytest.mark.parametrize(("time_constant", "delay"), [(0.3, 0.2), (0.02, 0.03)])
def test_a_late_base_stops_in_the_room_of_the_stated_deceleration(
    time_constant: float, delay: float
) -> None:
    top, decel = 1.0, 2.5
    stated = Response(1.0, time_constant, delay, 0.0, 1.0).deceleration(top, decel)
    needed = top * (time_constant + delay) + top**2 / (2.0 * decel)
    granted = top * REACTION + top**2 / (2.0 * stated)
    assert granted >= needed - 1e-9
    assert stated <= decel
