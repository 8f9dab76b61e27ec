"""What is sent at once over a channel: in the socket, or, if large, in memory handed over by it."""

from __future__ import annotations

import array
import errno
import os
import socket

INLINE = 65_536  # bytes that fit into the socket; what is larger goes beside it

_ONE_DESCRIPTOR = socket.CMSG_SPACE(array.array("i").itemsize)
_FULL = (errno.EAGAIN, errno.ENOBUFS, errno.ETOOMANYREFS)


def send_packet(end: socket.socket, packet: bytes) -> bool:
    """Send a packet, without waiting.

    Returns
    -------
    bool
        Whether there was room: nobody reads at the other end, or not fast enough, where there is
        none.

    Raises
    ------
    OSError
        When the channel, or memory, cannot be used at all.
    """
    try:
        if len(packet) <= INLINE:
            end.send(packet, socket.MSG_DONTWAIT)
            return True
        with os.fdopen(os.memfd_create("packet", os.MFD_CLOEXEC), "wb") as memory:
            memory.write(packet)
            memory.flush()
            rights = array.array("i", [memory.fileno()])
            # socket.send_fds and recv_fds take flags, and do not look at them (Python 3.11).
            handed_over = (socket.SOL_SOCKET, socket.SCM_RIGHTS, rights)
            end.sendmsg([b"\n"], [handed_over], socket.MSG_DONTWAIT)
    except OSError as error:
        if error.errno in _FULL:
            return False
        raise
    return True


def receive_packet(end: socket.socket, *, wait: bool = True) -> bytes | None:
    """Take the next packet.

    Returns
    -------
    bytes or None
        Empty when there is none now (``wait=False``); None when all who had the other end are gone.
    """
    how = socket.MSG_CMSG_CLOEXEC | (0 if wait else socket.MSG_DONTWAIT)
    try:
        packet, beside, _, _ = end.recvmsg(INLINE, _ONE_DESCRIPTOR, how)
    except BlockingIOError:
        return b""
    for _, _, rights in beside:
        (descriptor,) = array.array("i", rights)
        with os.fdopen(descriptor, "rb") as memory:
            memory.seek(0)
            return memory.read()
    return packet or None
