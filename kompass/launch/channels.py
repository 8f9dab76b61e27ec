"""Channels from the monitor to the processes of components, opened before any of them is forked."""

from __future__ import annotations

from collections.abc import Iterable

from kompass.channel.pair import open_pair
from kompass.supervisor.process import ProcessSpec


def connect(monitor: ProcessSpec, hosts: Iterable[ProcessSpec]) -> list[int]:
    """Open a channel from the monitor to each process of components.

    Returns
    -------
    list of int
        The file descriptors of all ends, to be closed when the supervisor has ended.
    """
    opened: list[int] = []
    for spec in hosts:
        pair = open_pair()
        opened += pair
        spec.channels = dict.fromkeys(spec.names, pair.answerer)
        monitor.channels |= dict.fromkeys(spec.names, pair.asker)
    return opened
