"""Any number of timers on an executor, and none of ROS.

The events executor (rclpy 7.1.6) handles nine timers of a node badly, and says so on the terminal;
a monitor has two for each action that runs. One timer of ROS that is set anew each time it fires
is worse: on a machine that is too busy for a while, each firing leaves two more events in the
executor's queue, until it does nothing else and fills the memory.
"""

from __future__ import annotations

from collections.abc import Callable
from heapq import heapify, heappop, heappush
from itertools import count

from kompass.bus.node import Node

LONGEST_WAIT = 3600.0  # s; later than that, it looks again
MOST_CANCELLED = 256  # cancelled timers that may stay in the queue


class Timer:
    """Calls a function once, or every ``period`` seconds, until it is cancelled."""

    def __init__(self, function: Callable[[], None], period: float | None) -> None:
        self.function = function
        self.period = period
        self.active = True

    def cancel(self) -> None:
        """Call it no more."""
        self.active = False


class Timers:
    """Timers on the thread that spins a node; on the monotonic clock, whatever time ROS has.

    Parameters
    ----------
    node
        Must be in a :class:`kompass.rclpy_ext.executor.TaskExecutor`, which fires them.
    """

    def __init__(self, node: Node) -> None:
        self.clock = node.clock
        self._heap: list[tuple[float, int, Timer]] = []
        self._order = count()
        node.executor.add_timers(self)

    def after(self, seconds: float, function: Callable[[], None]) -> Timer:
        """Call a function once, some seconds from now."""
        timer = Timer(function, None)
        self._add(self.clock.monotonic() + seconds, timer)
        return timer

    def every(self, period: float, function: Callable[[], None]) -> Timer:
        """Call a function every ``period`` seconds; a time that is missed is left out."""
        timer = Timer(function, period)
        self._add(self.clock.monotonic() + period, timer)
        return timer

    def _add(self, at: float, timer: Timer) -> None:
        if len(self._heap) > MOST_CANCELLED and len(self._heap) > 2 * sum(
            each.active for _, _, each in self._heap
        ):
            self._heap = [item for item in self._heap if item[2].active]
            heapify(self._heap)
        heappush(self._heap, (at, next(self._order), timer))

    def fire(self) -> float:
        """Call what is due.

        Returns
        -------
        float
            Time until the next is due [s].
        """
        now = self.clock.monotonic()
        while self._heap and self._heap[0][0] <= now:
            at, _, timer = heappop(self._heap)
            if not timer.active:
                continue
            if timer.period is None:
                timer.active = False
            else:
                heappush(self._heap, (max(at + timer.period, now), next(self._order), timer))
            timer.function()
        while self._heap and not self._heap[0][2].active:
            heappop(self._heap)
        if not self._heap:
            return LONGEST_WAIT
        return min(max(self._heap[0][0] - self.clock.monotonic(), 0.0), LONGEST_WAIT)


class MovableTimer:
    """One call that is moved to when it is next needed: early at times, and never late.

    Setting a later time changes nothing: at a message every millisecond, that saves a thousand
    changes for each call that comes for nothing.
    """

    def __init__(self, timers: Timers, function: Callable[[], None]) -> None:
        self._timers, self._function = timers, function
        self._at = float("inf")
        self._timer: Timer | None = None

    def set(self, at: float | None) -> None:
        """Call at this time of the monotonic clock [s], or before; None asks for nothing."""
        if at is None or self._at <= at:
            return
        if self._timer is not None:
            self._timer.cancel()
        self._at = at
        self._timer = self._timers.after(at - self._timers.clock.monotonic(), self._fire)

    def _fire(self) -> None:
        self._timer, self._at = None, float("inf")
        self._function()
