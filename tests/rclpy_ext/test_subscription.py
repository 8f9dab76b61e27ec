"""Messages wait for who takes them when it likes."""

import time
from collections.abc import Iterator

import pytest
import rclpy
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from std_msgs.msg import Int32

from kompass.rclpy_ext.node import PlainNode
from kompass.rclpy_ext.qos import FOR_ANY_PUBLISHER
from kompass.rclpy_ext.subscription import take_all
from tests.support.domains import give_back, next_domain
from tests.support.processes import wait_until


@pytest.fixture
def node() -> Iterator[Node]:
    domain = next_domain()
    context = rclpy.Context()
    rclpy.init(args=[], context=context, domain_id=domain)
    made = PlainNode("taker", context=context)
    yield made
    made.destroy_node()
    context.try_shutdown()
    give_back(domain)


def test_all_that_has_arrived_is_taken_in_order_and_once(node: Node) -> None:
    reader = node.create_subscription(Int32, "/t", print, FOR_ANY_PUBLISHER.profile(10))
    writer = node.create_publisher(Int32, "/t", 10)
    wait_until(lambda: writer.get_subscription_count() > 0, 10, "the reader")
    before = time.time_ns()
    for number in (1, 2, 3):
        writer.publish(Int32(data=number))
    taken: list[tuple[int, int]] = []

    def all_taken() -> bool:
        for raw, info in take_all(reader):
            message: Int32 = deserialize_message(raw, Int32)
            taken.append((message.data, info["received_timestamp"]))
        return len(taken) >= 3

    wait_until(all_taken, 10, "three messages")
    assert [number for number, _ in taken] == [1, 2, 3]
    assert all(at >= before for _, at in taken)
    assert list(take_all(reader)) == []
