"""Functions that sleep and wait take virtual time, and go the same way every time."""

from __future__ import annotations

import asyncio
import os
import queue
import subprocess
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import pytest
from std_msgs.msg import String

from kompass.virtual import waiting
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.node import VirtualNode
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

    def stuck() -> None:
        lock.acquire()

    named = (
        r"stuck \(now in line \d+ of test_waiting.py\) in the thread 'helper' of one has neither"
    )
    with pytest.raises(NeverReturned, match=named):
        made(stuck)
    lock.release()


def test_a_while_in_which_the_whole_process_was_held_is_no_functions_fault(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(waiting, "PATIENCE", 3.0)
    # Held for longer than all patience, in the middle of a turn of the function's.
    script = f"kill -STOP {os.getpid()}; sleep 3.5; kill -CONT {os.getpid()}; sleep 0.3"

    def held() -> str:
        subprocess.run(["sh", "-c", script], check=True)
        return "came to its end"

    assert made(held)[0] == "came to its end"


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


class Sleeper:
    """A node whose timer sleeps, and one that hears what it says afterwards."""

    def __init__(self, world: World, seconds: float) -> None:
        self.world, self.seconds = world, seconds
        self.process = world.process("sleeper")
        self.node = VirtualNode(self.process, "sleeper")
        self.executor = VirtualExecutor(self.process)
        self.executor.add_node(self.node)
        self._publisher = self.node.create_publisher(String, "/said", 10)
        self.turns: list[tuple[float, float]] = []  # when it began, and for how long it slept
        self.heard: list[tuple[float, str]] = []
        ear = VirtualNode(world.process("ear"), "ear")
        VirtualExecutor(ear.process).add_node(ear)
        ear.create_subscription(String, "/said", self._hear, 10)
        world.scheduler.run_for(SECOND)
        self.began = world.clock.monotonic()
        self.node.create_timer(0.1, self._turn)

    def _hear(self, message: String) -> None:
        self.heard.append((self.world.clock.monotonic() - self.began, message.data))

    def _turn(self) -> None:
        before = self.node.clock.monotonic()
        self._publisher.publish(String(data="before"))
        time.sleep(self.seconds)
        self._publisher.publish(String(data="after"))
        self.turns.append((before - self.began, self.node.clock.monotonic() - before))


def test_a_callback_that_sleeps_takes_virtual_time_and_no_other() -> None:
    begun = time.monotonic()
    with World() as world:
        sleeper = Sleeper(world, 30.0)
        world.scheduler.run_for(95 * SECOND)
    assert [slept for _, slept in sleeper.turns] == pytest.approx([30.0] * 4)
    assert [text for _, text in sleeper.heard[:4]] == ["before", "after"] * 2
    times = [at for at, _ in sleeper.heard[:4]]
    assert times == pytest.approx([0.1, 30.1, 30.1, 60.1], abs=0.2)
    assert time.monotonic() - begun < 20.0


def test_a_callback_that_sleeps_holds_up_its_executor_and_those_who_look_see_it() -> None:
    with World() as world:
        sleeper = Sleeper(world, 3.0)
        done: list[float] = []
        world.scheduler.run_for(SECOND)
        assert sleeper.executor.lag == pytest.approx(0.9 * SECOND, rel=0.01)
        sleeper.executor.push(lambda: done.append(world.clock.monotonic() - sleeper.began))
        world.scheduler.run_for(6 * SECOND)
    # After the timer's next turn, which was due before.
    assert done == [pytest.approx(6.1, abs=0.02)]


def test_what_a_callback_would_have_said_after_its_process_died_is_not_heard() -> None:
    with World() as world:
        sleeper = Sleeper(world, 3.0)
        world.scheduler.run_for(SECOND)
        sleeper.process.kill()
        world.scheduler.run_for(5 * SECOND)
    assert [text for _, text in sleeper.heard] == ["before"]


def test_a_callback_that_sleeps_again_and_again_for_ever_hangs_and_ends_no_drill() -> None:
    with World() as world:
        sleeper = Sleeper(world, 0.0)

        def wait_for_ever() -> None:
            while True:
                time.sleep(0.5)

        sleeper.executor.push(wait_for_ever)
        world.scheduler.run_for(200 * SECOND)
        assert sleeper.executor.lag == pytest.approx(200 * SECOND, rel=0.01)
