"""Whether a silent process is at work: it computes, or waits for a processor."""

from __future__ import annotations

from pathlib import Path

# Share of the time looked at. Less is what a process that waits for others uses now and then.
COMPUTING_SHARE = 0.3


def processor_time(pid: int) -> float | None:
    """Time that all threads of a process used a processor or waited for one.

    Returns
    -------
    float or None
        Seconds; None when the process is gone, or the kernel does not tell.
    """
    total = 0
    try:
        for task in Path(f"/proc/{pid}/task").iterdir():
            used, waited, _ = (task / "schedstat").read_text().split()
            total += int(used) + int(waited)
    except (OSError, ValueError):
        return None
    return total * 1e-9


class CpuUsage:
    """Use of the processor by one process, from the moment at which it fell silent."""

    def __init__(self) -> None:
        self._since: tuple[float, float] | None = None

    def clear(self) -> None:
        """Forget what was measured: the process has shown life again."""
        self._since = None

    def computing(self, pid: int, now: float) -> bool:
        """Whether a process was at work since the first call after :meth:`clear`.

        Parameters
        ----------
        pid
            Of the process.
        now
            Monotonic time [s].
        """
        used = processor_time(pid)
        if used is None:
            return False
        if self._since is None:
            self._since = now, used
            return True  # nothing to compare with yet: not to be called stuck at first sight
        began, before = self._since
        return used - before > COMPUTING_SHARE * (now - began)
