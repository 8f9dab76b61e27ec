"""Every healing scenario heals: faults of the embedded robot, and rules that answer them."""

import json
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ExecuteMethod
from nav_msgs.msg import Odometry
from rclpy.qos import ReliabilityPolicy, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool

from tests.support.journal import Journal
from tests.support.tester import LATCHED
from tests.support.virtual_robot import VirtualRobot

RECIPE = Path(__file__).parents[1] / "recipes" / "healing_robot.py"
HEALTHY, ALGORITHM, SYSTEM = 0, 1, 3
SUCCEEDED = 4


@pytest.fixture
def robot() -> Iterator[VirtualRobot]:
    with closing(VirtualRobot(RECIPE)) as client:
        for name in ("planner", "controller", "mapper", "drive_manager"):
            client.subscribe(ComponentStatus, f"/{name}/status", LATCHED)
        client.ready()
        yield client


@pytest.fixture
def journal(robot: VirtualRobot) -> Journal:
    return Journal(robot)


def level(robot: VirtualRobot, component: str) -> int:
    message = robot.newest.get(f"/{component}/status")
    return -1 if message is None else int(message.status)


def test_a_start_that_the_map_calls_occupied_is_left_and_the_goal_reached(
    robot: VirtualRobot, journal: Journal
) -> None:
    since, (x, y, _) = journal.mark, robot.truth
    robot.fault("start_occupied")
    robot.wait_until(lambda: not robot.check(-1.5, 0.5).reachable, 5, "a start in an occupied cell")
    handle = robot.send_goal(-1.5, 0.5)
    robot.wait_until(
        lambda: any(step.ok for step in journal.of("planner-status", "done", since)),
        15,
        "a way out",
    )
    assert robot.distance_to(x, y) > 0.1
    ended = robot.result(handle, timeout=40)
    assert ended.status == SUCCEEDED, ended.result.message
    assert robot.contacts == 0


def test_a_blocked_way_restarts_the_planner_and_then_frees_the_robot(
    robot: VirtualRobot, journal: Journal
) -> None:
    """The fast emergency flag counts only together with a latched one, which came long before."""
    speeds: list[float] = []
    robot.node.create_subscription(
        Odometry, "/odometry/filtered", lambda told: speeds.append(told.twist.twist.linear.x), 50
    )
    robot.wait_until(lambda: speeds and speeds[-1] < 0.01, 10, "a standing robot")
    armed = robot.node.create_publisher(Bool, "/test/armed", LATCHED)
    robot.wait_until(lambda: heard(robot, "/test/armed"), 10, "a listener on /test/armed")
    armed.publish(Bool(data=True))
    since = journal.mark
    handle = robot.send_goal(0.5, 0.5)
    robot.wait_until(lambda: robot.speed > 0.15, 15, "motion")
    robot.fault("way_blocked")
    run = journal.done("emergency-stop", since, timeout=15)
    assert run.ok, run.text
    restarted, freed = journal.actions(run)
    assert "planner.restart" in restarted.details["action"]
    assert "drive_manager.move_to_unblock" in freed.details["action"]
    assert freed.stamp - freed.details["seconds"] >= restarted.stamp - 0.01
    assert robot.result(handle, timeout=5).status != SUCCEEDED
    assert robot.contacts == 0
    robot.wait_until(lambda: speeds[-1] < 0.01, 5, "a standing robot")
    armed.publish(Bool(data=False))
    # The edges of "moving and armed", with 50 messages of odometry a second; of two bounds each
    # start is one edge, of one bound there may be some more.
    starts, moving = starts_of(speeds), sum(speed > 0.05 for speed in speeds)
    assert starts >= 1
    robot.wait_until(lambda: len(journal.of("sets-off", "fired", since)) >= starts, 5, "each start")
    assert len(journal.of("sets-off", "fired", since)) == starts
    assert starts <= len(journal.of("odometry-filtered", "fired", since)) <= moving / 5


def heard(robot: VirtualRobot, topic: str) -> bool:
    # The monitor begins with a best-effort reader and changes it once it knows the publisher.
    readers = robot.node.get_subscriptions_info_by_topic(topic)
    return any(r.qos_profile.reliability == ReliabilityPolicy.RELIABLE for r in readers)


def starts_of(speeds: Sequence[float]) -> int:
    """How often the robot set off, by what was measured of its speed [m/s], noise included."""
    starts, moves = 0, False
    for speed in speeds:
        starts += not moves and speed > 0.05
        moves = speed > 0.05 or (moves and speed >= 0.01)
    return starts


def test_a_controller_that_finds_no_way_asks_once_per_delay_to_be_freed(
    robot: VirtualRobot, journal: Journal
) -> None:
    request = ExecuteMethod.Request(
        name="set_algorithm", kwargs_json=json.dumps({"algorithm_value": "DWA"})
    )
    assert robot.call(ExecuteMethod, "/controller/execute_method", request).success
    robot.wait_until(lambda: robot.check(-1.6, -0.5).reachable, 20, "a planner with map and pose")
    handle = robot.send_goal(-1.6, -0.5)
    robot.wait_until(lambda: robot.speed > 0.05, 15, "motion")
    since = journal.mark
    robot.fault("boxed_in")
    robot.wait_until(lambda: level(robot, "controller") == ALGORITHM, 10, "a failure to find a way")
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
        assert again - ended == pytest.approx(1.0, abs=0.05)
    robot.fault("boxed_in", on=False)
    ended = robot.result(handle, timeout=60)
    assert ended.status == SUCCEEDED, ended.result.message


def stream(robot: VirtualRobot, topic: str, message: Any, rate: float, seconds: float) -> None:
    """Publish one message again and again."""
    publisher = robot.node.create_publisher(type(message), topic, LATCHED)
    for _ in range(round(rate * seconds)):
        publisher.publish(message)
        robot.rest(1.0 / rate)
    publisher.publish(type(message)())  # the last word stays, as it is latched


def test_an_unplugged_lidar_is_answered_by_the_fallbacks_up_to_giving_up(
    robot: VirtualRobot, journal: Journal
) -> None:
    robot.subscribe(LaserScan, "/scan", qos_profile_sensor_data)
    robot.wait_until(lambda: "/scan" in robot.newest, 5, "the first scan")
    since = journal.mark
    robot.fault("lidar_unplugged")
    robot.wait_until(lambda: level(robot, "drive_manager") == SYSTEM, 3, "a missing scan")
    assert list(robot.newest["/drive_manager/status"].src_topics) == ["/scan"]
    restarted = journal.done("drive-manager-on-fail", since)
    assert "restart" in journal.actions(restarted)[0].text
    robot.wait_for_line("the mapper misses something", 5)
    robot.wait_for_line("the drive manager is given up", 20)
    robot.fault("lidar_unplugged", on=False)
    robot.wait_until(lambda: level(robot, "drive_manager") == HEALTHY, 5, "health with the scan")
    robot.wait_until(lambda: level(robot, "mapper") == HEALTHY, 5, "health with the scan")
