"""Time, for programs that run in real time and in a time of their own."""

from __future__ import annotations

import time
from typing import Protocol


class Clock(Protocol):
    """Tells the time. Nothing that acts on the world asks anybody else for it."""

    def monotonic(self) -> float:
        """Seconds that never go back; only differences mean something."""

    def monotonic_ns(self) -> int:
        """As :meth:`monotonic`, in nanoseconds."""

    def wall(self) -> float:
        """Seconds since the epoch, as people and messages count them."""


class SystemClock:
    """The clock of this machine."""

    def monotonic(self) -> float:
        return time.monotonic()

    def monotonic_ns(self) -> int:
        return time.monotonic_ns()

    def wall(self) -> float:
        return time.time()


SYSTEM: Clock = SystemClock()
