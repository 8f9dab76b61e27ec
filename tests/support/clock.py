"""A clock that a test sets."""

from __future__ import annotations

from collections.abc import Callable


class SetClock:
    """Shows what it is told to.

    Parameters
    ----------
    now_ns
        Gives the monotonic time [ns].
    epoch
        Seconds since the epoch at monotonic zero.
    """

    def __init__(self, now_ns: Callable[[], int], epoch: float) -> None:
        self._now_ns, self._epoch = now_ns, epoch

    def monotonic(self) -> float:
        return self._now_ns() * 1e-9

    def monotonic_ns(self) -> int:
        return self._now_ns()

    def wall(self) -> float:
        return self._epoch + self._now_ns() * 1e-9
