"""The controller sees obstacles with one sensor or the other, and changes over without a halt."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from automatika_ros_sugar.srv import ChangeParameter
from geometry_msgs.msg import PoseStamped
from kompass_interfaces.action import ControlPath
from kompass_interfaces.msg import TwistArray
from nav_msgs.msg import Odometry, Path
from pydantic import ValidationError
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

from kompass.algorithms.grid import Grid
from kompass.components import Controller, ControllerConfig
from kompass.components.base.config_file import ConfigFileError
from kompass.components.base.convert import grid_msg
from kompass.control import ControllersID, DWAConfig, StanleyConfig
from kompass.rclpy_ext.topic import Topic
from tests.components.alive import LATCHED, Alive
from tests.components.test_manoeuvres import robot

Run = Callable[..., Alive]


class Stage:
    """Everything that a controller listens to, published at 20 Hz; nothing moves."""

    def __init__(self, run: Run, **settings: Any) -> None:
        self.controller = Controller(config=ControllerConfig(robot=robot(), **settings))
        self.alive = run(self.controller)
        self.at = (0.0, 0.0)
        self.scans = self.maps = True
        self.odometry = True
        self.obeys = False  # reports the commanded speed
        self.ring: float | None = None  # radius of a wall all around the robot [m]
        node = self.alive.node
        self._odometry = node.create_publisher(Odometry, "/odom", 10)
        self._scan = node.create_publisher(LaserScan, "/scan", qos_profile_sensor_data)
        self._map = node.create_publisher(
            Topic(name="m", msg_type="OccupancyGrid").ros_msg_type, "/local_map/occupancy_layer", 1
        )
        self._plan = node.create_publisher(Path, "/plan", LATCHED)
        self.commands: list[TwistArray] = self.alive.hear(TwistArray, "/control_list")
        self.tracked: list[PoseStamped] = self.alive.hear(PoseStamped, "/tracked_point")
        node.create_timer(0.05, self._tick)

    def _tick(self) -> None:
        if self.odometry:
            odometry = Odometry()
            odometry.header.frame_id = "map"
            odometry.pose.pose.position.x, odometry.pose.pose.position.y = self.at
            odometry.pose.pose.orientation.w = 1.0
            if self.obeys and self.commands:
                odometry.twist.twist.linear.x = self.speed
            self._odometry.publish(odometry)
        if self.scans:
            scan = LaserScan(range_min=0.05, range_max=3.5, angle_increment=math.radians(1))
            scan.header.frame_id = "base_link"
            scan.ranges = [self.ring or math.inf] * 360
            self._scan.publish(scan)
        if self.maps:
            cells = np.zeros((60, 60), dtype=np.int8)
            if self.ring:
                angles = np.linspace(0, 2 * math.pi, 90)
                columns = (30 + self.ring * np.cos(angles) / 0.05).astype(int)
                rows = (30 + self.ring * np.sin(angles) / 0.05).astype(int)
                cells[rows, columns] = 100
            grid = Grid(cells, 0.05, (self.at[0] - 1.5, self.at[1] - 1.5, 0.0))
            stamp = self.alive.node.get_clock().now().to_msg()
            self._map.publish(grid_msg(grid, "map", stamp))

    def plan(self, *points: tuple[float, float]) -> None:
        path = Path()
        path.header.frame_id = "map"
        for x, y in points:
            pose = PoseStamped()
            pose.pose.position.x, pose.pose.position.y = x, y
            pose.pose.orientation.w = 1.0
            path.poses.append(pose)
        self._plan.publish(path)

    def listeners(self) -> tuple[int, int]:
        """To the scan and to the local map."""
        return self._scan.get_subscription_count(), self._map.get_subscription_count()

    @property
    def speed(self) -> float:
        return self.commands[-1].linear_velocities.x[0] if self.commands else math.nan

    @property
    def place(self) -> tuple[float, float]:
        """Where on the path the controller takes the robot to be [m]."""
        if not self.tracked:
            return math.nan, math.nan
        position = self.tracked[-1].pose.position
        return position.x, position.y

    def drives(self) -> bool:
        return self.speed > 0.05

    def set(self, name: str, value: str) -> ChangeParameter.Response:
        request = ChangeParameter.Request(name=name, value=value, keep_alive=True)
        answer = self.alive.call(ChangeParameter, "update_config_parameter", request)
        assert answer.success, answer.error_msg
        return answer

    def status(self) -> Any:
        self.alive.wait_until(lambda: self.alive.statuses, 5, "a status")
        return self.alive.statuses[-1]


STRAIGHT = ((0.0, 0.0), (1.0, 0.0), (2.0, 0.0))


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({}, (0, 1)),
        ({"use_direct_sensor": True}, (1, 0)),
        ({"algorithm": "Stanley", "use_direct_sensor": True}, (0, 0)),
        ({"algorithm": "PurePursuit"}, (0, 0)),
    ],
)
def test_only_the_sensor_that_is_needed_is_subscribed_to(
    run: Run, settings: dict[str, Any], expected: tuple[int, int]
) -> None:
    stage = Stage(run, **settings)
    stage.plan(*STRAIGHT)
    stage.alive.wait_until(stage.drives, 10, "motion")
    assert stage.listeners() == expected


def test_a_path_that_takes_too_long_to_look_at_is_not_followed_and_the_one_before_ends(
    run: Run,
) -> None:
    stage = Stage(run)
    stage.plan(*STRAIGHT)
    stage.alive.wait_until(stage.drives, 5, "the path is followed")
    stage.plan(*[(0.0, 0.0)] * 20_001)
    stage.alive.wait_until(lambda: stage.speed == 0.0, 5, "a standstill")
    stage.plan(*STRAIGHT)
    stage.alive.wait_until(stage.drives, 5, "the next path is followed")


def test_as_an_action_server_it_follows_what_is_on_plan_when_a_goal_asks_for_it(run: Run) -> None:
    stage = Stage(run)
    stage.controller.run_type = "ActionServer"
    stage.plan(*STRAIGHT)
    stage.alive.wait_until(lambda: stage.controller.input("plan").message, 5, "the plan")
    stage.alive.rest(1.0)
    assert not stage.commands
    client = stage.alive.action_client(ControlPath, "/controller/control_path")
    handle = stage.alive.send(client, ControlPath.Goal())
    stage.alive.wait_until(stage.drives, 10, "motion")
    stage.plan()
    stage.alive.rest(1.0)
    assert stage.drives()  # the path is not the planner's any more
    handle.cancel_goal_async()
    stage.alive.wait_until(lambda: stage.speed == 0.0, 5, "a stop command")
    assert stage.alive.result(handle).result.outcome == ControlPath.Result.OUTCOME_CANCELED


def test_the_sensor_can_be_changed_on_the_way_without_a_halt(run: Run) -> None:
    stage = Stage(run)
    stage.plan(*STRAIGHT)
    stage.alive.wait_until(stage.drives, 10, "motion")
    before = len(stage.commands)
    stage.scans = False  # the new source is late
    stage.set("use_direct_sensor", "True")
    switched = len(stage.commands)
    stage.alive.wait_until(
        lambda: len(stage.commands) > switched + 4, 5, "commands with the old source"
    )
    stage.scans = True
    stage.alive.wait_until(lambda: stage.listeners() == (1, 0), 5, "the change of subscriptions")
    after = len(stage.commands)
    stage.alive.wait_until(lambda: len(stage.commands) > after + 10, 5, "commands after it")
    assert all(one.linear_velocities.x[0] > 0.05 for one in stage.commands[before:])
    assert all(one.status == 0 for one in stage.alive.statuses)


def test_a_dead_local_map_is_a_system_failure_and_the_scan_takes_over(run: Run) -> None:
    stage = Stage(run)
    stage.plan(*STRAIGHT)
    stage.alive.wait_until(stage.drives, 10, "motion")
    stage.maps = False
    stage.alive.wait_until(lambda: stage.status().status == 3, 5, "a SYSTEM failure")
    assert list(stage.status().src_topics) == ["/local_map/occupancy_layer"]
    stage.alive.wait_until(lambda: stage.speed == 0.0, 5, "a stop command")
    stage.set("use_direct_sensor", "True")
    stage.alive.wait_until(stage.drives, 5, "motion again")
    stage.alive.wait_until(lambda: stage.status().status == 0, 5, "health")


@pytest.mark.parametrize("direct", [False, True])
def test_no_way_round_an_obstacle_is_an_algorithm_failure_and_stops(run: Run, direct: bool) -> None:
    stage = Stage(run, use_direct_sensor=direct)
    stage.plan(*STRAIGHT)
    stage.alive.wait_until(stage.drives, 10, "motion")
    stage.ring = 0.14
    stage.alive.wait_until(lambda: stage.status().status == 1, 5, "an ALGORITHM failure")
    assert list(stage.status().src_algorithms) == ["MPPI"]
    stage.alive.wait_until(lambda: stage.speed == 0.0, 5, "a stop command")
    stage.ring = None
    stage.alive.wait_until(stage.drives, 5, "motion again")
    stage.alive.wait_until(lambda: stage.status().status == 0, 5, "health")


def test_another_algorithm_goes_on_where_the_last_one_was(run: Run) -> None:
    stage = Stage(run, algorithm="PurePursuit")
    # There and back beside itself: the nearest place alone would not tell where the robot is.
    stage.plan((0.0, 0.0), (1.0, 0.0), (1.0, 0.1), (0.0, 0.1))
    stage.alive.wait_until(stage.drives, 10, "motion")
    for step in range(1, 11):
        stage.at = (0.1 * step, 0.0)
        stage.alive.wait_until(lambda: stage.place[0] > 0.1 * step - 0.05, 5, "progress")  # noqa: B023
    stage.at = (1.0, 0.1)
    stage.alive.wait_until(lambda: stage.place[1] > 0.05, 5, "the way back")
    before, count = stage.place, len(stage.tracked)
    assert stage.alive.execute("set_algorithm", algorithm_value="Stanley").success
    assert stage.controller.algorithm is ControllersID.STANLEY
    stage.alive.wait_until(lambda: len(stage.tracked) > count + 3, 5, "more places")
    # Not back on the way out, nor at its beginning.
    for message in stage.tracked[count:]:
        assert message.pose.position.y >= before[1] - 1e-6


def test_another_algorithm_drives_on_without_a_dip_in_speed(run: Run) -> None:
    stage = Stage(run, algorithm="PurePursuit")
    stage.plan(*STRAIGHT)
    stage.alive.wait_until(stage.drives, 10, "motion")
    stage.obeys = True
    stage.alive.wait_until(lambda: stage.speed > 0.19, 5, "full speed")
    before = len(stage.commands)
    for name in ("Stanley", "MPPI", "DWA", "PurePursuit"):
        assert stage.alive.execute("set_algorithm", algorithm_value=name).success
        now = len(stage.commands)
        stage.alive.wait_until(lambda: len(stage.commands) > now + 5, 5, f"commands of {name}")  # noqa: B023
    slowest = min(one.linear_velocities.x[0] for one in stage.commands[before:])
    assert slowest > 0.9 * 0.19


def test_a_robot_that_gets_nowhere_is_an_algorithm_failure_until_it_moves(run: Run) -> None:
    stage = Stage(run, algorithm="Stanley", progress_timeout=0.6)
    stage.plan(*STRAIGHT)
    stage.alive.wait_until(stage.drives, 10, "motion")
    stage.alive.wait_until(lambda: stage.status().status == 1, 5, "an ALGORITHM failure")
    assert list(stage.status().src_algorithms) == ["Stanley"]
    assert "no progress" in stage.status().msg
    assert stage.drives()
    stage.at = (0.1, 0.0)
    stage.alive.wait_until(lambda: stage.status().status == 0, 5, "health")
    assert list(stage.status().src_algorithms) == []


def test_an_unknown_algorithm_is_refused_and_nothing_changes(run: Run) -> None:
    stage = Stage(run)
    answer = stage.alive.execute("set_algorithm", algorithm_value="Stanly")
    assert not answer.success
    assert "'Stanly' is none of Stanley, PurePursuit, DWA" in answer.error_msg
    assert stage.controller.algorithm is ControllersID.MPPI


def test_a_lost_pose_stops_the_robot(run: Run) -> None:
    stage = Stage(run)
    stage.plan(*STRAIGHT)
    stage.alive.wait_until(stage.drives, 10, "motion")
    stage.odometry = False
    stage.alive.wait_until(lambda: stage.status().status == 3, 5, "a SYSTEM failure")
    assert list(stage.status().src_topics) == ["/odom"]
    stage.alive.wait_until(lambda: stage.speed == 0.0, 5, "a stop command")


def test_an_algorithm_that_there_is_not_says_which_there_are() -> None:
    with pytest.raises(ValidationError, match=r"'MPC' is none of Stanley, PurePursuit, DWA, DVZ"):
        Controller().algorithm = "MPC"


def test_the_users_choice_of_sensor_is_kept_for_every_algorithm() -> None:
    controller = Controller()
    controller.algorithm = ControllersID.STANLEY
    controller.direct_sensor = False
    assert controller.direct_sensor is False
    controller.direct_sensor = True
    assert controller.config.use_direct_sensor is True


def test_sections_of_the_file_set_up_the_algorithms(tmp_path: Any) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(
        "controller:\n  DWA: {path_weight: 5.0, max_linear_samples: 7, octree_resolution: 0.1}\n"
        "  Stanley: {heading_gain: 2.0, goal_dist_tolerance: 0.08}\n"
    )
    controller = Controller(config_file=str(path))
    params = controller.algorithms_config["DWA"].params()
    assert (params.path_weight, params.linear_samples) == (5.0, 7)
    stanley = controller.algorithms_config["Stanley"].params(goal_tolerance=0.03)
    assert (stanley.heading_gain, stanley.goal_tolerance) == (2.0, 0.08)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("DWA: {path_weigt: 5.0}", "did you mean 'path_weight'?"),
        (
            "Stanley: {wheel_base: 0.0}",
            "= 0.0: Input should be greater than or equal to 0.001; allowed is ≥ 0.001 and ≤ 100",
        ),
        ("DWA: {linear_samples: 1}", "allowed is ≥ 2 and ≤ 100"),
    ],
)
def test_a_wrong_setting_of_an_algorithm_names_the_remedy(
    tmp_path: Any, text: str, message: str
) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(f"controller:\n  {text}\n")
    with pytest.raises(ConfigFileError) as raised:
        Controller(config_file=str(path))
    assert message in str(raised.value)


def test_settings_of_algorithms_may_come_from_the_recipe() -> None:
    controller = Controller()
    controller.algorithms_config = [DWAConfig(clearance=0.1), StanleyConfig(heading_gain=0.5)]
    assert controller.algorithms_config["DWA"].params().clearance == 0.1
    with pytest.raises(TypeError, match="is none of StanleyConfig"):
        controller.algorithms_config = 3
