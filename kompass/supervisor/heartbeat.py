"""Heartbeats of a process, in memory that it shares with its supervisor.

A pipe would wake the supervisor for each heartbeat of each process, and could fill up; here a
heartbeat is the store of one number, and the supervisor looks when it likes. There is no lock that
a dying process could keep.
"""

from __future__ import annotations

import mmap
import threading
import time
from collections.abc import Sequence

PERIOD = 0.2  # s between the heartbeats of the process as such
_ITEM = 8  # bytes of one time


class Heartbeat:
    """When each part of a process last showed life, as times of the monotonic clock [s].

    The first part is a thread that does nothing else; the others are the executors of ``members``.
    Made before the fork. Zero stands for a part that never has.

    Parameters
    ----------
    members
        Names of the nodes that have an executor each.
    """

    def __init__(self, members: Sequence[str]) -> None:
        self.members = tuple(members)
        size = _ITEM * (1 + len(self.members))
        self._times = memoryview(mmap.mmap(-1, size)).cast("d")
        self._index = {name: 1 + index for index, name in enumerate(self.members)}

    def reset(self) -> None:
        """Forget all heartbeats, before another process takes over."""
        for index in range(len(self._times)):
            self._times[index] = 0.0

    def send(self, member: str | None = None) -> None:
        """Show life of a member's executor; without a name, of the process as such."""
        self._times[0 if member is None else self._index[member]] = time.monotonic()

    def last_sent(self, member: str | None = None) -> float:
        """When that part last showed life, as monotonic time [s]; 0 for never."""
        return self._times[0 if member is None else self._index[member]]

    def silent(self) -> float:
        """For how long the process as such has shown no life [s]; for whoever shares it."""
        return time.monotonic() - self.last_sent()

    def start(self) -> None:
        """Show life of the process as such from a thread of its own, until the process ends."""

        def run() -> None:
            while True:
                self.send()
                time.sleep(PERIOD)

        self.send()
        threading.Thread(target=run, name="heartbeat", daemon=True).start()


_own: Heartbeat | None = None


def start_heartbeat(heartbeat: Heartbeat) -> None:
    """Let this process, just forked, show life there from now on."""
    global _own
    _own = heartbeat
    heartbeat.start()


def send_heartbeat(member: str) -> None:
    """Say that the loop of a member has come round; nothing happens without a supervisor."""
    if _own is not None:
        _own.send(member)
