"""Empty a subscription without an executor, which rclpy (7.1.6) offers only to its executors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any


def take_all(subscription: Any) -> Iterator[tuple[bytes, dict[str, int]]]:
    """Take the messages that have arrived, oldest first.

    Parameters
    ----------
    subscription
        Of a node that is in no executor.

    Yields
    ------
    raw : bytes
        The message as it came over the network (CDR).
    info : dict[str, int]
        ``received_timestamp`` and ``source_timestamp``, in nanoseconds since the epoch; 0 where the
        middleware gives none.
    """
    handle, kind = subscription.handle, subscription.msg_type
    while (taken := handle.take_message(kind, True)) is not None:
        yield taken
