"""Virtual time passes in order, and only when it is let."""

from __future__ import annotations

import pytest

from kompass.virtual.scheduler import MOST_CANCELLED, SECOND, START, Scheduler, VirtualClock


def test_what_is_due_happens_in_the_order_of_time() -> None:
    scheduler, done = Scheduler(), list[tuple[str, int]]()

    def note(what: str) -> None:
        done.append((what, scheduler.now - START))

    scheduler.call_later(30, note, "c")
    scheduler.call_later(10, note, "a")
    scheduler.call_at(START + 20, note, "b")
    scheduler.call_later(40, note, "not yet")
    scheduler.run_until(START + 30)
    assert done == [("a", 10), ("b", 20), ("c", 30)]
    assert scheduler.now == START + 30
    scheduler.run_for(5)
    assert scheduler.now == START + 35
    assert len(done) == 3


def test_what_is_due_at_one_moment_happens_in_the_order_of_the_seed() -> None:
    def order(seed: int) -> list[int]:
        scheduler, done = Scheduler(seed), list[int]()
        for number in range(8):
            scheduler.call_later(1, done.append, number)
        scheduler.run_for(1)
        return done

    assert order(1) == order(1)
    assert len({tuple(order(seed)) for seed in range(10)}) > 5


def test_what_is_cancelled_does_not_happen() -> None:
    scheduler, done = Scheduler(), list[int]()
    events = [scheduler.call_later(10, done.append, number) for number in range(3)]
    scheduler.call_later(5, events[1].cancel)
    events[0].cancel()
    scheduler.run_for(20)
    assert done == [2]
    events[2].cancel()
    for _ in range(3 * MOST_CANCELLED):
        scheduler.call_later(SECOND, print).cancel()
    scheduler.call_later(SECOND, done.append, 7)
    scheduler.run_for(SECOND)
    assert done == [2, 7]


def test_time_stops_when_something_has_come_true() -> None:
    scheduler, done = Scheduler(), list[int]()
    for number in range(5):
        scheduler.call_later(10 * (number + 1), done.append, number)
    assert scheduler.run_while(lambda: len(done) < 2)
    assert scheduler.now == START + 20
    assert not scheduler.run_while(lambda: len(done) < 4, limit=15)
    assert (done, scheduler.now) == ([0, 1, 2], START + 35)
    assert not scheduler.run_while(lambda: True), "nothing is left to happen"


def test_what_a_function_raises_comes_out_and_the_rest_is_still_to_come() -> None:
    def fail() -> None:
        raise ValueError("as expected")

    scheduler, done = Scheduler(), list[int]()
    scheduler.call_later(1, fail)
    scheduler.call_later(2, done.append, 1)
    with pytest.raises(ValueError, match="as expected"):
        scheduler.run_for(5)
    scheduler.run_for(5)
    assert done == [1]


def test_what_happens_cannot_make_time_pass() -> None:
    scheduler = Scheduler()
    scheduler.call_later(1, scheduler.run_for, 1)
    with pytest.raises(RuntimeError, match="time passes already"):
        scheduler.run_for(5)


def test_the_clock_shows_virtual_time_alone() -> None:
    scheduler = Scheduler(epoch=5 * SECOND)
    clock = VirtualClock(scheduler)
    assert clock.wall() == 5.0
    before = clock.monotonic()
    scheduler.run_for(3600 * SECOND)
    assert clock.wall() == 3605.0
    assert clock.monotonic() - before == 3600.0
    assert clock.monotonic_ns() - START == 3600 * SECOND


def test_chance_of_one_use_is_not_changed_by_another() -> None:
    one, other = Scheduler(7), Scheduler(7)
    other.random("weather").random()
    assert one.random("network").random() == other.random("network").random()
    assert one.random("network").random() != Scheduler(8).random("network").random()
