"""Over DDS the embedded robot looks like a real base, and obeys like one."""

import contextlib
import functools
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import pytest

from tests.support.domains import next_domain
from tests.support.patience import patient

pytestmark = [
    pytest.mark.ros,
    # rclpy loads its message generator, and with it a parser that imports a deprecated module.
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]

DEADLINE = 15.0

STREAMS = {
    "/odometry/filtered": "nav_msgs/msg/Odometry",
    "/odom": "nav_msgs/msg/Odometry",
    "/simulator/ground_truth": "nav_msgs/msg/Odometry",
    "/scan": "sensor_msgs/msg/LaserScan",
    "/imu": "sensor_msgs/msg/Imu",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/simulator/rate": "std_msgs/msg/Float32",
}
LATCHED = {
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/robot_description": "std_msgs/msg/String",
    "/simulator/contacts": "std_msgs/msg/UInt32",
    "/simulator/person_contacts": "std_msgs/msg/UInt32",
}
BEST_EFFORT = {"/scan", "/imu"}


@dataclass
class Observer:
    """Another process' view of the robot."""

    node: Any
    executor: Any
    newest: dict[str, Any] = field(default_factory=dict)
    count: dict[str, int] = field(default_factory=dict)

    def listen(self, message_type: type[Any], topic: str, profile: Any) -> None:
        self.count[topic] = 0

        def store(message: Any) -> None:
            self.newest[topic] = message
            self.count[topic] += 1

        self.node.create_subscription(message_type, topic, store, profile)

    def until(self, reached: Callable[[], bool], what: str, seconds: float = DEADLINE) -> None:
        """Handle messages until `reached`."""
        end = time.monotonic() + patient(seconds)
        while not reached():
            assert time.monotonic() < end, f"not within {seconds} s: {what}"
            self.executor.spin_once(timeout_sec=0.05)

    def listen_for(self, seconds: float) -> float:
        """Handle messages for about `seconds`; returns how long it really was."""
        began = time.monotonic()
        while time.monotonic() - began < seconds:
            self.executor.spin_once(timeout_sec=0.05)
        return time.monotonic() - began

    @property
    def position(self) -> tuple[float, float]:
        place = self.newest["/simulator/ground_truth"].pose.pose.position
        return place.x, place.y

    @property
    def speed(self) -> float:
        return float(self.newest["/simulator/ground_truth"].twist.twist.linear.x)


@functools.cache
def domain(robot: str) -> int:
    """Of one of the robots of these tests."""
    return next_domain()


@contextlib.contextmanager
def ros_node(name: str, robot: str = "shared") -> Iterator[tuple[Any, Any]]:
    """A node with its executor, on the domain of a robot."""
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.signals import SignalHandlerOptions

    context = rclpy.Context()
    rclpy.init(
        args=[],
        context=context,
        domain_id=domain(robot),
        signal_handler_options=SignalHandlerOptions.NO,
    )
    with contextlib.ExitStack() as undo:
        undo.callback(context.try_shutdown)
        node = rclpy.create_node(name, context=context)
        undo.callback(node.destroy_node)
        executor = SingleThreadedExecutor(context=context)
        undo.callback(executor.shutdown)
        executor.add_node(node)
        yield node, executor


def environment(robot: str = "shared") -> dict[str, str]:
    return {
        **os.environ,
        "ROS_DOMAIN_ID": str(domain(robot)),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "PYTHONUNBUFFERED": "1",
    }


# As the launcher does it: a parent without threads, MuJoCo or ROS forks, the child runs the robot.
FORK = """
import os, sys, threading
from kompass.simulation.node import run_simulator
from kompass.simulation.worlds.registry import world
assert threading.active_count() == len(os.listdir("/proc/self/task")) == 1
assert "mujoco" not in sys.modules and "rclpy" not in sys.modules
child = os.fork()
if child == 0:
    run_simulator(world("hexagon"), seed=1, node_name="robot_under_test")
    os._exit(0)
print(child, flush=True)
_, status = os.waitpid(child, 0)
sys.exit(os.waitstatus_to_exitcode(status) != 0)
"""


@pytest.fixture(scope="module")
def simulator() -> Iterator[int]:
    """Process id of a forked simulator; checks afterwards that SIGTERM ends it cleanly."""
    with subprocess.Popen(
        [sys.executable, "-c", FORK],
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as parent:
        assert parent.stdout is not None
        assert parent.stderr is not None
        child = int(parent.stdout.readline())
        yield child
        told = time.monotonic()
        os.kill(child, signal.SIGTERM)
        assert parent.wait(timeout=patient(5.0)) == 0
        assert time.monotonic() - told < patient(1.0)
        assert "Traceback" not in parent.stderr.read()


@pytest.fixture
def observer(simulator: int) -> Iterator[Observer]:
    from nav_msgs.msg import Odometry
    from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
    from sensor_msgs.msg import Imu, LaserScan
    from std_msgs.msg import Float32, String, UInt32
    from tf2_msgs.msg import TFMessage

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    with ros_node("observer") as (node, executor):
        watch = Observer(node, executor)
        for topic in ("/odometry/filtered", "/odom", "/simulator/ground_truth"):
            watch.listen(Odometry, topic, QoSProfile(depth=100))
        watch.listen(LaserScan, "/scan", qos_profile_sensor_data)
        watch.listen(Imu, "/imu", qos_profile_sensor_data)
        watch.listen(TFMessage, "/tf", QoSProfile(depth=100))
        watch.listen(Float32, "/simulator/rate", QoSProfile(depth=10))
        watch.listen(TFMessage, "/tf_static", latched)
        watch.listen(String, "/robot_description", latched)
        for topic in ("/simulator/contacts", "/simulator/person_contacts"):
            watch.listen(UInt32, topic, latched)
        watch.until(
            lambda: all(topic in watch.newest for topic in (*STREAMS, *LATCHED)),
            f"a message on each of {[*STREAMS, *LATCHED]}",
        )
        yield watch


def test_every_topic_has_its_type_and_quality_of_service(observer: Observer) -> None:
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

    infos = observer.node.get_publishers_info_by_topic

    def named(topic: str) -> bool:
        return [info.node_name for info in infos(topic)] == ["robot_under_test"]

    # What a node is called arrives after its publishers, and after its first messages.
    observer.until(lambda: all(map(named, STREAMS | LATCHED)), "publishers, all of the robot")
    for topic, type_name in (STREAMS | LATCHED).items():
        (info,) = infos(topic)
        assert info.topic_type == type_name
        reliable = info.qos_profile.reliability == ReliabilityPolicy.RELIABLE
        assert reliable == (topic not in BEST_EFFORT), topic
        latched = info.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
        assert latched == (topic in LATCHED), topic


def test_messages_come_at_their_rates(observer: Observer) -> None:
    rates = dict.fromkeys(STREAMS, 50.0) | {"/scan": 10.0, "/simulator/rate": 1.0}
    before = dict(observer.count)
    elapsed = observer.listen_for(4.0)
    for topic, rate in rates.items():
        expected = rate * elapsed
        received = observer.count[topic] - before[topic]
        # One message more or less belongs to where the interval happens to begin and end; ten more
        # may have waited for a reader that had no turn before.
        assert expected / patient(1.18) - 1 <= received <= 1.1 * expected + 11, topic
    assert 1 / patient(1.1) < observer.newest["/simulator/rate"].data < 1.1


def test_messages_are_filled_in_completely(observer: Observer) -> None:
    scan = observer.newest["/scan"]
    assert scan.header.frame_id == "LDS-01"
    assert len(scan.ranges) == 360
    assert scan.angle_min == 0.0
    assert scan.angle_increment == pytest.approx(math.tau / 360)
    assert scan.angle_max == pytest.approx(359 * math.tau / 360)
    assert (scan.range_min, scan.range_max) == pytest.approx((0.12, 3.5))
    assert scan.scan_time == pytest.approx(0.1)
    assert any(math.isinf(value) for value in scan.ranges)
    assert abs(time.time() - scan.header.stamp.sec) < 10.0

    frames = {"/odometry/filtered": "map", "/odom": "odom", "/simulator/ground_truth": "map"}
    for topic, frame in frames.items():
        assert observer.newest[topic].header.frame_id == frame
        assert observer.newest[topic].child_frame_id == "base_link"
    assert all(observer.newest["/odometry/filtered"].pose.covariance[k] > 0 for k in (0, 7, 35))
    assert not any(observer.newest["/simulator/ground_truth"].pose.covariance)

    imu = observer.newest["/imu"]
    assert imu.header.frame_id == "imu_link"
    assert imu.linear_acceleration.z == pytest.approx(9.81, abs=0.3)
    assert all(imu.angular_velocity_covariance[k] > 0 for k in (0, 4, 8))


def test_transforms_lead_from_the_map_to_every_sensor(observer: Observer) -> None:
    static = observer.newest["/tf_static"].transforms
    heights = {
        (item.header.frame_id, item.child_frame_id): item.transform.translation.z for item in static
    }
    assert heights == {
        ("base_link", "LDS-01"): pytest.approx(0.17),
        ("base_link", "imu_link"): pytest.approx(0.07),
    }
    moving = observer.newest["/tf"].transforms
    links = {(item.header.frame_id, item.child_frame_id): item for item in moving}
    assert set(links) == {("map", "odom"), ("odom", "base_link")}
    correction = links["map", "odom"].transform
    step = links["odom", "base_link"].transform
    yaw = 2 * math.atan2(correction.rotation.z, correction.rotation.w)
    x = correction.translation.x
    x += math.cos(yaw) * step.translation.x - math.sin(yaw) * step.translation.y
    y = correction.translation.y
    y += math.sin(yaw) * step.translation.x + math.cos(yaw) * step.translation.y
    assert math.dist((x, y), observer.position) < 0.05


@pytest.mark.parametrize("stamped", [True, False], ids=["TwistStamped", "Twist"])
def test_drives_by_either_type_of_command_and_stops_without(
    observer: Observer, stamped: bool
) -> None:
    from geometry_msgs.msg import Twist, TwistStamped
    from rclpy.qos import QoSProfile

    command = TwistStamped() if stamped else Twist()
    (command.twist if stamped else command).linear.x = 0.2
    began = observer.position
    with ros_node("driver") as (driver, _):
        publisher = driver.create_publisher(type(command), "/cmd_vel", QoSProfile(depth=10))

        def driven() -> bool:
            publisher.publish(command)
            return math.dist(began, observer.position) > 0.15

        observer.until(driven, "0.15 m driven")
    observer.until(lambda: abs(observer.speed) < 1e-3, "standstill without commands", seconds=2.0)
    assert observer.newest["/simulator/contacts"].data == 0


def test_silent_publisher_of_the_other_type_does_not_hold_the_robot(observer: Observer) -> None:
    from geometry_msgs.msg import Twist, TwistStamped
    from rclpy.qos import QoSProfile

    with ros_node("silent") as (silent, _), ros_node("driver") as (driver, _):
        ghost = silent.create_publisher(TwistStamped, "/cmd_vel", QoSProfile(depth=10))
        observer.until(lambda: ghost.get_subscription_count() > 0, "a reader of TwistStamped")
        publisher = driver.create_publisher(Twist, "/cmd_vel", QoSProfile(depth=10))
        command = Twist()
        command.linear.x = -0.1

        def driving() -> bool:
            publisher.publish(command)
            return observer.speed < -0.09

        observer.until(driving, "the publisher that speaks to be obeyed")


def test_command_that_is_no_number_is_ignored(observer: Observer) -> None:
    from geometry_msgs.msg import Twist
    from rclpy.qos import QoSProfile

    with ros_node("driver") as (driver, _):
        publisher = driver.create_publisher(Twist, "/cmd_vel", QoSProfile(depth=10))
        command = Twist()
        command.linear.x = math.nan
        observer.until(lambda: publisher.get_subscription_count() > 0, "a reader of Twist")
        publisher.publish(command)
        command.linear.x = 0.1

        def driving() -> bool:
            publisher.publish(command)
            return observer.speed > 0.09

        observer.until(driving, "the next good command to be obeyed")


def test_touching_the_wall_is_announced_at_once(observer: Observer) -> None:
    from geometry_msgs.msg import Twist
    from rclpy.qos import QoSProfile

    before = observer.newest["/simulator/contacts"].data
    with ros_node("driver") as (driver, _):
        publisher = driver.create_publisher(Twist, "/cmd_vel", QoSProfile(depth=10))
        command = Twist()
        command.linear.x = -0.3

        def touched() -> bool:
            publisher.publish(command)
            return bool(observer.newest["/simulator/contacts"].data > before)

        observer.until(touched, "a contact")
        # The wall behind the start, where the shell of 0.10 m meets it at y = -0.5 m. The odometry
        # is another topic: on a busy machine it may be read a moment after the contact.
        observer.until(
            lambda: observer.position[0] == pytest.approx(-2.37, abs=0.03),
            "the robot to be where the wall is",
        )


def test_unknown_world_is_one_clear_line() -> None:
    result = subprocess.run(
        [sys.executable, "-m", "kompass.simulation", "moon"],
        env=environment(),
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
    )
    assert result.returncode == 2
    assert "invalid choice: 'moon'" in result.stderr
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=["SIGTERM", "SIGINT"])
def test_a_signal_ends_it_in_its_order(number: signal.Signals) -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "kompass.simulation", "hexagon", "--node-name", "short_lived"],
        env=environment("short-lived"),
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stderr is not None
        while "robot in 'hexagon'" not in process.stderr.readline():
            assert process.poll() is None
        process.send_signal(number)
        try:
            assert process.wait(timeout=patient(5.0)) == 0
        finally:
            process.kill()
        assert "Traceback" not in process.stderr.read()


@contextlib.contextmanager
def watched(name: str, *options: str) -> Iterator[tuple[subprocess.Popen[str], Any, Observer]]:
    """A robot of its own, with a node that watches it; it is ended with the block."""
    with (
        subprocess.Popen(
            [sys.executable, "-m", "kompass.simulation", "hexagon", "--node-name", name, *options],
            env=environment(name),
            stderr=subprocess.PIPE,
            text=True,
        ) as process,
        ros_node("timekeeper", name) as (node, executor),
    ):
        try:
            yield process, node, Observer(node, executor)
        finally:
            process.terminate()


def test_that_the_machine_is_too_busy_is_said_once_a_minute_and_leaves_room_in_the_log() -> None:
    from rclpy.qos import QoSProfile
    from std_msgs.msg import Float32

    begun = time.monotonic()
    with watched("held_up") as (process, node, watch):
        rates: list[float] = []
        node.create_subscription(
            Float32, "/simulator/rate", lambda rate: rates.append(rate.data), QoSProfile(depth=10)
        )
        watch.until(lambda: len(rates) > 0, "a rate")
        for _ in range(3):
            process.send_signal(signal.SIGSTOP)
            time.sleep(1.0)  # for which it is held up
            process.send_signal(signal.SIGCONT)
            rates.clear()
            watch.until(lambda: any(rate < 0.9 for rate in rates), "a rate that tells of it")
        process.terminate()
        assert process.stderr is not None
        said = process.stderr.read().count("the machine is too busy for it")
        assert 1 <= said <= 1 + (time.monotonic() - begun) // 60


def test_late_sensors_publish_old_stamps_and_what_is_in_time_is_not_held_up() -> None:
    from nav_msgs.msg import Odometry
    from rclpy.qos import QoSProfile, qos_profile_sensor_data
    from sensor_msgs.msg import LaserScan
    from tf2_msgs.msg import TFMessage

    faults = ("scan_late:0.5", "odometry_late:0.3")
    options = (word for fault in faults for word in ("--fault", fault))
    with watched("late", *options) as (_, node, watch):
        ages: dict[str, list[float]] = {}

        def keep(topic: str, stamp: Any) -> None:
            elapsed = node.get_clock().now().nanoseconds - stamp.sec * 1e9 - stamp.nanosec
            ages.setdefault(topic, []).append(elapsed / 1e9)

        def listen(message_type: type[Any], topic: str, profile: Any) -> None:
            def heard(message: Any) -> None:
                first = message.transforms[0] if topic == "/tf" else message
                keep(topic, first.header.stamp)

            node.create_subscription(message_type, topic, heard, profile)

        expected = {
            "/scan": 0.5,
            "/odometry/filtered": 0.3,
            "/odom": 0.3,
            "/tf": 0.3,
            "/simulator/ground_truth": 0.0,
        }
        listen(LaserScan, "/scan", qos_profile_sensor_data)
        for topic in ("/odometry/filtered", "/odom", "/simulator/ground_truth"):
            listen(Odometry, topic, QoSProfile(depth=100))
        listen(TFMessage, "/tf", QoSProfile(depth=100))
        watch.until(
            lambda: all(len(ages.get(topic, ())) >= 10 for topic in expected),
            f"ten messages on each of {list(expected)}",
        )
        # What the machine adds by being busy comes on top; the quickest of ten has little of it.
        for topic, age in expected.items():
            assert age - 0.01 < min(ages[topic]) < age + 0.2, topic
