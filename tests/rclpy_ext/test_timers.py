"""Any number of timers ring when they should, on one timer of ROS."""

import time

import pytest

from kompass.rclpy_ext.timers import MovableTimer, Timers
from tests.support.patience import patient
from tests.support.spinning import Spinning


@pytest.fixture
def timers(spinning: Spinning) -> Timers:
    return Timers(spinning.node)


def test_they_ring_in_order_and_in_time(spinning: Spinning, timers: Timers) -> None:
    rung: list[tuple[float, float]] = []
    begun = time.monotonic()
    for delay in (0.15, 0.05, 0.1, 0.0):
        timers.after(delay, lambda d=delay: rung.append((d, time.monotonic() - begun)))  # type: ignore[misc]
    spinning.until(lambda: len(rung) == 4)
    assert [delay for delay, _ in rung] == [0.0, 0.05, 0.1, 0.15]
    assert all(at >= delay for delay, at in rung)
    assert min(at - delay for delay, at in rung) < patient(0.01)


def test_fifty_of_them_say_nothing_on_the_terminal(
    spinning: Spinning, timers: Timers, capfd: pytest.CaptureFixture[str]
) -> None:
    rung: list[int] = []
    for number in range(50):
        timers.after(0.01, lambda n=number: rung.append(n))  # type: ignore[misc]
    spinning.until(lambda: len(rung) == 50)
    assert rung == list(range(50))
    assert capfd.readouterr() == ("", "")


def test_a_cancelled_one_is_silent_and_the_others_go_on(spinning: Spinning, timers: Timers) -> None:
    rung: list[str] = []
    again = timers.every(0.02, lambda: rung.append("again"))
    timers.after(0.03, lambda: rung.append("never")).cancel()
    spinning.until(lambda: len(rung) == 3)
    again.cancel()
    spinning.rest(0.06)
    assert rung == ["again"] * 3


def test_a_thousand_that_were_cancelled_do_not_pile_up(timers: Timers) -> None:
    kept = timers.after(1000.0, lambda: None)
    for _ in range(2000):
        timers.after(500.0, lambda: None).cancel()
    assert len(timers._heap) < 600
    assert any(item[2] is kept for item in timers._heap)


def test_a_wake_up_is_never_late(spinning: Spinning, timers: Timers) -> None:
    rung: list[float] = []
    wake_up = MovableTimer(timers, lambda: rung.append(time.monotonic()))
    soon = time.monotonic() + 0.05
    wake_up.set(soon + 10.0)
    wake_up.set(soon)
    wake_up.set(soon + 5.0)
    wake_up.set(None)
    spinning.until(lambda: rung)
    assert rung[0] >= soon
    spinning.rest(0.05)
    assert len(rung) == 1


def test_one_that_raises_silences_no_other(spinning: Spinning, timers: Timers) -> None:
    rung: list[str] = []

    def fail() -> None:
        raise RuntimeError("as expected")

    timers.after(0.01, fail)
    timers.after(0.02, lambda: rung.append("later"))
    again = timers.every(0.01, lambda: rung.append("again"))
    with pytest.raises(RuntimeError, match="as expected"):
        spinning.until(lambda: False)
    spinning.until(lambda: "later" in rung and rung.count("again") > 2)
    again.cancel()
