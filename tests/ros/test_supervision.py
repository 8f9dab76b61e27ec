"""What dies, hangs or goes blind on a driving robot is noticed in time, answered, and mended."""

import json
import os
import signal
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ChangeParameter
from kompass_interfaces.msg import StackState
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from kompass.rulebook.schema.journal import FiringRecord
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot
from tests.support.rules import Rules
from tests.support.stack import Stack

pytestmark = pytest.mark.ros

RECIPE = Path(__file__).parents[1] / "recipes" / "supervised_robot.py"
HEALTHY, COMPONENT, SYSTEM = 0, 2, 3
SUCCEEDED = 4
INPUTS = {"/scan_of_the_mapper", "/odometry/filtered"}  # of the mapper
# Places to drive to and fro between, with room all around.
PLACES = ((-1.5, 0.3), (-1.5, -0.4))


def starved(firing: FiringRecord) -> bool:
    """Whether it answered inputs that did not come, and nothing else."""
    message = firing.message
    assert isinstance(message, dict)
    late = message["src_topics"]
    assert isinstance(late, list)
    return message["status"] == SYSTEM and late != [] and set(late) <= INPUTS


class Watched(Robot):
    """A robot whose rules and processes are watched; it lends its scan to the mapper."""

    def __init__(self, stack: Stack) -> None:
        super().__init__(stack.domain)
        self.stack = stack
        self.rules = Rules(self)
        self.blind = False
        self._goals = 0
        scans = self.node.create_publisher(
            LaserScan, "/scan_of_the_mapper", qos_profile_sensor_data
        )
        self.node.create_subscription(
            LaserScan,
            "/scan",
            lambda scan: None if self.blind else scans.publish(scan),
            qos_profile_sensor_data,
        )
        self.subscribe(StackState, "/monitor/stack_state", LATCHED)
        for name in ("mapper", "controller", "planner"):
            self.subscribe(ComponentStatus, f"/{name}/status", LATCHED)

    def state(self, name: str) -> str:
        """Of a process, as the supervisor tells it."""
        stack = self.newest.get("/monitor/stack_state")
        found = [one.state for one in stack.processes if one.name == name] if stack else []
        return found[0] if found else ""

    def level(self, name: str) -> int:
        """Of a component, as its status says."""
        message = self.newest.get(f"/{name}/status")
        return -1 if message is None else int(message.status)

    def fired(self, since: float, level: int) -> list[FiringRecord]:
        """What the journal has of the rule on the mapper since a time [s since the epoch].

        On a machine that is starved a mapper that has come back may be without its inputs for half
        a second. That is another failure, and answered: of a mapper that died it does not count.
        """
        found = [
            entry
            for entry in self.rules.journal()
            if entry.kind == "firing" and "mapper" in entry.rule_id and entry.time >= since
        ]
        return found if level == SYSTEM else [one for one in found if not starved(one)]

    def drive_somewhere(self) -> Any:
        """A goal under way, with the local map in use."""
        request = ChangeParameter.Request(
            name="use_direct_sensor", value=json.dumps(False), keep_alive=True
        )
        answer = self.call(ChangeParameter, "/controller/update_config_parameter", request)
        assert answer.success, answer.error_msg
        wait_until(lambda: self.level("mapper") == HEALTHY, 15, "a healthy mapper")
        handle = self.send_goal(*PLACES[self._goals % 2])
        self._goals += 1
        wait_until(lambda: self.speed > 0.1, 20, "motion")
        wait_until(lambda: self.level("mapper") == HEALTHY, 5, "a healthy mapper still")
        return handle

    def drives_on(self, handle: Any, began: float, within: float, level: int) -> None:
        """The rule fired once, in time; the robot goes on with the scan and arrives."""
        wait_until(lambda: self.fired(began, level), 5, "the rule's firing")
        ended = self.result(handle)
        assert ended.status == SUCCEEDED, ended.result.message
        (firing,) = self.fired(began, level)
        assert isinstance(firing.message, dict)
        assert firing.message["status"] == level
        assert firing.time - began <= patient(within)
        assert firing.ok, firing.error
        assert self.contacts == 0


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    with closing(Stack.simulated(recipe=RECIPE)) as running:
        yield running


@pytest.fixture(scope="module")
def robot(stack: Stack) -> Iterator[Watched]:
    with closing(Watched(stack)) as client:
        client.ready()
        yield client


def test_a_killed_mapper_is_answered_within_half_a_second(stack: Stack, robot: Watched) -> None:
    handle = robot.drive_somewhere()
    began = time.time()
    os.kill(stack.pid_of("mapper"), signal.SIGKILL)
    robot.drives_on(handle, began, within=0.5, level=COMPONENT)
    wait_until(lambda: robot.state("mapper") == "active", 10, "the mapper's second life")
    assert robot.level("mapper") == HEALTHY


def test_a_stopped_mapper_is_answered_within_a_second_and_may_go_on(
    stack: Stack, robot: Watched
) -> None:
    handle = robot.drive_somewhere()
    pid = stack.pid_of("mapper")
    began = time.time()
    os.kill(pid, signal.SIGSTOP)
    try:
        wait_until(lambda: robot.state("mapper") == "stuck", 2, "word of the stuck mapper")
        wait_until(lambda: robot.level("mapper") == COMPONENT, 2, "word on its status topic")
    finally:
        os.kill(pid, signal.SIGCONT)
    wait_until(lambda: robot.state("mapper") == "active", 3, "word of its recovery")
    robot.drives_on(handle, began, within=1.0, level=COMPONENT)
    assert stack.pid_of("mapper") == pid


def test_monitor_and_console_come_back_while_the_robot_drives_on(
    stack: Stack, robot: Watched
) -> None:
    handle = robot.drive_somewhere()
    killed, hung = stack.pid_of("monitor"), stack.pid_of("console")
    os.kill(killed, signal.SIGKILL)
    os.kill(hung, signal.SIGSTOP)
    wait_until(lambda: stack.pid_of("monitor") != killed, 10, "another monitor")
    stack.wait_for_line("console is killed: it was stuck", 10)
    wait_until(lambda: robot.state("console") == "active", 20, "another console")
    ended = robot.result(handle)
    assert ended.status == SUCCEEDED, ended.result.message


def test_a_hung_monitor_is_noticed_though_nobody_can_speak_for_it(
    stack: Stack, robot: Watched
) -> None:
    hung = stack.pid_of("monitor")
    os.kill(hung, signal.SIGSTOP)
    stack.wait_for_line("monitor is killed: it was stuck", 10)
    wait_until(lambda: stack.pid_of("monitor") != hung, 10, "another monitor")
    robot.newest.pop("/monitor/stack_state")
    wait_until(lambda: robot.state("monitor") == "active", 15, "its word")
    assert {robot.state(name) for name in ("planner", "controller", "mapper")} == {"active"}


def test_a_supervisor_that_is_held_by_a_signal_is_told_of_until_it_goes_on(
    stack: Stack, robot: Watched
) -> None:
    robot.subscribe(String, "/monitor/alarms", LATCHED)

    def alarms() -> list[str]:
        message = robot.newest.get("/monitor/alarms")
        told = json.loads(message.data) if message else []
        return [each["text"] for each in told if each["name"] == "supervisor-silent"]

    stack.process.send_signal(signal.SIGSTOP)
    try:
        wait_until(alarms, 10, "an alarm")
    finally:
        stack.process.send_signal(signal.SIGCONT)
    assert "what dies or hangs is not started again" in alarms()[0]
    wait_until(lambda: not alarms(), 5, "the end of the alarm")


def test_a_fallback_restarts_what_hangs_before_the_supervisor_loses_patience(
    stack: Stack, robot: Watched
) -> None:
    hung = stack.pid_of("planner")
    os.kill(hung, signal.SIGSTOP)
    stack.wait_for_line("planner is killed: a restart was asked for", 5)
    wait_until(lambda: stack.pid_of("planner") != hung, 10, "another planner")
    wait_until(lambda: robot.state("planner") == "active", 10, "its word")
    # What is asked before it is found goes to the dead one, whom DDS remembers for a while.
    robot.newest.pop("/planner/status", None)
    wait_until(lambda: robot.level("planner") == HEALTHY, 20, "a planner with map and pose")
    wait_until(
        lambda: robot.node.get_node_names().count("planner") == 1, 40, "the dead one forgotten"
    )


def test_a_blind_mapper_is_answered_within_a_second(robot: Watched) -> None:
    # By the third monitor of this stack: it knows its rules.
    handle = robot.drive_somewhere()
    began = time.time()
    robot.blind = True
    robot.drives_on(handle, began, within=1.0, level=SYSTEM)
    assert robot.level("mapper") == SYSTEM
    assert list(robot.newest["/mapper/status"].src_topics) == ["/scan_of_the_mapper"]
    robot.blind = False
    wait_until(lambda: robot.level("mapper") == HEALTHY, 3, "health")
    assert list(robot.newest["/mapper/status"].src_topics) == []
