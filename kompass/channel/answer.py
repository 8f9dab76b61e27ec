"""What a component answers the monitor."""

from __future__ import annotations

import json
from typing import NamedTuple

from kompass.channel.life import Life


class Answer(NamedTuple):
    """The answer to a request.

    Attributes
    ----------
    number
        Of the request.
    asker
        Who asked.
    problem
        Why the service gave no answer, in words; empty when it did.
    body
        The service's answer as ROS serialises it.
    """

    number: int
    asker: Life
    problem: str
    body: bytes

    def to_packet(self) -> bytes:
        """As bytes: a line of JSON, and the body."""
        return json.dumps(self[:-1]).encode() + b"\n" + self.body

    @classmethod
    def of_packet(cls, packet: bytes) -> Answer:
        """As :meth:`to_packet` wrote it."""
        head, _, body = packet.partition(b"\n")
        number, asker, problem = json.loads(head)
        return cls(number, Life(*asker), problem, body)
