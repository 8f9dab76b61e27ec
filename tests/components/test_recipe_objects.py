"""What a recipe may say, and how it is told when it may not."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from kompass.components import (
    Controller,
    ControllerConfig,
    DriveManager,
    DriveManagerConfig,
    LocalMapper,
    Planner,
    PlannerConfig,
    TopicsKeys,
)
from kompass.components.base.config_file import ConfigFileError
from kompass.control import ControllersID
from kompass.rclpy_ext.topic import Topic
from kompass.robot import AngularCtrlLimits, LinearCtrlLimits, RobotGeometry
from kompass.ros import Launcher
from tests.support.described import described_robot


def name_of(topic: Topic | list[Topic] | None) -> str:
    """Of a single topic."""
    assert isinstance(topic, Topic)
    return topic.name


def test_topic_names_are_equal_with_and_without_the_slash() -> None:
    assert Topic(name="/scan", msg_type="LaserScan") == Topic(name="scan", msg_type="LaserScan")


def test_a_topic_of_an_unknown_type_names_the_type() -> None:
    with pytest.raises(ValueError, match="'LaserScann': no such message"):
        Topic(name="/scan", msg_type="LaserScann")


def test_a_message_class_may_stand_for_its_name() -> None:
    from std_msgs.msg import Bool

    assert Topic(name="a", msg_type=Bool).msg_type == "Bool"


def test_one_components_topics_do_not_leak_into_the_next() -> None:
    DriveManager(outputs={"robot_command": Topic(name="/base", msg_type="TwistStamped")})
    assert name_of(DriveManager().get_out_topic("robot_command")) == "cmd_vel"


def test_an_unknown_input_lists_the_known_ones() -> None:
    with pytest.raises(ValueError, match=r"'scan' is not an input; known are .*sensor_data"):
        LocalMapper().inputs(scan=Topic(name="/scan", msg_type="LaserScan"))


def test_an_input_of_a_wrong_type_is_refused_and_nothing_changes() -> None:
    mapper = LocalMapper()
    with pytest.raises(TypeError, match="takes LaserScan or PointCloud2, not the Bool of '/x'"):
        mapper.inputs(
            location=Topic(name="/y", msg_type="Odometry"),
            sensor_data=Topic(name="/x", msg_type="Bool"),
        )
    assert name_of(mapper.get_in_topic("location")) == "odom"


@pytest.mark.parametrize("given", ["ActionServer", "actionserver", "ACTIONSERVER"])
def test_run_types_are_read_in_any_case(given: str) -> None:
    planner = Planner()
    planner.run_type = given
    assert planner.run_type.value == "ActionServer"


def test_an_impossible_run_type_names_the_possible_ones() -> None:
    with pytest.raises(ValueError, match="possible are Timed"):
        LocalMapper().run_type = "ActionServer"


def test_an_algorithm_may_be_named_by_its_string() -> None:
    controller = Controller()
    controller.algorithm = "Stanley"
    assert controller.algorithm is ControllersID.STANLEY
    with pytest.raises(ValueError, match="none of Stanley, PurePursuit"):
        controller.algorithm = "Stanly"


def test_both_spellings_of_the_angular_limits_are_read() -> None:
    older: Any = {"max_omega": 0.4, "max_ang": 1.0}
    assert AngularCtrlLimits(max_vel=0.4, max_steer=1.0) == AngularCtrlLimits(**older)


@pytest.mark.parametrize(
    ("kind", "params", "radius", "height"),
    [
        ("BOX", [0.6, 0.8, 0.4], 0.5, 0.4),
        ("CYLINDER", [0.1, 0.3], 0.1, 0.3),
        ("SPHERE", [0.2], 0.2, 0.4),
        ("ELLIPSOID", [1.0, 2.0, 3.0], 2.0, 6.0),
        ("CAPSULE", [0.2, 1.0], 0.2, 1.4),
        ("CONE", [0.2, 1.0], 0.2, 1.0),
    ],
)
def test_radius_and_height_follow_from_the_shape(
    kind: Any, params: Any, radius: float, height: float
) -> None:
    robot = described_robot(geometry_type=kind, geometry_params=params)
    assert robot.radius == pytest.approx(radius)
    assert robot.height == pytest.approx(height)
    assert np.hypot(*robot.footprint.T).max() == pytest.approx(radius)


def test_a_shape_with_the_wrong_number_of_parameters_says_which_it_needs() -> None:
    with pytest.raises(ValidationError, match="BOX are 3 numbers"):
        described_robot(geometry_type=RobotGeometry.Type.BOX, geometry_params=np.array([1.0]))


def test_a_negative_limit_is_refused() -> None:
    with pytest.raises(ValidationError, match="max_vel"):
        LinearCtrlLimits(max_vel=-1.0)


def test_zones_that_do_not_nest_are_refused() -> None:
    with pytest.raises(ValidationError, match="must be greater than critical_zone_distance"):
        DriveManagerConfig(critical_zone_distance=0.3, slowdown_zone_distance=0.2)


def test_a_config_of_another_component_is_refused() -> None:
    with pytest.raises(TypeError, match="is not a PlannerConfig"):
        Planner(config=ControllerConfig())


@pytest.mark.parametrize(
    ("suffix", "text"),
    [
        (".yaml", "/**:\n  frames: {scan: LDS-01}\nplanner:\n  loop_rate: 2.0\n"),
        (".json", '{"/**": {"frames": {"scan": "LDS-01"}}, "planner": {"loop_rate": 2.0}}'),
        (".toml", '["/**".frames]\nscan = "LDS-01"\n[planner]\nloop_rate = 2.0\n'),
    ],
)
def test_a_config_file_is_laid_over_the_settings(tmp_path: Path, suffix: str, text: str) -> None:
    path = tmp_path / f"robot{suffix}"
    path.write_text(text)
    planner = Planner(config=PlannerConfig(clearance=0.3), config_file=str(path))
    assert planner.config.loop_rate == 2.0
    assert planner.frames.scan == "LDS-01"
    assert planner.config.clearance == 0.3


def test_topics_may_come_from_the_config_file(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(
        "/**:\n  inputs:\n    location: {name: /odometry/filtered, msg_type: Odometry}\n"
        "    sensor_data: {name: /front, msg_type: LaserScan}\n"
    )
    mapper, planner = LocalMapper(config_file=str(path)), Planner(config_file=str(path))
    assert name_of(mapper.get_in_topic("sensor_data")) == "front"
    assert name_of(planner.get_in_topic("location")) == "odometry/filtered"


def test_a_mistyped_setting_names_file_field_and_the_nearest(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text("drive_manager:\n  critical_zone_distanse: 0.1\n")
    with pytest.raises(ConfigFileError) as raised:
        DriveManager(config_file=str(path))
    assert "robot.yaml" in str(raised.value)
    assert "did you mean 'critical_zone_distance'?" in str(raised.value)


def test_a_missing_config_file_is_named() -> None:
    with pytest.raises(ConfigFileError, match=r"nowhere\.yaml: there is no such"):
        Planner(config_file="nowhere.yaml")


@pytest.mark.parametrize("processes", [True, False])
def test_the_launcher_gives_the_robot_and_topics_to_all(processes: bool) -> None:
    planner, driver = Planner(), DriveManager()
    launcher = Launcher()
    launcher.kompass(components=[planner, driver], multi_processing=processes)
    launcher.robot = described_robot(geometry_params=np.array([0.3, 0.5]))
    launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
    assert [robot and robot.radius for robot in launcher.robot.values()] == [0.3, 0.3]
    assert planner.get_in_topic("location") == driver.get_in_topic("location")


def test_an_input_that_no_component_has_is_refused() -> None:
    launcher = Launcher()
    launcher.kompass(components=[Planner()])
    with pytest.raises(ValueError, match=r"no component has 'locaton'; known are .*location"):
        launcher.inputs(locaton=Topic(name="/o", msg_type="Odometry"))


def test_two_components_of_one_name_are_refused() -> None:
    with pytest.raises(ValueError, match="two components are called 'planner'"):
        Launcher().kompass(components=[Planner(), Planner()])


def test_a_launcher_without_components_says_so() -> None:
    with pytest.raises(ValueError, match="no components"):
        Launcher().bringup()


def test_topics_may_be_asked_for_by_the_older_keys() -> None:
    driver, planner = DriveManager(), Planner()
    assert driver.out_topic_name(TopicsKeys.EMERGENCY) == "emergency_stop"
    assert name_of(driver.get_in_topic(TopicsKeys.SPATIAL_SENSOR)) == "scan"
    assert driver.in_topic_name("map") is None
    planner.inputs(
        goal_point=[
            Topic(name="/goal_pose", msg_type="PoseStamped"),
            Topic(name="/clicked_point", msg_type="PointStamped"),
        ]
    )
    assert planner.in_topic_name(TopicsKeys.GOAL_POINT) == ["goal_pose", "clicked_point"]
