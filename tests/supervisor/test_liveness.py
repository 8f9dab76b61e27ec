"""What silence means: busy, stuck, or nothing."""

import pytest

from kompass.supervisor.liveness import LivenessLimits, Observation, assess_liveness

LIMITS = LivenessLimits()


@pytest.mark.parametrize(
    ("observed", "expected"),
    [
        (Observation(silent=0.1, lag=0.1), "active"),
        (Observation(silent=0.1), "active"),  # no executor of its own
        (Observation(silent=0.1, lag=0.6), "busy"),
        (Observation(silent=0.1, lag=9.9), "busy"),
        (Observation(silent=0.1, lag=10.1), "stuck"),
        (Observation(silent=0.1, lag=10.1, allowed=30.0), "busy"),
        (Observation(silent=0.7, lag=0.7), "stuck"),
        (Observation(silent=0.7, lag=0.7, computing=True), "busy"),
        (Observation(silent=0.7, computing=True), "busy"),
        (Observation(silent=10.5, computing=True), "stuck"),
        (Observation(silent=10.5, lag=10.5, computing=True), "stuck"),
        (Observation(silent=0.1, lag=0.1, stopped=0.1), "busy"),
        (Observation(silent=0.4, lag=0.4, stopped=0.4), "stuck"),
    ],
)
def test_death_hang_and_work_are_told_apart(observed: Observation, expected: str) -> None:
    condition, reason = assess_liveness(observed, LIMITS)
    assert condition == expected
    assert bool(reason) == (expected != "active")


def test_limits_are_positive() -> None:
    with pytest.raises(ValueError, match=r"silent = 0 s must be above 0"):
        LivenessLimits(silent=0)
    assert LivenessLimits(killed=None).killed is None
