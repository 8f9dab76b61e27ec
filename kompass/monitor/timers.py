"""Any number of timers on one timer of ROS.

rclpy's events executor (7.1.6) handles nine timers of a node badly, and says so on the terminal; a
monitor has two for each action that runs.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from heapq import heapify, heappop, heappush
from itertools import count

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node

SOONEST = 1e-4  # s
LATEST = 3600.0  # s; later than that, it looks again
CLUTTER = 256  # cancelled timers that may lie about


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
    """Timers on the thread that spins a node; on the monotonic clock, whatever time ROS has."""

    def __init__(self, node: Node) -> None:
        self._heap: list[tuple[float, int, Timer]] = []
        self._order = count()
        self._set = float("inf")
        self._timer = node.create_timer(
            LATEST, self._ring, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )
        self._timer.cancel()

    def after(self, seconds: float, function: Callable[[], None]) -> Timer:
        """Call a function once, some seconds from now."""
        timer = Timer(function, None)
        self._add(time.monotonic() + seconds, timer)
        return timer

    def every(self, period: float, function: Callable[[], None]) -> Timer:
        """Call a function every ``period`` seconds; a time that is missed is left out."""
        timer = Timer(function, period)
        self._add(time.monotonic() + period, timer)
        return timer

    def _add(self, at: float, timer: Timer) -> None:
        if len(self._heap) > CLUTTER and len(self._heap) > 2 * sum(
            each.active for _, _, each in self._heap
        ):
            self._heap = [item for item in self._heap if item[2].active]
            heapify(self._heap)
        heappush(self._heap, (at, next(self._order), timer))
        if at < self._set:
            self._arm(at)

    def _arm(self, at: float) -> None:
        self._set = at
        delay = min(max(at - time.monotonic(), SOONEST), LATEST)
        self._timer.timer_period_ns = int(delay * 1e9)
        self._timer.reset()

    def _ring(self) -> None:
        self._timer.cancel()
        self._set = float("inf")
        try:
            self._call_due(time.monotonic())
        finally:
            # All others ring on after one that raises.
            while self._heap and not self._heap[0][2].active:
                heappop(self._heap)
            if self._heap and self._heap[0][0] < self._set:
                self._arm(self._heap[0][0])

    def _call_due(self, now: float) -> None:
        while self._heap and self._heap[0][0] <= now:
            at, _, timer = heappop(self._heap)
            if not timer.active:
                continue
            if timer.period is None:
                timer.active = False
            else:
                heappush(self._heap, (max(at + timer.period, now), next(self._order), timer))
            timer.function()
