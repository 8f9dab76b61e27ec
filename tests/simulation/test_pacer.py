"""Simulated time keeps up with real time, or says that it does not."""

import pytest

from kompass.simulation.pacer import MAX_CATCH_UP, Pacer

PERIOD = 0.02


def test_on_time_it_simulates_one_period_per_tick() -> None:
    pacer = Pacer(PERIOD, now=100.0)
    assert [pacer.due(100.0 + PERIOD * tick) for tick in range(1, 51)] == [1] * 50
    rate, lost = pacer.report(101.0)
    assert rate == pytest.approx(1.0)
    assert lost == 0.0


def test_jitter_neither_loses_nor_repeats_a_period() -> None:
    pacer = Pacer(PERIOD, now=0.0)
    total = sum(
        pacer.due(PERIOD * tick + (0.003 if tick % 2 else -0.003)) for tick in range(1, 1001)
    )
    assert total == 1000


def test_short_hiccup_is_made_up_for() -> None:
    pacer = Pacer(PERIOD, now=0.0)
    assert pacer.due(0.08) == 4
    assert pacer.due(0.10) == 1


def test_overload_slows_the_simulation_and_is_reported() -> None:
    pacer = Pacer(PERIOD, now=0.0)
    counts = [pacer.due(0.5 * tick) for tick in range(1, 11)]
    assert max(counts) * PERIOD <= MAX_CATCH_UP + 1e-9
    rate, lost = pacer.report(5.0)
    assert rate == pytest.approx(0.2, abs=0.01)
    assert lost == pytest.approx(4.0, abs=0.1)
    assert pacer.report(6.0) == (0.0, 0.0)
