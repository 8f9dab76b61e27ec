"""The two ends of a channel."""

from __future__ import annotations

import socket
from typing import NamedTuple


class Pair(NamedTuple):
    """File descriptors of connected sockets that keep the borders of what is sent.

    Attributes
    ----------
    asker
        For the monitor.
    answerer
        For the process of components.
    """

    asker: int
    answerer: int


def open_pair() -> Pair:
    """Open a channel. Its ends go to children that are forked, and to no program executed."""
    asker, answerer = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    # Plain numbers: no object closes one that another file has got since.
    return Pair(asker.detach(), answerer.detach())
