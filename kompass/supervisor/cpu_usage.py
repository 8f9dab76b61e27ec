"""What a silent process does: it computes, waits for a processor, or for something else."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

# Share of the time looked at. Less is what a process that waits for others uses now and then.
COMPUTING_SHARE = 0.3


class ThreadTime(NamedTuple):
    """What a thread spent since it began [s]: on a processor, and waiting for one."""

    used: float
    waited: float


def thread_times(pid: int) -> dict[str, ThreadTime]:
    """What each thread of a process spent, by its id.

    Empty when the process is gone, or the kernel does not tell.
    """
    found: dict[str, ThreadTime] = {}
    try:
        for task in Path(f"/proc/{pid}/task").iterdir():
            used, waited, _ = (task / "schedstat").read_text().split()
            found[task.name] = ThreadTime(int(used) * 1e-9, int(waited) * 1e-9)
    except (OSError, ValueError):
        return {}
    return found


class Work(NamedTuple):
    """What a process did since a moment.

    Attributes
    ----------
    computing
        Whether it used, or waited for, a processor all the time.
    waited
        For how long the thread that waited longest for a processor did so [s].
    """

    computing: bool
    waited: float


class CpuUsage:
    """Use of the processor by one process, from the moment at which it fell silent."""

    def __init__(self) -> None:
        self._since: tuple[float, dict[str, ThreadTime]] | None = None

    def clear(self) -> None:
        """Forget what was measured: the process has shown life again."""
        self._since = None

    def look(self, pid: int, now: float) -> Work:
        """What a process did since the first look after :meth:`clear`.

        Parameters
        ----------
        pid
            Of the process.
        now
            Monotonic time [s].
        """
        times = thread_times(pid)
        if not times:
            return Work(computing=False, waited=0.0)
        if self._since is None:
            self._since = now, times
            # Nothing to compare with yet: not to be called stuck at first sight.
            return Work(computing=True, waited=0.0)
        began, before = self._since
        spent = [
            (time.used - old.used, time.waited - old.waited)
            for thread, time in times.items()
            for old in (before.get(thread, ThreadTime(0.0, 0.0)),)
        ]
        total = sum(used + waited for used, waited in spent)
        return Work(
            computing=total > COMPUTING_SHARE * (now - began),
            waited=max(waited for _, waited in spent),
        )
