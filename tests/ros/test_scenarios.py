"""Every healing scenario heals: real faults of the embedded robot, and rules that answer them."""

import json
import time
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, cast

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ExecuteMethod
from geometry_msgs.msg import PointStamped
from kompass_interfaces.srv import SetFault
from nav_msgs.msg import Odometry
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


def fault(robot: Robot, name: str, *, on: bool = True, duration: float = 0.0) -> None:
    """Switch a fault, as soon as the simulator has found what it is about."""
    request = SetFault.Request(fault=name, on=on, duration=duration)
    wait_until(
        lambda: robot.call(SetFault, "/simulator/set_fault", request).success, 10, f"fault {name}"
    )


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


def test_a_start_that_the_map_calls_occupied_is_left_and_the_goal_reached(
    robot: Robot, journal: Journal
) -> None:
    since, (x, y, _) = journal.mark, robot.truth
    fault(robot, "start_occupied")
    try:
        wait_until(lambda: not robot.check(-1.5, 0.5).reachable, 5, "a start in an occupied cell")
        handle = robot.send_goal(-1.5, 0.5)
        wait_until(
            lambda: any(step.ok for step in journal.of("planner-status", "done", since)),
            15,
            "a way out",
        )
        assert robot.distance_to(x, y) > 0.1
        ended = robot.result(handle, timeout=40)
        assert ended.status == SUCCEEDED, ended.result.message
        assert robot.contacts == 0
    finally:
        fault(robot, "start_occupied", on=False)


def test_a_blocked_way_restarts_the_planner_and_then_frees_the_robot(
    robot: Robot, journal: Journal, voices: Voices
) -> None:
    """The fast emergency flag counts only together with a latched one, which came long before."""
    speeds: list[float] = []
    robot.node.create_subscription(
        Odometry, "/odometry/filtered", lambda told: speeds.append(told.twist.twist.linear.x), 50
    )
    wait_until(lambda: speeds and speeds[-1] < 0.01, 10, "a standing robot")
    voices.say("/test/armed", Bool(data=True))
    since = journal.mark
    handle = robot.send_goal(0.5, 0.5)
    wait_until(lambda: robot.speed > 0.15, 15, "motion")
    fault(robot, "way_blocked")
    try:
        run = journal.done("emergency-stop", since, timeout=15)
        assert run.ok, run.text
        restarted, freed = journal.actions(run)
        assert "planner.restart" in restarted.details["action"]
        assert "drive_manager.move_to_unblock" in freed.details["action"]
        assert freed.stamp - freed.details["seconds"] >= restarted.stamp - 0.01
        assert robot.result(handle, timeout=5).status != SUCCEEDED
        assert robot.contacts == 0
        wait_until(lambda: speeds[-1] < 0.01, 5, "a standing robot")
    finally:
        fault(robot, "way_blocked", on=False)
        voices.say("/test/armed", Bool(data=False))
    # The edges of "moving and armed", with 50 messages of odometry a second; of two bounds each
    # start is one edge, of one bound there may be some more.
    starts, moving = starts_of(speeds), sum(speed > 0.05 for speed in speeds)
    assert starts >= 1
    wait_until(lambda: len(journal.of("sets-off", "fired", since)) >= starts, 5, "each start")
    assert len(journal.of("sets-off", "fired", since)) == starts
    assert starts <= len(journal.of("odometry-filtered", "fired", since)) <= moving / 5


def starts_of(speeds: Sequence[float]) -> int:
    """How often the robot set off, by what was measured of its speed [m/s], noise included."""
    starts, moves = 0, False
    for speed in speeds:
        starts += not moves and speed > 0.05
        moves = speed > 0.05 or (moves and speed >= 0.01)
    return starts


def test_a_controller_that_finds_no_way_asks_once_per_delay_to_be_freed(
    robot: Robot, journal: Journal, voices: Voices
) -> None:
    request = ExecuteMethod.Request(
        name="set_algorithm", kwargs_json=json.dumps({"algorithm_value": "DWA"})
    )
    assert robot.call(ExecuteMethod, "/controller/execute_method", request).success
    wait_until(lambda: robot.check(-1.6, -0.5).reachable, 20, "a planner with map and pose")
    handle = robot.send_goal(-1.6, -0.5)
    wait_until(lambda: robot.speed > 0.05, 15, "motion")
    since = journal.mark
    fault(robot, "boxed_in")
    try:
        wait_until(lambda: level(robot, "controller") == ALGORITHM, 10, "a failure to find a way")
        assert list(robot.newest["/controller/status"].src_algorithms) == ["DWA"]
        boxed = journal.done("stuck", since)
        assert not boxed.ok
        assert "boxed in" in boxed.text
        since = journal.mark
        stream(robot, "/controller_status", ComponentStatus(status=ALGORITHM), 100.0, 4.0)
        fired = [step.at for step in journal.of("stuck", "fired", since)]
        done = [step.at for step in journal.of("stuck", "done", since)]
        assert 3 <= len(fired) <= 4
        for ended, again in zip(done, fired[1:], strict=False):
            assert again - ended == pytest.approx(1.0, abs=0.25)
    finally:
        fault(robot, "boxed_in", on=False)
    ended = robot.result(handle, timeout=60)
    assert ended.status == SUCCEEDED, ended.result.message


def stream(robot: Robot, topic: str, message: Any, rate: float, seconds: float) -> None:
    """Publish one message again and again."""
    publisher = robot.node.create_publisher(type(message), topic, LATCHED)
    begin = time.monotonic()
    for turn in range(round(rate * seconds)):
        publisher.publish(message)
        time.sleep(max(0.0, begin + (turn + 1) / rate - time.monotonic()))
    # The last word stays, as it is latched. The publisher goes with the node: the executor of
    # another thread must not lose it under its hands.
    publisher.publish(type(message)())


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


def test_an_unplugged_lidar_is_answered_by_the_fallbacks_up_to_giving_up(
    stack: Stack, robot: Robot, journal: Journal
) -> None:
    since = journal.mark
    fault(robot, "lidar_unplugged")
    try:
        wait_until(lambda: level(robot, "drive_manager") == SYSTEM, 3, "a missing scan")
        assert list(robot.newest["/drive_manager/status"].src_topics) == ["/scan"]
        restarted = journal.done("drive-manager-on-fail", since)
        assert "restart" in journal.actions(restarted)[0].text
        stack.wait_for_line("the mapper misses something", 5)
        stack.wait_for_line("the drive manager is given up", 20)
    finally:
        fault(robot, "lidar_unplugged", on=False)
    wait_until(lambda: level(robot, "drive_manager") == HEALTHY, 5, "health with the scan")
    wait_until(lambda: level(robot, "mapper") == HEALTHY, 5, "health with the scan")


def test_processes_are_stopped_for_a_while_and_killed_by_name(stack: Stack, robot: Robot) -> None:
    before = stack.pid_of("mapper")
    fault(robot, "stop:mapper", duration=0.4)
    wait_until(lambda: state_of(before) == "T", 2, "a stopped mapper")
    wait_until(lambda: state_of(before) != "T", 3, "a mapper that goes on")
    fault(robot, "kill:mapper")
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
    offered = robot.node.get_publishers_info_by_topic("/cmd_vel")
    assert {info.topic_type for info in offered} == {"geometry_msgs/msg/TwistStamped"}
    readers = robot.node.get_subscriptions_info_by_topic("/cmd_vel")
    assert "geometry_msgs/msg/TwistStamped" in {info.topic_type for info in readers}
