"""When one that speaks again and again is overdue, told by how it has spoken so far."""

from collections import deque
from statistics import median

SHORTEST = 0.3  # s; on a busy machine a message may be as late, and nothing is wrong
LOOKED_AT = 7  # of the last pauses; with this median one that was late changes nothing
KNOWN = 3  # pauses from which on there is a rhythm


class Rhythm:
    """The pauses between messages. Time is an argument [s]."""

    def __init__(self) -> None:
        self._pauses: deque[float] = deque(maxlen=LOOKED_AT)
        self._last: float | None = None

    def heard(self, now: float) -> None:
        """Take in that a message came."""
        if self._last is not None:
            self._pauses.append(now - self._last)
        self._last = now

    def patience(self, missed: int, longest: float) -> float:
        """Seconds after a message from which the next one is overdue.

        Parameters
        ----------
        missed
            How many in a row may be left out.
        longest
            What it is at most [s].

        Where there is no rhythm yet, it is as short as can be: one who has just begun to listen
        must not drive on for longest by the only message that there was.
        """
        if len(self._pauses) < KNOWN:
            return min(longest, SHORTEST)
        return min(longest, max(SHORTEST, missed * median(self._pauses)))
