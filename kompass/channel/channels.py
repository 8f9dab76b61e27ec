"""The channels to components, as who asks has them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from kompass.channel.life import Life

# Sends a packet without waiting, and tells whether there was room.
Send = Callable[[bytes], bool]


class Channels(NamedTuple):
    """Where to send requests, and in whose name.

    Attributes
    ----------
    life
        Our own.
    send
        By the name of the component that is asked.
    """

    life: Life
    send: Mapping[str, Send]
