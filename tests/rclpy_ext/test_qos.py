"""A reader is connected with whoever publishes, and is as good as all of them allow."""

import time
from types import SimpleNamespace
from typing import Any

import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32

from kompass.rclpy_ext.qos import FOR_ANY_PUBLISHER, LATCHED_PROFILE, ReaderQoS, best_for
from tests.support.spinning import Spinning

RELIABLE = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)
BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = ReaderQoS(ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL)


def publishers(*profiles: QoSProfile) -> list[Any]:
    return [SimpleNamespace(qos_profile=profile) for profile in profiles]


@pytest.mark.parametrize(
    ("offered", "expected"),
    [
        ([BEST_EFFORT], FOR_ANY_PUBLISHER),
        ([RELIABLE], ReaderQoS(ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE)),
        ([LATCHED_PROFILE], LATCHED),
        ([LATCHED_PROFILE, LATCHED_PROFILE], LATCHED),
        (
            [LATCHED_PROFILE, RELIABLE],
            ReaderQoS(ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE),
        ),
        ([LATCHED_PROFILE, BEST_EFFORT], FOR_ANY_PUBLISHER),
    ],
)
def test_a_reader_asks_for_no_more_than_every_publisher_offers(
    offered: list[QoSProfile], expected: ReaderQoS
) -> None:
    assert best_for(publishers(*offered)) == expected
    assert expected.latched == (expected.durability == DurabilityPolicy.TRANSIENT_LOCAL)


def test_without_publishers_a_reader_stays_as_it_is() -> None:
    assert best_for([]) == FOR_ANY_PUBLISHER
    assert best_for([], LATCHED) == LATCHED


@pytest.mark.parametrize("offered", [BEST_EFFORT, RELIABLE, LATCHED_PROFILE])
def test_what_asks_for_little_hears_every_publisher(
    spinning: Spinning, offered: QoSProfile
) -> None:
    name = f"/heard_{time.monotonic_ns()}"
    heard: list[Int32] = []
    reader = spinning.node.create_subscription(
        Int32, name, heard.append, FOR_ANY_PUBLISHER.profile(5)
    )
    writer = spinning.node.create_publisher(Int32, name, offered)

    def published() -> bool:
        writer.publish(Int32(data=7))
        return bool(heard)

    spinning.until(published)
    assert heard[0].data == 7
    spinning.node.destroy_subscription(reader)
    spinning.node.destroy_publisher(writer)


def test_once_the_publishers_are_known_the_reader_is_given_what_they_said_last(
    spinning: Spinning,
) -> None:
    name = f"/latched_{time.monotonic_ns()}"
    writer = spinning.node.create_publisher(Int32, name, LATCHED_PROFILE)
    writer.publish(Int32(data=3))
    infos = spinning.node.get_publishers_info_by_topic
    spinning.until(lambda: infos(name))
    asked = best_for(infos(name))
    assert asked.latched
    heard: list[Int32] = []
    reader = spinning.node.create_subscription(Int32, name, heard.append, asked.profile(1))
    spinning.until(lambda: heard)
    assert [message.data for message in heard] == [3]
    spinning.node.destroy_subscription(reader)
    spinning.node.destroy_publisher(writer)
