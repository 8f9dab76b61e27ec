"""One life of a process: what tells it from its successor."""

from __future__ import annotations

import os
from typing import NamedTuple

from kompass.supervisor.process import born


class Life(NamedTuple):
    """A process, as the supervisor tells of it.

    Attributes
    ----------
    pid
        Of the process.
    born
        When it began (clock ticks since boot): no other has both this and its pid.
    """

    pid: int
    born: int


def own_life() -> Life:
    """The life of this process."""
    return Life(os.getpid(), born(os.getpid()))
