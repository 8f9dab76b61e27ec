"""The robot goes where it is sent, over real DDS, and every goal ends with its reason."""

import math
from pathlib import Path as FilePath

import pytest
from kompass_interfaces.action import ControlPath
from nav2_msgs.srv import LoadMap
from nav_msgs.msg import Path

from kompass.share import map_path
from tests.support.path_file import save_path
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot

pytestmark = pytest.mark.ros

SUCCEEDED, ABORTED = 4, 6
REFUSED, STOPPED = 1, 3


def test_a_clicked_point_from_another_process_moves_the_robot_there(robot: Robot) -> None:
    robot.click(0.55, -0.5, taker="planner")
    wait_until(lambda: robot.distance_to(0.55, -0.5) < 0.10, 30, "arrival at the clicked point")
    # The next test begins with a robot that stands.
    wait_until(lambda: robot.newest["/drive_state"].standstill, 10, "a measured standstill")
    assert robot.contacts == 0


def test_a_saved_path_is_followed_to_its_end(robot: Robot, tmp_path: FilePath) -> None:
    x, y, _ = robot.truth
    end = (0.85, -0.5)
    file = save_path(tmp_path / "ahead.json", [(x, y, 0.0), (*end, 0.0)])
    client = robot.action_client(ControlPath, "/controller/control_path")
    goal = ControlPath.Goal(path_source=1, path_file_location=str(tmp_path), path_name=file.name)
    ended = robot.result(robot.send(client, goal), timeout=30)
    assert ended.status == SUCCEEDED, ended.result.message
    assert ended.result.reached_end
    assert robot.distance_to(*end) < 0.06
    goal.path_name = "none.json"
    refused = robot.result(robot.send(client, goal), timeout=10)
    assert (refused.status, refused.result.outcome) == (ABORTED, REFUSED)
    assert "none.json: does not exist" in refused.result.message


@pytest.mark.parametrize(
    ("x", "y", "reason"),
    [(50.0, 0.0, 2), (0.0, 0.0, 3), (0.0, 0.2, 4)],
    ids=["outside the map", "in a pillar", "too close to a pillar"],
)
def test_a_goal_that_cannot_be_reached_is_told_with_the_nearest_that_can(
    robot: Robot, x: float, y: float, reason: int
) -> None:
    answer = robot.check(x, y)
    assert not answer.reachable
    assert answer.reason == reason, answer.message
    assert answer.message.endswith(".")
    assert answer.has_nearest
    assert robot.check(answer.nearest.x, answer.nearest.y).reachable


def test_a_refused_goal_ends_at_once_and_nothing_moves(robot: Robot) -> None:
    before = robot.truth
    ended = robot.result(robot.send_goal(0.0, 0.0), timeout=2)
    assert (ended.status, ended.result.outcome) == (ABORTED, REFUSED)
    assert ended.result.message
    assert robot.distance_to(*before[:2]) < 0.02


def test_checking_a_goal_moves_nothing_and_tells_length_and_time(robot: Robot) -> None:
    before = robot.truth
    answer = robot.check(-0.5, 0.5)
    assert answer.reachable
    assert answer.length >= math.hypot(before[0] + 0.5, before[1] - 0.5) - 0.01
    assert answer.duration > answer.length / 0.3
    assert len(answer.preview.poses) > 5
    assert robot.distance_to(*before[:2]) < 0.02


def test_a_late_listener_still_gets_plan_and_map(robot: Robot) -> None:
    handle = robot.send_goal(-1.5, 0.5)
    wait_until(lambda: robot.speed > 0.05, 10, "motion")
    robot.subscribe(Path, "/plan", LATCHED)
    wait_until(lambda: "/plan" in robot.newest, 5, "the latched plan")
    assert len(robot.newest["/plan"].poses) > 2
    robot.cancel(handle)


def test_stop_halts_the_robot_and_holds_it_until_a_person_releases(robot: Robot) -> None:
    handle = robot.send_goal(0.5, 0.5)
    wait_until(lambda: robot.speed > 0.1, 10, "motion")
    assert robot.stop().success
    ended = robot.result(handle, timeout=5)
    assert (ended.status, ended.result.outcome) == (ABORTED, STOPPED)
    wait_until(lambda: robot.newest["/drive_state"].standstill, 3, "a measured standstill")
    command = robot.newest["/cmd_vel"]
    assert (command.linear.x, command.angular.z) == (0.0, 0.0)

    stood = robot.truth
    refused = robot.result(robot.send_goal(-0.5, -0.55), timeout=5)
    assert (refused.status, refused.result.outcome) == (ABORTED, STOPPED)
    robot.click(-0.5, -0.55, taker="planner")
    assert max(math.dist(at[:2], stood[:2]) for at in robot.watch(1.5)) < 0.01
    assert robot.newest["/drive_state"].stopped_by == "tester"

    assert robot.release().success
    assert max(math.dist(at[:2], stood[:2]) for at in robot.watch(1.0)) < 0.01
    assert robot.result(robot.send_goal(-0.5, -0.55)).status == SUCCEEDED


def test_another_map_can_be_loaded_and_a_missing_one_is_an_answer(robot: Robot) -> None:
    path = str(map_path("hexagon"))
    answer = robot.call(LoadMap, "/map_server/load_map", LoadMap.Request(map_url=path))
    assert answer.result == LoadMap.Response.RESULT_SUCCESS
    assert answer.map.info.width * answer.map.info.height == len(answer.map.data)
    answer = robot.call(LoadMap, "/map_server/load_map", LoadMap.Request(map_url="/no/map.yaml"))
    assert answer.result == LoadMap.Response.RESULT_MAP_DOES_NOT_EXIST
