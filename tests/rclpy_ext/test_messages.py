"""What a rule sends is what it says, for each field of each message type that is installed."""

from types import SimpleNamespace
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import Point, Pose, PoseStamped, PoseWithCovariance
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from rclpy.serialization import deserialize_message, serialize_message
from rosidl_parser.definition import (  # type: ignore[import-untyped]
    BoundedString,
    BoundedWString,
    UnboundedWString,
)
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Byte, ByteMultiArray, Float32, Int32, String, UInt8

from kompass.field_types import field_types
from kompass.monitor.introspection.message_types import MessageTypes
from kompass.rclpy_ext.messages import checked, fill, part_to_plain, to_plain
from kompass.rules.checks.check import check_rule
from kompass.rules.checks.problem import Problem
from kompass.rules.schema.actions import CallService, Publish, SendGoal
from kompass.rules.schema.arguments import expand, resolve
from kompass.rules.schema.conditions import Received
from kompass.rules.schema.signals import Signal
from tests.rules.building import rule
from tests.support.fields import (
    alike,
    class_of,
    literal,
    message_as_received,
    message_data,
    message_misfits,
    sendable_types,
)
from tests.support.properties import MANY, few_or_many

TYPES = sendable_types()
HALF = r"\ud800"  # of a surrogate pair, as Python shows it
EVERY_TYPE = pytest.mark.parametrize("type_name", TYPES)


def tried(examples: int) -> settings:
    return settings(
        max_examples=examples,
        deadline=None,
        suppress_health_check=(
            HealthCheck.too_slow,
            HealthCheck.data_too_large,
            HealthCheck.large_base_example,
        ),
    )


def action(type_name: str, data: dict[str, Any]) -> Publish | CallService | SendGoal:
    if type_name.endswith("_Request"):
        return CallService(service="s", type=type_name.removesuffix("_Request"), request=data)
    if type_name.endswith("_Goal"):
        return SendGoal(action="a", type=type_name.removesuffix("_Goal"), goal=data)
    return Publish(topic="t", type=type_name, message=data)


def sent(type_name: str, message: Any) -> Any:
    """What a receiver is given."""
    return deserialize_message(serialize_message(message), class_of(type_name))


def made(type_name: str, arguments: dict[str, Any], trigger: Any = None) -> Any:
    """What is handed to the middleware."""
    return fill(class_of(type_name)(), expand(resolve(arguments, trigger)))


def problems(type_name: str, data: dict[str, Any]) -> list[Problem]:
    """What is wrong with sending this when a message of the same type triggers it."""
    trigger = Received(signal=Signal(topic="t", type=type_name))
    made = rule(trigger).model_copy(update={"actions": (action(type_name, data),)})
    return check_rule(made, MessageTypes())


def test_there_are_types_of_all_packages() -> None:
    packages = {name.partition("/")[0] for name in TYPES}
    wanted = {"std_msgs", "geometry_msgs", "sensor_msgs", "nav_msgs", "diagnostic_msgs"}
    assert packages >= wanted | {"std_srvs", "nav2_msgs", "kompass_interfaces"}
    assert len(TYPES) > 200


@few_or_many(MANY // 8, few=2)
@EVERY_TYPE
def test_what_fits_arrives_as_it_was_written(type_name: str, examples: int) -> None:
    @tried(examples)
    @given(message_data(type_name))
    def check(data: dict[str, Any]) -> None:
        written = literal(data)
        assert problems(type_name, written) == []
        arrived = to_plain(sent(type_name, made(type_name, written)))
        assert alike(arrived, message_as_received(type_name, data))

    check()


@few_or_many(MANY // 8, few=2)
@EVERY_TYPE
def test_what_is_taken_from_a_message_arrives_as_it_was_there(
    type_name: str, examples: int
) -> None:
    references = {name: f"$msg.{name}" for name in field_types(class_of(type_name))}
    assert problems(type_name, references) == []

    @tried(examples)
    @given(message_data(type_name, finite=False))
    def check(data: dict[str, Any]) -> None:
        source = sent(type_name, fill(class_of(type_name)(), data))
        expected = message_as_received(type_name, data)
        for message in (made(type_name, references, source), checked(source)):
            assert alike(to_plain(sent(type_name, message)), expected)

    check()


@few_or_many(MANY // 8, few=2)
@EVERY_TYPE
def test_what_does_not_fit_is_refused_before_anything_is_sent(
    type_name: str, examples: int
) -> None:
    @tried(examples)
    @given(message_misfits(type_name))
    def check(wrong: tuple[dict[str, Any], str]) -> None:
        data, way = wrong
        try:
            (found,) = problems(type_name, literal(data))
        except ValidationError:
            assert HALF in repr(data)  # that is refused even before
        else:
            assert found.field.endswith(way)
            assert found.remedy
        references = {name: f"$msg.{name}" for name in data}
        for arguments, trigger in ((literal(data), None), (references, SimpleNamespace(**data))):
            with pytest.raises((ValueError, AttributeError)) as refused:
                made(type_name, arguments, trigger)
            assert way.removeprefix(".") in str(refused.value)

    check()


@pytest.mark.parametrize(
    ("kind", "data", "words"),
    [
        (UInt8, {"data": 300}, "data = 300: it is an integer (uint8: 0 to 255)"),
        (Int32, {"data": 2**40}, "from -2147483648 to 2147483647"),
        (Byte, {"data": 256}, "(byte: 0 to 255)"),
        (Float32, {"data": 1e300}, "from -3.4028235e38 to 3.4028235e38"),
        (Float32, {"data": "0.5"}, "data = '0.5': it is a number (float32); give a number"),
        (PoseStamped, {"pose": {"position": {"x": "1"}}}, "pose.position.x = '1'"),
        (
            PoseStamped,
            {"pose": Point()},
            "pose = a Point: it is a message (geometry_msgs/",
        ),
        (PoseWithCovariance, {"covariance": [0.0] * 35}, "give 36 items, not 35"),
        (LaserScan, {"ranges": [0.5, None]}, "ranges[1] = None"),
        (DiagnosticArray, {"status": [{"level": -1}]}, "status[0].level = -1"),
    ],
)
def test_a_refusal_names_field_value_and_what_is_allowed(
    kind: type[Any], data: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValueError) as refused:
        fill(kind(), data)
    assert words in str(refused.value)


def test_a_byte_may_be_a_number_or_one_byte() -> None:
    for given_ in (2, 2.0, b"\x02", DiagnosticStatus.ERROR):
        assert fill(DiagnosticStatus(), {"level": given_}).level == b"\x02"
    assert fill(ByteMultiArray(), {"data": [1, b"\x02"]}).data == [b"\x01", b"\x02"]
    with pytest.raises(ValueError, match="level"):
        fill(DiagnosticStatus(), {"level": b"\x02\x03"})


def test_a_byte_of_a_message_is_a_number_in_plain_data() -> None:
    array = DiagnosticArray(status=[DiagnosticStatus(level=b"\x02")])
    assert to_plain(array)["status"][0]["level"] == 2
    assert to_plain(ByteMultiArray(data=[b"\x01", b"\x02"]))["data"] == [1, 2]
    assert part_to_plain({"levels": [b"\x03"]}) == {"levels": [3]}


def test_nan_and_infinity_of_a_message_go_on_as_they_are() -> None:
    scan = LaserScan(ranges=[float("inf"), float("nan"), 0.5], range_max=float("inf"))
    arrived = sent("sensor_msgs/msg/LaserScan", fill(LaserScan(), {"ranges": scan.ranges}))
    assert alike(list(arrived.ranges), list(scan.ranges))
    assert fill(Float32(), {"data": float("inf")}).data == float("inf")


@pytest.mark.parametrize(
    ("message", "field"),
    [
        (DiagnosticArray(status=[DiagnosticStatus(level=300)]), r"status\[0\]\.level = 300"),
        (Float32(data="high"), "data = 'high'"),
        (UInt8(data=300), "data = 300"),
        (String(data=None), "data = None"),
        (PoseStamped(pose=Point()), "pose = a Point"),
    ],
)
def test_a_message_that_a_recipe_made_wrong_is_refused(message: Any, field: str) -> None:
    with pytest.raises(ValueError, match=field):
        checked(message)


def test_a_byte_that_a_recipe_gave_as_a_number_is_sent_as_that_byte() -> None:
    assert checked(DiagnosticStatus(level=2)).level == b"\x02"


class Wide:
    """Texts with bounds, and wide ones: no package that is installed has any."""

    SLOT_TYPES = (BoundedString(4), UnboundedWString(), BoundedWString(4))

    def __init__(self) -> None:
        self.text, self.wide, self.short = "", "", ""

    @staticmethod
    def get_fields_and_field_types() -> dict[str, str]:
        return {"text": "string<4>", "wide": "wstring", "short": "wstring<4>"}


def test_texts_are_as_long_as_they_are_when_they_are_sent() -> None:
    message = fill(Wide(), {"text": "abcd", "wide": "é" * 99, "short": "😀😀"})
    assert (message.text, message.short) == ("abcd", "😀😀")
    for wrong in ({"text": "abcde"}, {"text": "ééé"}, {"short": "😀😀😀"}, {"wide": "a\0b"}):
        with pytest.raises(ValueError, match="text"):
            fill(Wide(), wrong)


@given(st.integers(0, 255))
def test_parts_of_messages_are_taken_as_they_are(level: int) -> None:
    pose = Pose(position=Point(x=float(level)))
    assert fill(PoseStamped(), {"pose": pose}).pose is pose
