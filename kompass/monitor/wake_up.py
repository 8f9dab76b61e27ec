"""One timer that is set to when it is next needed."""

from __future__ import annotations

import time
from collections.abc import Callable

from rclpy.node import Node

SOONEST = 1e-4  # s
LATEST = 3600.0  # s; later than that, it looks again


class WakeUp:
    """Calls a function at a time of the monotonic clock, early at times and never late.

    Setting a later time leaves the timer alone: at a message every millisecond, that saves a
    thousand changes for each time it goes off for nothing.
    """

    def __init__(self, node: Node, function: Callable[[], None]) -> None:
        self._function = function
        self._at: float | None = None
        self._timer = node.create_timer(LATEST, self._ring)
        self._timer.cancel()

    def set(self, at: float | None) -> None:
        """Ring at this time [s]; None asks for nothing."""
        if at is None or (self._at is not None and self._at <= at):
            return
        delay = min(max(at - time.monotonic(), SOONEST), LATEST)
        self._at = at
        self._timer.timer_period_ns = int(delay * 1e9)
        self._timer.reset()

    def _ring(self) -> None:
        self._timer.cancel()
        self._at = None
        self._function()
