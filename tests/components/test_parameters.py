"""Settings change while the robot drives: typed, all or none, at once."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from automatika_ros_sugar.srv import (
    ChangeParameter,
    ChangeParameters,
    ConfigureFromFile,
    ReplaceTopic,
)
from geometry_msgs.msg import Twist, TwistStamped
from lifecycle_msgs.msg import TransitionEvent
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.logging import get_logger

from kompass.components import (
    DriveManager,
    DriveManagerConfig,
    LocalMapper,
    LocalMapperConfig,
    MapServerConfig,
)
from kompass.components.base.parameter import ParameterError, read_values, with_values
from kompass.rclpy_ext.topic import Topic
from tests.components.alive import Alive
from tests.support.described import described_robot

Run = Callable[..., Alive]


def set_one(
    alive: Alive, name: str, value: str, keep_alive: bool = True
) -> ChangeParameter.Response:
    request = ChangeParameter.Request(name=name, value=value, keep_alive=keep_alive)
    return alive.call(ChangeParameter, "update_config_parameter", request)


@pytest.mark.parametrize(
    ("text", "value"),
    [("False", False), ("false", False), ("0", False), ("True", True), ("true", True)],
)
def test_a_truth_value_is_read_as_a_person_writes_it(text: str, value: bool) -> None:
    config = DriveManagerConfig(disable_safety_stop=not value)
    values, refused = read_values(config, {"disable_safety_stop": text})
    assert not refused
    changed = with_values(config, values)
    assert changed.disable_safety_stop is value


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("critical_zone_distance", "0.1", 0.1),
        ("critical_zone_distance", "1e-1", 0.1),
        ("log_level", "debug", "debug"),
        ("log_level", '"debug"', "debug"),
    ],
)
def test_the_field_decides_the_type(name: str, text: str, value: object) -> None:
    values, refused = read_values(DriveManagerConfig(), {name: text})
    assert not refused
    assert getattr(with_values(DriveManagerConfig(), values), name) == value


def test_a_text_that_reads_as_a_number_stays_a_text_where_a_text_belongs() -> None:
    assert read_values(MapServerConfig(), {"map_file_path": "3"}) == ({"map_file_path": "3"}, {})


def test_a_dotted_name_leads_into_a_nested_setting() -> None:
    changed = with_values(LocalMapperConfig(), {"map_params.width": 5})
    assert changed.map_params.width == 5.0
    assert changed.map_params.height == LocalMapperConfig().map_params.height


@pytest.mark.parametrize(
    ("name", "value", "remedy"),
    [
        ("critical_zone_distanse", 0.1, "did you mean 'critical_zone_distance'?"),
        ("critical_zone_distance", -1, "greater than 0"),
        ("critical_zone_distance", "near", "valid number"),
        ("loop_rate.x", 1, "'loop_rate' holds no settings; those that do are frames"),
        ("robot.model_type", "OMNI", "nobody gave 'robot' yet; give it whole"),
        ("critical_zone_distance", 1e9, "less than or equal to 10; allowed is > 0 and ≤ 10"),
        ("critical_zone_distance", 0.5, "must be greater than critical_zone_distance = 0.5"),
    ],
)
def test_a_refused_setting_names_itself_its_value_and_the_remedy(
    name: str, value: object, remedy: str
) -> None:
    config = DriveManagerConfig()
    with pytest.raises(ParameterError) as raised:
        with_values(config, {name: value}, "drive_manager")
    assert remedy in str(raised.value)
    assert str(raised.value).startswith("drive_manager: ")
    assert config.model_dump() == DriveManagerConfig().model_dump()


def test_a_change_through_the_service_takes_effect(run: Run) -> None:
    driver = DriveManager()
    alive = run(driver)
    assert set_one(alive, "critical_zone_distance", "0.15").success
    assert driver.config.critical_zone_distance == 0.15
    assert driver.is_active


def test_a_change_that_is_refused_changes_nothing_and_says_why(run: Run) -> None:
    driver = DriveManager()
    answer = set_one(run(driver), "critical_zone_distance", "far")
    assert not answer.success
    assert "drive_manager: 'critical_zone_distance' = 'far'" in answer.error_msg
    assert driver.config == DriveManagerConfig(robot=described_robot())


def test_of_several_changes_all_or_none_are_made(run: Run) -> None:
    driver = DriveManager()
    alive = run(driver)

    def change(**values: str) -> ChangeParameters.Response:
        request = ChangeParameters.Request(
            names=list(values), values=list(values.values()), keep_alive=True
        )
        return alive.call(ChangeParameters, "update_config_parameters", request)

    answer = change(scan_timeout="0.7", command_timeout="-1")
    assert list(answer.success) == [False, False]
    assert "because 'command_timeout' was refused" in answer.error_msg[0]
    assert "greater than 0" in answer.error_msg[1]
    assert driver.config == DriveManagerConfig(robot=described_robot())

    # Neither of these is possible alone.
    answer = change(critical_zone_distance="0.3", slowdown_zone_distance="0.4")
    assert list(answer.success) == [True, True], list(answer.error_msg)
    assert driver.config.slowdown_zone_distance == 0.4


def test_a_change_without_keep_alive_restarts_the_component(run: Run) -> None:
    driver = DriveManager()
    alive = run(driver)
    transitions = alive.hear(TransitionEvent, f"/{driver.node_name}/transition_event")
    alive.wait_until(
        lambda: alive.node.count_subscribers("/drive_manager/transition_event") == 1,
        5,
        "a listener",
    )
    assert set_one(alive, "scan_timeout", "0.7", keep_alive=False).success
    assert driver.is_active
    alive.wait_until(
        lambda: [event.goal_state.label for event in transitions].count("active") == 1,
        5,
        "a restart",
    )
    assert driver.config.scan_timeout == 0.7


@pytest.mark.ros
def test_a_change_of_the_loop_rate_changes_the_loop(run_on_dds: Run) -> None:
    mapper = LocalMapper()
    alive = run_on_dds(mapper)
    assert set_one(alive, "loop_rate", "50").success
    # Beside the loop there are a timer that exchanges the challenge, once a minute, and one that
    # repeats the status of a component that is not active.
    node: Any = mapper.node
    assert sorted(round(1e9 / timer.timer_period_ns) for timer in node.timers) == [0, 5, 50]


def test_a_file_reconfigures_a_running_component(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text("drive_manager:\n  scan_timeout: 0.8\n")
    driver = DriveManager()
    alive = run(driver)
    request = ConfigureFromFile.Request(path_to_file=str(path), keep_alive=True)
    assert alive.call(ConfigureFromFile, "configure_from_file", request).success
    assert driver.config.scan_timeout == 0.8

    path.write_text("drive_manager:\n  scan_timeout: 0.9\n  scan_timout: 1.0\n")
    answer = alive.call(ConfigureFromFile, "configure_from_file", request)
    assert not answer.success
    assert "did you mean 'scan_timeout'?" in answer.error_msg
    assert driver.config.scan_timeout == 0.8


def test_an_input_can_be_moved_to_another_topic_while_running(run: Run) -> None:
    driver = DriveManager()
    alive = run(driver)
    request = ReplaceTopic.Request(old_name="/control", new_name="/joystick", new_msg_type="Twist")
    assert alive.call(ReplaceTopic, "change_topic", request).success
    publisher = alive.publisher(Twist, "/joystick")
    publisher.publish(Twist())
    alive.wait_until(lambda: driver.input("command").message is not None, 5, "a command")
    alive.wait_until(
        lambda: alive.node.count_subscribers("/control") == 0, 5, "the end of the old one"
    )


def test_an_output_can_be_moved_to_another_topic_while_running(run: Run) -> None:
    alive = run(DriveManager())
    request = ReplaceTopic.Request(
        direction=ReplaceTopic.Request.OUTPUT_TOPIC,
        old_name="cmd_vel",
        new_name="/base/cmd_vel",
        new_msg_type="TwistStamped",
    )
    answer = alive.call(ReplaceTopic, "change_topic", request)
    assert answer.success, answer.error_msg
    alive.hear(TwistStamped, "/base/cmd_vel")
    alive.wait_until(
        lambda: alive.node.count_publishers("/base/cmd_vel") == 1, 5, "the new publisher"
    )


@pytest.mark.parametrize(
    ("old", "kind", "message"),
    [
        ("/nowhere", "Twist", "no input uses '/nowhere'; those in use are /control"),
        ("/control", "LaserScan", "command takes Twist, not the LaserScan"),
        ("/control", "Twizt", "no such message"),
    ],
)
def test_a_topic_that_does_not_fit_is_refused(run: Run, old: str, kind: str, message: str) -> None:
    driver = DriveManager()
    request = ReplaceTopic.Request(old_name=old, new_name="/new", new_msg_type=kind)
    answer = run(driver).call(ReplaceTopic, "change_topic", request)
    assert not answer.success
    assert message in answer.error_msg
    assert driver.get_in_topic("command") == Topic(name="/control", msg_type="Twist")


@pytest.mark.ros
def test_the_log_level_is_that_of_the_nodes_own_log_and_changes_while_it_runs(
    run_on_dds: Run,
) -> None:
    driver = DriveManager(config=DriveManagerConfig(log_level="error"))
    alive = run_on_dds(driver)
    logger: Any = driver.node.get_logger()
    assert logger.get_effective_level() is LoggingSeverity.ERROR
    assert get_logger("rcl").get_effective_level() is LoggingSeverity.WARN
    assert set_one(alive, "log_level", "debug").success
    assert logger.get_effective_level() is LoggingSeverity.DEBUG
    assert set_one(alive, "rclpy_log_level", "error").success
    assert get_logger("rcl").get_effective_level() is LoggingSeverity.ERROR
