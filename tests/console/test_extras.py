"""Further layers: found by type, read only while somebody looks, and drawn where they are."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import (
    Point,
    Point32,
    PolygonStamped,
    Pose,
    PoseArray,
    PoseStamped,
    Quaternion,
    TransformStamped,
)
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan, PointCloud2, PointField
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from kompass_console.link.on_demand.extras import MOST_READ, newest
from kompass_console.schema.look_models import MOST_EXTRAS
from kompass_console.schema.roles import Role
from tests.console.conftest import Served, cookie_of
from tests.console.looking import FlatPage, flat_page
from tests.console.scene_client import SceneClient
from tests.console.test_link import State, listening, until
from tests.support.processes import wait_until
from tests.support.robot import Robot

pytestmark = pytest.mark.ros

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BEST_EFFORT = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)


# What the scene draws anyway; where it is not there, the next of its kind takes its place.
USUAL = (
    (Path, "/plan"),
    (LaserScan, "/scan"),
    (OccupancyGrid, "/map"),
    (OccupancyGrid, "/local_map/occupancy_layer"),
    (PolygonStamped, "/robot/footprint"),
)


@pytest.fixture
def robot(console: Served, domain: int) -> Iterator[Robot]:
    robot = Robot(domain)
    usual = [robot.node.create_publisher(kind, name, LATCHED) for kind, name in USUAL]
    robot.wait_until(
        lambda: all(each.get_subscription_count() > 0 for each in usual), 10, "the console"
    )
    yield robot
    robot.close()


@pytest.fixture
def client(console: Served) -> Iterator[httpx.Client]:
    with console.client(Role.VIEWER) as client:
        yield client


@pytest.fixture
def page(console: Served, client: httpx.Client) -> Iterator[FlatPage]:
    with flat_page(console, client) as page:
        yield page


@contextmanager
def told(console: Served, client: httpx.Client, topic: str) -> Iterator[Callable[..., State]]:
    """Waits until what pages are told of a further topic fits."""
    with listening(console, client) as socket:

        def wait(good: Callable[[State], object]) -> State:
            def fits(state: State) -> object:
                one = [each for each in state["extras"] if each["topic"] == topic]
                return one and good(one[0])

            found = until(socket, fits)
            return next(each for each in found["extras"] if each["topic"] == topic)

        yield wait


def path_of(points: list[tuple[float, float]], frame: str = "map") -> Path:
    path = Path(header=Header(frame_id=frame))
    path.poses = [PoseStamped(pose=Pose(position=Point(x=x, y=y, z=0.0))) for x, y in points]
    return path


def cloud_of(points: np.ndarray, frame: str = "map") -> PointCloud2:
    cloud = PointCloud2(header=Header(frame_id=frame), height=1, width=len(points))
    cloud.fields = [
        PointField(name=name, offset=4 * i, datatype=PointField.FLOAT32, count=1)
        for i, name in enumerate("xyz")
    ]
    cloud.point_step, cloud.row_step = 12, 12 * len(points)
    cloud.data = points.astype(np.float32).tobytes()
    return cloud


def mounting(parent: str, child: str, x: float, yaw: float = 0.0) -> TFMessage:
    transform = TransformStamped(header=Header(frame_id=parent), child_frame_id=child)
    transform.transform.translation.x = x
    transform.transform.rotation = Quaternion(z=math.sin(yaw / 2), w=math.cos(yaw / 2))
    return TFMessage(transforms=[transform])


def test_a_topic_is_read_once_while_pages_show_it_and_not_before_or_after(
    console: Served, client: httpx.Client, page: FlatPage, robot: Robot
) -> None:
    publisher = robot.node.create_publisher(Path, "/other/way", LATCHED)
    publisher.publish(path_of([(0.0, 0.0), (1.0, 0.5), (2.0, 0.5)]))
    with told(console, client, "/other/way") as of_way:
        said = of_way(lambda each: True)
        assert (said["kind"], said["age"], said["problem"]) == ("path", None, "")
        assert publisher.get_subscription_count() == 0
        page.show("/other/way")
        page.until(lambda extras: "/other/way" in extras)
        assert page.extras["/other/way"]["lines"] == [0.0, 0.0, 1.0, 0.5, 1.0, 0.5, 2.0, 0.5]
        assert of_way(lambda each: each["age"] is not None)["problem"] == ""
        with console.client(Role.OPERATOR) as other, flat_page(console, other) as second:
            second.show("/other/way")
            second.until(lambda extras: "/other/way" in extras)
            assert publisher.get_subscription_count() == 1
            page.show()
            page.until(lambda extras: not extras)
            publisher.publish(path_of([(5.0, 5.0), (6.0, 6.0)]))
            second.until(lambda extras: extras["/other/way"]["lines"] == [5.0, 5.0, 6.0, 6.0])
        wait_until(lambda: publisher.get_subscription_count() == 0, 5.0, "nobody reads it")
        of_way(lambda each: each["age"] is None)


def test_what_the_stack_has_drawn_anyway_is_no_further_layer(
    console: Served, client: httpx.Client, robot: Robot
) -> None:
    robot.node.create_publisher(LaserScan, "/rear_scan", BEST_EFFORT)
    with listening(console, client) as socket:
        state = until(
            socket, lambda state: any(e["topic"] == "/rear_scan" for e in state["extras"])
        )
    topics = {each["topic"] for each in state["extras"]}
    assert not topics & {name for _, name in USUAL}


def test_a_layer_is_drawn_in_its_frame_and_says_so_where_that_is_not_connected(
    console: Served, client: httpx.Client, page: FlatPage, robot: Robot
) -> None:
    odometry = Odometry(header=Header(frame_id="map"))
    odometry.pose.pose.position.x, odometry.pose.pose.position.y = 2.0, 1.0
    odometry.pose.pose.orientation = Quaternion(z=math.sqrt(0.5), w=math.sqrt(0.5))
    moving = robot.node.create_publisher(Odometry, "/odometry/filtered", 10)
    cloud = robot.node.create_publisher(PointCloud2, "/depth/points", BEST_EFFORT)
    static = robot.node.create_publisher(TFMessage, "/tf_static", LATCHED)
    beat = robot.node.create_timer(
        0.05,
        lambda: (
            moving.publish(odometry),
            cloud.publish(cloud_of(np.array([[1.0, 0.0, 0.3]]), "depth_camera")),
        ),
    )
    page.show("/depth/points")
    with told(console, client, "/depth/points") as of_cloud:
        problem = of_cloud(lambda each: each["problem"])["problem"]
        assert problem == (
            "Its frame depth_camera is not connected to map: no transform says where it is."
        )
        assert page.extras.get("/depth/points", {}).get("points", []) == []
        static.publish(mounting("base_link", "depth_camera", 0.5))
        of_cloud(lambda each: each["problem"] == "" and each["age"] is not None)
        # Half a metre before the robot's middle, a metre ahead of that, and it looks to the north.
        page.until(lambda extras: extras.get("/depth/points", {}).get("points") == [2.0, 2.5])
    beat.cancel()


def test_every_kind_is_drawn_by_what_it_says(page: FlatPage, robot: Robot) -> None:
    poses = PoseArray(header=Header(frame_id="map"))
    poses.poses = [Pose(position=Point(x=1.0, y=2.0), orientation=Quaternion(w=1.0))]
    scan = LaserScan(header=Header(frame_id="map"), angle_increment=math.pi / 2)
    scan.range_min, scan.range_max, scan.ranges = 0.1, 3.0, [1.0, 2.0, math.inf, math.nan]
    grid = OccupancyGrid(header=Header(frame_id="map"))
    grid.info.resolution, grid.info.width, grid.info.height = 0.5, 3, 2
    grid.info.origin.position.x = 1.0
    grid.data = [0, 100, 100, -1, 0, 30]
    polygon = PolygonStamped(header=Header(frame_id="map"))
    polygon.polygon.points = [Point32(x=0.0), Point32(x=1.0), Point32(y=1.0)]
    sent = [
        (PoseArray, "/particles", poses),
        (LaserScan, "/low_scan", scan),
        (OccupancyGrid, "/costs", grid),
        (PolygonStamped, "/fence", polygon),
        (
            Marker,
            "/sign",
            Marker(
                header=Header(frame_id="map"),
                type=Marker.TEXT_VIEW_FACING,
                text="here\n<b>",
                pose=Pose(position=Point(x=3.0)),
                color=opaque(),
                scale=metre(),
            ),
        ),
    ]
    for kind, name, message in sent:
        robot.node.create_publisher(kind, name, LATCHED).publish(message)
    page.show(*(name for _, name, _ in sent))
    page.until(lambda extras: all(any(extras.get(name, {}).values()) for _, name, _ in sent))
    assert page.extras["/particles"]["lines"] == [1.0, 2.0, 1.25, 2.0]
    assert page.extras["/low_scan"]["points"] == [1.0, 0.0, 0.0, 2.0]
    assert page.extras["/costs"]["areas"] == [1.5, 0.0, 2.5, 0.0, 2.5, 0.5, 1.5, 0.5]
    assert page.extras["/fence"]["lines"][:4] == [0.0, 0.0, 1.0, 0.0]
    assert page.extras["/fence"]["lines"][-4:] == [0.0, 1.0, 0.0, 0.0]
    assert page.extras["/sign"]["texts"] == [{"x": 3.0, "y": 0.0, "text": "here <b>"}]


def opaque() -> Any:
    return Marker().color.__class__(r=1.0, a=1.0)


def metre() -> Any:
    return Marker().scale.__class__(x=1.0, y=1.0, z=1.0)


def test_markers_come_change_and_go_as_they_say(page: FlatPage, robot: Robot) -> None:
    publisher = robot.node.create_publisher(MarkerArray, "/marks", 10)

    def mark(number: int, x: float, action: int = Marker.ADD, lifetime: float = 0.0) -> Marker:
        until = Duration(sec=int(lifetime), nanosec=int(lifetime % 1 * 1e9))
        made = Marker(header=Header(frame_id="map"), ns="a", id=number, type=Marker.POINTS)
        made.action, made.lifetime, made.color, made.scale = action, until, opaque(), metre()
        made.points = [Point(x=x)]
        return made

    def say(*markers: Marker) -> None:
        publisher.publish(MarkerArray(markers=list(markers)))

    def is_shown(*x: float) -> None:
        points = [each for one in x for each in (one, 0.0)]
        page.until(lambda extras: extras.get("/marks", {}).get("points") == points)

    page.show("/marks")
    robot.wait_until(lambda: publisher.get_subscription_count() > 0, 5, "the console")
    say(mark(1, 1.0), mark(2, 2.0))
    is_shown(1.0, 2.0)
    say(mark(1, 0.0, Marker.DELETE))
    is_shown(2.0)
    say(mark(3, 3.0, lifetime=0.5))
    is_shown(2.0, 3.0)
    is_shown(2.0)
    say(mark(0, 0.0, Marker.DELETEALL), mark(4, 4.0))
    is_shown(4.0)


def test_a_million_points_become_as_many_as_a_page_can_draw(
    console: Served, client: httpx.Client, robot: Robot
) -> None:
    view = str(client.post("/api/views").json()["id"])
    scene = SceneClient(console.port, view, cookie_of(client))
    points = np.random.default_rng(1).normal(size=(1_000_000, 3))
    points[::7] = math.nan
    publisher = robot.node.create_publisher(PointCloud2, "/hall/points", LATCHED)
    publisher.publish(cloud_of(points))
    try:
        scene.look()
        assert client.patch(f"/api/views/{view}", json={"extras": ["/hall/points"]}).is_success
        with told(console, client, "/hall/points") as of_cloud:
            said = of_cloud(lambda each: each["note"])
            assert said["note"] == "One in 125 of 1000000 points is drawn."
        name = "/world/extra0/points"
        wait_until(lambda: "points" in scene.updates.get(name, {}), 5.0, "points in the scene")
    finally:
        scene.close()


def wrong_messages() -> list[tuple[str, Any, str]]:
    """What contradicts itself or is too large, and a word of what people are told of it."""
    grid = OccupancyGrid(header=Header(frame_id="map"))
    grid.info.resolution, grid.info.width, grid.info.height, grid.data = 0.05, 4_000_000, 4000, [0]
    unpinned = path_of([(math.nan, 0.0), (math.inf, 1.0)])
    truncated = cloud_of(np.zeros((5, 3)))
    truncated.width = 2**31
    odd = cloud_of(np.zeros((5, 3)))
    odd.fields = odd.fields[:2]
    many = path_of([(0.0, 0.0)])
    many.poses = many.poses * 40_000
    return [
        ("/wrong/grid", grid, "data: 1 cells"),
        ("/wrong/path", unpinned, "none of 2 is finite"),
        ("/wrong/cloud", truncated, "data has 60 bytes"),
        ("/wrong/fields", odd, "fields has no 'z'"),
        ("/wrong/size", many, "2 MB is the most of this kind"),
    ]


def test_what_cannot_be_drawn_is_refused_in_a_sentence_and_disturbs_nobody(
    console: Served, client: httpx.Client, page: FlatPage, robot: Robot
) -> None:
    sent = wrong_messages()
    for name, message, _ in sent:
        robot.node.create_publisher(type(message), name, LATCHED).publish(message)
    robot.node.create_publisher(PointCloud2, "/well/cloud", LATCHED).publish(
        cloud_of(np.zeros((0, 3)))
    )
    page.show(*(name for name, _, _ in sent), "/well/cloud")
    with listening(console, client) as socket:

        def all_said(state: State) -> bool:
            problems = {each["topic"]: each["problem"] for each in state["extras"]}
            return all(problems.get(name) for name, _, _ in sent)

        state = until(socket, all_said, 15.0)
        problems = {each["topic"]: each for each in state["extras"]}
        for name, _, word in sent:
            assert word in problems[name]["problem"], problems[name]
            assert problems[name]["problem"].startswith("Not drawn: ")
        until(
            socket,
            lambda s: any(
                e["topic"] == "/well/cloud" and e["age"] is not None for e in s["extras"]
            ),
        )
    assert not any(any(shape.values()) for shape in page.extras.values())


def test_a_page_shows_so_many_further_layers_and_all_pages_together_so_many(
    console: Served, client: httpx.Client, robot: Robot
) -> None:
    names = [f"/many/way{number:02}" for number in range(MOST_READ + 1)]
    for name in names:
        robot.node.create_publisher(Path, name, LATCHED).publish(path_of([(0, 0), (1, 1)]))
    view = str(client.post("/api/views").json()["id"])
    over = client.patch(f"/api/views/{view}", json={"extras": names[: MOST_EXTRAS + 1]})
    assert over.status_code == 422
    no_name = client.patch(f"/api/views/{view}", json={"extras": ["way"]})
    assert no_name.status_code == 422
    with (
        flat_page(console, client) as one,
        flat_page(console, client) as two,
        flat_page(console, client) as three,
        told(console, client, names[-1]) as of_last,
    ):
        one.show(*names[:MOST_EXTRAS])
        two.show(*names[MOST_EXTRAS:-1])
        three.show(names[-1])
        said = of_last(lambda each: each["problem"])
        assert said["problem"] == (
            f"{MOST_READ} further layers are drawn on all pages; switch one off."
        )
        one.show()
        of_last(lambda each: each["problem"] == "" and each["age"] is not None)


def test_of_more_messages_than_can_be_read_the_newest_count() -> None:
    waiting = [bytes([number]) * 400 for number in range(6)]
    assert newest(waiting, 1000) == waiting[-2:]
    assert newest(waiting, 10_000) == waiting
    assert newest([bytes(5000)], 1000) == [bytes(5000)]
    assert newest([], 1000) == []


def test_a_flood_of_markers_is_drawn_as_of_now_and_says_what_is_left_out(
    console: Served, client: httpx.Client, page: FlatPage, robot: Robot
) -> None:
    publisher = robot.node.create_publisher(MarkerArray, "/flood", 10)
    many = [
        Marker(header=Header(frame_id="map"), id=number, color=opaque(), scale=metre())
        for number in range(1500)
    ]

    def say(x: float) -> None:
        many[0].pose.position.x = x
        publisher.publish(MarkerArray(markers=many))

    page.show("/flood")
    robot.wait_until(lambda: publisher.get_subscription_count() > 0, 5, "the console")
    with told(console, client, "/flood") as of_flood:
        for x in range(30):
            say(float(x))
        of_flood(lambda each: "faster than it can be read" in each["note"])
    page.until(lambda extras: 29.0 in extras.get("/flood", {}).get("lines", []), 15.0)
