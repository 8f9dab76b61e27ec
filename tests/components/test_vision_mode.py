"""Who chooses to follow a target must say with what it is seen, and gets an action server."""

from __future__ import annotations

import array
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from kompass_interfaces.action import ControlPath, TrackVisionTarget
from kompass_interfaces.msg import TwistArray
from kompass_interfaces.srv import StopVisionTracking
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, Image
from vision_msgs.msg import Detection2D, Detection2DArray, ObjectHypothesisWithPose

from kompass.actions import send_component_action_server_goal
from kompass.components import Controller, ControllerConfig, TopicsKeys
from kompass.components.controller.detections import boxes_of, camera_of, depths_of
from kompass.control import ControllersID, VisionRGBDFollowerConfig, VisionRGBFollowerConfig
from kompass.launcher import Launcher
from kompass.ros import Topic
from tests.components.alive import Alive
from tests.components.test_manoeuvres import robot

DETECTIONS = Topic(name="/detections", msg_type="Detection2DArray")
CAMERA = Topic(name="/camera/camera_info", msg_type="CameraInfo")
DEPTH = Topic(name="/camera/depth", msg_type="Image")


def seeing() -> Controller:
    controller = Controller()
    controller.inputs(vision_detections=DETECTIONS, depth_camera_info=CAMERA, depth_image=DEPTH)
    return controller


@pytest.mark.parametrize(
    ("algorithm", "given", "missing"),
    [
        (ControllersID.VISION_IMG, {}, "vision_detections"),
        ("VisionRGBFollower", {"vision_detections": DETECTIONS}, "depth_camera_info"),
        (
            "VISION_DEPTH",
            {"vision_detections": DETECTIONS, "depth_camera_info": CAMERA},
            "depth_image",
        ),
    ],
)
def test_without_what_it_is_to_see_with_it_is_not_chosen(
    algorithm: Any, given: dict[str, Topic], missing: str
) -> None:
    controller = Controller()
    controller.inputs(**given)
    before = controller.algorithm
    with pytest.raises(ValueError, match=rf"needs the input {missing}; give it first, as in inp"):
        controller.algorithm = algorithm
    assert controller.algorithm is before
    assert controller.run_type.value == "Timed"


def test_a_config_that_chooses_it_blindly_is_refused_before_anything_starts() -> None:
    controller = Controller(config=ControllerConfig(algorithm=ControllersID.VISION_IMG))
    launcher = Launcher()
    launcher.kompass(components=[controller])
    with pytest.raises(ValueError, match="needs the input vision_detections"):
        launcher.bringup()
    controller.inputs(vision_detections=DETECTIONS, depth_camera_info=CAMERA)
    controller.check_declaration()


def test_it_is_an_action_server_for_as_long_as_it_is_chosen() -> None:
    controller = seeing()
    controller.algorithm = ControllersID.VISION_DEPTH
    assert controller.run_type.value == "ActionServer"
    assert controller.main_action_name == "controller/track_vision_target"
    assert controller.main_action_type is TrackVisionTarget
    goal = TrackVisionTarget.Goal(label="person")
    assert send_component_action_server_goal(component=controller, request_msg=goal)
    with pytest.raises(
        ValueError, match=r"run_type = Timed is not possible .*; it is ActionServer"
    ):
        controller.run_type = "Timed"
    controller.algorithm = ControllersID.DWA
    assert controller.run_type.value == "Timed"
    assert controller.main_action_type is ControlPath
    assert controller.main_action_name == "controller/control_path"


def test_its_settings_come_from_the_recipe_and_from_older_files(tmp_path: Any) -> None:
    controller = seeing()
    controller.algorithms_config = [
        VisionRGBFollowerConfig(enable_search=False),
        VisionRGBDFollowerConfig(target_distance=1.2),
    ]
    assert controller.algorithms_config["VisionRGBFollower"].params().enable_search is False
    assert controller.algorithms_config["VisionRGBDFollower"].params().target_distance == 1.2
    path = tmp_path / "robot.yaml"
    path.write_text(
        "controller:\n"
        "  VisionRGBFollower: {speed_gain: 0.5, buffer_size: 3, control_horizon: 2}\n"
        "  VisionRGBDFollower: {target_distance: 1.5, error_pose: 0.05, prediction_horizon: 10}\n"
    )
    controller.apply_config_file(str(path))
    assert controller.algorithms_config["VisionRGBFollower"].params().speed_gain == 0.5
    depth = controller.algorithms_config["VisionRGBDFollower"].params()
    assert (depth.target_distance, depth.place_deviation) == (1.5, 0.05)


def test_over_dds_a_goal_makes_it_turn_to_what_is_seen(run_on_dds: Callable[..., Alive]) -> None:
    controller = Controller(config=ControllerConfig(robot=robot()))
    controller.inputs(vision_detections=DETECTIONS, depth_camera_info=CAMERA)
    controller.algorithm = "VisionRGBFollower"
    alive = run_on_dds(controller)
    commands: list[TwistArray] = alive.hear(TwistArray, "/control_list")
    odometry = Odometry()
    odometry.header.frame_id, odometry.pose.pose.orientation.w = "map", 1.0
    found, one = Detection2D(), ObjectHypothesisWithPose()
    one.hypothesis.class_id, one.hypothesis.score = "person", 0.9
    found.results = [one]
    # At the left edge of the image.
    found.bbox.center.position.x, found.bbox.center.position.y = 20.0, 240.0
    found.bbox.size_x, found.bbox.size_y = 40.0, 200.0
    said = {
        alive.publisher(Odometry, "/odom"): odometry,
        alive.publisher(CameraInfo, "/camera/camera_info"): CameraInfo(width=640, height=480),
        alive.publisher(Detection2DArray, "/detections"): Detection2DArray(detections=[found]),
    }
    alive.node.create_timer(0.05, lambda: [where.publish(what) for where, what in said.items()])
    client = alive.action_client(TrackVisionTarget, "/controller/track_vision_target")
    handle = alive.send(client, TrackVisionTarget.Goal(label="person"))
    alive.wait_until(
        lambda: commands and commands[-1].angular_velocities.z[0] > 0.5, 10, "a turn to the left"
    )
    end = StopVisionTracking.Request(label="person")
    assert alive.call(StopVisionTracking, "end_vision_tracking", end).success
    ended = alive.result(handle)
    assert ended.result.outcome == TrackVisionTarget.Result.OUTCOME_ENDED
    assert commands[-1].angular_velocities.z[0] == 0.0


def test_older_names_of_the_inputs_are_keys() -> None:
    controller = seeing()
    assert controller.get_in_topic(TopicsKeys.VISION_DETECTIONS) is not None
    assert controller.get_in_topic(TopicsKeys.DEPTH_CAM_INFO) is not None


def test_a_detection_is_a_box_of_its_likeliest_class() -> None:
    found = Detection2D(id="3")
    found.bbox.center.position.x, found.bbox.center.position.y = 10.0, 20.0
    found.bbox.size_x, found.bbox.size_y = 4.0, 8.0
    for name, score in (("dog", 0.2), ("cat", 0.7), ("cow", 0.1)):
        one = ObjectHypothesisWithPose()
        one.hypothesis.class_id, one.hypothesis.score = name, score
        found.results.append(one)
    cat, nothing = boxes_of(Detection2DArray(detections=[found, Detection2D()]))
    assert (cat.label, cat.x, cat.y, cat.width, cat.height, cat.track) == ("cat", 10, 20, 4, 8, "3")
    assert not nothing.is_usable


def test_a_camera_without_a_focal_length_is_none() -> None:
    with pytest.raises(ValueError, match=r"fx of the camera is 0\.0; publish one above 0"):
        camera_of(CameraInfo(width=640, height=480))


@pytest.mark.parametrize(
    ("encoding", "kind", "scale"),
    [("16UC1", "<u2", 0.001), ("32FC1", "<f4", 1.0), ("16UC1", ">u2", 0.001)],
)
def test_depths_are_read_as_they_are_encoded(encoding: str, kind: str, scale: float) -> None:
    given = np.array([[1, 2, 3], [4, 5, 6]], dtype=kind)
    # Rows may be longer than what they hold.
    rows = b"".join(row.tobytes() + b"\xff\xff\xff\xff" for row in given)
    step = len(rows) // 2
    image = Image(height=2, width=3, encoding=encoding, step=step, is_bigendian=kind[0] == ">")
    image.data = array.array("B", rows)
    assert np.allclose(depths_of(image, 0.001), given * scale)
    image.data = array.array("B", rows[:-1])
    with pytest.raises(ValueError, match="bytes are fewer than 2 rows of 3 depths need"):
        depths_of(image, 0.001)
    image.encoding = "rgb8"
    with pytest.raises(ValueError, match="its encoding is 'rgb8'; publish one of 16UC1"):
        depths_of(image, 0.001)
    assert math.isfinite(float(depths_of(Image(encoding="32FC1"), 1.0).size))
