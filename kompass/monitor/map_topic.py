"""On which topic the robot's map comes."""

from __future__ import annotations

from collections.abc import Collection

from kompass.bus.node import Node
from kompass.monitor.introspection.catalog import RecipeCatalog

_MAP = "map"


def map_topic(node: Node, catalog: RecipeCatalog) -> str | None:
    """The topic of the map, without the leading slash; None while there is none.

    ``/map``, else what a component listens to that takes goals.
    """
    names: Collection[str] = sorted(
        name.removeprefix("/")
        for name, types in node.get_topic_names_and_types()
        if "nav_msgs/msg/OccupancyGrid" in types
    )
    if _MAP in names:
        return _MAP
    heard = frozenset[str]().union(
        *(spec.hears for spec in catalog.components().values() if spec.takes_goals)
    )
    return next((name for name in names if name in heard), None)
