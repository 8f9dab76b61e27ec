"""The settings that are shipped fit the components, in all three formats."""

import json
import logging
import tomllib
from pathlib import Path

import pytest
import yaml

from kompass.components import Controller, DriveManager, LocalMapper, Planner, PlannerConfig
from kompass.components.base.config_file import ConfigFileError
from kompass.control import ControllersID
from kompass.share import map_path

FORMATS = ["yaml", "json", "toml"]


def path_of(suffix: str) -> str:
    return str(map_path("hexagon").parents[1] / "params" / f"turtlebot3.{suffix}")


@pytest.mark.parametrize("suffix", FORMATS)
def test_every_key_is_known_and_nothing_is_ignored(
    suffix: str, caplog: pytest.LogCaptureFixture
) -> None:
    path = path_of(suffix)
    with caplog.at_level(logging.WARNING):
        planner = Planner(config_file=path)
        controller = Controller(config_file=path)
        mapper, driver = LocalMapper(config_file=path), DriveManager(config_file=path)
    assert not caplog.records
    # The robot is not to be stopped on paths that it planned itself.
    assert planner.config.clearance > driver.config.critical_zone_distance
    assert driver.config.critical_zone_distance == 0.15
    assert controller.algorithms_config["Stanley"].params().heading_gain == 1.5
    assert mapper.config.map_params.resolution == 0.05
    assert planner.frames.odom == "map"
    for algorithm in ControllersID:
        assert controller.algorithms_config[algorithm.value].params()


def test_the_three_formats_say_the_same() -> None:
    texts = {suffix: Path(path_of(suffix)).read_text() for suffix in FORMATS}
    said = yaml.safe_load(texts["yaml"])
    assert json.loads(texts["json"]) == said
    assert tomllib.loads(texts["toml"]) == said


def test_keys_of_older_files_are_accepted_and_told_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "older.yaml"
    path.write_text(
        "drive_manager: {cmd_rate: 10.0, use_gpu: false, closed_loop_span: 3}\n"
        "controller:\n  DVZ: {K_angular: 1.0, min_angular_vel: 0.01}\n"
        "  DWA: {control_horizon: 6, prediction_horizon: 40, octree_resolution: 0.1,\n"
        "        costs_weights: {goal_distance_weight: 1.0}, max_num_threads: 10}\n"
        "planner:\n  algorithm: ompl\n"
        "  inputs: {map_layer: {name: /map, msg_type: OccupancyGrid}}\n"
        "  ompl: {log_level: WARN, planning_timeout: 10.0, planner_id: ompl.geometric.TRRT,\n"
        "         KPIECE1: {optimization_objective: MaximizeMinClearanceObjective}}\n"
    )
    with caplog.at_level(logging.WARNING):
        for _ in range(2):
            DriveManager(config_file=str(path))
            Controller(config_file=str(path))
            planner = Planner(config_file=str(path))
    told = [record.getMessage() for record in caplog.records]
    assert len(told) == len(set(told))
    for word in (
        "cmd_rate",
        "min_angular_vel",
        "prediction_horizon",
        "map_layer",
        "TRRT",
        "log_level",
    ):
        assert any(word in text for text in told), (word, told)
    assert planner.config.chosen_timeout == 10.0


def test_a_planner_that_no_ompl_has_is_refused_with_the_nearest() -> None:
    with pytest.raises(ValueError, match="did you mean 'RRTConnect'"):
        PlannerConfig(planner_id="ompl.geometric.RRTConect")


def test_a_mistyped_key_of_the_planners_section_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text("planner:\n  ompl: {planning_timout: 1.0}\n")
    with pytest.raises(ConfigFileError, match="did you mean 'planning_timeout'"):
        Planner(config_file=str(path))
