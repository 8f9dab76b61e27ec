"""Functions that sleep and wait take virtual time, and go the same way every time."""

from __future__ import annotations

import asyncio
import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import pytest

from kompass.virtual import waiting
from kompass.virtual.process import VirtualProcess, World
from kompass.virtual.threads import HOP, VirtualThreads
from kompass.virtual.waiting import NeverReturned, in_virtual_time

SECOND = 1_000_000_000


def made(function: Callable[..., Any], *args: Any, seconds: float = 100.0) -> tuple[Any, float]:
    """What a function returns in a thread of virtual time, and the virtual seconds that it took."""
    with World() as world:
        threads = VirtualThreads(world.process("one"), 2, "helper")
        future: Future[Any] = threads.submit(function, *args)
        began = world.scheduler.now + HOP
        assert world.scheduler.run_while(lambda: not future.done(), round(seconds * SECOND))
        return future.result(), (world.scheduler.now - began) * 1e-9


def test_sleep_takes_virtual_time_and_no_other() -> None:
    begun = time.monotonic()
    _, took = made(time.sleep, 0.0)
    assert took == 0.0

    def sleep() -> tuple[float, float, float]:
        before = time.monotonic(), time.time(), time.perf_counter()
        time.sleep(90.0)
        after = time.monotonic(), time.time(), time.perf_counter()
        return tuple(b - a for a, b in zip(before, after, strict=True))  # type: ignore[return-value]

    clocks, took = made(sleep)
    assert clocks == pytest.approx((90.0, 90.0, 90.0))
    assert took == pytest.approx(90.0)
    assert time.monotonic() - begun < 60.0


def test_what_was_imported_by_its_own_name_goes_by_virtual_time_too() -> None:
    with in_virtual_time():
        from time import sleep
    assert made(sleep, 30.0)[1] == pytest.approx(30.0)
    begun = time.monotonic()
    sleep(0.01)
    assert time.monotonic() - begun >= 0.01, "elsewhere it is as always"


def test_all_is_as_before_when_nobody_runs() -> None:
    before = time.sleep, time.monotonic, threading.Condition.wait, asyncio.new_event_loop
    made(time.sleep, 5.0)
    assert (time.sleep, time.monotonic, threading.Condition.wait, asyncio.new_event_loop) == before


def test_a_coroutine_awaits_in_virtual_time() -> None:
    async def work() -> float:
        begun = asyncio.get_running_loop().time()
        async with asyncio.timeout(50.0):
            await asyncio.gather(asyncio.sleep(20.0), asyncio.sleep(30.0))
        await asyncio.to_thread(time.sleep, 10.0)
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(asyncio.Event().wait(), 5.0)
        return asyncio.get_running_loop().time() - begun

    told, took = made(lambda: asyncio.run(work()))
    assert told == pytest.approx(took) == pytest.approx(45.0)


def test_events_queues_and_futures_are_waited_for_in_virtual_time() -> None:
    with World() as world:
        threads = VirtualThreads(world.process("one"), 2, "helper")
        event, items = threading.Event(), queue.Queue[int]()
        given: Future[int] = Future()

        def take() -> tuple[Any, ...]:
            early = event.wait(3.0)
            item = items.get(timeout=100.0)
            with pytest.raises(queue.Empty):
                items.get(timeout=2.0)
            return early, event.wait(), item, given.result(50.0), time.monotonic()

        began = world.clock.monotonic()
        taken = threads.submit(take)
        for at, put in (
            (5, event.set),
            (9, lambda: items.put(7)),
            (20, lambda: given.set_result(8)),
        ):
            world.scheduler.call_later(at * SECOND, put)
        world.scheduler.run_for(60 * SECOND)
        early, late, item, number, ended = taken.result()
        assert (early, late, item, number) == (False, True, 7, 8)
        assert ended - began == pytest.approx(20.0)


def test_no_more_run_at_a_time_than_there_are_threads_and_in_their_order() -> None:
    with World() as world:
        threads = VirtualThreads(world.process("one"), 2, "helper")
        told: list[tuple[int, float]] = []

        def work(number: int) -> None:
            time.sleep(1.0)
            told.append((number, round(world.clock.monotonic(), 2)))

        for number in range(5):
            threads.submit(work, number)
        began = round(world.clock.monotonic(), 2)
        world.scheduler.run_for(10 * SECOND)
        assert [round(at - began) for _, at in told] == [1, 1, 2, 2, 3]
        assert [number for number, _ in told][4] == 4


def test_who_is_held_sleeps_on_and_who_is_killed_never_wakes() -> None:
    with World() as world:
        told: list[float] = []

        def work() -> None:
            time.sleep(1.0)
            told.append(world.clock.monotonic())

        process: VirtualProcess = world.process("one")
        began = world.clock.monotonic()
        VirtualThreads(process, 1, "helper").submit(work)
        world.scheduler.run_for(SECOND // 2)
        process.stop()
        world.scheduler.run_for(5 * SECOND)
        assert told == []
        process.go_on()
        world.scheduler.run_for(SECOND)
        assert [at - began for at in told] == [pytest.approx(5.5)]
        VirtualThreads(process, 1, "helper").submit(work)
        world.scheduler.run_for(SECOND // 2)
        process.kill()
        world.scheduler.run_for(5 * SECOND)
        assert len(told) == 1


def test_what_virtual_time_cannot_wait_for_is_told_instead_of_hanging(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(waiting, "PATIENCE", 0.2)
    lock = threading.Lock()
    lock.acquire()
    with pytest.raises(NeverReturned, match="thread 'helper' of one has neither returned"):
        made(lock.acquire)
    lock.release()


def test_a_hundred_sleepers_wake_in_the_same_order_every_time() -> None:
    def run() -> list[int]:
        with World(seed=3) as world:
            threads = VirtualThreads(world.process("one"), 100, "helper")
            woken: list[int] = []

            def work(number: int) -> None:
                for _ in range(3):
                    time.sleep(0.5)
                    woken.append(number)

            for number in range(100):
                threads.submit(work, number)
            world.scheduler.run_for(5 * SECOND)
            return woken

    first = run()
    assert len(first) == 300
    assert run() == first
