"""Who publishes on a topic, as the watch of the drive manager sees it, on real DDS."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

import pytest
import rclpy
from std_msgs.msg import String

from kompass.components.drive.publisher_watch import NAMESAKES, PublisherWatch, WatchedTopic
from tests.support.domains import give_back, next_domain
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros
TOPIC = "watched"
Join = Callable[[str], Any]


@pytest.fixture
def join() -> Iterator[Join]:
    """Have a program with a node of that name join the domain; its node."""
    domain = next_domain()
    with ExitStack() as left:
        left.callback(give_back, domain)

        def joined(name: str) -> Any:
            context = rclpy.Context()
            rclpy.init(args=[], context=context, domain_id=domain)
            left.callback(context.try_shutdown)
            node = rclpy.create_node(name, context=context)
            left.callback(node.destroy_node)
            return node

        yield joined


def watch_of(node: Any, **allowed: Any) -> PublisherWatch:
    return PublisherWatch(node, lambda: [WatchedTopic(TOPIC, **allowed)])


def sees(node: Any, *names: str) -> None:
    """Wait until a node knows the publishers of nodes of these names, and no others."""

    def seen() -> list[str]:
        return sorted(info.node_name for info in node.get_publishers_info_by_topic(TOPIC))

    wait_until(lambda: seen() == sorted(names), 10, f"publishers of {names}")


def publish(*nodes: Any) -> None:
    """Let each have two publishers, which the last gets to know."""
    for node in nodes:
        node.create_publisher(String, TOPIC, 1)
        node.create_publisher(String, TOPIC, 1)
    sees(nodes[-1], *(node.get_name() for node in nodes for _ in range(2)))


def test_a_node_that_takes_the_name_of_an_owner_is_found(join: Join) -> None:
    impostor, owner = join("halt"), join("halt")
    publish(impostor, owner)
    watch = watch_of(owner, owners=frozenset({"halt"}))
    assert watch.intruders(0.0) == {}  # may be the one before, which was killed
    assert watch.intruders(NAMESAKES - 1.0) == {}
    assert watch.intruders(NAMESAKES) == {TOPIC: ("another halt",)}


def test_a_node_that_is_started_again_and_again_is_no_intruder(join: Join) -> None:
    owner = join("owner")
    publish(owner)
    watch = watch_of(owner, owners=frozenset({"owner", "halt"}))
    before, now = join("halt"), 0.0
    before.create_publisher(String, TOPIC, 1)
    for _ in range(3):
        after = join("halt")
        after.create_publisher(String, TOPIC, 1)
        sees(owner, "owner", "owner", "halt", "halt")
        assert watch.intruders(now) == {}
        now += NAMESAKES - 1.0
        assert watch.intruders(now) == {}
        before.destroy_node()  # nobody believes in the dead one any more
        sees(owner, "owner", "owner", "halt")
        before = after
        now += NAMESAKES - 1.0
        assert watch.intruders(now) == {}


def test_a_node_of_a_taken_name_is_found_though_it_comes_and_goes(join: Join) -> None:
    owner = join("drive_manager")
    owner.create_publisher(String, TOPIC, 1)
    watch = watch_of(owner, owners=frozenset({"drive_manager"}))
    sees(owner, "drive_manager")
    assert watch.intruders(0.0) == {}
    now, found = 100.0, []
    for _ in range(3):
        impostor = join("drive_manager")
        impostor.create_publisher(String, TOPIC, 1)
        sees(owner, "drive_manager", "drive_manager")
        found.append(watch.intruders(now))
        impostor.destroy_node()
        sees(owner, "drive_manager")
        assert watch.intruders(now + 18.0) == {}
        now += 19.0
    assert found == [{}, {}, {TOPIC: ("another drive_manager",)}]


def test_who_finds_a_dead_one_beside_its_successor_takes_neither_for_an_intruder(
    join: Join,
) -> None:
    dead, successor, owner = join("halt"), join("halt"), join("owner")
    publish(dead, successor, owner)
    watch = watch_of(owner, owners=frozenset({"owner", "halt"}))
    assert watch.intruders(0.0) == {}
    dead.destroy_node()
    sees(owner, "owner", "owner", "halt", "halt")
    assert watch.intruders(NAMESAKES - 5.0) == {}
    # Long after that it is killed, too.
    another = join("halt")
    another.create_publisher(String, TOPIC, 1)
    sees(owner, "owner", "owner", "halt", "halt", "halt")
    assert watch.intruders(1000.0) == {}
    assert watch.intruders(1000.0 + NAMESAKES - 5.0) == {}


def test_two_processes_with_the_one_allowed_name_are_one_too_many(join: Join) -> None:
    impostor, controller = join("controller"), join("controller")
    publish(impostor, controller)
    watch = watch_of(controller, others=1)
    assert watch.intruders(0.0) == {}
    assert watch.intruders(NAMESAKES) == {TOPIC: ("another controller",)}


def test_two_nodes_where_one_may_be_are_found_at_once(join: Join) -> None:
    stranger, controller = join("stranger"), join("controller")
    publish(stranger, controller)
    assert watch_of(controller, others=1).intruders(0.0) == {TOPIC: ("controller", "stranger")}
    assert watch_of(controller, others=2).intruders(0.0) == {}
