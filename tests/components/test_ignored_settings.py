"""A setting without effect: read from older recipes and files, told once, closed to rules."""

import json
import logging
from pathlib import Path
from typing import Any, ClassVar

import pytest
import yaml
from automatika_ros_sugar.srv import ChangeParameter

from kompass.actions import update_parameter
from kompass.components import (
    Component,
    ComponentConfig,
    Controller,
    ControllerConfig,
    DriveManager,
    DriveManagerConfig,
    LocalMapper,
    MapConfig,
    MapServer,
    Planner,
    PlannerConfig,
)
from kompass.components.base.config_file import sections_of_nobody
from kompass.components.base.parameter import ParameterError
from kompass.control import DWAConfig
from kompass.monitor.introspection.component_specs import component_spec
from kompass.settings import Settings
from tests.components.alive import Alive

# Every name that older recipes may give a value, by the component that takes it.
NAMES = {
    "drive_manager": {
        *("cmd_rate", "closed_loop", "closed_loop_span", "cmd_tolerance", "smooth_commands"),
        *("critical_zone_angle", "use_gpu", "pointcloud_angle_resolution"),
    },
    "planner": {
        *("algorithm", "depth_conversion_factor", "depth_range", "ompl.log_level", "retries"),
        *("visualization", "detailed_logging", "number_of_sent_cmds", "safety_stop_dist"),
        "stop_angle_range",
    },
    "controller": {
        *("prediction_horizon", "debug", "DWA.costs_weights"),
        *("VisionRGBFollower.target_distance", "VisionRGBDFollower.error_pose"),
    },
    "mapper": {
        *(
            f"scan_model.{name}"
            for name in ("range_sure", "wall_size", "angle_step", "max_height", "min_height")
        ),
        "scan_model.range_max",
        *(
            f"map_params.{name}"
            for name in ("padding", "filter_limit", "max_points_per_line", "max_num_threads")
        ),
    },
    "map_server": {
        *("map_file_read_rate", "pc_publish_row", "pc_frame", "grid_resolution"),
        "z_ground_limit",
    },
}
OF_ALL = {
    *("topic_try_wait_timeout", "executor_spin_timeout", "wait_for_restart_time"),
    "core_log_level",
}


def all_components() -> list[Component]:
    return [DriveManager(), Planner(), Controller(), LocalMapper(), MapServer()]


def told(caplog: pytest.LogCaptureFixture, name: str) -> list[str]:
    return [text for record in caplog.records if f"'{name}'" in (text := record.getMessage())]


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: DriveManagerConfig(use_gpu=True), "use_gpu"),  # type: ignore[call-arg]
        (lambda: PlannerConfig(depth_range=[0.1, 1.0]), "depth_range"),  # type: ignore[call-arg]
        (lambda: ControllerConfig(debug=True), "debug"),  # type: ignore[call-arg]
        (lambda: MapConfig(filter_limit=3.0), "filter_limit"),  # type: ignore[call-arg]
        (lambda: DWAConfig(octree_resolution=0.1), "octree_resolution"),
        (lambda: ComponentConfig(wait_for_restart_time=1.0), "wait_for_restart_time"),  # type: ignore[call-arg]
    ],
)
def test_a_recipe_may_still_give_it(make: Any, name: str) -> None:
    made = make()
    assert name not in made.model_dump()
    assert made.model_dump() == type(made)().model_dump()


def test_it_is_told_once_with_the_place_and_the_reason(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "told_once.yaml"
    path.write_text(
        "drive_manager: {closed_loop: false, scan_timeout: 0.7}\n"
        "controller: {DWA: {drop_samples: true}}\n"
    )
    with caplog.at_level(logging.WARNING):
        drivers = [DriveManager(config_file=str(path)) for _ in range(2)]
        Controller(config_file=str(path))
    assert [driver.config.scan_timeout for driver in drivers] == [0.7, 0.7]
    (text,) = told(caplog, "closed_loop")
    assert f"{path}, section 'drive_manager'" in text
    assert "the base holds the commanded speed" in text
    (text,) = told(caplog, "drop_samples")
    assert "section 'controller', DWA" in text


def test_assigning_it_changes_nothing_and_is_told(caplog: pytest.LogCaptureFixture) -> None:
    config = DriveManagerConfig()
    with caplog.at_level(logging.WARNING):
        for _ in range(2):
            config.smooth_commands = False
    assert config.model_dump() == DriveManagerConfig().model_dump()
    assert len(told(caplog, "smooth_commands")) == 1


def test_a_mistyped_setting_is_still_an_error() -> None:
    with pytest.raises(ValueError, match="use_gpus"):
        DriveManagerConfig(use_gpus=True)  # type: ignore[call-arg]


def test_rule_editors_are_not_offered_it() -> None:
    for component in all_components():
        spec = component_spec(component)
        ignored = NAMES[component.node_name] | OF_ALL
        assert ignored <= set(spec.ignored)
        assert not set(spec.ignored) & set(spec.parameters)
        assert not [name for name, each in spec.parameters.items() if "effect" in each.text]


def test_a_recipe_that_lets_a_rule_set_it_is_refused_with_the_reason() -> None:
    for name, value, why in (
        ("use_gpu", True, "needs no GPU"),
        ("closed_loop", False, "the base holds the commanded speed"),
    ):
        with pytest.raises(ParameterError, match=f"'{name}'.* would have no effect: .*{why}"):
            update_parameter(component=DriveManager(), param_name=name, new_value=value)
    with pytest.raises(ParameterError, match=r"'map_params\.padding'.* would have no effect"):
        update_parameter(component=LocalMapper(), param_name="map_params.padding", new_value=0.1)


def test_a_service_call_that_sets_it_is_refused_with_the_reason(run: Any) -> None:
    alive: Alive = run(DriveManager())
    request = ChangeParameter.Request(name="use_gpu", value="true", keep_alive=True)
    answer = alive.call(ChangeParameter, "update_config_parameter", request)
    assert not answer.success
    assert "drive_manager: 'use_gpu' = True would have no effect" in answer.error_msg


def test_a_component_of_ones_own_may_name_such_settings_too(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    class LampConfig(ComponentConfig):
        ignored_settings: ClassVar = {"colour": "it is always white"}
        # A name that the base ignores may mean something here.
        wait_for_restart_time: float = 1.0

    class Lamp(Component):
        config_class = LampConfig
        ignored_settings: ClassVar = {"shape": "it is always round"}

    path = tmp_path / "lamp.yaml"
    path.write_text("lamp: {colour: red, shape: oval, loop_rate: 3.0, wait_for_restart_time: 2.0}")
    with caplog.at_level(logging.WARNING):
        lamp = Lamp("lamp", config_file=str(path))
    assert lamp.config.loop_rate == 3.0
    assert isinstance(lamp.config, LampConfig)
    assert lamp.config.wait_for_restart_time == 2.0
    assert told(caplog, "colour")
    assert told(caplog, "shape")
    assert "wait_for_restart_time" in component_spec(lamp).parameters


def test_plain_settings_ignore_nothing() -> None:
    class Plain(Settings):
        number: int = 0

    with pytest.raises(ValueError, match="colour"):
        Plain(colour="red")  # type: ignore[call-arg]


# Keys of the files that come with the original packages, over their releases.
ORIGINAL = """
/**: {frames: {robot_base: base_link, odom: map, world: map, scan: hokuyo}}
mapper: {loop_rate: 10.0, map_params: {width: 3.0, padding: 0.0}, scan_model: {p_prior: 0.6}}
drive_manager:
  cmd_rate: 10.0
  critical_zone_angle: 90.0
  closed_loop: false
  use_gpu: false
  outputs: {robot_command: {name: cmd_vel, msg_type: Twist}}
controller:
  control_time_step: 0.1
  ctrl_publish_type: Array
  Stanley: {cross_track_gain: 1.0, heading_gain: 2.0}
  DVZ: {K_angular: 1.0, min_front_margin: 1.0}
  DWA: {control_horizon: 6, prediction_horizon: 40, costs_weights: {jerk_weight: 0.0}}
  VisionRGBFollower: {speed_gain: 0.7}
  VisionRGBDFollower: {target_distance: 1.0}
planner:
  inputs:
    map_layer: {name: /map, msg_type: OccupancyGrid}
    goal_point: {name: /clicked_point, msg_type: PointStamped}
  visualization: true
  detailed_logging: true
  number_of_sent_cmds: 5
  safety_stop_dist: 0.1
  stop_angle_range: 0.52
  retries: 0
  algorithm: ompl
  ompl: {log_level: WARN, planner_id: ompl.geometric.KPIECE1, KPIECE1: {goal_bias: 0.1}}
map_server: {map_file_read_rate: 0.0, pc_publish_row: true, z_ground_limit: 0.01}
"""


@pytest.mark.parametrize("suffix", ["yaml", "json", "toml"])
def test_the_files_of_the_original_packages_are_read(
    suffix: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / f"original.{suffix}"
    content = yaml.safe_load(ORIGINAL)
    path.write_text(
        {"yaml": ORIGINAL, "json": json.dumps(content), "toml": as_toml(content)}[suffix]
    )
    components = [Planner(), Controller(), LocalMapper(), DriveManager(), MapServer()]
    for component in components:
        component.apply_config_file(str(path))
    assert components[3].out_topic_name("robot_command") == "cmd_vel"
    assert f"{path}, section 'planner': 'safety_stop_dist' is ignored: the drive manager" in (
        caplog.text
    )


def as_toml(sections: dict[str, Any]) -> str:
    """Inline tables all the way down."""

    def value(given: Any) -> str:
        if isinstance(given, dict):
            return "{" + ", ".join(f'"{k}" = {value(v)}' for k, v in given.items()) + "}"
        return json.dumps(given)

    return "".join(f'"{name}" = {value(given)}\n' for name, given in sections.items())


def test_a_section_for_nobody_is_told_with_the_nearest_name(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text("/**: {loop_rate: 1.0}\nplaner: {loop_rate: 2.0}\nplanner: {}\narm: {}\n")
    common = tmp_path / "common.yaml"
    common.write_text("/**: {statsu_rate: 5.0, loop_rate: 5.0, }\n", encoding="utf-8")
    assert sections_of_nobody(str(common), ["planner"], ["status_rate", "loop_rate"]) == [
        f"{common}: no component has 'statsu_rate' of the section '/**'; "
        "did you mean 'status_rate'?"
    ]
    assert sections_of_nobody(str(path), ["planner", "controller"]) == [
        f"{path}: the section 'planer' is for no component; did you mean 'planner'?",
        f"{path}: the section 'arm' is for no component; there are planner, controller",
    ]
