"""A service that says no has not done it: the run fails, and says what the service said."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from automatika_ros_sugar.srv import ChangeParameters, ExecuteMethod
from kompass_interfaces.action import FollowPath
from kompass_interfaces.srv import StopRobot
from nav2_msgs.srv import ClearEntireCostmap, LoadMap
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.action import ActionServer
from std_srvs.srv import SetBool, Trigger

from kompass.monitor.execution.action_runner import ActionRunner
from kompass.monitor.execution.service_refusal import refusal
from kompass.monitor.reporting.alarms import Alarms
from kompass.monitor.reporting.entries import ActionOutcome
from kompass.rclpy_ext.timers import Timers
from kompass.rulebook.permissions import Permissions
from kompass.rules.engine.firing import Firing
from kompass.rules.schema.actions import Action, CallService, Log, Method, SendGoal
from kompass.rules.schema.table import Rule, Severity, Table
from tests.rules.building import received, rule
from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros

LOAD = LoadMap.Response
BAD = SetParametersResult(successful=False, reason="too fast")
GOOD = SetParametersResult(successful=True)


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (Trigger.Response(success=False, message="the door is locked"), "the door is locked"),
        (Trigger.Response(success=False), "success is false"),
        (SetBool.Response(success=True, message="fine"), ""),
        (LOAD(result=LOAD.RESULT_SUCCESS), ""),
        (LOAD(result=LOAD.RESULT_MAP_DOES_NOT_EXIST), "RESULT_MAP_DOES_NOT_EXIST"),
        (LOAD(result=77), "result is 77"),
        (ClearEntireCostmap.Response(), ""),
        (ChangeParameters.Response(success=[True, False], error_msg=["", "no"]), "no"),
        (SetParameters.Response(results=[GOOD, BAD]), "too fast"),
        (SetParameters.Response(results=[GOOD]), ""),
        (SetParametersAtomically.Response(result=BAD), "too fast"),
    ],
)
def test_an_answer_says_no_only_where_custom_says_so(answer: Any, words: str) -> None:
    assert refusal(answer) == words


OWN = rule(received("a"), "r", source="recipe")


class Robot:
    """Actions of a rule, and the services that answer them, on one executor."""

    def __init__(self, spinning: Spinning) -> None:
        self._spinning = spinning
        node = spinning.node
        self.runner = ActionRunner(
            *(
                node,
                spinning.executor,
                Timers(node),
                {},
                Alarms(node, Timers(node), lambda _: None),
            ),
            permissions=Permissions({}, Table()),
            components=(),
            restart_if_stuck=lambda component: False,
        )

    def offer(self, kind: Any, name: str, answer: Callable[[Any], Any]) -> None:
        """A service, that answers what a function makes of the response."""
        self._spinning.node.create_service(kind, name, lambda _, response: answer(response))

    def run(self, *actions: Action, of: Rule = OWN) -> tuple[tuple[bool, str], list[ActionOutcome]]:
        """How a run of these ends, and each of its actions."""
        told: list[ActionOutcome] = []
        more: dict[str, Any] = {"lane": "normal", "severity": Severity.INFO, "actions": actions}
        firing = Firing("r", 1, 0.0, 0.0, "hash", None, None, {}, (), rule=of, **more)
        ended = self._spinning.executor.create_task(self.runner.run, firing, told.append)
        self._spinning.until(ended.done, 20.0)
        result: tuple[bool, str] = ended.result()
        return result, told


@pytest.fixture(scope="module")
def robot(spinning: Spinning) -> Iterator[Robot]:
    made = Robot(spinning)
    yield made
    made.runner.close()


def test_a_service_that_says_no_fails_the_run_and_what_follows_waits(robot: Robot) -> None:
    answers = [LOAD.RESULT_INVALID_MAP_DATA, LOAD.RESULT_SUCCESS]

    def load(response: Any) -> Any:
        response.result = answers.pop(0)
        return response

    robot.offer(LoadMap, "load_map", load)
    call = CallService(service="load_map", type="nav2_msgs/srv/LoadMap", request={}, timeout=15.0)
    (ok, error), told = robot.run(call, Log(text="the map is there"))
    assert (ok, [each.ok for each in told]) == (False, [False])
    assert "load_map says no: RESULT_INVALID_MAP_DATA" in error
    # The next try, after the cooldown of its rule, is a run of its own.
    (ok, error), told = robot.run(call, Log(text="the map is there"))
    assert (ok, error, [each.ok for each in told]) == (True, "", [True, True])


def test_who_does_not_care_goes_on_and_it_is_recorded_all_the_same(robot: Robot) -> None:
    def refuse(response: Any) -> Any:
        response.message = "the lamp is broken"
        return response

    robot.offer(SetBool, "lamp", refuse)
    call = CallService(
        service="lamp", type="std_srvs/srv/SetBool", request={}, timeout=15.0, on_error="continue"
    )
    (ok, error), told = robot.run(call, Log(text="dark"))
    assert (ok, [each.ok for each in told]) == (False, [False, True])
    assert "the lamp is broken" in error


def test_one_that_is_there_with_another_type_is_not_called_absent(robot: Robot) -> None:
    robot.offer(SetBool, "shut_door", lambda response: response)
    for type_name in ("std_srvs/srv/Trigger", "std_srvs/srv/Empty"):
        call = CallService(service="shut_door", type=type_name, request={}, timeout=15.0)
        (ok, error), _ = robot.run(call)
        assert not ok
        assert "the service /shut_door is there, but of type std_srvs/srv/SetBool" in error
        assert f"not {type_name}" in error
    call = CallService(service="no_door", type="std_srvs/srv/Trigger", request={}, timeout=15.0)
    assert "no service no_door within 2 s" in robot.run(call)[0][1]


def test_an_action_that_is_there_with_another_type_is_not_called_absent(
    robot: Robot, spinning: Spinning
) -> None:
    server = ActionServer(spinning.node, FollowPath, "rounds", lambda handle: FollowPath.Result())
    try:
        send = SendGoal(action="rounds", type="kompass_interfaces/action/PlanPath", goal={})
        (ok, error), _ = robot.run(send)
    finally:
        server.destroy()
    assert not ok
    assert "the action /rounds is there, but of type kompass_interfaces/action/FollowPath" in error


def test_a_rule_that_stops_the_robot_says_which_it_is(robot: Robot, spinning: Spinning) -> None:
    pressed: list[str] = []

    def stop(request: StopRobot.Request, response: StopRobot.Response) -> StopRobot.Response:
        pressed.append(request.operator_name)
        response.success = True
        return response

    spinning.node.create_service(StopRobot, "drive_manager/stop", stop)
    call = CallService(
        service="drive_manager/stop", type="kompass_interfaces/srv/StopRobot", timeout=15.0
    )
    named = call.model_copy(update={"request": {"operator_name": "night watch"}})
    walls = OWN.model_copy(update={"name": "Walls"})
    assert robot.run(call, named)[0][0]
    assert robot.run(call, of=walls)[0][0]
    assert pressed == ["rule r", "night watch", "rule Walls"]


def test_why_a_component_failed_is_told_beside_what_it_said(robot: Robot) -> None:
    def fail(response: Any) -> Any:
        response.error_msg = "lamp.shine did not succeed: the bulb is gone"
        response.response_json = '{"problem": "the bulb is gone"}'
        return response

    robot.offer(ExecuteMethod, "lamp/execute_method", fail)
    robot.offer(ExecuteMethod, "stranger/execute_method", lambda response: response)
    _, (known,) = robot.run(Method(component="lamp", method="shine", timeout=15.0))
    assert known.text == "lamp.shine did not succeed: the bulb is gone"
    assert known.problem == "the bulb is gone"
    _, (other,) = robot.run(Method(component="stranger", method="shine", timeout=15.0))
    assert other.problem == other.text == "stranger.shine failed"
