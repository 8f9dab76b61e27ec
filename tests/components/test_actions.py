"""Rules reach a component through its services, and through nothing that is not marked."""

import json
from collections.abc import Callable
from typing import Any

import pytest
from automatika_ros_sugar.srv import ExecuteMethod
from geometry_msgs.msg import Point, Pose
from kompass_interfaces.srv import StopRobot

from kompass.components import Component, DriveManager, Planner
from kompass.components.base.actions import component_action
from tests.components.alive import Alive

Run = Callable[..., Alive]


class Worker(Component):
    """A component with actions of every kind."""

    def __init__(self) -> None:
        super().__init__("worker")
        self.steps = 0
        self.configured = 0
        self.slow_begun = False
        self.broken = False

    def custom_on_configure(self) -> None:
        self.configured += 1
        if self.broken:
            raise OSError("the device is gone")

    def _execution_step(self) -> None:
        self.steps += 1

    @component_action
    async def slow(self, *, seconds: float) -> bool:
        """Takes its time."""
        self.slow_begun = True
        await self.sleep(seconds)
        return True

    @component_action(active=True)
    def add(self, a: int, b: int = 1) -> int:
        """Adds."""
        return a + b

    @component_action
    def reach(self, pose: Pose, others: list[Point]) -> list[str]:
        """Tells what it was given."""
        return [type(pose).__name__, f"{pose.position.x}", *(type(p).__name__ for p in others)]

    @component_action
    def fail(self) -> bool:
        """Does not succeed."""
        return False

    @component_action
    def nothing(self) -> None:
        """Returns nothing."""

    @component_action
    def opaque(self) -> object:
        """Returns what JSON cannot carry."""
        return object()

    @component_action
    def raises(self) -> None:
        """Has a defect."""
        raise RuntimeError("no such luck")

    def unmarked(self) -> bool:
        return True


def test_every_component_lists_the_builtin_actions_and_its_own() -> None:
    builtin = {"start", "stop", "restart", "reconfigure", "set_param", "set_params"}
    assert builtin | {"broadcast_status"} <= set(Planner().available_actions)
    assert {"slow", "add"} <= set(Worker().available_actions)
    assert "unmarked" not in Worker().available_actions


def test_an_override_of_an_action_is_an_action() -> None:
    class Other(Worker):
        def add(self, a: int, b: int = 1) -> int:
            return a - b

    assert "add" in Other().available_actions


@pytest.mark.parametrize(
    ("name", "kwargs", "success", "told"),
    [
        ("add", {"a": 2}, True, "3"),
        ("nothing", {}, True, ""),
        ("slow", {"seconds": 0.01}, True, "true"),
        ("add", {"a": 2.0}, True, "3"),
        (
            "reach",
            {"pose": {"position": {"x": 2}}, "others": [{"x": 1.0}, {}]},
            True,
            '["Pose", "2.0", "Point", "Point"]',
        ),
    ],
)
def test_results_travel_as_json(
    run: Run, name: str, kwargs: dict[str, Any], success: bool, told: str
) -> None:
    answer = run(Worker()).execute(name, **kwargs)
    assert (answer.success, answer.response_json, answer.error_msg) == (success, told, "")


@pytest.mark.parametrize(
    ("name", "kwargs", "message"),
    [
        ("fail", {}, "worker.fail did not succeed"),
        ("raises", {}, "no such luck"),
        ("add", {}, r"missing a required argument: 'a'; it takes (a: int, b: int = 1)"),
        ("add", {"a": 1, "c": 2}, "unexpected keyword argument 'c'"),
        ("add", {"a": "1"}, "worker.add: a = '1': it should be a valid integer; it takes (a:"),
        ("add", {"a": 1, "b": 0.5}, "b = 0.5: it should be a valid integer"),
        ("reach", {"pose": {"positoin": {}}, "others": []}, "Pose has no field 'positoin'"),
        ("reach", {"pose": {"position": {"x": "1"}}, "others": []}, "position.x = '1': it is a"),
        ("reach", {"pose": [1.0], "others": []}, "it is no Pose; give its fields by name"),
        ("reach", {"pose": {}, "others": [{"x": None}]}, "others = [{'x': None}]: x = None"),
        ("unmarked", {}, "worker has no action 'unmarked'; known are"),
        ("__init__", {}, "has no action '__init__'"),
    ],
)
def test_what_goes_wrong_is_the_answer(
    run: Run, name: str, kwargs: dict[str, Any], message: str
) -> None:
    answer = run(Worker()).execute(name, **kwargs)
    assert not answer.success
    assert message in answer.error_msg


def test_why_an_action_failed_is_also_told_without_its_name(run: Run) -> None:
    class Blocked(Worker):
        @component_action
        def fail(self) -> bool:
            """Says why it does not succeed."""
            return self.fails("the way is blocked")

    answer = run(Blocked()).execute("fail")
    assert answer.error_msg == "worker.fail did not succeed: the way is blocked"
    assert json.loads(answer.response_json) == {"problem": "the way is blocked"}


def test_a_result_that_is_no_json_is_still_a_success_that_says_so(run: Run) -> None:
    answer = run(Worker()).execute("opaque")
    assert answer.success
    assert "no JSON" in answer.error_msg


@pytest.mark.parametrize("text", ["{", "[1]", "3"])
def test_malformed_arguments_are_an_answer(run: Run, text: str) -> None:
    request = ExecuteMethod.Request(name="nothing", kwargs_json=text)
    answer = run(Worker()).call(ExecuteMethod, "execute_method", request)
    assert not answer.success
    assert text in answer.error_msg


def test_the_loop_and_other_actions_go_on_during_a_long_action(run: Run) -> None:
    worker = Worker()
    alive = run(worker)
    request = ExecuteMethod.Request(name="slow", kwargs_json='{"seconds": 0.6}')
    slow = alive.begin(ExecuteMethod, "execute_method", request)
    alive.wait_until(lambda: worker.slow_begun, 5, "the long action")
    before = worker.steps
    assert alive.execute("add", a=1).success
    assert slow() is None, "the short action waited for the long one"
    alive.wait_until(lambda: slow() is not None, 5, "the end of the long action")
    assert worker.steps - before >= 3


def test_a_restart_configures_anew_and_answers_when_active(run: Run) -> None:
    worker = Worker()
    alive = run(worker)
    alive.wait_until(lambda: worker.steps > 0, 5, "a first step")
    node = worker.node
    assert alive.execute("restart", wait_time=0.1).success
    assert worker.is_active
    assert worker.configured == 2
    assert worker.node is node
    steps = worker.steps
    alive.wait_until(lambda: worker.steps > steps, 5, "steps after the restart")


def test_a_restart_that_fails_says_why_and_can_be_repeated(run: Run) -> None:
    worker = Worker()
    alive = run(worker)
    worker.broken = True
    answer = alive.execute("restart")
    assert not answer.success
    assert "the device is gone" in answer.error_msg
    alive.wait_until(
        lambda: alive.statuses and alive.statuses[-1].status == 2, 5, "the failure's status"
    )
    worker.broken = False
    assert alive.execute("restart").success
    alive.wait_until(lambda: alive.statuses[-1].status == 0, 5, "health")


def test_actions_reach_an_inactive_component_except_those_that_need_it_active(run: Run) -> None:
    alive = run(Worker(), activate=False)
    assert alive.execute("nothing").success
    answer = alive.execute("add", a=1)
    assert not answer.success
    assert "not active; start it" in answer.error_msg
    assert alive.execute("start").success
    assert alive.execute("add", a=1).success
    assert alive.execute("stop").success
    assert not alive.component.is_active
    assert alive.execute("start").success


def test_a_broadcast_publishes_the_status_at_once(run: Run) -> None:
    worker = Worker()
    worker.config.status_rate = 0.1
    alive = run(worker)
    alive.wait_until(lambda: alive.statuses, 5, "the first status")
    count = len(alive.statuses)
    assert alive.execute("broadcast_status").success
    alive.wait_until(lambda: len(alive.statuses) > count, 2, "the broadcast")


def test_a_latched_stop_survives_a_restart_of_the_drive_manager(run: Run) -> None:
    driver = DriveManager()
    alive = run(driver)
    assert alive.call(StopRobot, "stop", StopRobot.Request(operator_name="ava")).success
    assert alive.execute("restart").success
    refused = alive.execute("move_forward", max_distance=0.1)
    assert not refused.success
    assert "ava pressed STOP" in refused.error_msg
