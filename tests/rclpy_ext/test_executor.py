"""Coroutines on the executor cost nothing while they wait, and end when they are told to."""

import time

import pytest
from rclpy.task import Future

from kompass.rclpy_ext.executor import Cancelled, Task
from tests.support.patience import patient
from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros


def test_one_that_waits_costs_nothing(spinning: Spinning) -> None:
    awaited = Future(executor=spinning.executor)

    async def wait() -> int:
        return int(await awaited) + 1

    result = spinning.executor.create_task(wait)
    begun = time.process_time()
    spinning.rest(1.0)
    assert time.process_time() - begun < 0.4
    awaited.set_result(41)
    spinning.until(result.done)
    assert result.result() == 42


def test_one_may_await_another(spinning: Spinning) -> None:
    awaited = Future(executor=spinning.executor)

    async def inner() -> str:
        return str(await awaited)

    async def outer() -> str:
        second: str = await spinning.executor.create_task(inner)
        return await inner() + second

    result = spinning.executor.create_task(outer)
    spinning.rest(0.05)
    assert not result.done()
    awaited.set_result("a")
    spinning.until(result.done)
    assert result.result() == "aa"


def test_what_it_raises_is_raised_where_it_is_awaited(spinning: Spinning) -> None:
    async def fail() -> None:
        raise RuntimeError("as expected")

    async def look() -> str:
        try:
            await spinning.executor.create_task(fail)
        except RuntimeError as error:
            return str(error)
        return "nothing was raised"

    result = spinning.executor.create_task(look)
    spinning.until(result.done)
    assert result.result() == "as expected"


def test_a_cancelled_one_cleans_up_and_does_no_more(spinning: Spinning) -> None:
    awaited = Future(executor=spinning.executor)
    done: list[str] = []
    ends: list[BaseException | None] = []

    async def work() -> None:
        try:
            await awaited
            done.append("went on")
        finally:
            done.append("cleaned up")

    job = Task(work(), ends.append)
    job.cancel()
    job.cancel()
    assert job.done
    awaited.set_result(None)
    spinning.rest(0.05)
    assert done == ["cleaned up"]
    assert [type(end) for end in ends] == [Cancelled]


def test_one_that_cancels_itself_ends_at_its_next_wait(spinning: Spinning) -> None:
    ends: list[BaseException | None] = []
    jobs: list[Task] = []
    first, second = (Future(executor=spinning.executor) for _ in range(2))

    async def work() -> None:
        await first
        jobs[0].cancel()
        await second

    jobs.append(Task(work(), ends.append))
    first.set_result(None)
    spinning.until(lambda: ends)
    assert [type(end) for end in ends] == [Cancelled]


def test_what_a_function_raises_comes_out_of_the_spin_and_ends_no_process(
    spinning: Spinning,
) -> None:
    def fail() -> None:
        raise RuntimeError("as expected")

    result = spinning.executor.create_task(fail)
    with pytest.raises(RuntimeError, match="as expected"):
        spinning.until(lambda: False)
    assert str(result.exception()) == "as expected"
    after = spinning.executor.create_task(lambda: "it goes on")
    spinning.until(after.done)
    assert after.result() == "it goes on"


def test_without_a_timeout_it_rests_and_timers_fire(spinning: Spinning) -> None:
    fired: list[float] = []
    timer = spinning.node.create_timer(0.05, lambda: fired.append(time.monotonic()))
    begun = time.process_time()
    deadline = time.monotonic() + patient(5.0)
    while len(fired) < 5 and time.monotonic() < deadline:
        spinning.executor.spin_once()
    assert len(fired) >= 5
    assert time.process_time() - begun < 0.2
    spinning.node.destroy_timer(timer)
