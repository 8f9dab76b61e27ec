"""One call that is moved to when it is next needed."""

from __future__ import annotations

import time
from collections.abc import Callable

from kompass.rclpy_ext.timers import Timer, Timers


class MovableTimer:
    """Calls a function at a time of the monotonic clock, early at times and never late.

    Setting a later time changes nothing: at a message every millisecond, that saves a thousand
    changes for each time it rings for nothing.
    """

    def __init__(self, timers: Timers, function: Callable[[], None]) -> None:
        self._timers, self._function = timers, function
        self._at = float("inf")
        self._timer: Timer | None = None

    def set(self, at: float | None) -> None:
        """Ring at this time [s]; None asks for nothing."""
        if at is None or self._at <= at:
            return
        if self._timer is not None:
            self._timer.cancel()
        self._at = at
        self._timer = self._timers.after(at - time.monotonic(), self._ring)

    def _ring(self) -> None:
        self._timer, self._at = None, float("inf")
        self._function()
