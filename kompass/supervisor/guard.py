"""Ends what its supervisor could not end any more.

Children are sent SIGTERM by the kernel when their supervisor dies. One that is stopped by a signal
(SIGSTOP), or hangs, does not get to it: it would keep its port, and a gate of commands its robot.
"""

from __future__ import annotations

import logging
import os
import select
import signal
import time

from kompass.supervisor.news import ProcessNews
from kompass.supervisor.process import ProcessSpec, Report, born

NAME = "guard"

log = logging.getLogger("kompass.supervisor")


def guard_process(patience: float) -> ProcessSpec:
    """The process of the guard.

    Parameters
    ----------
    patience
        What is still there so long after the supervisor's death is killed [s].
    """

    def main(report: Report) -> None:
        report(f"active {NAME}")
        guard(spec.inbox, patience)

    spec = ProcessSpec(NAME, main, listens=True, outlives=True)
    return spec


def guard(inbox: int, patience: float) -> None:
    """Listen for as long as the supervisor lives, then see to it that nothing is left.

    Parameters
    ----------
    inbox
        File descriptor on which the supervisor tells of processes; at its end the supervisor is
        dead, in whatever way.
    patience
        As of :func:`guard_process`.
    """
    living: dict[int, int] = {}  # pidfds by pid: they never come to mean another process
    with os.fdopen(inbox) as lines:
        for line in lines:
            news = ProcessNews.of_line(line)
            if news.state in ("dead", "given up"):
                if news.pid in living:
                    os.close(living.pop(news.pid))
            elif news.pid not in living and news.pid != os.getpid():
                # The line may have waited, and the pid be another's by now.
                pidfd = _opened(news.pid)
                if born(news.pid) == news.born and pidfd >= 0:
                    living[news.pid] = pidfd
                elif pidfd >= 0:
                    os.close(pidfd)
    _end(living, patience)


def _opened(pid: int) -> int:
    """A pidfd; -1 when there is no such process."""
    try:
        return os.pidfd_open(pid)
    except ProcessLookupError:
        return -1


def _end(living: dict[int, int], patience: float) -> None:
    """Wait for all to end by themselves, and kill those that do not."""
    deadline = time.monotonic() + patience
    waiting = set(living.values())
    poll = select.poll()
    for pidfd in waiting:
        poll.register(pidfd, select.POLLIN)
    while waiting and (left := deadline - time.monotonic()) > 0:
        for pidfd, _ in poll.poll(1000 * left):
            poll.unregister(pidfd)
            waiting.discard(pidfd)
    for pid, pidfd in living.items():
        if pidfd in waiting:
            log.error("the supervisor is dead, and process %d did not end: killed", pid)
            signal.pidfd_send_signal(pidfd, signal.SIGKILL)
