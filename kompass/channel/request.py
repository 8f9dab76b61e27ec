"""What the monitor asks of a component."""

from __future__ import annotations

import json
from typing import NamedTuple

from kompass.channel.life import Life


class Request(NamedTuple):
    """A request to one of a component's own services.

    Attributes
    ----------
    number
        Among the requests of the asker's life.
    asker
        Who waits for the answer.
    answerer
        The process that it is for: what a dead one has not read is not for its successor.
    until
        Until when it may be begun, on the monotonic clock of this machine [s]; None for ever.
    node
        Name of the component.
    service
        The last part of the service's name.
    body
        The request as ROS serialises it.
    """

    number: int
    asker: Life
    answerer: Life
    until: float | None
    node: str
    service: str
    body: bytes

    def is_late(self, now: float) -> bool:
        """Whether nobody waits for it any more."""
        return self.until is not None and now > self.until

    def to_packet(self) -> bytes:
        """As bytes: a line of JSON, and the body."""
        return json.dumps(self[:-1]).encode() + b"\n" + self.body

    @classmethod
    def of_packet(cls, packet: bytes) -> Request:
        """As :meth:`to_packet` wrote it."""
        head, _, body = packet.partition(b"\n")
        number, asker, answerer, until, node, service = json.loads(head)
        return cls(number, Life(*asker), Life(*answerer), until, node, service, body)
