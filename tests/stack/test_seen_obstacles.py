"""What the scan shows reaches the planner: the robot finds its way around what no map has."""

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from automatika_ros_sugar.srv import ChangeParameter
from nav_msgs.msg import Path as PathMsg

from kompass.components.planner import live_map
from tests.support.stack import RECIPE
from tests.support.virtual_robot import VirtualRobot

SUCCEEDED, ABORTED = 4, 6
STUCK = 6


@pytest.fixture
def seeing(tmp_path: Path) -> Path:
    """Recipe 01, with a planner that looks."""
    recipe, said = tmp_path / "seeing.py", "goals_from_topics=True"
    text = RECIPE.read_text(encoding="utf-8")
    assert said in text
    recipe.write_text(text.replace(said, f"{said}, use_sensor=True"), encoding="utf-8")
    return recipe


@pytest.fixture
def robot(seeing: Path) -> Iterator[VirtualRobot]:
    with closing(VirtualRobot(seeing)) as client:
        client.ready()
        yield client


def block_the_way(robot: VirtualRobot) -> None:
    robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
    robot.fault("way_blocked")


def test_a_wall_that_comes_up_in_the_way_is_driven_around(robot: VirtualRobot) -> None:
    handle = robot.send_goal(-0.5, -0.55)
    block_the_way(robot)
    ended = robot.result(handle, timeout=60)
    assert ended.status == SUCCEEDED, ended.result.message
    assert robot.distance_to(-0.5, -0.55) < 0.10
    assert robot.contacts == 0


def test_a_planner_that_does_not_look_stands_before_it() -> None:
    with closing(VirtualRobot()) as blind:
        blind.ready()
        handle = blind.send_goal(-0.5, -0.55)
        block_the_way(blind)
        ended = blind.result(handle, timeout=60)
        assert (ended.status, ended.result.outcome) == (ABORTED, STUCK)


def test_it_can_be_told_to_look_while_it_drives() -> None:
    with closing(VirtualRobot()) as blind:
        blind.ready()
        handle = blind.send_goal(-0.5, -0.55)
        block_the_way(blind)
        change = ChangeParameter.Request(name="use_sensor", value="true", keep_alive=True)
        assert blind.call(ChangeParameter, "/planner/update_config_parameter", change).success
        ended = blind.result(handle, timeout=60)
        assert ended.status == SUCCEEDED, ended.result.message
        assert blind.contacts == 0


def test_a_path_that_holds_is_kept(robot: VirtualRobot) -> None:
    plans: list[int] = []
    latched = robot.node.create_subscription(
        PathMsg, "/plan", lambda message: plans.append(len(message.poses)), 10
    )
    assert latched is not None
    ended = robot.result(robot.send_goal(0.5, 0.5))
    assert ended.status == SUCCEEDED
    # One path on which it drives, one that clears it at the end; and hardly any between them.
    assert 2 <= len(plans) <= 5
    assert all(plans[:-1])
    assert not plans[-1]


def test_where_a_way_is_mended_a_wall_in_it_is_driven_around_too(
    seeing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live_map, "LARGE", 0)
    with closing(VirtualRobot(seeing)) as robot:
        robot.ready()
        handle = robot.send_goal(-0.5, -0.55)
        block_the_way(robot)
        ended = robot.result(handle, timeout=60)
        assert ended.status == SUCCEEDED, ended.result.message
        assert robot.distance_to(-0.5, -0.55) < 0.10
        assert robot.contacts == 0


def test_in_a_large_hall_the_way_is_mended_near_the_robot_and_stays_beyond(seeing: Path) -> None:
    with closing(VirtualRobot(seeing, place="depot")) as robot:
        robot.ready()
        paths: list[list[tuple[float, float]]] = []
        heard = robot.node.create_subscription(
            PathMsg,
            "/plan",
            lambda message: paths.append(
                [(pose.pose.position.x, pose.pose.position.y) for pose in message.poses]
            ),
            10,
        )
        assert heard is not None
        handle = robot.send_goal(24.0, 3.5)
        block_the_way(robot)
        ended = robot.result(handle, timeout=200)
        assert ended.status == SUCCEEDED, ended.result.message
        assert robot.distance_to(24.0, 3.5) < 0.10
        assert robot.contacts == 0
    first, *mended = [path for path in paths if path]
    assert mended, "the wall has changed the way"
    assert mended[0] != first
    assert mended[0][-60:] == first[-60:], "the last 6 m are as they were"
