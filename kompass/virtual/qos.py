"""Quality of service as this bus carries it out."""

from __future__ import annotations

from typing import Any, NamedTuple

from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

_TIMES = ("deadline", "lifespan", "liveliness_lease_duration")
_KNOWN = {
    "reliability": (ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT),
    "durability": (DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE),
    "history": (HistoryPolicy.KEEP_LAST, HistoryPolicy.KEEP_ALL),
    "liveliness": (LivelinessPolicy.AUTOMATIC, LivelinessPolicy.SYSTEM_DEFAULT),
}


class QoS(NamedTuple):
    """What decides who hears whom.

    Attributes
    ----------
    depth
        Messages kept; None for all.
    profile
        As it was given, with the depth that holds.
    """

    reliable: bool
    latched: bool
    depth: int | None
    profile: QoSProfile

    def serves(self, asked: QoS) -> bool:
        """Whether a writer of this quality is matched with a reader that asks for that."""
        return self.reliable >= asked.reliable and self.latched >= asked.latched


def qos_of(given: Any, where: str) -> QoS:
    """Read a profile of rclpy, or a depth.

    Raises
    ------
    ValueError
        When it asks for something that this bus does not carry out.
    """
    profile = given if isinstance(given, QoSProfile) else QoSProfile(depth=given)
    for name in _TIMES:
        if getattr(profile, name).nanoseconds:
            raise _refused(where, name, getattr(profile, name), "leave it out")
    for name, known in _KNOWN.items():
        value = getattr(profile, name)
        if value not in known:
            names = " or ".join(each.name for each in known)
            raise _refused(where, name, value.name, f"choose {names}")
    keeps_all = profile.history == HistoryPolicy.KEEP_ALL
    return QoS(
        profile.reliability == ReliabilityPolicy.RELIABLE,
        profile.durability == DurabilityPolicy.TRANSIENT_LOCAL,
        None if keeps_all else max(1, profile.depth),  # to DDS, 0 is its default of 1
        profile,
    )


def _refused(where: str, name: str, value: object, remedy: str) -> ValueError:
    return ValueError(f"{where}: {name} = {value} is not known to the virtual bus; {remedy}")
