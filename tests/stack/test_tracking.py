"""The controller follows who a camera sees, and says how that ended."""

from __future__ import annotations

import array
import math
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from automatika_ros_sugar.msg import ComponentStatus
from geometry_msgs.msg import TransformStamped
from kompass_interfaces.action import ControlPath, TrackVisionTarget
from kompass_interfaces.srv import StopVisionTracking
from sensor_msgs.msg import CameraInfo, Image
from tf2_msgs.msg import TFMessage
from vision_msgs.msg import Detection2D, Detection2DArray, ObjectHypothesisWithPose

from kompass.algorithms.geometry import wrap_angle
from tests.stack.test_components import change, execute
from tests.support.hand import Hand
from tests.support.tester import LATCHED
from tests.support.virtual_robot import VirtualRobot

RECIPE = Path(__file__).parents[1] / "recipes" / "tracking_robot.py"
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
Outcome = TrackVisionTarget.Result
Place = tuple[float, float] | None
WIDTH, HEIGHT, FOCAL = 64, 48, 55.0  # px
FORWARD = 0.08  # m from the robot's middle to the camera
FOLLOWERS = ["VisionRGBFollower", "VisionRGBDFollower"]
# Along a row between the pillars, ahead of where the robot starts.
START, END, PACE = (-1.2, -0.5), (1.0, -0.52), 0.1  # m, m, m/s


class TrackingRobot(VirtualRobot):
    """Its camera looks ahead and sees one person, who is nowhere else in its world."""

    def __init__(self, follower: str) -> None:
        super().__init__(RECIPE, FOLLOWER=follower)
        self.person: Callable[[float], Place] = lambda _now: START
        self.sees = True
        self.encoding = "16UC1"
        node = self.node
        self._detections = node.create_publisher(Detection2DArray, "/detections", 10)
        self._info = node.create_publisher(CameraInfo, "/camera/camera_info", 10)
        self._depth = node.create_publisher(Image, "/camera/depth", 10)
        self._mounted = node.create_publisher(TFMessage, "/tf_static", LATCHED)
        mounting = TransformStamped(child_frame_id="eye")
        mounting.header.frame_id = "base_link"
        mounting.transform.translation.x = FORWARD
        half = mounting.transform.rotation
        half.x, half.y, half.z, half.w = -0.5, 0.5, -0.5, 0.5
        self._mounted.publish(TFMessage(transforms=[mounting]))
        self._targets = self.action_client(TrackVisionTarget, "/controller/track_vision_target")
        self.feedback: list[Any] = []
        node.create_subscription(
            TrackVisionTarget.Impl.FeedbackMessage,
            "/controller/track_vision_target/_action/feedback",
            self.feedback.append,
            10,
        )
        self.subscribe(ComponentStatus, "/controller/status", LATCHED)
        self.ready()
        self.began = self.clock.monotonic()
        node.create_timer(0.1, self._look)

    @property
    def elapsed(self) -> float:
        return self.clock.monotonic() - self.began

    @property
    def place(self) -> Place:
        """Where the person is."""
        return self.person(self.elapsed)

    @property
    def apart(self) -> float:
        place = self.place
        assert place is not None
        return self.distance_to(*place)

    @property
    def status(self) -> ComponentStatus:
        return self.newest["/controller/status"]

    def walk(self) -> None:
        """Have the person go from start to end, and stand there."""
        began, length = self.elapsed, math.dist(START, END)

        def at(now: float) -> Place:
            share = min(1.0, max(0.0, now - began) * PACE / length)
            return START[0] + share * (END[0] - START[0]), START[1] + share * (END[1] - START[1])

        self.person = at

    def track(self, **goal: Any) -> Any:
        return self.send(self._targets, TrackVisionTarget.Goal(**goal))

    def follow_person(self, **goal: Any) -> Any:
        handle = self.track(label="person", **goal)
        assert handle.accepted
        return handle

    def is_under_way(self) -> None:
        self.wait_until(lambda: self.speed > 0.05, 20, "motion")

    def stands(self) -> None:
        self.wait_until(lambda: self.speed < 0.01, 5, "standstill")

    def _look(self) -> None:
        stamp = self.node.get_clock().now().to_msg()
        info = CameraInfo(width=WIDTH, height=HEIGHT)
        info.header.frame_id, info.header.stamp = "eye", stamp
        info.k = [FOCAL, 0.0, WIDTH / 2, 0.0, FOCAL, HEIGHT / 2, 0.0, 0.0, 1.0]
        depths = np.full((HEIGHT, WIDTH), 4000, dtype=np.uint16)
        found = Detection2DArray(header=info.header)
        box = self._box()
        if box is not None:
            u, depth, width, height = box
            left, right = round(u - width / 2), round(u + width / 2)
            top, bottom = round(HEIGHT / 2 - height / 2), round(HEIGHT / 2 + height / 2)
            depths[max(0, top) : bottom, max(0, left) : max(0, right)] = round(1000 * depth)
            one = Detection2D(header=info.header, id="7")
            one.bbox.center.position.x, one.bbox.center.position.y = u, HEIGHT / 2
            one.bbox.size_x, one.bbox.size_y = width, height
            likely, other = ObjectHypothesisWithPose(), ObjectHypothesisWithPose()
            likely.hypothesis.class_id, likely.hypothesis.score = "person", 0.9
            other.hypothesis.class_id, other.hypothesis.score = "coat", 0.4
            one.results = [other, likely]
            found.detections = [one]
        image = Image(height=HEIGHT, width=WIDTH, encoding=self.encoding, step=2 * WIDTH)
        image.header, image.data = info.header, array.array("B", depths.tobytes())
        if self.sees:
            self._info.publish(info)
            self._depth.publish(image)
            self._detections.publish(found)

    def _box(self) -> tuple[float, float, float, float] | None:
        """Column, depth, width and height of the person's box; None when out of the image."""
        place = self.place
        if place is None:
            return None
        x, y, yaw = self.truth
        bearing = wrap_angle(math.atan2(place[1] - y, place[0] - x) - yaw)
        distance = math.dist(place, (x, y))
        depth = distance * math.cos(bearing) - FORWARD
        if depth < 0.1:
            return None
        u = WIDTH / 2 - FOCAL * distance * math.sin(bearing) / depth
        if not 0.0 <= u <= WIDTH:
            return None
        return u, depth, FOCAL * 0.2 / depth, FOCAL * 0.5 / depth


@pytest.fixture(params=FOLLOWERS)
def robot(request: pytest.FixtureRequest) -> Iterator[TrackingRobot]:
    with closing(TrackingRobot(request.param)) as client:
        yield client


@pytest.fixture
def measuring() -> Iterator[TrackingRobot]:
    with closing(TrackingRobot("VisionRGBDFollower")) as client:
        yield client


def test_a_walking_person_is_followed_until_that_is_ended(robot: TrackingRobot) -> None:
    handle = robot.follow_person()
    robot.walk()
    apart = []

    def has_walked() -> bool:
        apart.append(robot.apart)
        return math.dist(robot.place or START, END) < 0.001

    robot.wait_until(has_walked, 60, "the end of the walk")
    robot.rest(8.0)
    assert robot.truth[0] > 0.0, "it has come along"
    assert min(apart) > 0.6, "and never near"
    robot.stands()
    end, name = StopVisionTracking.Request, "/controller/end_vision_tracking"
    assert not robot.call(StopVisionTracking, name, end(label="dog")).success
    assert robot.call(StopVisionTracking, name, end(label="Person")).success
    ended = robot.result(handle)
    assert (ended.status, ended.result.outcome) == (SUCCEEDED, Outcome.OUTCOME_ENDED)
    assert ended.result.success
    assert ended.result.tracked_duration > 20.0
    assert not robot.call(StopVisionTracking, name, end()).success
    assert robot.contacts == 0


def test_by_depth_the_distance_and_what_is_off_are_told(measuring: TrackingRobot) -> None:
    measuring.person = lambda _now: (-0.6, -0.3)
    handle = measuring.follow_person()
    measuring.is_under_way()
    measuring.wait_until(lambda: measuring.feedback[-1].feedback.orientation_error, 5, "a sight")
    told = measuring.feedback[-1].feedback
    assert 0.1 < told.distance_error < 0.8
    assert 0.0 < told.orientation_error < 0.3
    measuring.wait_until(lambda: abs(measuring.apart - 0.7) < 0.08, 20, "the distance kept")
    measuring.stands()
    handle.cancel_goal_async()
    ended = measuring.result(handle)
    assert (ended.status, ended.result.outcome) == (CANCELED, Outcome.OUTCOME_CANCELED)
    assert not ended.result.success
    assert abs(measuring.apart - 0.7) < 0.1


def test_who_is_out_of_sight_is_searched_for_and_given_up_at_rest(robot: TrackingRobot) -> None:
    handle = robot.follow_person(search_timeout=9.0)
    robot.walk()
    robot.is_under_way()
    robot.person = lambda _now: None
    robot.wait_until(lambda: "is not in sight" in robot.status.msg, 5, "what it says")
    at, turned = robot.truth, [robot.truth[2]]

    def has_ended() -> bool:
        turned.append(robot.truth[2])
        return bool(handle.status == ABORTED)

    robot.wait_until(has_ended, 12, "the end of the search")
    assert np.ptp(np.unwrap(turned)) > 1.5
    ended = robot.result(handle)
    assert ended.result.outcome == Outcome.OUTCOME_LOST
    assert ended.result.message == "For 9 s, 'person' is not in sight."
    robot.stands()
    assert robot.distance_to(*at[:2]) < 0.15


def test_who_steps_aside_is_found_again(robot: TrackingRobot) -> None:
    handle = robot.follow_person()
    robot.walk()
    robot.is_under_way()
    x, y, _ = robot.truth
    robot.person = lambda _now: (x - 1.2, y)
    robot.wait_until(lambda: "is not in sight" in robot.status.msg, 5, "a search")
    robot.wait_until(lambda: abs(abs(robot.truth[2]) - math.pi) < 0.6, 20, "a turn")
    robot.wait_until(lambda: "is not in sight" not in robot.status.msg, 5, "that it is found")
    assert handle.status not in (SUCCEEDED, CANCELED, ABORTED)


def test_a_detector_that_falls_silent_stops_the_robot_until_it_speaks(
    robot: TrackingRobot,
) -> None:
    handle = robot.follow_person(search_timeout=6.0)
    robot.walk()
    robot.is_under_way()
    robot.sees = False
    robot.wait_until(lambda: robot.status.status == 3, 1.5, "a SYSTEM failure")
    assert "nothing on /detections" in robot.status.msg
    robot.wait_until(lambda: robot.speed < 0.01, 1.0, "standstill")
    robot.sees = True
    robot.wait_until(lambda: robot.status.status == 0, 3, "health")
    robot.is_under_way()
    robot.sees = False
    ended = robot.result(handle, timeout=20)
    assert ended.result.outcome == Outcome.OUTCOME_LOST
    assert "For 6 s, nothing on /detections" in ended.result.message


def test_stop_ends_it_and_none_begins_before_the_release(measuring: TrackingRobot) -> None:
    handle = measuring.follow_person()
    measuring.walk()
    measuring.is_under_way()
    measuring.stop()
    ended = measuring.result(handle)
    assert (ended.status, ended.result.outcome) == (ABORTED, Outcome.OUTCOME_STOPPED)
    assert "tester pressed STOP" in ended.result.message
    measuring.stands()
    refused = measuring.result(measuring.follow_person())
    assert refused.result.outcome == Outcome.OUTCOME_REFUSED
    assert "tester pressed STOP" in refused.result.message
    measuring.release()
    at = measuring.truth
    measuring.rest(3.0)
    assert measuring.distance_to(*at[:2]) < 0.01


def test_a_goal_that_waits_for_the_camera_does_not_outlive_a_stop(
    measuring: TrackingRobot,
) -> None:
    measuring.sees = False
    measuring.rest(1.0)
    handle = measuring.follow_person()
    measuring.stop()
    measuring.release()
    measuring.sees = True
    refused = measuring.result(handle)
    assert refused.result.outcome == Outcome.OUTCOME_REFUSED
    assert "STOP was pressed" in refused.result.message
    assert measuring.speed < 0.01


def test_a_goal_outlives_no_deactivation_and_may_be_canceled_while_it_waits(
    measuring: TrackingRobot,
) -> None:
    measuring.sees = False
    measuring.rest(1.0)
    waits = measuring.follow_person()
    waits.cancel_goal_async()
    assert measuring.result(waits).status == CANCELED
    measuring.sees = True
    handle = measuring.follow_person()
    measuring.walk()
    measuring.is_under_way()
    assert execute(measuring, "controller", "stop").success
    ended = measuring.result(handle)
    assert ended.result.outcome == Outcome.OUTCOME_ERROR
    assert "deactivated" in ended.result.message
    measuring.stands()


def test_settings_that_change_on_the_way_do_not_end_it(measuring: TrackingRobot) -> None:
    measuring.person = lambda _now: (-0.5, -0.5)
    handle = measuring.follow_person()
    measuring.is_under_way()
    change(measuring, "controller", "VisionRGBDFollower.target_distance", "1.0")
    measuring.wait_until(lambda: abs(measuring.apart - 1.0) < 0.1, 20, "the new distance")
    measuring.stands()
    handle.cancel_goal_async()
    assert measuring.result(handle).status == CANCELED


def test_the_wheel_and_a_newer_target_take_over(measuring: TrackingRobot) -> None:
    first = measuring.follow_person()
    measuring.walk()
    measuring.is_under_way()
    alias = measuring.action_client(TrackVisionTarget, "/track_vision_target")
    second = measuring.send(alias, TrackVisionTarget.Goal(pose_x=WIDTH // 2, pose_y=HEIGHT // 2))
    ended = measuring.result(first)
    assert ended.result.outcome == Outcome.OUTCOME_PREEMPTED
    assert "newer target" in ended.result.message
    measuring.is_under_way()
    ava = Hand(measuring, "ava")
    measuring.wait_until(lambda: ava.ask().success, 20, "the wheel")
    ended = measuring.result(second)
    assert ended.result.outcome == Outcome.OUTCOME_PREEMPTED
    assert "ava drives by hand" in ended.result.message


def test_a_person_between_them_holds_the_robot_back_and_it_says_so(
    measuring: TrackingRobot,
) -> None:
    measuring.person = lambda _now: (1.0, -0.5)
    handle = measuring.follow_person()
    measuring.is_under_way()
    measuring.fault("person_ahead")
    ended = measuring.result(handle, timeout=60)
    assert ended.result.outcome == Outcome.OUTCOME_STUCK
    assert ended.result.message == "No progress for 8 s."
    measuring.stands()
    assert measuring.contacts == 0


def test_algorithms_change_while_it_runs_and_each_refuses_the_other_ones_goals(
    measuring: TrackingRobot,
) -> None:
    paths = measuring.action_client(ControlPath, "/controller/control_path")
    refused = measuring.result(measuring.send(paths, ControlPath.Goal(path_name="/plan")))
    assert "VisionRGBDFollower follows no path; choose another" in refused.result.message
    handle = measuring.follow_person()
    measuring.walk()
    measuring.is_under_way()
    assert execute(measuring, "controller", "set_algorithm", algorithm_value="DVZ").success
    ended = measuring.result(handle)
    assert ended.result.outcome == Outcome.OUTCOME_PREEMPTED
    assert "DVZ follows a path now" in ended.result.message
    refused = measuring.result(measuring.follow_person())
    assert refused.result.outcome == Outcome.OUTCOME_REFUSED
    assert "choose VisionRGBFollower or VisionRGBDFollower" in refused.result.message
    assert measuring.result(measuring.send_goal(-1.0, -0.5)).status == SUCCEEDED
    said = {"algorithm_value": "VisionRGBFollower"}
    assert execute(measuring, "controller", "set_algorithm", **said).success
    measuring.person = lambda _now: (0.0, -0.5)
    again = measuring.follow_person()
    measuring.wait_until(lambda: measuring.feedback[-1].feedback.orientation_error, 5, "a sight")
    again.cancel_goal_async()
    assert measuring.result(again).status == CANCELED


@pytest.mark.parametrize(
    ("goal", "told"),
    [
        ({}, "label = '' and no pixel; give"),
        ({"pose_x": -3, "pose_y": 4}, "pose_x, pose_y = (-3, 4); give a pixel"),
        ({"label": "person", "search_timeout": -1.0}, "search_timeout = -1.0; give from 0"),
        ({"label": "person", "search_radius": math.nan}, "search_radius = nan; give from 0"),
    ],
)
def test_a_goal_that_cannot_be_meant_is_refused_with_what_is_wrong(
    measuring: TrackingRobot, goal: dict[str, Any], told: str
) -> None:
    refused = measuring.result(measuring.track(**goal))
    assert (refused.status, refused.result.outcome) == (ABORTED, Outcome.OUTCOME_REFUSED)
    assert told in refused.result.message
    assert measuring.speed < 0.01


def test_without_a_camera_a_goal_is_refused_and_with_a_bad_one_the_robot_stands(
    measuring: TrackingRobot,
) -> None:
    measuring.sees = False
    measuring.rest(1.0)
    refused = measuring.result(measuring.follow_person(), timeout=20)
    assert refused.result.outcome == Outcome.OUTCOME_REFUSED
    assert (
        "nothing on /detections, /camera/camera_info, /camera/depth for 5 s"
        in refused.result.message
    )
    measuring.sees, measuring.encoding = True, "rgb8"
    handle = measuring.follow_person()
    measuring.wait_until(lambda: measuring.status.status == 3, 5, "a SYSTEM failure")
    assert "/camera/depth: its encoding is 'rgb8'; publish one of 16UC1" in measuring.status.msg
    assert measuring.speed < 0.01
    handle.cancel_goal_async()
    assert measuring.result(handle).status == CANCELED
