"""What people have ended with STOP or by taking the wheel is over, whoever was away meanwhile."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import closing
from typing import Any

import pytest
from kompass_interfaces.action import PlanPath
from kompass_interfaces.srv import TakeWheel
from rclpy.action import CancelResponse, GoalResponse
from std_msgs.msg import Empty

from kompass.rules.schema.actions import Action, CallService, SendGoal
from kompass.rules.schema.conditions import Received
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table
from kompass.virtual.network import Conditions
from tests.support.hand import Hand
from tests.support.rules import Rules
from tests.support.tester import pose
from tests.support.virtual_robot import VirtualRobot
from tests.support.virtual_time import node_in

ABORTED = 6
HELD = 3.0  # s; who is held for longer is killed


@pytest.fixture
def robot() -> Iterator[VirtualRobot]:
    with closing(VirtualRobot()) as client:
        client.ready()
        yield client


def press_and_release(robot: VirtualRobot) -> None:
    assert robot.stop().success
    robot.wait_until(lambda: robot.speed < 0.01, 3, "a standstill")
    assert robot.release().success


def take_and_give(robot: VirtualRobot) -> None:
    ava = Hand(robot, "ava")
    ava.take()
    robot.wait_until(lambda: robot.speed < 0.01, 3, "a standstill")
    assert ava.ask(TakeWheel.Request.GIVE).success


def ask_for_a_goal(robot: VirtualRobot) -> Any:
    """Ask the planner's action for a goal, whether it answers or not."""
    goal = PlanPath.Goal(goal=pose(0.5, 0.5, 0.0))
    goal.end_tolerance.orientation_error = math.pi
    client = robot.action_client(PlanPath, "/planner/plan_path")
    robot.wait_until(client.server_is_ready, 10, "the planner's action")
    return client.send_goal_async(goal)


def stands(robot: VirtualRobot, seconds: float) -> bool:
    x, y, _ = robot.truth
    return max(math.hypot(at[0] - x, at[1] - y) for at in robot.watch(seconds)) < 0.02


@pytest.mark.parametrize("interrupt", [press_and_release, take_and_give])
@pytest.mark.parametrize("held", [["planner"], ["controller"], ["planner", "controller"]])
def test_who_was_held_meanwhile_does_not_go_on_with_it(
    robot: VirtualRobot, held: list[str], interrupt: Callable[[VirtualRobot], None]
) -> None:
    under_way = robot.send_goal(0.5, 0.5)
    robot.wait_until(lambda: robot.speed > 0.1, 20, "motion")
    for name in held:
        robot.stack.stop(name)
    interrupt(robot)
    assert stands(robot, 0.5)
    for name in held:
        robot.stack.go_on(name)
    assert stands(robot, HELD)
    ended = robot.result(under_way, timeout=5)
    assert ended.status == ABORTED
    assert ended.result.message
    assert robot.result(robot.send_goal(0.5, 0.5)).result.reached_end


@pytest.mark.parametrize("interrupt", [press_and_release, take_and_give])
def test_a_goal_that_waited_for_a_held_planner_is_not_begun_after_the_release(
    robot: VirtualRobot, interrupt: Callable[[VirtualRobot], None]
) -> None:
    assert stands(robot, 0.5)  # the planner has heard of the drive manager
    robot.stack.stop("planner")
    asked = ask_for_a_goal(robot)
    robot.rest(0.2)
    interrupt(robot)
    robot.stack.go_on("planner")
    assert stands(robot, HELD)
    ended = robot.result(asked.result(), timeout=5)
    assert ended.status == ABORTED
    assert "while the planner was held" in ended.result.message
    assert robot.result(robot.send_goal(0.5, 0.5)).result.reached_end


@pytest.mark.parametrize("interrupt", [press_and_release, take_and_give])
def test_the_path_of_a_planner_that_died_is_not_driven_on(
    robot: VirtualRobot, interrupt: Callable[[VirtualRobot], None]
) -> None:
    robot.send_goal(0.5, 0.5)
    robot.wait_until(lambda: robot.speed > 0.1, 20, "motion")
    robot.stack.kill("planner")
    interrupt(robot)
    assert stands(robot, 5.0)


def test_a_goal_that_has_failed_with_its_planner_is_not_driven_to(robot: VirtualRobot) -> None:
    robot.send_goal(0.5, 0.5)
    robot.wait_until(lambda: robot.speed > 0.1, 20, "motion")
    robot.stack.kill("planner")
    robot.wait_until(lambda: robot.speed < 0.01, 5, "a standstill")
    assert robot.distance_to(0.5, 0.5) > 0.5
    assert stands(robot, 3.0)


GO = SendGoal(
    action="/planner/plan_path",
    type="kompass_interfaces/action/PlanPath",
    goal={
        "goal": {"position": {"x": 0.5, "y": 0.5}, "orientation": {"w": 1.0}},
        "end_tolerance": {"orientation_error": 3.1},
    },
)


def when_told_to_go(*actions: Action) -> Table:
    """A rule that does this when somebody says so on ``/go``."""
    told = Received(signal=Signal(topic="/go", type="std_msgs/msg/Empty"))
    rule = Rule(id="go", source="recipe", event=Event(condition=told), actions=actions)
    return Table(rules=(rule,))


# Looked for, for two seconds.
SLOWLY = when_told_to_go(
    CallService(service="/nobody", type="std_srvs/srv/Trigger", on_error="continue"), GO
)


def wait_for(rules: Rules, words: str) -> None:
    """Wait until a firing tells this."""
    told = lambda: any(words in step.text for step in rules.firings)  # noqa: E731
    rules.robot.wait_until(told, 5, words)


@pytest.mark.parametrize("interrupt", [press_and_release, take_and_give])
def test_a_rule_that_fired_before_sets_nothing_in_motion_after_it(
    interrupt: Callable[[VirtualRobot], None],
) -> None:
    with closing(VirtualRobot(table=SLOWLY)) as robot:
        robot.ready()
        go = robot.node.create_publisher(Empty, "/go", 10)
        robot.wait_for_listeners("/go", "monitor")
        rules = Rules(robot)
        go.publish(Empty())
        robot.wait_until(lambda: rules.firings, 5, "a firing")
        interrupt(robot)
        assert stands(robot, 5.0)
        told = [step.text for step in rules.firings]
        assert any("after the rule had fired" in text for text in told), told
        go.publish(Empty())
        robot.wait_until(lambda: robot.speed > 0.1, 20, "motion for who fires anew")


@pytest.mark.parametrize("interrupt", [press_and_release, take_and_give])
def test_a_goal_of_a_rule_whose_server_was_away_when_stop_was_pressed_is_not_sent(
    interrupt: Callable[[VirtualRobot], None],
) -> None:
    table = when_told_to_go(GO.model_copy(update={"action": "/patrol"}))
    with closing(VirtualRobot(table=table)) as robot:
        robot.ready()
        rules = Rules(robot)
        go = robot.node.create_publisher(Empty, "/go", 10)
        robot.wait_for_listeners("/go", "monitor")
        go.publish(Empty())
        robot.rest(0.5)
        interrupt(robot)
        asked: list[Any] = []

        def take(goal: Any) -> GoalResponse:
            asked.append(goal)
            return GoalResponse.ACCEPT

        robot.node.create_action_server(
            *(PlanPath, "/patrol", lambda _: PlanPath.Result()),
            goal_callback=take,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        wait_for(rules, "after the rule had fired")
        assert not asked


@pytest.mark.parametrize("interrupt", [press_and_release, take_and_give])
@pytest.mark.parametrize("under_way", [0.0, 1.0])  # s; the release is heard before or after it
def test_a_rule_whose_event_waited_for_a_held_monitor_sets_nothing_in_motion(
    under_way: float, interrupt: Callable[[VirtualRobot], None]
) -> None:
    with closing(VirtualRobot(table=when_told_to_go(GO))) as robot:
        robot.ready()
        go = node_in(robot.world, "door").create_publisher(Empty, "/go", 10)
        robot.wait_for_listeners("/go", "monitor")
        robot.world.network.set_conditions(Conditions(under_way, under_way), process="door")
        assert stands(robot, 0.5)  # the monitor has heard of the drive manager
        rules = Rules(robot)
        robot.stack.stop("monitor")
        go.publish(Empty())
        robot.rest(0.2)
        interrupt(robot)
        robot.rest(0.2)
        robot.stack.go_on("monitor")
        assert stands(robot, HELD)
        wait_for(rules, "not begun: STOP was pressed, or the wheel taken")
        go.publish(Empty())
        robot.wait_until(lambda: robot.speed > 0.1, 20, "motion for who fires anew")


def test_a_goal_that_a_held_planner_takes_up_too_late_is_called_off() -> None:
    with closing(VirtualRobot(table=when_told_to_go(GO))) as robot:
        robot.ready()
        rules = Rules(robot)
        go = robot.node.create_publisher(Empty, "/go", 10)
        robot.wait_for_listeners("/go", "monitor")
        robot.stack.stop("planner")
        go.publish(Empty())
        robot.rest(2.5)  # the rule waits for two
        robot.stack.go_on("planner")
        wait_for(rules, "no answer from planner/plan_path")
        assert stands(robot, 5.0)
