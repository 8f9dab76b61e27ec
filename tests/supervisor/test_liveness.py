"""What silence means: busy, stuck, or nothing."""

from dataclasses import replace

import pytest

from kompass.supervisor.liveness import LivenessLimits, Observation, assess_liveness

LIMITS = LivenessLimits()


@pytest.mark.parametrize(
    ("observed", "expected"),
    [
        (Observation(silent=0.1, lag=0.1), "active"),
        (Observation(silent=0.1), "active"),  # no executor of its own
        (Observation(silent=0.1, lag=0.6), "busy"),
        (Observation(silent=0.1, lag=2.4), "busy"),
        (Observation(silent=0.1, lag=2.6), "stuck"),
        (Observation(silent=0.1, lag=9.9, allowed=30.0), "busy"),
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
    judged = assess_liveness(observed, LIMITS)
    assert judged.condition == expected
    assert bool(judged.reason) == (expected != "active")


@pytest.mark.parametrize(
    ("observed", "lost"),
    [
        (Observation(silent=0.1, lag=2.6), False),  # it may come round
        (Observation(silent=0.1, lag=10.1), True),
        (Observation(silent=0.1, lag=10.1, waited=9.0), True),
        (Observation(silent=0.1, lag=10.1, allowed=30.0), False),
        (Observation(silent=0.7, lag=0.7), True),
        (Observation(silent=0.1, lag=0.4, stopped=0.4), True),
    ],
)
def test_what_may_still_come_round_is_not_given_up(observed: Observation, lost: bool) -> None:
    assert assess_liveness(observed, LIMITS).is_lost == lost


def test_time_for_which_it_waits_for_a_processor_does_not_count_on_a_starved_machine() -> None:
    starved = Observation(silent=0.1, lag=6.0, waited=4.0)

    assert assess_liveness(starved, LIMITS).condition == "busy"
    assert assess_liveness(replace(starved, waited=3.0), LIMITS).condition == "stuck"


def test_limits_are_positive() -> None:
    with pytest.raises(ValueError, match=r"silent = 0 s must be above 0"):
        LivenessLimits(silent=0)
    assert LivenessLimits(killed=None).killed is None
    with pytest.raises(ValueError, match=r"hung = 10.0 s must not be below stuck = 60 s"):
        LivenessLimits(stuck=60)
