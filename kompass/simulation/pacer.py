"""Keeps simulated time beside real time, and says honestly when it cannot."""

from __future__ import annotations

import math

# A hiccup this long is made up for; time beyond it is given up, so that a slow machine gets a
# slow robot and never a burst of steps that makes it slower still.
MAX_CATCH_UP = 0.1  # s


class Pacer:
    """Says how many periods of simulated time are due. It has no clock: callers pass ``now``.

    Parameters
    ----------
    period
        Simulated time per period [s].
    now
        Monotonic real time [s], at which nothing is due.
    """

    def __init__(self, period: float, now: float) -> None:
        self._period = period
        self._origin = now
        self._done = 0
        self._rate_at = now
        self._rate_done = 0
        self._lost = 0.0

    def due(self, now: float) -> int:
        """How many periods to simulate at ``now``; the caller is taken to simulate them all."""
        # The tolerance lets a timer that fires a hair early do its work now, not a period later.
        behind = now - self._origin - self._done * self._period + 0.2 * self._period
        excess = behind - MAX_CATCH_UP
        if excess > 0.0:
            self._origin += excess
            self._lost += excess
            behind = MAX_CATCH_UP
        count = max(0, math.floor(behind / self._period))
        self._done += count
        return count

    def report(self, now: float) -> tuple[float, float]:
        """What became of the time since the last report.

        Returns
        -------
        tuple[float, float]
            Simulated seconds per real second, and seconds given up.
        """
        elapsed = now - self._rate_at
        simulated = (self._done - self._rate_done) * self._period
        lost = self._lost
        self._rate_at, self._rate_done, self._lost = now, self._done, 0.0
        return (simulated / elapsed if elapsed > 0.0 else 1.0), lost
