"""What rules look at is heard once: none missed and none twice, whoever publishes it and how."""

from typing import Any

import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from std_msgs.msg import Int32

from kompass.monitor.inputs.rule_inputs import RuleInputs
from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Heard:
    """Inputs of one topic, and the numbers that came."""

    def __init__(self, spinning: Spinning, topic: str) -> None:
        self.numbers: list[int] = []
        self.inputs = RuleInputs(spinning.node, self._take)
        self.inputs.follow({topic: "std_msgs/msg/Int32"})

    def _take(self, topic: str, type_name: str, message: Any, raw: bytes) -> None:
        self.numbers.append(message.data)


@pytest.mark.parametrize("qos", [QoSProfile(depth=1000), LATCHED], ids=["reliable", "latched"])
def test_a_reader_is_made_better_without_missing_or_repeating_anything(
    spinning: Spinning, qos: QoSProfile, request: pytest.FixtureRequest
) -> None:
    topic = f"numbers_{request.node.callspec.id}"
    heard = Heard(spinning, topic)
    publisher = spinning.node.create_publisher(Int32, topic, qos)
    spinning.until(lambda: publisher.get_subscription_count() == 1)
    for number in range(60):
        # The fifth is heard by the first reader; a latched one is given it again by the second.
        if number in (5, 35):
            heard.inputs.fit()
        publisher.publish(Int32(data=number))
        spinning.until(lambda number=number: number in heard.numbers)  # type: ignore[misc]
    spinning.rest(0.2)
    assert heard.numbers == list(range(60))


def test_equal_messages_are_counted_and_not_taken_for_one(spinning: Spinning) -> None:
    heard = Heard(spinning, "equal")
    publisher = spinning.node.create_publisher(Int32, "equal", 100)
    spinning.until(lambda: publisher.get_subscription_count() == 1)
    for count in range(1, 41):
        if count in (5, 25):
            heard.inputs.fit()
        publisher.publish(Int32(data=7))
        spinning.until(lambda count=count: len(heard.numbers) >= count)  # type: ignore[misc]
    spinning.rest(0.2)
    assert heard.numbers == [7] * 40


def test_bytes_that_are_no_such_message_are_left_out_and_told_of(
    spinning: Spinning, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    monkeypatch.setattr(spinning.node, "write_log", lambda _, text: told.append(text))
    heard = Heard(spinning, "cut")
    publisher = spinning.node.create_publisher(Int32, "cut", 100)
    spinning.until(lambda: publisher.get_subscription_count() == 1)
    whole = serialize_message(Int32(data=7))
    for _ in range(5):
        publisher.publish(whole[:4])
    publisher.publish(whole)
    spinning.until(lambda: heard.numbers)
    assert heard.numbers == [7]
    assert told == [
        "/cut: a message was left out: 4 bytes are no std_msgs/msg/Int32; "
        "look at who publishes there"
    ]
