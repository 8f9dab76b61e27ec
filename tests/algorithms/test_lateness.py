"""Ages count from stamps where these can be believed, and what is wrong with them is said."""

import pytest

from kompass.algorithms.safety.delay import Delay
from kompass.algorithms.safety.lateness import AHEAD, LONGEST, Lateness

NOW = 1_800_000_000.0


def heard(*transits: float) -> Lateness:
    """After messages that came so many seconds after their stamps."""
    source = Lateness()
    for second, transit in enumerate(transits):
        source.heard(NOW + second - transit, NOW + second)
    return source


def test_what_was_long_under_way_is_as_old_as_its_stamp_says() -> None:
    source = heard(0.0, 1.0)
    assert source.late == 1.0
    assert not source.note
    assert "1.0 s after its stamp" in source.told


def test_a_clock_a_hair_ahead_is_no_matter() -> None:
    source = heard(-0.9 * AHEAD)
    assert (source.late, source.note) == (0.0, "")


def test_a_stamp_in_the_future_counts_from_the_arrival_and_is_told() -> None:
    source = heard(-2.5)
    assert source.late == 0.0
    assert "2.5 s in the future" in source.note


def test_a_clock_that_was_never_set_counts_from_the_arrival_and_is_told() -> None:
    source = heard(NOW - 86_400.0)
    assert source.late == 0.0
    assert "in the past" in source.note


def test_one_whose_clock_was_right_is_late_however_late_it_is() -> None:
    source = heard(0.01, 3.0, LONGEST + 5.0)
    assert source.late == LONGEST + 5.0
    assert not source.note


def test_no_stamp_tells_nothing() -> None:
    source = Lateness()
    source.heard(0.0, NOW)
    assert (source.late, source.note) == (0.0, "")


# -- senders with a clock of their own -------------------------------------------------------


def test_a_delay_is_told_against_the_quickest_message_whatever_the_clocks_say() -> None:
    for offset in (-1e6, 0.0, 1e6):
        delay = Delay()
        assert delay.of(10.0 + offset, 10.3) == 0.0
        assert delay.of(11.0 + offset, 11.1) == 0.0  # that was the quicker way
        assert delay.of(12.0 + offset, 12.6) == pytest.approx(0.5, abs=1e-3)


def test_a_delay_does_not_grow_because_two_clocks_drift_apart() -> None:
    delay = Delay()
    told = [delay.of((1 - 5e-5) * second, second + 0.01) for second in range(7200)]
    assert max(told) < 1e-3


def test_a_queue_that_is_emptied_at_once_is_as_late_as_it_lay() -> None:
    delay = Delay()
    delay.of(10.0, 10.0)
    assert [round(delay.of(10.0 + 0.1 * n, 13.0), 2) for n in range(3)] == [3.0, 2.9, 2.8]
