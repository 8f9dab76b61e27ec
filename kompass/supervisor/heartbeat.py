"""Signs of life of a process, in memory that it shares with its supervisor.

A pipe would wake the supervisor for each beat of each process, and could fill up; here a beat is
the store of one number, and the supervisor looks when it likes. There is no lock that a dying
process could keep.
"""

from __future__ import annotations

import mmap
import threading
import time
from collections.abc import Sequence

PERIOD = 0.2  # s between the beats of the side thread
_ITEM = 8  # bytes of one time


class Heartbeat:
    """When each part of a process last showed life, as times of the monotonic clock [s].

    The first part is a thread that does nothing else; the others are the executors of ``members``.
    Made before the fork. Zero stands for a part that has never beaten.
    """

    def __init__(self, members: Sequence[str]) -> None:
        self.members = tuple(members)
        size = _ITEM * (1 + len(self.members))
        self._times = memoryview(mmap.mmap(-1, size)).cast("d")
        self._index = {name: 1 + index for index, name in enumerate(self.members)}

    def reset(self) -> None:
        """Forget all beats, before another process takes over."""
        for index in range(len(self._times)):
            self._times[index] = 0.0

    def beat(self, member: str | None = None) -> None:
        """Show life of a member's executor; of the process as such without one."""
        self._times[0 if member is None else self._index[member]] = time.monotonic()

    def last(self, member: str | None = None) -> float:
        """When it last showed life [s]; 0 for never."""
        return self._times[0 if member is None else self._index[member]]

    def keep_beating(self) -> None:
        """Beat from a thread of its own, for as long as this process lives."""

        def run() -> None:
            while True:
                self.beat()
                time.sleep(PERIOD)

        self.beat()
        threading.Thread(target=run, name="pulse", daemon=True).start()


_own: Heartbeat | None = None


def adopt(pulse: Heartbeat) -> None:
    """Let this process, just forked, beat on ``pulse`` from now on."""
    global _own
    _own = pulse
    pulse.keep_beating()


def beat(member: str) -> None:
    """Say that the loop of ``member`` has come round; nothing happens without a supervisor."""
    if _own is not None:
        _own.beat(member)
