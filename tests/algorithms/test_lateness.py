"""Ages count from stamps where these can be believed, and what is wrong with them is said."""

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
