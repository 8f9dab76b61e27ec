"""Lives of the monitor: from its start to its end, clean or not."""

from pathlib import Path
from typing import NamedTuple

MONITOR = "monitor"  # author and role of what nobody asked for


class MonitorSession(NamedTuple):
    """One session of the monitor.

    Attributes
    ----------
    epoch
        Unlike any other.
    stack
        The run of the stack that it belongs to.
    machine
        The run of the machine; a new one after each boot.
    started, ended
        Seconds since the epoch; ``ended`` is None when it did not end as it should, or lives.
    revision
        Last in force.
    """

    epoch: str
    stack: str
    machine: str
    started: float
    ended: float | None
    revision: int
    safe_mode: bool


def this_machine() -> str:
    """What tells this run of the machine from those before a reboot."""
    return Path("/proc/sys/kernel/random/boot_id").read_text().strip()
