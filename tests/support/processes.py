"""Look at processes from outside, through /proc."""

import ctypes
import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.support.patience import patient

PR_SET_PDEATHSIG = 1
_LIBC = ctypes.CDLL(None)  # opened here: between fork and exec nothing must be loaded


def end_with_parent() -> None:
    """For ``preexec_fn``: end in good order when the run of the tests is killed.

    What has a session of its own hears of no Ctrl-C, and a run that is killed closes nothing.
    """
    _LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


@contextmanager
def held(pid: int) -> Iterator[None]:
    """A process that a signal holds, until the end of the block."""
    os.kill(pid, signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(pid, signal.SIGCONT)


def marked(mark: str) -> list[str]:
    """Command lines of all other living processes that carry ``mark`` in their environment."""
    found = []
    for folder in Path("/proc").iterdir():
        if not folder.name.isdigit() or int(folder.name) == os.getpid():
            continue
        try:
            if mark.encode() not in (folder / "environ").read_bytes().split(b"\0"):
                continue
            state = (folder / "stat").read_text().rpartition(")")[2].split()[0]
            command = (folder / "cmdline").read_text().replace("\0", " ")
        except OSError:
            continue  # ended meanwhile, or another user's
        if state != "Z":
            found.append(f"{folder.name}: {command}")
    return found


def ended(look: Callable[[], list[str]], timeout: float) -> list[str]:
    """Wait until ``look`` finds nothing; what it still finds after ``timeout`` patient seconds."""
    deadline = time.monotonic() + patient(timeout)
    while (left := look()) and time.monotonic() < deadline:
        time.sleep(0.05)
    return left


def children(pid: int) -> dict[int, list[int]]:
    """Pids of the direct children of a process, each with those of its own."""
    tasks = Path(f"/proc/{pid}/task")
    direct = [
        int(child) for task in tasks.iterdir() for child in (task / "children").read_text().split()
    ]
    return {child: list(children(child)) for child in direct}


def wait_until(condition: Callable[[], object], timeout: float, what: str) -> None:
    """Wait until a condition holds; fails naming ``what`` after ``timeout`` patient seconds."""
    deadline = time.monotonic() + patient(timeout)
    while not condition():
        assert time.monotonic() < deadline, f"not within {patient(timeout):g} s: {what}"
        time.sleep(0.02)
