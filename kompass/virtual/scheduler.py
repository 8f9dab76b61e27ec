"""What happens next, in a time that passes as fast as it can be worked out."""

from __future__ import annotations

import random
from collections.abc import Callable
from heapq import heapify, heappop, heappush
from typing import Any

SECOND = 1_000_000_000  # ns
START = 1000 * SECOND  # ns; what takes 0 for "never" is to be noticed
EPOCH = 1_767_225_600 * SECOND  # ns; the first second of 2026
MOST_CANCELLED = 4096  # cancelled events that may stay in the queue


def nanoseconds(seconds: float) -> int:
    """Seconds as whole nanoseconds, the nearest."""
    return round(seconds * 1e9)


class Event:
    """A call to come."""

    __slots__ = ("_scheduler", "args", "at", "function")

    def __init__(
        self, scheduler: Scheduler, at: int, function: Callable[..., object], args: tuple[Any, ...]
    ) -> None:
        self._scheduler = scheduler
        self.at = at
        self.function: Callable[..., object] | None = function
        self.args = args

    def cancel(self) -> None:
        """Have it not happen; nothing is done once it has."""
        if self.function is not None:
            self.function, self.args = None, ()
            self._scheduler.note_cancelled()


class Scheduler:
    """Calls functions in the order of virtual time.

    What is due at the same nanosecond happens in an order that the seed decides: nothing may rely
    on it, and a drill with other seeds finds out what does.

    Parameters
    ----------
    seed
        Of all that is left to chance.
    epoch
        Wall time of the first moment [ns since 1970].
    """

    def __init__(self, seed: int = 0, epoch: int = EPOCH) -> None:
        self.seed = seed
        self.now = START  # ns, monotonic
        self._to_wall = epoch - START
        self._ties = self.random("ties").getrandbits
        self._order = 0
        self._cancelled = 0
        self._running = False
        self._queue: list[tuple[int, int, int, Event]] = []

    @property
    def wall(self) -> int:
        """Wall time [ns since 1970]."""
        return self.now + self._to_wall

    def random(self, use: str) -> random.Random:
        """Chance for one use, which drawing for another does not change."""
        return random.Random(f"{self.seed}/{use}")

    def call_at(self, at: int, function: Callable[..., object], *args: Any) -> Event:
        """Call a function at a monotonic time [ns]; at once, that is next, if that has passed."""
        if at < self.now:
            at = self.now
        event = Event(self, at, function, args)
        self._order += 1
        heappush(self._queue, (at, self._ties(32), self._order, event))
        return event

    def call_later(self, delay: int, function: Callable[..., object], *args: Any) -> Event:
        """Call a function so many nanoseconds from now."""
        return self.call_at(self.now + delay, function, *args)

    def run_until(self, at: int) -> None:
        """Let time pass up to a moment [ns], which included.

        Raises
        ------
        Exception
            What a function raises; the others are still to come.
        """
        self._run(lambda: True, at)
        self.now = max(self.now, at)

    def run_for(self, duration: int) -> None:
        """Let so many nanoseconds pass; see :meth:`run_until`."""
        self.run_until(self.now + duration)

    def run_while(self, predicate: Callable[[], object], limit: int | None = None) -> bool:
        """Let time pass as long as something holds, which is asked after each event.

        Parameters
        ----------
        predicate
            What holds.
        limit
            For how long at most [ns]; None for as long as there are events.

        Returns
        -------
        bool
            Whether it came to hold no more.
        """
        until = None if limit is None else self.now + limit
        self._run(predicate, until)
        if not predicate():
            return True
        if until is not None:
            self.now = max(self.now, until)
        return False

    def _run(self, predicate: Callable[[], object], until: int | None) -> None:
        if self._running:
            raise RuntimeError("time passes already; what happens in it cannot make it pass")
        self._running = True
        # _queue stays one and the same list, so that it may be cleared of what was cancelled.
        queue = self._queue
        end = float("inf") if until is None else until
        try:
            while queue and queue[0][0] <= end and predicate():
                at, _, _, event = heappop(queue)
                function = event.function
                if function is None:
                    self._cancelled -= 1
                    continue
                event.function = None
                self.now = at
                function(*event.args)
        finally:
            self._running = False

    def note_cancelled(self) -> None:
        """Keep the queue from filling with what was cancelled; for :class:`Event`."""
        self._cancelled += 1
        if self._cancelled > MOST_CANCELLED and 2 * self._cancelled > len(self._queue):
            self._queue[:] = [each for each in self._queue if each[3].function is not None]
            heapify(self._queue)
            self._cancelled = 0


class VirtualClock:
    """The time of a scheduler; see :class:`kompass.bus.clock.Clock`."""

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler

    def monotonic(self) -> float:
        return self._scheduler.now * 1e-9

    def monotonic_ns(self) -> int:
        return self._scheduler.now

    def wall(self) -> float:
        return self._scheduler.wall * 1e-9
