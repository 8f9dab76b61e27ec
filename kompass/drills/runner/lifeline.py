"""Ends a process with the one that it works for, by the kernel's hand."""

from __future__ import annotations

import ctypes
import os
import signal

from kompass.supervisor.process import PR_SET_PDEATHSIG

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
