"""Zones for tests."""

from typing import Any

from kompass.places.place import MapIdentity
from kompass.zones.zone import Zone, ZonePlan

MAP = MapIdentity(id="0" * 32, label="3 × 3 m")
SQUARE = ((1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0))


def plan(**changed: Any) -> ZonePlan:
    given: dict[str, Any] = {"name": "Stairs", "kind": "keep_out", "corners": SQUARE, "map": MAP}
    return ZonePlan(**{**given, **changed})


def zone(number: int = 1, **changed: Any) -> Zone:
    """A zone as it is kept."""
    return Zone(
        id=number,
        version=1,
        author="ava",
        role="operator",
        time=0.0,
        **plan(**changed).model_dump(),
    )
