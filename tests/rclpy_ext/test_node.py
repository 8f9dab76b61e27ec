"""What comes and goes under the events executor takes nobody with it."""

import gc
import time
from pathlib import Path
from typing import Any

import pytest
import rclpy
from kompass_interfaces.action import PlanPath
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32

from kompass.components.base.node import ComponentNode
from kompass.rclpy_ext.executor import TaskExecutor
from kompass.rclpy_ext.node import NodeOnDDS, PlainNode, of_others
from tests.support.domains import give_back, next_domain
from tests.support.processes import wait_until
from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros


DEMANDING = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)
MODEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


def test_readers_and_writers_that_do_not_fit_each_other_come_and_go() -> None:
    domain = next_domain()
    context = rclpy.Context()
    rclpy.init(args=[], context=context, domain_id=domain)
    executor = TaskExecutor(context)
    nodes = [PlainNode(name, context=context) for name in ("one", "other")]
    try:
        for node in nodes:
            executor.add_node(node)
        end = time.monotonic() + 1.0
        while time.monotonic() < end:
            readers = [nodes[0].create_subscription(Int32, "/t", print, DEMANDING) for _ in "abc"]
            writers = [nodes[1].create_publisher(Int32, "/t", MODEST) for _ in "abc"]
            executor.spin_once(timeout_sec=0.01)
            # An event of one that is destroyed is what rclpy's own executor dies of.
            assert not any(each.event_handlers for each in (*readers, *writers))
            for reader, writer in zip(readers, writers, strict=True):
                nodes[0].destroy_subscription(reader)
                nodes[1].destroy_publisher(writer)
            executor.spin_once(timeout_sec=0.01)
        assert len(nodes[0].default_callback_group.entities) < 20, "none of them is remembered"
    finally:
        executor.shutdown()
        for node in nodes:
            node.destroy_node()
        context.try_shutdown()
        give_back(domain)


def dds_threads() -> set[str]:
    """Numbers of the threads of the participants of this process."""
    threads = Path("/proc/self/task").glob("*/comm")
    return {each.parent.name for each in threads if each.read_text().startswith("dds.")}


async def never(goal: object) -> None:
    """Stands for what carries a goal out."""


@pytest.mark.parametrize("side", ["client", "server"])
def test_nothing_of_a_participant_outlives_a_node_that_had_an_action(side: str) -> None:
    domain = next_domain()
    gc.disable()  # which would free it at some time, on some thread
    try:
        before = dds_threads()
        context = rclpy.Context()
        rclpy.init(args=[], context=context, domain_id=domain)
        node = PlainNode("short_lived", context=context)
        if side == "client":
            node.create_action_client(PlanPath, "/planner/plan_path")
        else:
            node.create_action_server(PlanPath, "/planner/plan_path", never)
        assert dds_threads() - before
        node.destroy_node()
        context.try_shutdown()
        wait_until(lambda: not dds_threads() - before, 5, "the end of its threads")
    finally:
        gc.enable()
        give_back(domain)


def test_components_are_spared_too() -> None:
    assert issubclass(ComponentNode, NodeOnDDS)


def test_a_node_of_the_same_name_in_another_namespace_is_another_one(spinning: Spinning) -> None:
    own = spinning.node
    twin = rclpy.create_node(own.get_name(), namespace="/other_robot")
    try:
        publishers = [node.create_publisher(Int32, "/shared", 10) for node in (own, twin)]

        def found() -> list[Any]:
            return list(own.get_publishers_info_by_topic("/shared"))

        spinning.until(lambda: len(found()) == len(publishers))
        assert [each.node_namespace for each in of_others(own, found())] == ["/other_robot"]
    finally:
        twin.destroy_node()
