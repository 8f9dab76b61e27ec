"""The virtual network carries messages as well or as badly as it is told."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from rclpy.duration import Duration
from rclpy.qos import HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32

from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.network import Conditions
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import World
from kompass.virtual.scheduler import SECOND

BEST_EFFORT = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)


def node_in(world: World, name: str) -> VirtualNode:
    node = VirtualNode(world.process(name, cost=0.0), name)
    VirtualExecutor(node.process).add_node(node)
    return node


@pytest.fixture
def world() -> Iterator[World]:
    with World(seed=5) as world:
        yield world


def heard(world: World, topic: str, qos: object = 1000, count: int = 500) -> list[tuple[int, int]]:
    """Numbers that were heard, and how long they took [ns]; one was sent each 10 µs."""
    one, other = node_in(world, "one"), node_in(world, "other")
    publisher = one.create_publisher(Int32, topic, 1000)
    came: list[tuple[int, int]] = []
    sent: list[int] = []
    other.create_subscription(
        Int32, topic, lambda m: came.append((m.data, world.scheduler.now - sent[m.data])), qos
    )

    def say(number: int) -> None:
        sent.append(world.scheduler.now)
        publisher.publish(Int32(data=number))

    for number in range(count):
        world.scheduler.call_later(10_000 * number, say, number)
    world.scheduler.run_for(SECOND)
    return came


def test_messages_take_their_time_and_stay_in_order(world: World) -> None:
    came = heard(world, "/t")
    assert [number for number, _ in came] == list(range(500))
    took = [time for _, time in came]
    assert 100_000 <= min(took) < 150_000
    assert 350_000 < max(took) < 450_000
    assert len(set(took)) > 400


def test_only_who_did_not_ask_for_all_loses_some(world: World) -> None:
    world.network.set_conditions(Conditions(loss=0.5))
    assert len(heard(world, "/reliable")) == 500
    some = [number for number, _ in heard(world, "/best_effort", BEST_EFFORT)]
    assert 200 < len(some) < 300
    assert some == sorted(some)


def test_conditions_are_those_of_a_topic_before_those_of_a_process(world: World) -> None:
    world.network.set_conditions(Conditions(0.5, 0.5))
    world.network.set_conditions(Conditions(0.02, 0.02), process="one")
    world.network.set_conditions(Conditions(0.001, 0.001), topic="/fast")
    assert {round(took / 1e6) for _, took in heard(world, "/fast", count=5)} == {1}
    assert {round(took / 1e6) for _, took in heard(world, "/slow", count=5)} == {20}


def test_conditions_change_under_way(world: World) -> None:
    one, other = node_in(world, "one"), node_in(world, "other")
    publisher, came = one.create_publisher(Int32, "/t", 10), list[int]()
    other.create_subscription(Int32, "/t", lambda m: came.append(m.data), BEST_EFFORT)
    world.network.set_conditions(Conditions(loss=1.0), topic="/t")
    publisher.publish(Int32(data=1))
    world.scheduler.run_for(SECOND)
    world.network.set_conditions(Conditions(), topic="/t")
    publisher.publish(Int32(data=2))
    world.scheduler.run_for(SECOND)
    assert came == [2]


def test_who_has_just_come_is_found_after_a_while() -> None:
    with World(discovery=0.3) as world:
        one, other = node_in(world, "one"), node_in(world, "other")
        publisher, came = one.create_publisher(Int32, "/t", 10), list[int]()
        other.create_subscription(Int32, "/t", lambda m: came.append(m.data), 10)
        assert one.get_node_names_and_namespaces() == [("one", "/")]
        assert (one.count_subscribers("/t"), other.count_subscribers("/t")) == (0, 1)
        publisher.publish(Int32(data=1))
        world.scheduler.run_for(SECOND // 2)
        assert one.get_node_names_and_namespaces() == [("one", "/"), ("other", "/")]
        assert (one.count_subscribers("/t"), publisher.get_subscription_count()) == (1, 1)
        publisher.publish(Int32(data=2))
        world.scheduler.run_for(SECOND // 2)
        assert came == [2]


def test_all_is_kept_where_all_is_to_be_kept(world: World) -> None:
    one, other = node_in(world, "one"), node_in(world, "other")
    publisher, came = one.create_publisher(Int32, "/t", 10), list[int]()
    keep = QoSProfile(history=HistoryPolicy.KEEP_ALL)
    other.create_subscription(Int32, "/t", lambda m: came.append(m.data), keep)
    other.process.stop()
    for number in range(3000):
        publisher.publish(Int32(data=number))
    other.process.go_on()
    world.scheduler.run_for(SECOND)
    assert came == list(range(3000))


@pytest.mark.parametrize(
    ("profile", "text"),
    [
        (QoSProfile(depth=1, deadline=Duration(seconds=1)), "deadline = .*; leave it out"),
        (QoSProfile(depth=1, lifespan=Duration(seconds=1)), "lifespan = .*; leave it out"),
        (
            QoSProfile(depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC),
            "liveliness = MANUAL_BY_TOPIC .*; choose",
        ),
        (
            QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_AVAILABLE),
            "reliability = BEST_AVAILABLE .*; choose RELIABLE or BEST_EFFORT",
        ),
    ],
)
def test_a_quality_that_is_not_carried_out_is_refused(
    world: World, profile: QoSProfile, text: str
) -> None:
    with pytest.raises(ValueError, match=f"^/t: {text}"):
        node_in(world, "one").create_publisher(Int32, "/t", profile)


@pytest.mark.parametrize(
    ("fastest", "slowest", "loss"), [(-1.0, 0.1, 0.0), (0.2, 0.1, 0.0), (0.0, 0.1, 1.5)]
)
def test_conditions_that_cannot_be_are_refused(fastest: float, slowest: float, loss: float) -> None:
    with pytest.raises(ValueError, match=r"Conditions: (fastest|loss) = "):
        Conditions(fastest, slowest, loss)
