"""Rules reach the components of a running stack, and the robot drives on meanwhile."""

import json
import math
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ChangeParameter, ExecuteMethod

from tests.support.tester import LATCHED
from tests.support.virtual_robot import VirtualRobot

RECIPE = Path(__file__).parents[1] / "recipes" / "tutorial_robot.py"
HEALTHY, ALGORITHM, SYSTEM = 0, 1, 3
SUCCEEDED, ABORTED = 4, 6


@pytest.fixture
def robot() -> Iterator[VirtualRobot]:
    with closing(VirtualRobot(RECIPE, start=(-0.55, -0.55, math.pi / 2))) as client:
        client.ready()
        for name in ("planner", "controller", "mapper", "drive_manager"):
            client.subscribe(ComponentStatus, f"/{name}/status", LATCHED)
        yield client


def execute(
    robot: VirtualRobot, component: str, name: str, **kwargs: Any
) -> ExecuteMethod.Response:
    request = ExecuteMethod.Request(name=name, kwargs_json=json.dumps(kwargs))
    return robot.call(ExecuteMethod, f"/{component}/execute_method", request, timeout=30)


def change(robot: VirtualRobot, component: str, name: str, value: str) -> None:
    request = ChangeParameter.Request(name=name, value=value, keep_alive=True)
    answer = robot.call(ChangeParameter, f"/{component}/update_config_parameter", request)
    assert answer.success, answer.error_msg


def level(robot: VirtualRobot, component: str) -> int:
    message = robot.newest.get(f"/{component}/status")
    return -1 if message is None else int(message.status)


def test_all_components_are_healthy_from_the_start(robot: VirtualRobot) -> None:
    for name in ("planner", "controller", "mapper", "drive_manager"):
        robot.wait_until(lambda: level(robot, name) == HEALTHY, 10, f"health of {name}")  # noqa: B023


def test_dwa_on_the_local_map_reaches_a_goal_around_the_pillars(robot: VirtualRobot) -> None:
    ended = robot.result(robot.send_goal(0.55, 0.55, 0.5), timeout=90)
    assert ended.status == SUCCEEDED, ended.result.message
    assert robot.distance_to(0.55, 0.55) < 0.10
    assert robot.contacts == 0


def test_algorithm_and_sensor_are_changed_on_the_way(robot: VirtualRobot) -> None:
    handle = robot.send_goal(-0.55, 0.55)
    robot.wait_until(lambda: robot.speed > 0.1, 20, "motion")
    change(robot, "controller", "use_direct_sensor", "True")
    assert execute(robot, "controller", "set_algorithm", algorithm_value="Stanley").success
    robot.wait_until(lambda: robot.speed > 0.1, 20, "motion with another algorithm")
    assert execute(robot, "controller", "set_algorithm", algorithm_value="DWA").success
    ended = robot.result(handle, timeout=90)
    assert ended.status == SUCCEEDED, ended.result.message
    assert robot.contacts == 0


def test_a_goal_may_be_sent_by_an_action_of_the_planner(robot: VirtualRobot) -> None:
    answer = execute(robot, "planner", "trigger_main_action_server", goal_x=-0.55, goal_y=0.55)
    assert answer.success, answer.error_msg
    robot.wait_until(lambda: robot.distance_to(-0.55, 0.55) < 0.12, 60, "arrival")


def test_the_drive_manager_moves_as_measured_by_the_physics(robot: VirtualRobot) -> None:
    robot.wait_until(lambda: robot.speed < 0.01, 10, "a halt")
    x, y, _ = robot.truth
    answer = execute(robot, "drive_manager", "move_backward", max_distance=0.15)
    assert answer.success, answer.error_msg
    assert robot.distance_to(x, y) == pytest.approx(0.15, abs=0.05)
    assert execute(robot, "drive_manager", "move_to_unblock").success
    assert robot.contacts == 0


def test_a_restart_of_the_planner_aborts_its_goal_and_the_next_succeeds(
    robot: VirtualRobot,
) -> None:
    handle = robot.send_goal(0.55, 0.55)
    robot.wait_until(lambda: robot.speed > 0.1, 20, "motion")
    assert execute(robot, "planner", "restart").success
    assert robot.result(handle, timeout=10).status == ABORTED
    robot.wait_until(lambda: robot.speed < 0.02, 5, "a halt")
    robot.wait_until(lambda: robot.check(0.55, 0.55).reachable, 20, "a planner with map and pose")
    ended = robot.result(robot.send_goal(0.55, 0.55), timeout=90)
    assert ended.status == SUCCEEDED, ended.result.message


def test_stop_outlasts_a_restart_and_refuses_manoeuvres(robot: VirtualRobot) -> None:
    robot.stop()
    try:
        assert execute(robot, "drive_manager", "restart").success
        robot.wait_until(lambda: robot.newest["/drive_state"].stopped, 5, "the latched STOP")
        answer = execute(robot, "drive_manager", "move_to_unblock")
        assert not answer.success
        assert "tester pressed STOP" in answer.error_msg
    finally:
        robot.release()


def test_with_a_hung_mapper_the_scan_takes_over(robot: VirtualRobot) -> None:
    change(robot, "controller", "use_direct_sensor", "False")
    handle = robot.send_goal(-0.55, 0.55)
    robot.wait_until(lambda: robot.speed > 0.1, 20, "motion")
    robot.stack.stop("mapper")
    try:
        robot.wait_until(lambda: level(robot, "controller") == SYSTEM, 3, "a SYSTEM failure")
        sources = robot.newest["/controller/status"].src_topics
        assert list(sources) == ["/local_map/occupancy_layer"]
        robot.wait_until(lambda: robot.speed < 0.02, 3, "a halt without the map")
        change(robot, "controller", "use_direct_sensor", "True")
        robot.wait_until(lambda: robot.speed > 0.1, 10, "motion with the scan")
        assert level(robot, "controller") == HEALTHY
        ended = robot.result(handle, timeout=90)
        assert ended.status == SUCCEEDED, ended.result.message
        assert robot.contacts == 0
    finally:
        robot.stack.go_on("mapper")
