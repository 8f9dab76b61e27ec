"""Ends a process with the one that it works for, and what it has started with itself."""

from __future__ import annotations

import ctypes
import os
import signal
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from kompass.supervisor.process import PR_SET_PDEATHSIG

_PR_SET_CHILD_SUBREAPER = 36
ASKS = "KOMPASS_WORKER_PARENT"  # in the environment: process id of who asks for drives


def end_with(parent: int) -> None:
    """Have this process killed when its parent ends, in whatever way that does.

    The kernel counts the end of the parent's *thread* that started this process; it must last.

    Parameters
    ----------
    parent
        Process id of the parent; a process whose parent is gone already ends here.
    """
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def keep_descendants() -> None:
    """Have what is started from here on come to this process when its own parent ends."""
    ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1)


def end_children() -> None:
    """Kill this process's children, and theirs that come to it, until there are none."""
    while children := list(_children()):
        for child in children:
            with suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)
        for child in children:
            with suppress(ChildProcessError):
                os.waitpid(child, 0)


def _children() -> Iterator[int]:
    for tasks in Path("/proc/self/task").iterdir():
        with suppress(OSError):  # a thread that has ended meanwhile
            yield from map(int, (tasks / "children").read_text().split())
