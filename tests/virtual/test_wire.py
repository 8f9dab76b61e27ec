"""What is copied on the virtual bus is what DDS would have delivered."""

from __future__ import annotations

import array
import importlib
import math
import random
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatusArray
from geometry_msgs.msg import PoseStamped, Twist
from hypothesis import strategies as st
from lifecycle_msgs.srv import GetAvailableTransitions
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rclpy.serialization import deserialize_message, serialize_message
from rosidl_parser.definition import (  # type: ignore[import-untyped]
    AbstractGenericString,
    AbstractNestedType,
    Array,
    BasicType,
    BoundedSequence,
    NamespacedType,
)
from sensor_msgs.msg import Image, Imu, JointState, LaserScan, PointCloud2
from std_msgs.msg import (
    Bool,
    ByteMultiArray,
    Char,
    Empty,
    Float32,
    Float32MultiArray,
    Header,
    Int8,
    Int64,
    String,
    UInt8MultiArray,
    UInt64,
)
from tf2_msgs.msg import TFMessage
from unique_identifier_msgs.msg import UUID
from visualization_msgs.msg import MarkerArray

from kompass.message_types import ros_class
from kompass.virtual.wire import Packet, copier
from tests.support.properties import property_test

_OURS: list[Any] = [
    found
    for family in ("msg", "srv", "action")
    for found in vars(importlib.import_module(f"kompass_interfaces.{family}")).values()
    if isinstance(found, type)
]
KINDS: list[Any] = [
    *(Odometry, Path, OccupancyGrid, PoseStamped, Twist, LaserScan, PointCloud2, Image, Imu),
    *(JointState, TFMessage, MarkerArray, UUID, GoalStatusArray, GetAvailableTransitions.Response),
    *(Bool, ByteMultiArray, Char, Empty, Float32, Float32MultiArray, Header, Int8, Int64, String),
    *(UInt8MultiArray, UInt64),
    *(found for found in _OURS if hasattr(found, "SLOT_TYPES")),
    *(
        part
        for found in _OURS
        if hasattr(found, "Request")
        for part in (found.Request, found.Response)
    ),
    *(part for found in _OURS if hasattr(found, "Goal") for part in (found.Goal, found.Result)),
]
# What a field takes and what a careless program puts there.
_FLOATS = (0.0, -0.0, 1.5, 0.1, math.pi, 1e300, -1e300, 1e-310, math.inf, math.nan, np.float64(0.3))
_TEXTS = ("", "a", "two words", "Grüße", "line\nbreak", "'quoted'")


def filled(kind: type[Any], chance: random.Random) -> Any:
    """A message with values of all sorts that its fields can hold."""
    message = kind()
    for name, slot in zip(kind.get_fields_and_field_types(), kind.SLOT_TYPES, strict=True):
        setattr(message, name, _value(slot, getattr(message, name), chance))
    return message


def _value(slot: Any, sample: Any, chance: random.Random) -> Any:
    if isinstance(slot, NamespacedType):
        known = type(sample) if sample is not None else None
        return filled(known or ros_class("/".join(slot.namespaced_name())), chance)
    if isinstance(slot, AbstractGenericString):
        return chance.choice(_TEXTS)
    if isinstance(slot, BasicType):
        return _scalar(slot.typename, chance)
    assert isinstance(slot, AbstractNestedType)
    size = slot.size if isinstance(slot, Array) else chance.randrange(4)
    if isinstance(slot, BoundedSequence):
        size = min(size, slot.maximum_size)
    values = [_value(slot.value_type, None, chance) for _ in range(size)]
    if isinstance(sample, np.ndarray):
        return np.array(values, dtype=sample.dtype)
    if isinstance(sample, array.array):
        if sample.typecode == "f":
            values = [value if abs(value) < 1e30 else 0.0 for value in values]
        return array.array(sample.typecode, values)
    return values


def _scalar(name: str, chance: random.Random) -> Any:
    if name in ("float", "double"):
        return chance.choice(_FLOATS)
    if name == "boolean":
        return chance.random() < 0.5
    if name == "octet":
        return bytes((chance.randrange(256),))
    limits = np.iinfo("uint8" if name == "char" else name)
    return chance.choice((0, 1, int(limits.min), int(limits.max), chance.randrange(100)))


def same(one: Any, other: Any) -> bool:
    """Whether two values are equal in all that can be seen of them, types and precision too."""
    if type(one) is not type(other):
        return False
    if hasattr(one, "SLOT_TYPES"):
        return all(same(getattr(one, name), getattr(other, name)) for name in one.__slots__)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray):
        return bool(one.dtype == other.dtype) and bool(one.tobytes() == other.tobytes())
    if isinstance(one, array.array):
        return bool(one.typecode == other.typecode) and bool(one.tobytes() == other.tobytes())
    return repr(one) == repr(other)


@property_test(st.sampled_from(KINDS), st.randoms(use_true_random=False), many=2000)
def test_what_arrives_is_what_dds_would_deliver(kind: type[Any], chance: random.Random) -> None:
    message = filled(kind, chance)
    arrived = Packet.of(message).message(kind)
    assert same(arrived, deserialize_message(serialize_message(message), kind)), repr(message)
    # Bytes are not compared: those between two fields are whatever was in memory before.
    assert same(arrived, deserialize_message(Packet.of(message).data, kind))


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_every_type_arrives_as_it_is_made(kind: type[Any]) -> None:
    for seed in range(20):
        message = filled(kind, random.Random(seed))
        arrived = Packet.of(message).message(kind)
        assert same(arrived, deserialize_message(serialize_message(message), kind))


def test_what_we_send_often_goes_the_short_way() -> None:
    rare = [kind.__name__ for kind in KINDS if copier(kind) is None]
    assert set(rare) <= {"Char"}


def test_a_packet_is_not_changed_by_who_sends_and_who_gets_it() -> None:
    message = LaserScan(ranges=[1.0, 2.0])
    message.header.frame_id = "laser"
    packet = Packet.of(message)
    message.ranges[0], message.header.frame_id = 9.0, "changed"
    first = packet.message(LaserScan)
    first.ranges[1], first.header.frame_id = 9.0, "changed"
    second = packet.message(LaserScan)
    assert (list(second.ranges), second.header.frame_id) == ([1.0, 2.0], "laser")
    covariance = Odometry()
    packet = Packet.of(covariance)
    covariance.pose.covariance[0] = 1.0
    assert packet.message(Odometry).pose.covariance[0] == 0.0
