"""Wait inside of coroutines on an rclpy executor: for a time, or for a future with a deadline.

rclpy (7.1.6) has neither: no sleep, and no deadline of an awaited future.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.task import Future

from kompass.bus.node import Executor
from kompass.rclpy_ext.timers import Timers

POLL_PERIOD = 0.02  # s between two looks at what has no future of its own


class Awaitables:
    """Awaitables on one executor. No thread sleeps.

    Parameters
    ----------
    timers
        On the same executor.
    executor
        Runs the coroutines that wait.
    """

    def __init__(self, timers: Timers, executor: Executor) -> None:
        self._timers = timers
        self._clock = timers.clock
        self._executor = executor

    def future(self) -> Future:
        """A future of this executor."""
        return Future(executor=self._executor)

    async def sleep(self, seconds: float) -> None:
        """Let others run for a while."""
        done = self.future()
        timer = self._timers.after(seconds, lambda: _finish(done))
        try:
            await done
        finally:
            timer.cancel()

    async def until(self, condition: Callable[[], bool], timeout: float, what: str) -> None:
        """Wait until a condition holds.

        Parameters
        ----------
        condition
            Asked every :data:`POLL_PERIOD`.
        timeout
            For how long at most [s].
        what
            Named in the error.

        Raises
        ------
        TimeoutError
            When it does not hold in time.
        """
        deadline = self._clock.monotonic() + timeout
        while not condition():
            if self._clock.monotonic() >= deadline:
                raise TimeoutError(f"{what} within {timeout:g} s")
            await self.sleep(POLL_PERIOD)

    async def result(self, awaited: Future, timeout: float | None, what: str) -> Any:
        """Wait for the result of a future.

        Parameters
        ----------
        awaited
            The future.
        timeout
            For how long at most [s]; None for ever.
        what
            Named in the error.

        Raises
        ------
        TimeoutError
            When there is none in time.
        """
        if timeout is None:
            return await awaited
        done = self.future()
        awaited.add_done_callback(lambda _: _finish(done))
        timer = self._timers.after(timeout, lambda: _finish(done))
        try:
            await done
        finally:
            timer.cancel()
        if not awaited.done():
            raise TimeoutError(f"{what} within {timeout:g} s")
        return awaited.result()


def _finish(future: Future) -> None:
    if not future.done():
        future.set_result(None)
