"""Tests of the base: driven through the gate, recorded, and made into how the base answers."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ExecuteMethod
from kompass_interfaces.action import MotionRecording
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from std_msgs.msg import Bool, Empty, String

from kompass.rules.schema.actions import Action, CallService, Method
from kompass.rules.schema.conditions import Received
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table
from kompass.simulation.physics.robot_model import TURTLEBOT3
from kompass.virtual.network import Conditions
from tests.support.hand import Hand
from tests.support.motion_recipe import motion_recipe
from tests.support.rules import Rules
from tests.support.tester import LATCHED
from tests.support.virtual_robot import VirtualRobot

SUCCEEDED, ABORTED = 4, 6
PERIOD = 2.0  # s
BOUND = 0.03  # s by which delay and time constant together may be off

Make = Callable[..., "TestedRobot"]


class TestedRobot(VirtualRobot):
    """A robot whose base is tested."""

    __test__ = False

    def __init__(self, recipe: Path, *faults: str, **how: Any) -> None:
        super().__init__(recipe, *faults, **how)
        self.subscribe(String, "/motion_server/fit", LATCHED)
        self._recorder = self.action_client(MotionRecording, "/motion_server/motion_recording")
        self.ready()
        self.can_be_tested()

    def begins(self, **kwargs: object) -> Callable[[], Any]:
        """Ask for a test; gives its answer once it is there."""
        request = ExecuteMethod.Request(name="run_test", kwargs_json=json.dumps(kwargs))
        name = "/motion_server/execute_method"
        reply = self._calls.begin(ExecuteMethod, name, request, 300.0)

        def answer() -> Any:
            reply.begin()
            return reply.result() if reply.done() else None

        return answer

    def tests(self, **kwargs: object) -> Any:
        """The answer to a test that is driven."""
        answer = self.begins(**kwargs)
        self.wait_until(answer, 120, "the end of the test")
        return answer()

    def record(self, **goal: Any) -> Any:
        """A goal to record."""
        return self.send(self._recorder, MotionRecording.Goal(**goal))

    def is_moved_by_the_test(self) -> None:
        self.wait_until(
            lambda: self.newest["/drive_state"].manoeuvre == "drive_leg" and self.speed > 0.05,
            20,
            "a leg that is driven",
        )


@pytest.fixture
def made(tmp_path: Path) -> Iterator[Make]:
    with ExitStack() as ending:

        def make(*faults: str, settings: str = "", run_type: str = "Event", **how: Any) -> Any:
            recipe = motion_recipe(tmp_path, PERIOD, settings, run_type)
            return ending.enter_context(closing(TestedRobot(recipe, *faults, **how)))

        yield make


def lag_of_the_base() -> float:
    """What the physics is like: a mass that a speed control of the wheels drives [s]."""
    mass = TURTLEBOT3.body_mass + 2 * TURTLEBOT3.wheel_mass
    return mass * TURTLEBOT3.wheel_radius**2 / (2 * TURTLEBOT3.wheel_gain)


def lateness(axis: dict[str, float]) -> float:
    return axis["delay"] + axis["time_constant"]


def test_both_tests_are_driven_and_tell_how_the_base_answers(made: Make) -> None:
    robot = made()
    began = robot.truth
    answer = robot.tests(step=True, circle=True)
    assert answer.success, answer.error_msg
    told = json.loads(answer.response_json)
    assert set(told["axes"]) == {"vx", "omega"}
    assert "the commands change by 0.000" in told["not_fitted"]["vy"]
    for axis in told["axes"].values():
        assert axis["gain"] == pytest.approx(1.0, abs=0.05)
        assert lateness(axis) == pytest.approx(lag_of_the_base(), abs=BOUND)
        assert axis["explained"] > 0.97
    assert json.loads(robot.newest["/motion_server/fit"].data) == told
    assert robot.contacts == 0
    assert math.dist(began[:2], robot.truth[:2]) < 0.1  # each leg is driven back
    with Path(told["file"]).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert Path(told["file"]).parent == robot.folder / "tested" / "motion"
    assert max(float(row["command_vx"]) for row in rows) == pytest.approx(0.11)
    assert max(float(row["vx"]) for row in rows) == pytest.approx(0.11, abs=0.02)
    assert robot.logged("vx: gain")


def test_the_lateness_that_is_found_is_that_of_the_base_and_not_of_the_odometry(
    made: Make,
) -> None:
    """Commands that are under way for long make a base late; of the readings the stamps count."""
    robot = made()
    late = Conditions(0.1, 0.1)
    robot.world.network.set_conditions(late, process="simulator")
    axes = json.loads(robot.tests(step=True, circle=False).response_json)["axes"]
    for axis in axes.values():
        assert lateness(axis) == pytest.approx(lag_of_the_base() + 0.1, abs=BOUND)
    assert axes["vx"]["max_decel"] < 2.4  # of 2.5, which the recipe states
    robot = made("odometry_late:0.1")
    axes = json.loads(robot.tests(step=True, circle=False).response_json)["axes"]
    assert lateness(axes["vx"]) == pytest.approx(lag_of_the_base(), abs=BOUND)


def test_stop_ends_a_test_and_nothing_of_it_goes_on_after_the_release(made: Make) -> None:
    robot = made()
    answer = robot.begins(step=True, circle=True)
    robot.is_moved_by_the_test()
    assert robot.stop().success
    robot.wait_until(answer, 10, "the end of the test")
    assert "STOP" in answer().error_msg
    robot.wait_until(lambda: robot.newest["/drive_state"].standstill, 5, "standstill")
    assert not robot.tests().success  # and none begins
    assert robot.release().success
    at = robot.truth
    robot.rest(2 * PERIOD)
    assert math.dist(at[:2], robot.truth[:2]) < 0.01


def test_who_takes_the_wheel_has_the_robot_at_once(made: Make) -> None:
    robot = made()
    answer = robot.begins(step=True, circle=False)
    robot.is_moved_by_the_test()
    ava = Hand(robot, "ava")
    robot.wait_until(lambda: ava.ask().success, 20, "the wheel")
    robot.wait_until(answer, 10, "the end of the test")
    assert "ava took the wheel" in answer().error_msg
    assert "ava drives by hand" in robot.tests().error_msg


def test_a_goal_ends_a_test_and_is_reached(made: Make) -> None:
    robot = made()
    answer = robot.begins(step=True, circle=True)
    robot.is_moved_by_the_test()
    handle = robot.send_goal(-0.3, -0.55)
    robot.wait_until(answer, 10, "the end of the test")
    assert "somebody else drives the robot" in answer().error_msg
    robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
    assert "somebody else drives the robot" in robot.tests().error_msg
    assert robot.result(handle, 60).status == SUCCEEDED


def test_what_a_test_lacks_is_told_before_one_is_asked_for(tmp_path: Path) -> None:
    recipe = motion_recipe(tmp_path, PERIOD)
    text = recipe.read_text(encoding="utf-8")
    wired = 'motion.inputs(command=driver.get_out_topic("robot_command"))'
    assert wired in text
    recipe.write_text(
        text.replace(wired, 'motion.inputs(command=Topic(name="/wheels", msg_type="Twist"))')
    )
    with closing(VirtualRobot(recipe)) as robot:
        robot.subscribe(ComponentStatus, "/motion_server/status", LATCHED)
        told = "nobody publishes on /wheels, where commands to the wheels are to be heard"
        status = "/motion_server/status"
        robot.wait_until(
            lambda: status in robot.newest and robot.newest[status].msg.endswith(told), 20, told
        )


def test_without_room_nothing_moves_and_the_room_is_told(made: Make) -> None:
    robot = made()
    at = robot.truth
    robot.fault("way_blocked")
    robot.wait_until(
        lambda: not robot.drive_manager_does("room_for", legs=[[0.11, 0.0, 0.0, 4.0]]),
        10,
        "a scan of the wall",
    )
    answer = robot.tests(step=True, circle=False)
    assert "there is no room: the legs reach" in answer.error_msg
    assert math.dist(at[:2], robot.truth[:2]) < 0.01


def test_a_test_that_something_steps_before_is_held_and_ended_by_the_gate(made: Make) -> None:
    robot = made()
    answer = robot.begins(step=True, circle=False)
    robot.is_moved_by_the_test()
    robot.fault("way_blocked")
    robot.wait_until(answer, 20, "the end of the test")
    assert not answer().success
    assert robot.contacts == 0


def test_a_message_begins_the_test_that_is_set(made: Make) -> None:
    robot = made(settings="run_step_test=True, run_circle_test=False")
    asks = robot.node.create_publisher(Bool, "/run_tests", 10)
    robot.wait_for_listeners("/run_tests", "motion_server")
    asks.publish(Bool(data=False))
    robot.rest(2.0)
    assert robot.newest["/drive_state"].manoeuvre == ""
    asks.publish(Bool(data=True))
    robot.wait_until(lambda: "/motion_server/fit" in robot.newest, 60, "the fit")
    told = json.loads(robot.newest["/motion_server/fit"].data)
    assert told["of"] == "test"
    assert set(told["axes"]) == {"vx", "omega"}


def test_the_death_of_the_motion_server_ends_its_test(made: Make) -> None:
    robot = made()
    robot.begins(step=True, circle=False)
    robot.is_moved_by_the_test()
    robot.stack.kill("motion_server")
    robot.wait_until(lambda: robot.newest["/drive_state"].manoeuvre == "", 1.5, "the end of a leg")
    robot.wait_until(lambda: robot.speed < 0.01, 1.0, "a robot that stands")


def test_a_motion_server_that_is_deactivated_ends_its_test_at_once(made: Make) -> None:
    robot = made()
    robot.begins(step=True, circle=False)
    robot.is_moved_by_the_test()
    request = ChangeState.Request(transition=Transition(id=Transition.TRANSITION_DEACTIVATE))
    assert robot.call(ChangeState, "/motion_server/change_state", request).success
    robot.wait_until(lambda: robot.newest["/drive_state"].manoeuvre == "", 0.5, "the end of a leg")
    robot.wait_until(lambda: robot.speed < 0.01, 1.0, "a robot that stands")


def test_what_a_goal_makes_the_robot_do_is_recorded_when_asked_for(made: Make) -> None:
    robot = made(run_type="ActionServer")
    going = robot.send_goal(-0.3, -0.55)
    goal = robot.record(
        recording_period_secs=4.0, recording_time_step_secs=0.1, csv_file_name="drive"
    )
    assert "a recording is under way" in robot.tests().error_msg
    ended = robot.result(goal)
    assert ended.status == SUCCEEDED, ended.result.message
    assert ended.result.recording_done
    told = json.loads(ended.result.message)
    assert Path(told["file"]) == robot.folder / "tested" / "motion" / "drive.csv"
    assert 30 <= len(Path(told["file"]).read_text().splitlines()) - 1 <= 41
    assert told["axes"]["vx"]["gain"] == pytest.approx(1.0, abs=0.1)
    assert robot.result(going).status == SUCCEEDED


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"recording_period_secs": 0.0}, "recording_period_secs = 0"),
        ({"recording_time_step_secs": 0.0}, "recording_time_step_secs = 0"),
        ({"csv_file_name": "../drive"}, "csv_file_name = '../drive'"),
        ({"csv_file_location": "/etc"}, "csv_file_location = '/etc'"),
    ],
)
def test_a_recording_that_cannot_be_made_is_refused_with_what_is_wrong(
    made: Make, changed: dict[str, Any], told: str
) -> None:
    robot = made(run_type="ActionServer")
    fields = {"recording_period_secs": 1.0, "recording_time_step_secs": 0.1} | changed
    ended = robot.result(robot.record(**fields))
    assert ended.status == ABORTED
    assert not ended.result.recording_done
    assert told in ended.result.message


def test_a_timed_one_keeps_the_newest_stretches_in_which_the_robot_moved(made: Make) -> None:
    robot = made(settings="most_recordings=2", run_type="Timed")
    folder = robot.folder / "tested" / "motion"
    robot.rest(3 * PERIOD)
    assert not list(folder.glob("*.csv"))
    assert robot.result(robot.send_goal(-0.3, -0.55)).status == SUCCEEDED
    robot.wait_until(lambda: len(list(folder.glob("*.csv"))) == 2, 20, "two recordings")
    before = set(folder.glob("*.csv"))
    assert robot.result(robot.send_goal(-2.0, -0.5)).status == SUCCEEDED
    robot.wait_until(lambda: set(folder.glob("*.csv")) != before, 20, "newer ones")
    assert len(list(folder.glob("*.csv"))) == 2


RUN = Method(component="motion_server", method="run_test")


def when_told_to_test(*actions: Action) -> Table:
    """A rule that does this when somebody says so on ``/test``."""
    told = Received(signal=Signal(topic="/test", type="std_msgs/msg/Empty"))
    rule = Rule(id="test", source="recipe", event=Event(condition=told), actions=actions)
    return Table(rules=(rule,))


AT_ONCE = when_told_to_test(RUN)
# Looked for, for two seconds.
SLOWLY = when_told_to_test(
    CallService(service="/nobody", type="std_srvs/srv/Trigger", on_error="continue"), RUN
)


def test_a_rule_that_fired_before_a_stop_begins_no_test_after_it(made: Make) -> None:
    robot = made(table=SLOWLY)
    asks = robot.node.create_publisher(Empty, "/test", 10)
    robot.wait_for_listeners("/test", "monitor")
    rules = Rules(robot)
    asks.publish(Empty())
    robot.wait_until(lambda: rules.firings, 5, "a firing")
    assert robot.stop().success
    assert robot.release().success
    at = robot.truth
    robot.rest(5.0)
    assert math.dist(at[:2], robot.truth[:2]) < 0.01
    asks.publish(Empty())
    robot.is_moved_by_the_test()


def asked_on_its_topic(robot: TestedRobot) -> Callable[[], None]:
    asks = robot.node.create_publisher(Bool, "/run_tests", 10)
    robot.wait_for_listeners("/run_tests", "motion_server")
    return lambda: asks.publish(Bool(data=True))


def asked_by_its_action(robot: TestedRobot) -> Callable[[], None]:
    def ask() -> None:
        robot.begins(step=True)

    return ask


def asked_by_a_rule(robot: TestedRobot) -> Callable[[], None]:
    asks = robot.node.create_publisher(Empty, "/test", 10)
    robot.wait_for_listeners("/test", "monitor")
    return lambda: asks.publish(Empty())


@pytest.mark.parametrize("way", [asked_on_its_topic, asked_by_its_action, asked_by_a_rule])
def test_a_test_that_waited_for_a_held_motion_server_is_not_begun_after_the_release(
    made: Make, way: Callable[[TestedRobot], Callable[[], None]]
) -> None:
    robot = made(settings="run_step_test=True, run_circle_test=False", table=AT_ONCE)
    ask = way(robot)
    robot.stack.stop("motion_server")
    ask()
    robot.rest(0.3)
    assert robot.stop().success
    robot.rest(0.3)
    assert robot.release().success
    at = robot.truth
    robot.stack.go_on("motion_server")
    robot.rest(4.0)
    assert math.dist(at[:2], robot.truth[:2]) < 0.01
    assert robot.logged("meanwhile; ask again") or robot.logged("a person pressed STOP")
    ask()
    robot.is_moved_by_the_test()
