"""What a component says that is well by its own account, and wrong."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from geometry_msgs.msg import Twist, TwistStamped
from kompass_interfaces.msg import TwistArray
from nav_msgs.msg import OccupancyGrid, Path

from kompass.message_types import ros_class
from kompass.virtual.wire import Packet

TURNED = math.pi / 2.0  # rad by which a path is turned about its first place
TIMES = -2.0  # what a command is multiplied by: the other way, and too fast
SHIFTED = 0.5  # m by which a map is off, along both of its axes
SCALED = 10.0  # what all other numbers are multiplied by
# What nobody drives by: who is there and how he is, what he logs, what came of an action.
_LEFT_ALONE = ("action_msgs", "automatika_ros_sugar", "builtin_interfaces", "kompass_interfaces",
               "lifecycle_msgs", "rcl_interfaces", "unique_identifier_msgs")  # fmt: skip
_STAMPS = ("builtin_interfaces/", "std_msgs/Header")

Spoil = Callable[[Any], None]


def spoiler(topic: str, type_name: str) -> Callable[[Packet], Packet] | None:
    """What makes messages of a topic wrong; None where nothing in them could be.

    Parameters
    ----------
    topic
        Full name.
    type_name
        As in "nav_msgs/msg/Path".
    """
    if "/_action/" in topic:
        return None
    kind: Any = ros_class(type_name)
    spoil = _KNOWN.get(kind)
    if spoil is None:
        if type_name.partition("/")[0] in _LEFT_ALONE or not _has_numbers(kind):
            return None
        spoil = _scale

    def spoilt(packet: Packet) -> Packet:
        message = packet.message(kind)
        spoil(message)
        return Packet.of(message)

    return spoilt


def _turn(path: Path) -> None:
    """About where it begins: it leads through whatever is there, and elsewhere."""
    if not path.poses:
        return
    first = path.poses[0].pose.position
    x, y = first.x, first.y
    cos, sin = math.cos(TURNED), math.sin(TURNED)
    half = math.cos(TURNED / 2.0), math.sin(TURNED / 2.0)
    for stamped in path.poses:
        place, heading = stamped.pose.position, stamped.pose.orientation
        dx, dy = place.x - x, place.y - y
        place.x, place.y = x + cos * dx - sin * dy, y + sin * dx + cos * dy
        z, w = heading.z, heading.w
        heading.z, heading.w = half[0] * z + half[1] * w, half[0] * w - half[1] * z


def _reverse(twist: Twist) -> None:
    for vector in (twist.linear, twist.angular):
        vector.x, vector.y, vector.z = (TIMES * part for part in (vector.x, vector.y, vector.z))


def _reverse_all(twists: TwistArray) -> None:
    for vectors in (twists.linear_velocities, twists.angular_velocities):
        for axis in vectors.get_fields_and_field_types():
            setattr(vectors, axis, [TIMES * part for part in getattr(vectors, axis)])


def _shift(grid: OccupancyGrid) -> None:
    grid.info.origin.position.x += SHIFTED
    grid.info.origin.position.y += SHIFTED


_KNOWN: dict[Any, Spoil] = {
    Path: _turn,
    Twist: _reverse,
    TwistStamped: lambda stamped: _reverse(stamped.twist),
    TwistArray: _reverse_all,
    OccupancyGrid: _shift,
}


@cache
def _numbers(kind: Any) -> tuple[tuple[str, str], ...]:
    """Fields of a type that hold numbers or messages: name, and type as ``double[3]``."""
    fields: dict[str, str] = kind.get_fields_and_field_types()
    return tuple(
        (name, of)
        for name, of in fields.items()
        if not of.startswith(_STAMPS) and (_item(of) in _LIMITS or "/" in of)
    )


# Whole numbers hold no more than their type does; 8 bits are codes and pixels, and no measures.
_LIMITS: dict[str, tuple[float, float]] = {
    "float": (-math.inf, math.inf),
    "double": (-math.inf, math.inf),
} | {
    name: (int(np.iinfo(name).min), int(np.iinfo(name).max))
    for name in ("int16", "uint16", "int32", "uint32", "int64", "uint64")
}


def _item(field: str) -> str:
    """The type of an item of a field: ``sequence<double, 5>`` and ``double[3]`` hold doubles."""
    return field.removeprefix("sequence<").partition("[")[0].partition(",")[0].rstrip(">")


def _has_numbers(kind: Any) -> bool:
    return any(_item(of) in _LIMITS or _has_numbers(_class(of)) for _, of in _numbers(kind))


def _class(field: str) -> Any:
    package, _, name = _item(field).partition("/")
    return ros_class(f"{package}/msg/{name}")


def _scale(message: Any) -> None:
    kind: Any = type(message)
    for name, of in _numbers(kind):
        value = getattr(message, name)
        if _item(of) in _LIMITS:
            setattr(message, name, _scaled(value, *_LIMITS[_item(of)]))
            continue
        for each in value if _item(of) != of else (value,):
            _scale(each)


def _scaled(value: Any, least: float, most: float) -> Any:
    if isinstance(value, np.ndarray):
        return np.clip(SCALED * value, least, most).astype(value.dtype)
    if isinstance(value, (int, float)):
        return type(value)(min(max(SCALED * value, least), most))
    return [_scaled(each, least, most) for each in value]
