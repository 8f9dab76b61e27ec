"""What comes regularly is missed soon; what comes seldom, or in fits, is waited for."""

from collections.abc import Iterable

from kompass.algorithms.safety.rhythm import SHORTEST, Rhythm


def heard(times: Iterable[float]) -> Rhythm:
    rhythm = Rhythm()
    for time in times:
        rhythm.heard(time)
    return rhythm


def test_what_comes_ten_times_a_second_is_overdue_after_three_messages() -> None:
    rhythm = heard(0.1 * n for n in range(10))
    assert abs(rhythm.patience(3, 0.5) - 0.3) < 1e-9
    assert abs(rhythm.patience(4, 0.5) - 0.4) < 1e-9


def test_nothing_is_overdue_sooner_than_a_busy_machine_may_be_late() -> None:
    assert heard(0.02 * n for n in range(20)).patience(3, 0.5) == SHORTEST


def test_the_timeout_counts_where_it_is_shorter() -> None:
    assert heard(0.2 * n for n in range(10)).patience(3, 0.5) == 0.5
    assert heard(0.1 * n for n in range(10)).patience(3, 0.2) == 0.2


def test_of_whom_no_rhythm_is_known_the_least_is_believed() -> None:
    assert Rhythm().patience(3, 0.5) == SHORTEST
    assert heard((0.0, 0.2, 0.4)).patience(3, 0.5) == SHORTEST
    assert Rhythm().patience(3, 0.2) == 0.2


def test_messages_that_came_late_and_then_at_once_change_no_rhythm() -> None:
    times = [0.0, 0.1, 0.2, 0.3, 0.8, 0.801, 0.802, 0.9, 1.0]
    assert abs(heard(times).patience(3, 0.5) - 0.3) < 1e-9
