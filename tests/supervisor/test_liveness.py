"""What silence means: busy, stuck, or nothing."""

import pytest

from kompass.supervisor.liveness import Patience, Signs, judge

PATIENCE = Patience()


@pytest.mark.parametrize(
    ("signs", "expected"),
    [
        (Signs(silent=0.1, lag=0.1), "active"),
        (Signs(silent=0.1), "active"),  # no executor of its own
        (Signs(silent=0.1, lag=0.6), "busy"),
        (Signs(silent=0.1, lag=9.9), "busy"),
        (Signs(silent=0.1, lag=10.1), "stuck"),
        (Signs(silent=0.1, lag=10.1, allowed=30.0), "busy"),
        (Signs(silent=0.7, lag=0.7), "stuck"),
        (Signs(silent=0.7, lag=0.7, computing=True), "busy"),
        (Signs(silent=0.7, computing=True), "busy"),
        (Signs(silent=10.5, computing=True), "stuck"),
        (Signs(silent=10.5, lag=10.5, computing=True), "stuck"),
        (Signs(silent=0.1, lag=0.1, stopped=0.1), "busy"),
        (Signs(silent=0.4, lag=0.4, stopped=0.4), "stuck"),
    ],
)
def test_death_hang_and_work_are_told_apart(signs: Signs, expected: str) -> None:
    condition, reason = judge(signs, PATIENCE)
    assert condition == expected
    assert bool(reason) == (expected != "active")


def test_patience_is_positive() -> None:
    with pytest.raises(ValueError, match=r"silent = 0 s must be above 0"):
        Patience(silent=0)
    assert Patience(killed=None).killed is None
