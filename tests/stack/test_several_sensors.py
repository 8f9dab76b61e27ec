"""A lidar, a scanner that looks back and a depth camera on one robot: what each of them is for."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ExecuteMethod
from kompass_interfaces.msg import DriveState
from kompass_interfaces.srv import SetFault
from numpy.typing import NDArray
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image

from kompass.launch.virtual_stack import Embedded
from kompass.simulation.physics.robot_model import TURTLEBOT3_PLUS
from kompass.simulation.sensors.picture_camera import PictureCamera
from kompass.simulation.worlds import registry
from kompass.simulation.worlds.shapes import Box
from kompass.simulation.worlds.world import World
from kompass.virtual.network import Conditions
from tests.support.stack import RECIPE
from tests.support.tester import LATCHED
from tests.support.virtual_robot import VirtualRobot

SEVERAL = RECIPE.with_name("09_several_sensors.py")
PLUS = Embedded(kind=TURTLEBOT3_PLUS, has_map=False)
REAR = '        Topic(name="/rear_scan", msg_type="LaserScan"),\n'
CAMERA = '        Topic(name="/camera/points", msg_type="PointCloud2"),\n'
SENSOR = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
SUCCEEDED = 4
SYSTEM = ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL
STATUS = "/drive_manager/status"
# Lower than the lidar's plane, at 0.17 m.
LOW = Box("low_box", (1.3, 0.0), (0.3, 0.5), height=0.10)
HALL = World(
    name="low",
    title="A hall with a box that the lidar looks over",
    floor=((-2.0, -2.0), (4.0, -2.0), (4.0, 2.0), (-2.0, 2.0)),
    start=(0.0, 0.0, 0.0),
    obstacles=(LOW,),
)


@pytest.fixture(autouse=True)
def hall(monkeypatch: pytest.MonkeyPatch) -> None:
    """Known for as long as a test takes: others count the worlds there are."""
    monkeypatch.setattr(registry, "_WORLDS", dict(registry._WORLDS))
    registry.add_world(HALL)


def brought_up(
    recipe: Path = SEVERAL, start: tuple[float, float, float] | None = None
) -> VirtualRobot:
    """A robot that is ready in that hall."""
    client = VirtualRobot(recipe, place="low", start=start, embedded=PLUS)
    client.subscribe(ComponentStatus, STATUS, LATCHED)
    client.subscribe(DriveState, "/drive_state", LATCHED)
    client.ready()
    return client


def without(tmp_path: Path, *sensors: str) -> Path:
    """The recipe, with fewer sensors."""
    recipe, text = tmp_path / "fewer.py", SEVERAL.read_text(encoding="utf-8")
    for sensor in sensors:
        assert sensor in text
        text = text.replace(sensor, "")
    recipe.write_text(text, encoding="utf-8")
    return recipe


def back_off(robot: VirtualRobot, distance: float) -> None:
    """Have the drive manager do so, as far as it lets itself."""
    request = ExecuteMethod.Request(
        name="move_backward", kwargs_json=json.dumps({"max_distance": distance})
    )
    robot.call(ExecuteMethod, "/drive_manager/execute_method", request, timeout=30)


@pytest.fixture
def robot() -> Iterator[VirtualRobot]:
    with closing(brought_up()) as client:
        yield client


def test_a_box_that_the_lidar_looks_over_is_gone_round(robot: VirtualRobot) -> None:
    ended = robot.result(robot.send_goal(2.6, 0.0), timeout=90)
    assert ended.status == SUCCEEDED, ended.result.message
    assert robot.distance_to(2.6, 0.0) < 0.10
    assert robot.contacts == 0


def test_a_low_box_that_comes_up_in_the_way_is_gone_round_as_the_recipe_says(
    robot: VirtualRobot,
) -> None:
    handle = robot.send_goal(0.0, 1.5)
    robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
    request = SetFault.Request(fault="low_box", on=True)
    assert robot.call(SetFault, "/simulator/set_fault", request).success
    ended = robot.result(handle, timeout=90)
    assert ended.status == SUCCEEDED, ended.result.message
    assert robot.contacts == 0


def test_without_the_camera_the_same_box_is_run_into(tmp_path: Path) -> None:
    with closing(brought_up(without(tmp_path, CAMERA))) as blind:
        blind.send_goal(2.6, 0.0)
        blind.wait_until(lambda: blind.contacts > 0, 60, "contact with the box")


def test_what_stands_low_behind_is_not_backed_into() -> None:
    with closing(brought_up(start=(1.9, 0.0, 0.0))) as client:
        before = client.truth[0]
        back_off(client, 1.0)
        assert client.contacts == 0
        assert client.truth[0] < before - 0.15  # as far as there is room


def test_without_the_scanner_behind_it_is(tmp_path: Path) -> None:
    with closing(brought_up(without(tmp_path, REAR), start=(1.9, 0.0, 0.0))) as client:
        back_off(client, 1.0)
        assert client.contacts > 0


@pytest.mark.parametrize(
    ("topic", "told"),
    [("/rear_scan", "no scan on /rear_scan"), ("/camera/points", "no point cloud on /camera/poi")],
)
def test_one_sensor_that_falls_silent_holds_the_robot_and_is_named(
    robot: VirtualRobot, topic: str, told: str
) -> None:
    handle = robot.send_goal(2.6, 0.0)
    robot.wait_until(lambda: robot.speed > 0.15, 20, "motion")
    robot.world.network.set_conditions(Conditions(loss=1.0), topic=topic)

    def says() -> bool:
        status = robot.newest.get(STATUS)
        if status is None or status.status != SYSTEM:
            return False
        return list(status.src_topics) == [topic] and told in status.msg

    robot.wait_until(says, 5, f"a drive manager that says '{told}'")
    robot.wait_until(lambda: robot.speed < 0.01, 1, "a halt")
    assert robot.newest["/drive_state"].limited_by == "scan stale"
    before = robot.truth
    robot.watch(2.0)
    assert robot.distance_to(before[0], before[1]) < 0.01
    robot.world.network.set_conditions(Conditions(), topic=topic)
    assert robot.result(handle, timeout=90).status == SUCCEEDED
    assert robot.contacts == 0


def test_pictures_are_taken_while_somebody_looks_and_at_no_other_time(
    robot: VirtualRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken: list[float] = []
    take = PictureCamera.picture

    def counted(camera: PictureCamera) -> NDArray[np.uint8]:
        taken.append(robot.clock.monotonic())
        return take(camera)

    monkeypatch.setattr(PictureCamera, "picture", counted)
    robot.rest(2.0)
    assert taken == []
    robot.subscribe(Image, "/camera/image", SENSOR)
    robot.wait_until(lambda: len(taken) > 5, 5, "pictures")
    image = robot.newest["/camera/image"]
    assert (image.encoding, image.height, image.width) == ("rgb8", 120, 160)
    assert image.header.frame_id == "camera_link"
    assert taken[-1] - taken[0] == pytest.approx(0.2 * (len(taken) - 1), abs=0.03)
