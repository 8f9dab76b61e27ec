"""What processes take of the machine, as the kernel tells (proc(5))."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

_TICKS = os.sysconf("SC_CLK_TCK")  # of a second
_PAGE = os.sysconf("SC_PAGE_SIZE")  # bytes
_USER, _SYSTEM, _RESIDENT = 11, 12, 21  # fields of stat after the name


class Usage(NamedTuple):
    """What a process takes.

    Attributes
    ----------
    cpu
        Share of one processor since the last look; None at the first.
    memory
        In the machine's memory [bytes], with what it shares with others.
    """

    cpu: float | None
    memory: int


class UsageMeter:
    """Measures processes from look to look."""

    def __init__(self) -> None:
        self._before: dict[int, tuple[float, int]] = {}

    def look(self, pids: Iterable[int], now: float) -> dict[int, Usage]:
        """What these processes take; those that are gone are left out.

        Parameters
        ----------
        now
            Monotonic time [s].
        """
        found: dict[int, Usage] = {}
        seen: dict[int, tuple[float, int]] = {}
        for pid in pids:
            try:
                fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            spent = int(fields[_USER]) + int(fields[_SYSTEM])
            seen[pid] = now, spent
            cpu = None
            if (before := self._before.get(pid)) is not None and now > before[0]:
                cpu = max(0.0, (spent - before[1]) / _TICKS / (now - before[0]))
            found[pid] = Usage(cpu, int(fields[_RESIDENT]) * _PAGE)
        self._before = seen
        return found
