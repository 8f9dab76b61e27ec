"""What is read out of the bytes is what rclpy would have made of them, for every message type."""

import importlib
import random
import struct
from collections.abc import Callable
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message
from std_msgs.msg import ByteMultiArray

from kompass.rclpy_ext.partial_decoder import Path, partial_decoder
from kompass.rules.schema.signals import reader
from kompass.rules.schema.values import same

PACKAGES = (
    "std_msgs",
    "geometry_msgs",
    "nav_msgs",
    "sensor_msgs",
    "diagnostic_msgs",
    "trajectory_msgs",
    "visualization_msgs",
    "rcl_interfaces",
    "action_msgs",
    "automatika_ros_sugar",
    "kompass_interfaces",
)


def message_types() -> list[str]:
    names = []
    for package in PACKAGES:
        module = importlib.import_module(f"{package}.msg")
        for name, kind in vars(module).items():
            if isinstance(kind, type) and hasattr(kind, "get_fields_and_field_types"):
                names.append(f"{package}/msg/{name}")
    return sorted(names)


NUMBERS: dict[str, Callable[[random.Random], Any]] = {
    "boolean": lambda r: r.random() < 0.5,
    "octet": lambda r: bytes([r.randrange(256)]),
    "float": lambda r: struct.unpack("f", struct.pack("f", r.uniform(-9, 9)))[0],
    "double": lambda r: r.choice([r.uniform(-9, 9), float("inf"), 0.0]),
}


def number(kind: str, chance: random.Random) -> Any:
    if kind in NUMBERS:
        return NUMBERS[kind](chance)
    bits = int(kind.removeprefix("u").removeprefix("int"))
    return chance.randrange(2**bits) - (0 if kind[0] == "u" else 2 ** (bits - 1))


def made(kind: type[Any], chance: random.Random) -> Any:
    """A message full of chance."""
    message = kind()
    for (name, text), slot in zip(
        kind.get_fields_and_field_types().items(), kind.SLOT_TYPES, strict=True
    ):
        value = of(slot, chance)
        if "wstring" not in text:
            setattr(message, name, value)
    return message


def of(slot: Any, chance: random.Random) -> Any:
    item = getattr(slot, "value_type", None)
    if item is not None:
        count = getattr(slot, "size", None)
        if count is None:
            count = chance.randrange(min(4, getattr(slot, "maximum_size", 4) + 1))
        return [of(item, chance) for _ in range(count)]
    if hasattr(slot, "typename"):
        return number(slot.typename, chance)
    if hasattr(slot, "namespaces"):
        module = importlib.import_module(".".join(slot.namespaces))
        return made(getattr(module, slot.name), chance)
    return "".join(chance.choice("abcdäö€") for _ in range(chance.randrange(9)))


def paths(kind: type[Any], prefix: Path = ()) -> list[Path]:
    """Paths to every value that is no message, nor behind a sequence of them."""
    found: list[Path] = []
    for name, slot in zip(kind.get_fields_and_field_types(), kind.SLOT_TYPES, strict=True):
        if hasattr(slot, "namespaces"):
            module = importlib.import_module(".".join(slot.namespaces))
            found += paths(getattr(module, slot.name), (*prefix, name))
        elif not hasattr(slot, "value_type") or hasattr(slot.value_type, "typename"):
            found.append((*prefix, name))
            if hasattr(slot, "value_type"):
                found += [(*prefix, name, 0), (*prefix, name, -1)]
    return found


@pytest.mark.parametrize("package", PACKAGES)
def test_every_field_of_every_type_reads_the_same(package: str) -> None:
    chance = random.Random(7)
    checked = 0
    for name in (name for name in message_types() if name.startswith(f"{package}/")):
        kind = getattr(importlib.import_module(f"{package}.msg"), name.rpartition("/")[2])
        everything = paths(kind)
        for path in everything:
            assert partial_decoder(name, [path]) is not None, f"{name} {path}"
        for _ in range(3):
            message = made(kind, chance)
            raw = bytes(serialize_message(message))
            some = chance.sample(everything, min(3, len(everything)))
            for chosen in (everything, some, [*some[:1]], []):
                decode = partial_decoder(name, chosen)
                assert decode is not None
                partial = decode(raw)
                for path in chosen:
                    read = reader(path, None)
                    assert same(read(partial), read(message)), f"{name} {path}"
                    checked += 1
    assert checked > 3


@pytest.mark.parametrize("path", [(), ("pose",), ("pose", "pose"), ("nothing",), (0,)])
def test_what_leads_to_no_value_calls_for_the_whole_message(path: Path) -> None:
    assert partial_decoder("nav_msgs/msg/Odometry", [path]) is None


def test_bytes_that_are_cut_short_are_refused() -> None:
    raw = bytes(serialize_message(Odometry(child_frame_id="base")))
    decode = partial_decoder("nav_msgs/msg/Odometry", [("twist", "twist", "angular", "z")])
    assert decode is not None
    assert decode(raw).twist.twist.angular.z == 0.0
    for size in range(40, 300, 7):
        with pytest.raises((ValueError, struct.error)):
            decode(raw[:size])
    with pytest.raises(ValueError, match="little endian"):
        decode(b"\0\0" + raw[2:])


def test_a_byte_is_the_number_that_a_rule_compares_it_with() -> None:
    message = DiagnosticStatus(level=DiagnosticStatus.ERROR, name="imu")
    decode = partial_decoder("diagnostic_msgs/msg/DiagnosticStatus", [("level",)])
    assert decode is not None
    assert reader(("level",), None)(decode(serialize_message(message))) == 2
    array = ByteMultiArray(data=[b"\x01", b"2"])
    decode = partial_decoder("std_msgs/msg/ByteMultiArray", [("data",)])
    assert decode is not None
    decoded = decode(serialize_message(array))
    assert reader(("data",), None)(decoded) == [1, 50]
    assert reader(("data",), "max")(decoded) == 50.0
