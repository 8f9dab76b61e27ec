"""The quality of service that a reader asks for, chosen by what the publishers offer.

DDS connects a reader with a publisher only where the publisher offers all that the reader asks
for, and a reader cannot change what it asks for. So a reader asks for little at first, which every
publisher can serve, and is made anew once the publishers are known.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, Protocol

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

# Of a publisher, and of a reader that wants to be given the last message at once.
LATCHED_PROFILE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class PublisherInfo(Protocol):
    """What ``Node.get_publishers_info_by_topic`` tells of each publisher, as far as needed here."""

    @property
    def qos_profile(self) -> QoSProfile: ...


class ReaderQoS(NamedTuple):
    """What a reader asks of all publishers of its topic."""

    reliability: ReliabilityPolicy
    durability: DurabilityPolicy

    @property
    def latched(self) -> bool:
        """Whether the last messages of before are asked for."""
        return bool(self.durability == DurabilityPolicy.TRANSIENT_LOCAL)

    def profile(self, depth: int) -> QoSProfile:
        """The profile for rclpy.

        Parameters
        ----------
        depth
            Messages that may wait to be handled.
        """
        return QoSProfile(depth=depth, reliability=self.reliability, durability=self.durability)


# Connects with every publisher at once, so nothing waits for discovery.
FOR_ANY_PUBLISHER = ReaderQoS(ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.VOLATILE)


def best_for(
    publishers: Iterable[PublisherInfo], without: ReaderQoS = FOR_ANY_PUBLISHER
) -> ReaderQoS:
    """As reliable, and as latched, as all publishers of a topic are.

    Parameters
    ----------
    publishers
        Those of the type that is read.
    without
        The answer when there are none: mostly what the reader asks for already.
    """
    offers = [publisher.qos_profile for publisher in publishers]
    if not offers:
        return without
    return ReaderQoS(
        ReliabilityPolicy.RELIABLE
        if all(offer.reliability == ReliabilityPolicy.RELIABLE for offer in offers)
        else FOR_ANY_PUBLISHER.reliability,
        DurabilityPolicy.TRANSIENT_LOCAL
        if all(offer.durability == DurabilityPolicy.TRANSIENT_LOCAL for offer in offers)
        else FOR_ANY_PUBLISHER.durability,
    )
