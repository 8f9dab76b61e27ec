"""Several scanners and point clouds: each placed by its frame, each with its own faults, named."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import OccupancyGrid
from numpy.typing import NDArray
from rclpy.qos import QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan, PointCloud2, PointField
from tf2_msgs.msg import TFMessage

from kompass.components import Controller, DriveManager, LocalMapper
from kompass.components.base.convert import grid_of
from kompass.components.base.health import TEXTS
from kompass.ros import Topic
from tests.components.alive import LATCHED, Alive, Virtual
from tests.components.test_by_hand import Scene
from tests.components.toy_robot import ToyRobot

Run = Callable[..., Alive]
Points = NDArray[np.float64]
BOTH = [Topic(name="/scan", msg_type="LaserScan"), Topic(name="/cloud", msg_type="PointCloud2")]
FLOOR = np.array([[x, y, 0.0] for x in np.arange(0.3, 2.0, 0.1) for y in np.arange(-1, 1, 0.1)])
MOUNTED = (0.1, 0.4, 0.3)  # x [m], pitch [rad], z [m]
# Far enough to the side not to be in the way.
POST = np.array([[0.5, 1.5, 0.1]])


def box(x: float, height: float = 0.1) -> Points:
    """The front of a box across the way of the robot."""
    return np.array([[x, y, z] for y in np.arange(-0.2, 0.2, 0.04) for z in (0.06, height)])


class Camera:
    """Publishes a cloud ten times a second, from ahead on the robot, looking down.

    Attributes
    ----------
    points
        What it sees now, (N, 3) in the frame of the robot.
    change
        Is given each message before it is sent.
    tells
        Whether it says, on a topic of moving transforms, where it is.
    """

    def __init__(self, alive: Alive, *, moves: bool = False) -> None:
        self.alive, self.sends, self.tells = alive, True, True
        if moves:
            self._tf = alive.node.create_publisher(TFMessage, "/tf", 10)
            alive.node.create_timer(0.05, self._tell)
        else:
            self._tf = alive.node.create_publisher(TFMessage, "/tf_static", LATCHED)
            self._tell()
        self.points: Callable[[], Points] = lambda: FLOOR
        self.change: Callable[[PointCloud2], object] = lambda _message: None
        self._random = np.random.default_rng(0)
        self._publisher = alive.publisher(PointCloud2, "/cloud", qos_profile_sensor_data)
        alive.node.create_timer(0.1, self._send)

    def _tell(self) -> None:
        if self.tells:
            self._tf.publish(transform(self.alive, *MOUNTED))

    def _send(self) -> None:
        if not self.sends:
            return
        points = seen_by_camera(self.points(), *MOUNTED)
        message = PointCloud2(height=1, width=len(points), point_step=12, row_step=12 * len(points))
        message.header.frame_id = "camera"
        message.header.stamp = self.alive.node.get_clock().now().to_msg()
        message.fields = [
            PointField(name=name, offset=4 * n, datatype=PointField.FLOAT32, count=1)
            for n, name in enumerate("xyz")
        ]
        noise = self._random.normal(0.0, 0.001, points.shape)
        message.data = (points + noise).astype("<f4").tobytes()
        self.change(message)
        self._publisher.publish(message)


def transform(alive: Alive, x: float, pitch: float, z: float, roll: float = 0.0) -> TFMessage:
    """Where the frame "camera" is on the robot."""
    message = TransformStamped()
    message.header.stamp = alive.node.get_clock().now().to_msg()
    message.header.frame_id, message.child_frame_id = "base_link", "camera"
    message.transform.translation.x, message.transform.translation.z = x, z
    turned = message.transform.rotation
    turned.w, turned.y, turned.x = math.cos(pitch / 2), math.sin(pitch / 2), 0.0
    if roll:
        turned.w, turned.x = math.cos(roll / 2), math.sin(roll / 2)
    return TFMessage(transforms=[message])


def seen_by_camera(points: Points, x: float, pitch: float, z: float) -> Points:
    """Points of the robot's frame in that of the camera."""
    moved, cos, sin = points - (x, 0.0, z), math.cos(pitch), math.sin(pitch)
    return np.stack(
        [cos * moved[:, 0] - sin * moved[:, 2], moved[:, 1],
         sin * moved[:, 0] + cos * moved[:, 2]], axis=1,
    )  # fmt: skip


def scene_with_camera(run: Run, *, moves: bool = False, **config: Any) -> tuple[Scene, Camera]:
    driver = DriveManager(inputs={"sensor_data": BOTH})
    for name, value in config.items():
        setattr(driver.config, name, value)
    alive = run(driver)
    camera, scene = Camera(alive, moves=moves), Scene(alive)
    scene.wait(lambda: is_well(alive), "a gate that sees")
    return scene, camera


def is_well(alive: Alive) -> bool:
    """Whether it says that it is, and waits for nothing."""
    status = alive.statuses[-1] if alive.statuses else None
    return status is not None and (status.status, status.msg) == (0, TEXTS[0])


def reason(scene: Scene) -> str:
    return str(scene.alive.statuses[-1].msg)


def held(scene: Scene, said: str, topic: str = "/cloud") -> None:
    """It stands, and names the sensor and what is wrong with it."""
    scene.wait(lambda: scene.state.limited_by == "scan stale", "that it is held back")
    assert scene.stands()
    scene.wait(lambda: said in reason(scene), f"the reason {said!r}")
    assert list(scene.alive.statuses[-1].src_topics) == [topic]


def test_what_is_lower_than_the_scan_stops_the_robot_and_the_floor_does_not(run: Run) -> None:
    scene, camera = scene_with_camera(run)
    scene.driven()
    camera.points = lambda: np.concatenate([FLOOR, box(0.8 - scene.robot.x)])
    scene.wait(lambda: scene.state.limited_by == "obstacle", "that it is held back")
    scene.wait(scene.robot.is_halted, "a halt")
    assert 0.4 < scene.robot.x < 0.65  # its radius, and the zone, before it


def test_what_it_goes_under_does_not_stop_it(run: Run) -> None:
    scene, camera = scene_with_camera(run)
    shelf = np.array([[0.8, y, 1.2] for y in np.arange(-0.5, 0.5, 0.05)])
    camera.points = lambda: np.concatenate([FLOOR, shelf - (scene.robot.x, 0.0, 0.0)])
    scene.driven()
    scene.wait(lambda: scene.robot.x > 1.2, "that it has gone under it")


def test_what_the_camera_does_not_see_any_more_is_still_in_the_way(run: Run) -> None:
    scene, camera = scene_with_camera(run)
    scene.driven()
    # As one that sees nothing nearer than 0.4 m.
    camera.points = lambda: np.concatenate(
        [FLOOR[FLOOR[:, 0] > 0.5], box(0.9 - scene.robot.x) if scene.robot.x < 0.5 else POST]
    )
    scene.wait(lambda: scene.state.limited_by == "obstacle", "that it is held back")
    assert scene.stands(3.0)
    assert scene.robot.x < 0.75


def test_a_camera_that_moves_is_where_its_frame_says_as_long_as_it_is_told(run: Run) -> None:
    scene, camera = scene_with_camera(run, moves=True)
    hand = scene.driven()
    camera.points = lambda: np.concatenate([FLOOR, box(0.8 - scene.robot.x)])
    scene.wait(lambda: scene.state.limited_by == "obstacle", "that it is held back")
    scene.wait(scene.robot.is_halted, "a halt")
    assert 0.4 < scene.robot.x < 0.65
    hand.vx = -0.2
    scene.wait(lambda: scene.robot.commands[-1][0] < -0.1, "that it backs off")
    camera.tells = False
    held(scene, "from 'camera' to 'base_link', which moves, is more than 0.5 s older than what was")


def bad(**fields: Any) -> Callable[[PointCloud2], object]:
    """Clouds with other fields."""

    def change(message: PointCloud2) -> None:
        for name, value in fields.items():
            setattr(message, name, value)

    return change


def drop_z(message: PointCloud2) -> None:
    message.fields = message.fields[:2]


def blind(message: PointCloud2) -> None:
    message.data = np.full(3 * message.width, np.nan, "<f4").tobytes()


def empty(message: PointCloud2) -> None:
    message.width, message.data = 0, b""


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (drop_z, "the point cloud on /cloud cannot be used: fields has no 'z'"),
        (bad(data=b"12"), "data has 2 bytes, and 1 rows of"),
        (bad(point_step=4), "goes beyond a point of point_step = 4 bytes"),
        (blind, "it has no point that was measured; look whether the sensor is covered"),
        (empty, "it has no point that was measured"),
    ],
)
def test_nobody_drives_by_a_cloud_that_says_nothing(
    run: Run, change: Callable[[PointCloud2], object], said: str
) -> None:
    scene, camera = scene_with_camera(run)
    scene.driven()
    camera.change = change
    held(scene, said)


def test_an_empty_cloud_of_obstacles_only_says_that_the_way_is_free(run: Run) -> None:
    scene, camera = scene_with_camera(run, clouds_may_be_empty=True)
    camera.change = empty
    scene.driven()
    scene.wait(lambda: scene.robot.x > 0.3, "that it drives on")


def test_a_cloud_that_repeats_itself_while_the_robot_moves_is_frozen_until_it_does_not(
    run: Run,
) -> None:
    scene, camera = scene_with_camera(run)
    camera.points = lambda: np.concatenate([FLOOR, POST])
    scene.driven()
    kept: list[Any] = []

    def freeze(message: PointCloud2) -> None:
        kept.append(message.data)
        message.data = kept[0]

    camera.change = freeze
    held(scene, "the point cloud on /cloud stays the same to the last bit while the robot moves")
    camera.change = lambda _message: None
    scene.wait(lambda: scene.state.limited_by != "scan stale", "that it may go on")


def test_each_sensor_is_missed_by_itself(run: Run) -> None:
    scene, camera = scene_with_camera(run)
    hand = scene.driven()
    camera.sends = False
    held(scene, "no point cloud on /cloud")
    camera.sends = True
    hand.vx = 0.0
    scene.alive.rest(0.3)
    hand.vx = 0.2
    scene.wait(scene.moves, "that it goes on")
    scene.robot.scans = False
    held(scene, "no scan on /scan", "/scan")


def test_without_all_of_them_it_drives_by_those_that_speak_where_that_is_allowed(run: Run) -> None:
    scene, camera = scene_with_camera(run, use_without_scan_sensor=True)
    camera.sends = False
    scene.driven()
    scene.robot.posts = [(0.8, 0.0, 0.1)]
    scene.wait(lambda: scene.state.limited_by == "obstacle", "that the scan still counts")


def test_a_scanner_that_hangs_upside_down_sees_what_is_left_on_the_left(run: Run) -> None:
    alive = run(LocalMapper())
    robot, maps = ToyRobot(alive), alive.hear(OccupancyGrid, "/local_map/occupancy_layer")
    robot.posts = [(0.0, 0.6, 0.1)]
    alive.node.create_publisher(TFMessage, "/tf_static", LATCHED).publish(
        transform(alive, 0.0, 0.0, 0.2, roll=math.pi)
    )
    make = robot.make_scan

    def hanging() -> LaserScan:
        scan = make()
        scan.header.frame_id = "camera"
        scan.ranges = scan.ranges[::-1]
        scan.angle_min += scan.angle_increment  # of what was the last ray
        return scan

    robot.make_scan = hanging  # type: ignore[method-assign]
    alive.wait_until(lambda: maps and grid_of(maps[-1]).occupied().any(), 10, "a map of it")
    grid = grid_of(maps[-1])
    rows, cols = np.nonzero(grid.occupied())
    assert grid.cell_to_world(np.stack([cols, rows], axis=1))[:, 1].min() > 0.3


def test_a_scanner_that_is_not_level_is_refused_with_what_to_do(run: Run) -> None:
    alive = run(DriveManager())
    publisher = alive.node.create_publisher(TFMessage, "/tf_static", LATCHED)
    publisher.publish(transform(alive, 0.0, 0.0, 0.2, roll=math.pi / 4))
    scene = Scene(alive)
    make = scene.robot.make_scan

    def tilted() -> LaserScan:
        scan = make()
        scan.header.frame_id = "camera"
        return scan

    scene.robot.make_scan = tilted  # type: ignore[method-assign]
    scene.wait(lambda: "mounted 45 degrees out of the level" in reason(scene), "the reason")
    assert "PointCloud2" in reason(scene)


def test_the_local_map_shows_what_any_of_them_sees(run: Run) -> None:
    alive = run(LocalMapper(inputs={"sensor_data": BOTH}))
    robot, maps = ToyRobot(alive), alive.hear(OccupancyGrid, "/local_map/occupancy_layer")
    robot.posts = [(-0.8, 0.0, 0.1)]
    camera = Camera(alive)
    camera.points = lambda: np.concatenate([FLOOR, box(0.8)])

    def at(x: float, y: float) -> int:
        grid = grid_of(maps[-1])
        ((col, row),) = grid.world_to_cell([[x, y]])
        return int(grid.cells[row, col])

    alive.wait_until(lambda: maps and at(0.805, 0.0) == 100, 10, "what the cloud shows")
    assert at(-0.71, 0.0) == 100
    assert at(0.4, 0.6) == 0
    camera.sends = False
    alive.wait_until(lambda: "nothing on /cloud" in alive.statuses[-1].msg, 10, "the reason")
    assert list(alive.statuses[-1].src_topics) == ["/cloud"]


def test_a_controller_that_sees_by_itself_names_the_sensor_that_is_silent(
    run: Callable[..., Virtual],
) -> None:
    controller = Controller(inputs={"sensor_data": BOTH})
    controller.direct_sensor = True
    alive = run(controller)
    ToyRobot(alive)
    camera = Camera(alive)
    alive.wait_until(lambda: is_well(alive), 10, "a controller that sees")
    camera.change = drop_z
    alive.wait_until(lambda: "/cloud: fields has no 'z'" in alive.statuses[-1].msg, 10, "why")
    assert list(alive.statuses[-1].src_topics) == ["/cloud"]


def test_a_band_in_which_nothing_is_is_refused() -> None:
    with pytest.raises(
        ValueError, match=r"cloud_max_height = 0\.1 m is not above cloud_min_height"
    ):
        DriveManager().config.model_validate({"cloud_min_height": 0.2, "cloud_max_height": 0.1})


def test_other_kinds_of_sensors_are_refused_when_they_are_named() -> None:
    with pytest.raises(TypeError, match="takes LaserScan or PointCloud2, not the Float64 of '/us'"):
        DriveManager(inputs={"sensor_data": Topic(name="/us", msg_type="Float64")})


def test_large_clouds_of_a_driver_that_sends_reliably_all_come(run_on_dds: Run) -> None:
    driver = DriveManager(inputs={"sensor_data": BOTH})
    alive, heard = run_on_dds(driver), list[PointCloud2]()
    publisher = alive.publisher(PointCloud2, "/cloud", QoSProfile(depth=10))
    topic = "/cloud"

    def is_reliable() -> bool:
        readers = alive.node.get_subscriptions_info_by_topic(topic)
        return [one.qos_profile.reliability for one in readers] == [ReliabilityPolicy.RELIABLE]

    alive.wait_until(is_reliable, 10, "a reader that has lost parts sent again")
    alive.wait_until(publisher.get_subscription_count, 10, "the reader")
    driver.input("sensor_data", 1).on_message = heard.append
    # Some 1,200 kB each, far more than a socket holds.
    cloud = PointCloud2(height=1, width=76_800, point_step=16, row_step=16 * 76_800)
    cloud.data = bytes(cloud.row_step)
    for _ in range(10):
        publisher.publish(cloud)
        alive.rest(0.05)
    alive.wait_until(lambda: len(heard) == 10, 20, "all ten")
