"""Every healing scenario heals: real faults of the embedded robot, and rules that answer them."""

import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any, cast

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from geometry_msgs.msg import PointStamped
from kompass_interfaces.srv import SetFault
from rclpy.qos import ReliabilityPolicy
from std_msgs.msg import Bool, Empty, Int32, UInt32

from kompass_console.cli_error import CliError
from kompass_console.stack import ConsoleListener, run_recipe
from tests.support.journal import Journal
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot
from tests.support.stack import Stack
from tests.support.stranger import Stranger

pytestmark = pytest.mark.ros

RECIPE = Path(__file__).parents[1] / "recipes" / "healing_robot.py"
HEALTHY, ALGORITHM, SYSTEM = 0, 1, 3
SUCCEEDED = 4


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    # A distribution whose bases are driven with stamped commands.
    with closing(
        Stack.simulated("--fault", "map_withheld", recipe=RECIPE, ROS_DISTRO="jazzy")
    ) as running:
        yield running


@pytest.fixture(scope="module")
def robot(stack: Stack) -> Iterator[Robot]:
    with closing(Robot(stack.domain)) as client:
        for name in ("planner", "controller", "mapper", "drive_manager"):
            client.subscribe(ComponentStatus, f"/{name}/status", LATCHED)
        client.ready()
        yield client


SPOKEN = {
    "/test/armed": Bool,
    "/test/clear": Empty,
    "/test/record": Empty,
    "/test/absent": Empty,
    "/test/point": PointStamped,
    "/test/silent": Bool,
    "/test/first": Bool,
    "/test/second": Int32,
}


class Voices:
    """Publishers of the tester on the topics of the rules."""

    def __init__(self, robot: Robot) -> None:
        self._node = robot.node
        self._made = {
            topic: self._node.create_publisher(kind, topic, LATCHED if "armed" in topic else 10)
            for topic, kind in SPOKEN.items()
        }

    def say(self, topic: str, message: Any) -> None:
        """Publish, to a listener that misses nothing."""
        wait_until(lambda: self._heard(topic), 10, f"a reliable listener on {topic}")
        self._made[topic].publish(message)

    def _heard(self, topic: str) -> bool:
        # The monitor begins with a best-effort reader and changes it once it knows the publisher.
        readers = self._node.get_subscriptions_info_by_topic(topic)
        return any(r.qos_profile.reliability == ReliabilityPolicy.RELIABLE for r in readers)


@pytest.fixture(scope="module")
def voices(robot: Robot) -> Voices:
    return Voices(robot)


@pytest.fixture(scope="module")
def journal(robot: Robot, voices: Voices) -> Journal:
    return Journal(robot)


def level(robot: Robot, component: str) -> int:
    message = robot.newest.get(f"/{component}/status")
    return -1 if message is None else int(message.status)


def test_without_a_map_the_planner_has_one_loaded_and_is_healthy(
    stack: Stack, robot: Robot
) -> None:
    wait_until(lambda: level(robot, "planner") == HEALTHY, 5, "a healthy planner")
    # It happens before a tester can listen; the log tells.
    stack.wait_for_line("no-map: call_service map_server/load_map done", 5)
    assert robot.check(-1.5, 0.5).reachable


def test_services_and_actions_of_other_nodes_are_called(
    robot: Robot, journal: Journal, voices: Voices
) -> None:
    robot.subscribe(UInt32, "/global_costmap/times_cleared", LATCHED)
    wait_until(lambda: "/global_costmap/times_cleared" in robot.newest, 5, "the costmap")
    stranger = Stranger(robot)
    try:
        since = journal.mark
        voices.say("/test/clear", Empty())
        assert journal.done("clear", since).ok
        assert robot.newest["/global_costmap/times_cleared"].data == 1
        voices.say("/test/record", Empty())
        recorded = journal.done("record", since)
        assert recorded.ok, recorded.text
        assert [goal.recording_period_secs for goal in stranger.goals] == [0.2]
        assert "recorded" in journal.actions(recorded)[0].text
    finally:
        stranger.close()


def test_an_action_without_a_target_fails_with_the_reason_in_time(
    journal: Journal, voices: Voices
) -> None:
    since, began = journal.mark, time.monotonic()
    voices.say("/test/absent", Empty())
    failed = journal.done("absent", since)
    assert not failed.ok
    assert "nobody/clear" in failed.text
    assert failed.at - began < 4.0


def test_every_way_to_say_each_message_fires_for_each_message(
    robot: Robot, journal: Journal, voices: Voices
) -> None:
    since = journal.mark
    for _ in range(5):
        message = PointStamped()
        message.header.stamp = robot.node.get_clock().now().to_msg()
        before = len(journal.of("point", "done", since))
        voices.say("/test/point", message)
        wait_until(
            lambda: len(journal.of("point", "done", since)) == before + 3,  # noqa: B023
            5,
            "three runs for each message",
        )
    fired = [step.rule for step in journal.of("point", "fired", since)]
    assert sorted(map(fired.count, set(fired))) == [5, 5, 5]


def test_silence_is_not_the_opposite_of_true(journal: Journal, voices: Voices) -> None:
    assert not journal.of("silent", "fired")
    since = journal.mark
    voices.say("/test/silent", Bool(data=False))
    assert journal.done("silent", since).ok


def test_an_edge_is_one_edge_however_often_the_other_topic_speaks(
    journal: Journal, voices: Voices
) -> None:
    since = journal.mark
    voices.say("/test/first", Bool(data=True))
    for number in range(1, 6):
        voices.say("/test/second", Int32(data=number))
    voices.say("/test/clear", Empty())
    journal.done("clear", since)
    assert len(journal.of("test-second", "fired", since)) == 1


def test_processes_are_stopped_for_a_while_and_killed_by_name(stack: Stack, robot: Robot) -> None:
    before = stack.pid_of("mapper")
    robot.fault("stop:mapper", duration=0.4)
    wait_until(lambda: state_of(before) == "T", 2, "a stopped mapper")
    wait_until(lambda: state_of(before) != "T", 3, "a mapper that goes on")
    robot.fault("kill:mapper")
    wait_until(lambda: stack.pid_of("mapper") != before, 5, "another mapper")
    request = SetFault.Request(fault="kill:nobody", on=True)
    refused = robot.call(SetFault, "/simulator/set_fault", request)
    assert not refused.success
    assert "no process 'nobody'" in refused.message
    assert not refused.active


def state_of(pid: int) -> str:
    """The kernel's letter for what a process does; T is stopped."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return ""


@pytest.mark.parametrize(
    ("sim", "order", "remedy"),
    [("hexagon", "boxedin", "did you mean 'boxed_in'?"), (None, "boxed_in", "add --sim")],
)
def test_a_fault_that_cannot_be_had_is_refused_before_anything_starts(
    sim: str | None, order: str, remedy: str
) -> None:
    with pytest.raises(CliError) as refusal:
        run_recipe(RECIPE, cast("ConsoleListener", None), sim, [order])
    assert refusal.value.code == 2
    assert remedy in str(refusal.value)


def test_the_base_is_driven_with_the_commands_of_its_distribution(robot: Robot) -> None:
    def offered() -> set[str]:
        return {info.topic_type for info in robot.node.get_publishers_info_by_topic("/cmd_vel")}

    def taken() -> set[str]:
        return {info.topic_type for info in robot.node.get_subscriptions_info_by_topic("/cmd_vel")}

    wait_until(offered, 10, "who drives the base")
    assert offered() == {"geometry_msgs/msg/TwistStamped"}
    wait_until(lambda: "geometry_msgs/msg/TwistStamped" in taken(), 10, "the base")
