"""Processes of virtual time are killed, stopped and starved as real ones are."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from itertools import pairwise

import pytest
from kompass_interfaces.action import PlanPath
from rclpy.action import CancelResponse, GoalResponse
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

from kompass.components.drive.publisher_watch import NAMESAKES
from kompass.rclpy_ext.awaitables import Awaitables
from kompass.rclpy_ext.timers import Timers
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.network import LEASE
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import World
from kompass.virtual.scheduler import SECOND

MS = 1_000_000  # ns


@pytest.fixture
def world() -> Iterator[World]:
    with World(seed=5) as world:
        yield world


def node_in(world: World, name: str) -> VirtualNode:
    node = VirtualNode(world.process(name), name)
    VirtualExecutor(node.process).add_node(node)
    return node


def test_of_a_process_that_was_killed_nothing_happens_any_more(world: World) -> None:
    one, other = node_in(world, "one"), node_in(world, "other")
    done: list[str] = []
    wait = Awaitables(Timers(one), one.executor)

    async def sleep() -> None:
        try:
            while True:
                await wait.sleep(0.01)
                done.append("slept")
        finally:
            done.append("cleaned up")

    publisher = one.create_publisher(Int32, "/t", 10)

    def tick() -> None:
        done.append("timer")
        publisher.publish(Int32())

    def serve(_: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        done.append("served")
        return response

    one.create_timer(0.01, tick)
    one.create_subscription(Int32, "/u", lambda _: done.append("heard"), 10)
    one.create_service(Trigger, "/s", serve)
    one.executor.create_task(sleep)
    speaker, client = other.create_publisher(Int32, "/u", 10), other.create_client(Trigger, "/s")
    other.create_timer(0.003, lambda: speaker.publish(Int32()))
    other.create_timer(0.007, lambda: client.call_async(Trigger.Request()))
    answered: list[Future] = []
    ask = one.create_client(Trigger, "/other")
    other.create_service(Trigger, "/other", lambda _, response: response)
    world.scheduler.run_for(50 * MS)
    assert set(done) == {"timer", "slept", "heard", "served"}
    # In the very moment in which all of it is under way.
    one.threads(1, "helper").submit(done.append, "thought")
    one.executor.create_task(done.append, "task")
    one.executor.create_task(sleep)
    ask.call_async(Trigger.Request()).add_done_callback(answered.append)
    heard: list[Int32] = []
    other.create_subscription(Int32, "/t", heard.append, 10)
    one.process.kill()
    done.clear()
    publisher.publish(Int32())
    one.create_timer(0.001, lambda: done.append("timer"))
    one.executor.create_task(done.append, "task")
    gc.collect()
    world.scheduler.run_for(30 * SECOND)
    assert done == []
    assert answered == heard == []


def test_the_others_believe_in_it_for_as_long_as_dds_does(world: World) -> None:
    one, other = node_in(world, "one"), node_in(world, "other")
    one.create_publisher(
        Int32, "/t", QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    )
    one.create_subscription(Int32, "/u", print, 10)
    one.create_service(Trigger, "/s", lambda _, response: response)
    publisher, client = other.create_publisher(Int32, "/u", 10), other.create_client(Trigger, "/s")
    assert publisher.wait_for_all_acked(None)
    one.process.kill()
    again = node_in(world, "one")
    again.create_publisher(Int32, "/t", 10)

    def known() -> tuple[int, int, bool, int]:
        return (
            len(other.get_publishers_info_by_topic("/t")),
            publisher.get_subscription_count(),
            client.service_is_ready(),
            [name for name, _ in other.get_node_names_and_namespaces()].count("one"),
        )

    assert 15.0 < LEASE < NAMESAKES, "the watch of publishers waits for longer"
    world.scheduler.run_for(round((LEASE - 0.1) * SECOND))
    assert known() == (2, 1, True, 2)
    assert len({bytes(i.endpoint_gid[:12]) for i in other.get_publishers_info_by_topic("/t")}) == 2
    assert not publisher.wait_for_all_acked(None), "the dead acknowledge nothing"
    world.scheduler.run_for(round(0.2 * SECOND))
    assert known() == (1, 0, False, 1)


def test_one_that_ends_in_order_is_gone_at_once(world: World) -> None:
    one, other = node_in(world, "one"), node_in(world, "other")
    one.create_service(Trigger, "/s", lambda _, response: response)
    client = other.create_client(Trigger, "/s")
    one.process.end()
    assert not client.service_is_ready()
    assert other.get_node_names_and_namespaces() == [("other", "/")]


def test_one_that_is_stopped_goes_on_with_what_waited(world: World) -> None:
    one, other = node_in(world, "one"), node_in(world, "other")
    heard: list[int] = []
    ticks: list[int] = []
    fired: list[int] = []
    one.create_subscription(Int32, "/t", lambda message: heard.append(message.data), 3)
    one.create_timer(0.01, lambda: ticks.append(world.scheduler.now))
    Timers(one).every(0.01, lambda: fired.append(world.scheduler.now))
    publisher = other.create_publisher(Int32, "/t", 10)
    done: list[str] = []
    world.scheduler.run_for(15 * MS)
    one.process.stop()
    thought = one.threads(1, "helper").submit(done.append, "thought")
    for number in range(10):
        publisher.publish(Int32(data=number))
    before = len(ticks), len(fired)
    assert not publisher.wait_for_all_acked(None)
    world.scheduler.run_for(100 * MS)
    assert (heard, done) == ([], [])
    assert (len(ticks), len(fired)) == before
    one.process.go_on()
    world.scheduler.run_for(3 * MS)
    assert heard == [7, 8, 9]
    assert done == ["thought"]
    assert thought.done()
    assert len(ticks) == before[0] + 1, "once for all it missed"
    assert len(fired) - before[1] in (1, 2)


def test_one_that_is_starved_does_everything_slower(world: World) -> None:
    one = VirtualNode(world.process("one", cost=0.001), "one")
    VirtualExecutor(one.process).add_node(one)
    other = node_in(world, "other")
    heard: list[int] = []
    one.create_timer(0.01, lambda: publisher.publish(Int32()))
    publisher = one.create_publisher(Int32, "/t", 10)
    other.create_subscription(Int32, "/t", lambda _: heard.append(world.scheduler.now), 10)
    world.scheduler.run_for(SECOND)
    assert 98 <= len(heard) <= 100
    one.process.slowness = 50.0
    heard.clear()
    world.scheduler.run_for(SECOND)
    assert 18 <= len(heard) <= 20
    assert min(b - a for a, b in pairwise(heard)) > 45 * MS


def test_what_is_sent_leaves_when_the_callback_is_over(world: World) -> None:
    slow = VirtualNode(world.process("slow", cost=0.1), "slow")
    VirtualExecutor(slow.process).add_node(slow)
    other = node_in(world, "other")
    publisher, heard = slow.create_publisher(Int32, "/t", 10), list[int]()
    other.create_subscription(Int32, "/t", lambda _: heard.append(world.scheduler.now), 10)
    begun = world.scheduler.now
    slow.executor.create_task(publisher.publish, Int32())
    world.scheduler.run_for(SECOND)
    [at] = heard
    assert 0.1 * SECOND < at - begun < 0.102 * SECOND


def test_a_callback_that_raises_is_given_to_who_asked_for_it_or_comes_out(world: World) -> None:
    def fail() -> None:
        raise ValueError("as expected")

    told: list[Exception] = []
    one, other = node_in(world, "one"), VirtualNode(world.process("other"), "other")
    VirtualExecutor(other.process, told.append).add_node(other)
    other.executor.create_task(fail)
    world.scheduler.run_for(MS)
    assert [str(error) for error in told] == ["as expected"]
    one.executor.create_task(fail)
    with pytest.raises(ValueError, match="as expected"):
        world.scheduler.run_for(MS)


def test_a_server_forgets_goals_that_ended_long_ago(world: World) -> None:
    async def execute(handle: object) -> PlanPath.Result:
        handle.succeed()  # type: ignore[attr-defined]
        return PlanPath.Result()

    one, other = node_in(world, "one"), node_in(world, "other")
    server = one.create_action_server(
        PlanPath,
        "/a",
        execute,
        goal_callback=lambda _: GoalResponse.ACCEPT,
        cancel_callback=lambda _: CancelResponse.REJECT,
    )
    sent = other.create_action_client(PlanPath, "/a").send_goal_async(PlanPath.Goal())
    world.scheduler.run_for(SECOND)
    goal = sent.result()
    for seconds, status in ((800, 4), (200, 0)):
        world.scheduler.run_for(seconds * SECOND)
        one.executor.create_task(server.expire_goals)
        ended = goal.get_result_async()
        world.scheduler.run_for(SECOND)
        assert ended.result().status == status


def test_nobody_stands_still_for_a_future(world: World) -> None:
    threads = node_in(world, "one").threads(1, "helper")
    future = threads.submit(print)
    for wait in (future.result, future.exception, lambda: threads.map(print, [1])):
        with pytest.raises(RuntimeError, match="in virtual time nobody can stand still"):
            wait()
    threads.shutdown(cancel_futures=True)
    assert future.cancelled()


def test_an_executor_takes_nodes_of_its_own_process_alone(world: World) -> None:
    one, other = node_in(world, "one"), node_in(world, "other")
    with pytest.raises(ValueError, match=r"'one'.*'other'.*of its own process"):
        one.executor.add_node(other)


def test_the_log_is_collected_with_time_and_level(world: World) -> None:
    node = VirtualNode(world.process("one"), "one", "robot")
    world.scheduler.run_for(SECOND)
    for _ in range(3):
        node.get_logger().warning("held back", throttle_duration_sec=5.0)
    node.get_logger().debug("not written")
    node.write_log("error", "written")
    assert [(entry.node, entry.level, entry.text) for entry in world.log] == [
        ("robot.one", "warning", "held back"),
        ("robot.one", "error", "written"),
    ]
    assert world.log[0].time == world.scheduler.now


def test_a_killed_process_lets_go_of_its_files_once() -> None:
    world, gone = World(), list[str]()
    process = world.process("a")
    process.at_death(lambda: gone.append("file"))
    process.kill()
    process.kill()
    assert gone == ["file"]
