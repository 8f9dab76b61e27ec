"""The controller follows a path of a file or a topic to its end, and says how that ended."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from automatika_ros_sugar.srv import ExecuteMethod
from geometry_msgs.msg import PoseStamped
from kompass_interfaces.action import ControlPath, PlanPath
from kompass_interfaces.srv import ChangeZones
from nav_msgs.msg import OccupancyGrid
from nav_msgs.msg import Path as PathMessage
from std_msgs.msg import String

from kompass.components import Controller
from kompass.components.base.convert import grid_of
from kompass.places.map_identity import identify
from kompass.zones.change import SaveZone
from kompass.zones.zone import ZonePlan
from tests.support.hand import Hand
from tests.support.path_file import save_path
from tests.support.tester import LATCHED, pose
from tests.support.virtual_robot import VirtualRobot

SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
Outcome = ControlPath.Result
TOPIC, FILE = 0, 1
START = (-2.0, -0.5)
AWAY = (-0.3, -0.55)
# Ahead of the start and back to it, along a lying triangle.
LOOP = [(-2.0, -0.5, 0.0), (-1.2, -0.5, 0.0), (-1.6, -0.2, 2.5), (-2.0, -0.5, -2.5)]
CORNER = 0.25  # m by which pure pursuit cuts one at most


class FollowingRobot(VirtualRobot):
    """A robot whose controller is given paths."""

    def __init__(self, **how: Any) -> None:
        super().__init__(**how)
        self._paths = self.action_client(ControlPath, "/controller/control_path")
        self.feedback: list[Any] = []
        self.node.create_subscription(
            ControlPath.Impl.FeedbackMessage,
            "/controller/control_path/_action/feedback",
            self.feedback.append,
            10,
        )
        self.ready()

    @property
    def paths(self) -> Path:
        return self.folder / "tested" / "paths"

    def follow(self, **goal: Any) -> Any:
        return self.send(self._paths, ControlPath.Goal(**goal))

    def follow_loop(self) -> Any:
        save_path(self.paths / "loop.json", LOOP)
        return self.follow(path_source=FILE, path_name="loop.json")

    def is_under_way(self) -> None:
        self.wait_until(lambda: self.speed > 0.15, 20, "motion")

    def is_refused(self, **goal: Any) -> str:
        """Why a goal is; nothing moves."""
        ended = self.result(self.follow(**goal))
        assert ended.status == ABORTED
        assert ended.result.outcome == Outcome.OUTCOME_REFUSED
        assert not ended.result.reached_end
        return str(ended.result.message)


@pytest.fixture
def robot() -> Iterator[FollowingRobot]:
    with closing(FollowingRobot()) as client:
        yield client


def test_a_path_of_a_file_that_ends_where_it_began_is_driven_all_round(
    robot: FollowingRobot,
) -> None:
    handle = robot.follow_loop()
    robot.wait_until(lambda: robot.distance_to(-1.2, -0.5) < CORNER, 30, "the first corner")
    robot.wait_until(lambda: robot.distance_to(-1.6, -0.2) < CORNER, 30, "the second corner")
    result = robot.result(handle)
    assert result.status == SUCCEEDED, result.result.message
    assert result.result.outcome == Outcome.OUTCOME_ARRIVED
    assert result.result.reached_end
    assert abs(result.result.destination_error.lateral_distance_error) < 0.05
    assert abs(result.result.destination_error.orientation_error) < 0.1
    assert robot.distance_to(*START) < 0.06
    told = [one.feedback for one in robot.feedback]
    assert len(told) > 20
    assert max(one.control.linear.x for one in told) > 0.1
    assert all(one.control_list.linear_velocities.x[0] == one.control.linear.x for one in told)
    assert max(abs(one.global_path_deviation.lateral_distance_error) for one in told) < 0.2


def test_the_same_path_a_second_time_is_driven_from_its_beginning(robot: FollowingRobot) -> None:
    handle = robot.follow_loop()
    robot.wait_until(lambda: robot.distance_to(-1.6, -0.2) < CORNER, 30, "the second corner")
    robot.wait_until(lambda: robot.distance_to(*START) < 0.3, 30, "the last leg")
    handle.cancel_goal_async()
    ended = robot.result(handle)
    assert ended.status == CANCELED
    assert ended.result.outcome == Outcome.OUTCOME_CANCELED
    robot.wait_until(lambda: robot.newest["/drive_state"].standstill, 5, "standstill")
    name, ahead = "/drive_manager/execute_method", json.dumps({"max_distance": 0.25})
    request = ExecuteMethod.Request(name="move_forward", kwargs_json=ahead)
    assert robot.call(ExecuteMethod, name, request, timeout=10.0).success
    again = robot.follow_loop()
    robot.wait_until(lambda: robot.distance_to(-1.2, -0.5) < CORNER, 30, "the first corner")
    assert robot.result(again).status == SUCCEEDED


def test_stop_ends_a_path_and_none_begins_before_the_release(robot: FollowingRobot) -> None:
    handle = robot.follow_loop()
    robot.is_under_way()
    robot.stop()
    ended = robot.result(handle)
    assert ended.status == ABORTED
    assert ended.result.outcome == Outcome.OUTCOME_STOPPED
    assert "tester pressed STOP" in ended.result.message
    robot.wait_until(lambda: robot.newest["/drive_state"].standstill, 5, "standstill")
    assert "tester pressed STOP" in robot.is_refused(path_source=FILE, path_name="loop.json")
    robot.release()
    at = robot.truth
    robot.rest(3.0)
    assert math.dist(at[:2], robot.truth[:2]) < 0.01
    assert robot.result(robot.follow_loop()).status == SUCCEEDED


def test_a_person_at_the_wheel_and_a_goal_come_first(robot: FollowingRobot) -> None:
    handle = robot.follow_loop()
    robot.is_under_way()
    goal = robot.send_goal(*AWAY)
    ended = robot.result(handle)
    assert ended.result.outcome == Outcome.OUTCOME_PREEMPTED
    assert "/plan took over" in ended.result.message
    robot.is_under_way()
    assert "is being followed; cancel its goal first" in robot.is_refused(
        path_source=FILE, path_name="loop.json"
    )
    assert robot.result(goal).status == SUCCEEDED
    assert robot.result(robot.send_goal(*START)).status == SUCCEEDED
    handle = robot.follow_loop()
    robot.is_under_way()
    ava = Hand(robot, "ava")
    robot.wait_until(lambda: ava.ask().success, 20, "the wheel")
    ended = robot.result(handle)
    assert ended.result.outcome == Outcome.OUTCOME_PREEMPTED
    assert "ava drives by hand" in ended.result.message


def test_a_newer_path_takes_over_and_one_of_a_topic_is_followed(robot: FollowingRobot) -> None:
    publisher = robot.node.create_publisher(PathMessage, "/taught", LATCHED)
    message = PathMessage()
    message.header.frame_id = "map"
    message.poses = [PoseStamped(pose=pose(x, -0.5, 0.0)) for x in (-2.0, -1.5, -1.3)]
    publisher.publish(message)
    robot.wait_until(
        lambda: robot.node.get_publishers_info_by_topic("/taught"), 5, "a known publisher"
    )
    first = robot.follow_loop()
    robot.is_under_way()
    second = robot.follow(path_source=TOPIC, path_name="/taught")
    ended = robot.result(first)
    assert ended.result.outcome == Outcome.OUTCOME_PREEMPTED
    assert "newer path" in ended.result.message
    assert robot.result(second).status == SUCCEEDED
    assert robot.distance_to(-1.3, -0.5) < 0.06


def test_a_path_that_something_stands_across_ends_stuck_with_the_reason(
    robot: FollowingRobot,
) -> None:
    robot.fault("way_blocked")
    handle = robot.follow_loop()
    ended = robot.result(handle, 90)
    assert ended.result.outcome == Outcome.OUTCOME_STUCK, ended.result.message
    assert "No progress for 20 s" in ended.result.message
    assert robot.contacts == 0


@pytest.mark.parametrize(
    ("poses", "goal", "told"),
    [
        (LOOP, {"path_source": 7}, "path_source = 7; give 0"),
        (LOOP, {"controller": 2}, "controller = 2; give 0"),
        (LOOP, {"path_name": ""}, "path_name = ''"),
        (LOOP, {"path_name": "none.json"}, "none.json: does not exist"),
        (LOOP, {"path_name": "/etc/hostname"}, "/etc/hostname: is no JSON"),
        (LOOP, {"path_source": TOPIC, "path_name": "/scan"}, "sensor_msgs/msg/LaserScan publishes"),
        (LOOP, {"path_source": TOPIC, "path_name": "/taught"}, "nobody publishes there"),
        (
            LOOP,
            {"path_source": TOPIC, "path_name": "bad name!"},
            "path_name = 'bad name!': Invalid",
        ),
        (LOOP, {"path_source": TOPIC, "path_name": "//"}, "path_name = '//': Invalid topic name"),
        (LOOP, {"path_source": TOPIC, "path_name": "{me}"}, "as in '/taught'"),
        ([(10**400, 0.0, 0.0), (2.0, 0.0, 0.0)], {}, "position.x: Infinity; give a finite"),
        ([(-1e308, 0.0, 0.0), (1e308, 0.0, 0.0)], {}, "the path is inf m long; give at most"),
        ([(1.5, 0.0, 0.0), (2.0, 0.0, 0.0)], {}, "away from the path; drive to within 1 m"),
        (LOOP[:1], {}, "the path has 1 poses; give from 2"),
        ([LOOP[0], LOOP[0]], {}, "is 0.000 m long"),
    ],
)
def test_a_path_that_cannot_be_followed_is_refused_with_what_is_wrong(
    robot: FollowingRobot,
    poses: list[tuple[float, float, float]],
    goal: dict[str, Any],
    told: str,
) -> None:
    save_path(robot.paths / "path.json", poses)
    assert told in robot.is_refused(**{"path_source": FILE, "path_name": "path.json"} | goal)


def test_a_goal_whose_pursuit_raises_has_not_arrived(
    robot: FollowingRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever it is that nobody has thought of."""

    def fail(*_: object) -> None:
        raise RuntimeError("nobody thought of it")

    with monkeypatch.context() as patched:
        patched.setattr("kompass.components.controller.controller.check_path", fail)
        ended = robot.result(robot.follow_loop())
        assert ended.status == ABORTED
        assert ended.result.outcome == Outcome.OUTCOME_ERROR
        assert "nobody thought of it" in ended.result.message
    with monkeypatch.context() as patched:
        patched.setattr("kompass.components.planner.planner.Planner._find", fail)
        ended = robot.result(robot.send_goal(*AWAY))
        assert ended.status == ABORTED
        assert ended.result.outcome == PlanPath.Result.OUTCOME_ERROR
        assert "nobody thought of it" in ended.result.message
    assert robot.result(robot.follow_loop()).status == SUCCEEDED


def test_a_path_in_another_frame_is_refused(robot: FollowingRobot) -> None:
    save_path(robot.paths / "path.json", LOOP, frame="odom")
    told = robot.is_refused(path_source=FILE, path_name="path.json")
    assert "the path is in frame 'odom'; give it in 'map'" in told


def test_a_path_through_a_keep_out_zone_is_refused_with_its_name() -> None:
    with closing(FollowingRobot(remembers=True)) as robot:
        robot.subscribe(OccupancyGrid, "/map", LATCHED)
        robot.subscribe(String, "/zones", LATCHED)
        robot.wait_until(lambda: "/map" in robot.newest, 10, "the map")
        plan = ZonePlan(
            name="Wet floor",
            kind="keep_out",
            map=identify(grid_of(robot.newest["/map"])),
            corners=((-1.6, -0.8), (-1.3, -0.8), (-1.3, -0.4), (-1.6, -0.4)),
        )
        change = SaveZone(plan=plan)
        request = ChangeZones.Request(
            change=change.model_dump_json(), author="ava", role="operator"
        )
        assert robot.call(ChangeZones, "/monitor/change_zones", request).success
        robot.wait_until(
            lambda: json.loads(robot.newest["/zones"].data)["zones"], 10, "a zone in force"
        )
        save_path(robot.paths / "loop.json", LOOP)
        told = robot.is_refused(path_source=FILE, path_name="loop.json")
        assert "leads through the keep-out zone 'Wet floor'" in told


def test_what_was_asked_for_before_a_stop_that_nobody_heard_is_not_begun(
    robot: FollowingRobot,
) -> None:
    assert robot.result(robot.follow_loop()).status == SUCCEEDED
    goal = ControlPath.Goal(path_source=FILE, path_name="loop.json")
    robot.stack.stop("controller")
    sent = robot.do(lambda: robot._paths.send_goal_async(goal))
    robot.rest(0.5)
    assert robot.stop().success
    assert robot.release().success
    robot.rest(0.5)
    robot.stack.go_on("controller")
    handle = robot.await_future(sent, 10, "the answer to the goal")
    ended = robot.result(handle)
    assert ended.result.outcome == Outcome.OUTCOME_REFUSED
    assert "ask again if it is wanted" in ended.result.message


def test_a_path_that_comes_after_a_stop_and_its_release_is_not_followed(
    robot: FollowingRobot,
) -> None:
    publisher = robot.node.create_publisher(PathMessage, "/taught", LATCHED)
    robot.wait_until(
        lambda: robot.node.get_publishers_info_by_topic("/taught"), 5, "a known publisher"
    )
    handle = robot.follow(path_source=TOPIC, path_name="/taught")
    robot.wait_for_listeners("/taught", "controller")
    assert robot.stop().success
    robot.rest(0.3)
    assert robot.release().success
    robot.rest(0.3)
    message = PathMessage()
    message.header.frame_id = "map"
    message.poses = [PoseStamped(pose=pose(x, -0.5, 0.0)) for x in (-2.0, -1.5, -1.3)]
    publisher.publish(message)
    ended = robot.result(handle)
    assert ended.status == ABORTED
    assert "pressed STOP" in ended.result.message
    assert math.dist(robot.truth[:2], START) < 0.01


@pytest.mark.parametrize(
    ("frame", "poses", "said"),
    [
        ("mars", [(-2.0, -0.5), (0.5, -0.5)], "give it in 'map'"),
        ("map", [(100.0, 0.0), (110.0, 0.0)], "m away from the path"),
        ("map", [(-1e4, 0.0), (1e4, 0.0)], "the path is 20000 m long"),
    ],
)
def test_a_path_on_the_plans_topic_that_cannot_be_meant_is_not_followed(
    frame: str, poses: list[tuple[float, float]], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    monkeypatch.setattr(Controller, "warn", lambda _self, text: told.append(text))
    with closing(FollowingRobot()) as robot:
        publisher = robot.node.create_publisher(PathMessage, "/plan", LATCHED)
        robot.wait_for_listeners("/plan", "controller")
        message = PathMessage(poses=[PoseStamped(pose=pose(x, y, 0.0)) for x, y in poses])
        message.header.frame_id = frame
        publisher.publish(message)
        robot.wait_until(lambda: any(said in line for line in told), 5, "why it is not followed")
        robot.rest(3.0)
        assert math.dist(robot.truth[:2], START) < 0.01


def test_a_path_that_cannot_be_meant_does_not_end_a_goal(robot: FollowingRobot) -> None:
    handle = robot.follow_loop()
    robot.is_under_way()
    publisher = robot.node.create_publisher(PathMessage, "/plan", LATCHED)
    message = PathMessage(poses=[PoseStamped(pose=pose(x, 0.0, 0.0)) for x in (100.0, 110.0)])
    message.header.frame_id = "map"
    publisher.publish(message)
    assert robot.result(handle).status == SUCCEEDED
