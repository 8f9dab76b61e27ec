"""What comes to the monitor past ROS: news of processes, and answers of components."""

from __future__ import annotations

import os
import select
import socket
from collections.abc import Iterator, Sequence

from kompass.channel.packet import receive_packet

CHUNK = 65_536  # bytes of news read at once


def incoming(inbox: int, ends: Sequence[socket.socket]) -> Iterator[str | bytes]:
    """Wait for what comes, until the supervisor is gone.

    Parameters
    ----------
    inbox
        File descriptor on which the supervisor tells of processes, a JSON line each.
    ends
        Ours, of the channels to components.

    Yields
    ------
    str or bytes
        A line of the supervisor, or a packet of a component. What a process has sent comes before
        the news that it is dead.
    """
    poll = select.poll()
    for descriptor in (inbox, *(end.fileno() for end in ends)):
        poll.register(descriptor, select.POLLIN)
    pending = b""
    while True:
        ready = {descriptor for descriptor, _ in poll.poll()}
        lines: list[bytes] = []
        if inbox in ready:
            data = os.read(inbox, CHUNK)
            if not data:
                return
            *lines, pending = (pending + data).split(b"\n")
        for end in ends:
            # News that was read just now may be of one who has sent something since the poll.
            if lines or end.fileno() in ready:
                while packet := receive_packet(end, wait=False):
                    yield packet
        for line in lines:
            yield line.decode()
