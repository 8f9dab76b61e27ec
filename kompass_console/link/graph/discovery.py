"""Which topics and services to use, of all that are on the graph. Pure functions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

NODE_NAME = "kompass_console"  # of every console, with its process id behind it

Graph = Mapping[str, Sequence[str]]  # name -> types, as rclpy's *_names_and_types give it

STATUS_TYPE = "automatika_ros_sugar/msg/ComponentStatus"

STREAM_TYPES = {
    "odometry": "nav_msgs/msg/Odometry",
    "scan": "sensor_msgs/msg/LaserScan",
    "map": "nav_msgs/msg/OccupancyGrid",
    "local_map": "nav_msgs/msg/OccupancyGrid",
    "path": "nav_msgs/msg/Path",
}

_USUAL = {
    "odometry": "/odometry/filtered",
    "scan": "/scan",
    "map": "/map",
    "local_map": "/local_map/occupancy_layer",
    "path": "/plan",
}
_LOCAL_WORDS = ("local", "costmap")


def of_type(graph: Graph, type_name: str) -> list[str]:
    """Names with a type, sorted."""
    return sorted(name for name, types in graph.items() if type_name in types)


def stream_topic(key: str, published: Graph, override: str | None) -> str | None:
    """Topic to read a stream from: the given one, the usual one, or the likeliest of its type.

    `published` holds only topics that somebody publishes.
    """
    if override is not None:
        return override if STREAM_TYPES[key] in published.get(override, ()) else None
    names = of_type(published, STREAM_TYPES[key])
    if _USUAL[key] in names:
        return _USUAL[key]
    local = [n for n in names if any(word in n for word in _LOCAL_WORDS)]
    if key == "local_map":
        names = local
    elif key in ("map", "path"):
        names = [n for n in names if n not in local]
    return names[0] if names else None


def status_topics(published: Graph) -> dict[str, str]:
    """Component name -> its status topic; `<node>/status` rather than its twin `<node>_status`."""
    found: dict[str, str] = {}
    for name in of_type(published, STATUS_TYPE):
        if name.endswith("/status"):
            found[name.removesuffix("/status").lstrip("/")] = name
    for name in of_type(published, STATUS_TYPE):
        if name.endswith("_status"):
            found.setdefault(name.removesuffix("_status").lstrip("/"), name)
    return found


def action_names(published: Graph, feedback_type: str) -> list[str]:
    """Action servers whose feedback has a type."""
    suffix = "/_action/feedback"
    return [
        name.removesuffix(suffix)
        for name in of_type(published, feedback_type)
        if name.endswith(suffix)
    ]
