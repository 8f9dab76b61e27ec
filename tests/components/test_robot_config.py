"""A robot is described whole, belongs to whoever has it, and is never left half changed."""

import copy
import json
import math
from collections.abc import Callable
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
    Planner,
    PlannerConfig,
)
from kompass.components.controller.follower_settings import make_follower
from kompass.control import ControllersID, StanleyConfig
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotFrames,
    RobotGeometry,
    RobotType,
)
from tests.support.described import described_robot

Change = Callable[[RobotConfig], Any]


def put(*path: str, to: Any) -> Change:
    """An assignment, e.g. to ``robot.ctrl_vx_limits.max_vel``."""

    def change(robot: RobotConfig) -> None:
        inner: Any = robot
        for name in path[:-1]:
            inner = getattr(inner, name)
        setattr(inner, path[-1], to)

    return change


def write(robot: RobotConfig) -> None:
    robot.geometry_params[0] = -1.0


def scale(robot: RobotConfig) -> None:
    robot.geometry_params *= -1.0


REFUSED = [
    (
        put("geometry_params", to=[-0.1, 0.3]),
        r"greater than 0 and at most 100 m, not \[-0\.1, 0\.3",
    ),
    (put("geometry_params", to=[0.0, 0.3]), "greater than 0"),
    (put("geometry_params", to=[math.nan, 0.3]), r"not \[nan, 0\.3\]"),
    (put("geometry_params", to=[math.inf, 0.3]), "at most 100 m"),
    (put("geometry_params", to=[1e9, 0.3]), "at most 100 m"),
    (put("geometry_params", to=[0.1]), "CYLINDER are 2 numbers"),
    (put("geometry_params", to=[[0.1, 0.3]]), "CYLINDER are 2 numbers"),
    (put("geometry_params", to="wide"), "'wide' is no list of numbers"),
    (put("geometry_params", to=[True, 0.3]), r"\[True, 0\.3\] is no list of numbers"),
    (put("geometry_params", to=["0.1", "0.3"]), "is no list of numbers"),
    (put("geometry_params", to=None), "geometry_params of a CYLINDER are 2 numbers"),
    (put("geometry_params", to={"radius": 1}), "is no list of numbers"),
    (put("geometry_type", to="BOX"), "BOX are 3 numbers.* make a new RobotConfig"),
    (put("geometry_type", to="CUBE"), "'CUBE' is none of BOX, CYLINDER"),
    (put("model_type", to="HOVERCRAFT"), "none of ACKERMANN, DIFFERENTIAL_DRIVE, OMNI"),
    (put("model_type", to=3), "ACKERMANN"),
    (put("ctrl_vx_limits", to=LinearCtrlLimits()), "ctrl_vx_limits.max_vel = 0.*not drive"),
    (put("ctrl_omega_limits", to=AngularCtrlLimits()), "ctrl_omega_limits.max_vel = 0.*not turn"),
    (put("ctrl_vx_limits", "max_vel", to=-1.0), "max_vel"),
    (put("ctrl_vx_limits", "max_vel", to=math.nan), "max_vel"),
    (put("ctrl_vx_limits", "max_vel", to=1e9), "less than or equal to 100"),
    (put("ctrl_vx_limits", "max_acc", to=0.0), "max_acc = 0 with max_vel = 1.*never start"),
    (put("ctrl_vx_limits", "max_decel", to=0.0), "max_decel = 0 with max_vel = 1.*never stop"),
    (
        put("ctrl_vx_limits", "min_absolute_val", to=2.0),
        "min_absolute_val = 2 is above max_vel = 1",
    ),
    (put("ctrl_omega_limits", "max_steer", to=4.0), "max_steer"),
    (put("model_type", to="ACKERMANN"), "max_steer = 3.14 rad: .* largest steering angle; give it"),
    (put("wheel_base", to=0.3), "wheel_base = 0.3 m: only ACKERMANN has one"),
    (
        put("ctrl_vy_limits", to=LinearCtrlLimits(max_vel=0.3)),
        "ctrl_vy_limits.max_vel = 0.3 m/s: a DIFFERENTIAL_DRIVE cannot move sideways",
    ),
    (put("ctrl_vx_limits", "max_vel", to=True), "that is no number"),
    (put("geometry_offset", to=0.2), "geometry_offset = 0.2 m: base_link would lie outside"),
    (put("model_typ", to="OMNI"), "'model_typ' is not a setting .* did you mean 'model_type'"),
    (write, "read-only"),
    (scale, "read-only"),
]


@pytest.mark.parametrize(("change", "message"), REFUSED)
def test_what_is_refused_leaves_the_robot_as_it_was(change: Change, message: str) -> None:
    robot, before = described_robot(), described_robot()
    with pytest.raises(ValueError, match=rf"(?s){message}"):
        change(robot)
    assert robot == before
    assert robot.geometry_params.tolist() == [0.2, 1.0]


def test_settings_of_components_are_left_as_they_were_too() -> None:
    config = DriveManagerConfig(critical_zone_distance=0.1, slowdown_zone_distance=0.2)
    with pytest.raises(ValidationError, match="must be greater than critical_zone_distance"):
        config.critical_zone_distance = 0.3
    assert config.critical_zone_distance == 0.1


def test_the_callers_array_is_copied() -> None:
    mine = np.array([0.1, 0.3])
    robot = described_robot(geometry_params=mine)
    mine[0] = 5.0
    assert robot.radius == 0.1


def test_the_callers_limits_are_copied() -> None:
    mine = LinearCtrlLimits(max_vel=0.2)
    robot = described_robot(ctrl_vx_limits=mine)
    mine.max_vel = 5.0
    assert robot.ctrl_vx_limits.max_vel == 0.2


def test_a_component_has_a_robot_of_its_own() -> None:
    mine = described_robot()
    planner, driver = Planner(config=PlannerConfig(robot=mine)), DriveManager()
    driver.robot = mine
    mine.ctrl_vx_limits.max_vel = 0.1
    assert driver.robot is not None
    driver.robot.ctrl_vx_limits.max_vel = 0.3
    assert planner.robot is not None
    assert planner.robot.ctrl_vx_limits.max_vel == 1.0


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, RobotConfig.model_copy])
def test_a_copy_is_equal_and_apart(copied: Callable[[RobotConfig], RobotConfig]) -> None:
    robot = described_robot()
    other = copied(robot)
    assert other == robot
    other.ctrl_vx_limits.max_vel = 0.4
    assert other != robot
    with pytest.raises(ValueError, match="read-only"):
        other.geometry_params[0] = -1.0


def test_a_copy_with_an_update_is_checked() -> None:
    robot = described_robot()
    with pytest.raises(ValidationError, match="greater than 0"):
        robot.model_copy(update={"geometry_params": [-1.0, 1.0]})
    box = robot.model_copy(update={"geometry_type": "BOX", "geometry_params": [1, 1, 1]})
    assert box.geometry_type == RobotGeometry.Type.BOX


def test_it_comes_back_from_json_as_it_was() -> None:
    robot = described_robot(
        model_type="OMNI", ctrl_vy_limits=LinearCtrlLimits(max_vel=0.1, max_acc=1.0)
    )
    assert RobotConfig.model_validate_json(robot.model_dump_json()) == robot
    assert RobotConfig.model_validate(robot.model_dump()) == robot


def test_wheels_that_no_car_has_are_refused() -> None:
    steered = {"model_type": "ACKERMANN", "geometry_type": "BOX", "geometry_params": [0.5, 0.3, 1]}
    limits = AngularCtrlLimits(max_vel=1.0, max_steer=0.5)
    with pytest.raises(ValueError, match=r"wheel_base = 5 m: the body is 0\.5 m long"):
        described_robot(**steered, ctrl_omega_limits=limits, wheel_base=5.0)
    slight = AngularCtrlLimits(max_vel=1.0, max_steer=1e-9)
    with pytest.raises(ValueError, match=r"give it, between 0\.01 and 1\.5"):
        described_robot(**steered, ctrl_omega_limits=slight)


@pytest.mark.parametrize("given", ["ACKERMANN", "ackermann", "RobotType.ACKERMANN"])
def test_kinds_are_equal_to_their_names(given: Any) -> None:
    limits = AngularCtrlLimits(max_vel=1.0, max_steer=0.5)
    robot = described_robot(
        model_type=given, geometry_type="Type.CYLINDER", ctrl_omega_limits=limits
    )
    assert robot.model_type == "ACKERMANN"
    assert robot.model_type is RobotType.ACKERMANN
    assert robot.geometry_type == "CYLINDER"
    assert f"{robot.geometry_type}" == "CYLINDER"


def car(**changed: Any) -> RobotConfig:
    fields: dict[str, Any] = {
        "model_type": "ACKERMANN",
        "geometry_type": "BOX",
        "geometry_params": [0.6, 0.4, 0.2],
        "ctrl_omega_limits": AngularCtrlLimits(max_vel=2.0, max_steer=0.5),
    }
    return described_robot(**{**fields, **changed})


def test_the_tightest_turn_of_a_car_comes_from_its_wheel_base_and_its_steering() -> None:
    assert car(wheel_base=0.4).turning_radius == pytest.approx(0.4 / math.tan(0.5))
    # No wheel base exceeds the body: without one the turn is taken to be as wide as it may be.
    assert car().turning_radius == pytest.approx(0.6 / math.tan(0.5))
    assert described_robot().turning_radius == 0.0


def test_a_car_is_not_said_to_go_sideways() -> None:
    with pytest.raises(ValidationError, match=r"max_vel = 0.1 m/s: an ACKERMANN cannot move side"):
        car(ctrl_vy_limits=LinearCtrlLimits(max_vel=0.1))


def test_a_body_may_lie_before_its_frame() -> None:
    robot = car(wheel_base=0.4, geometry_offset=0.2)
    assert robot.footprint[:, 0].max() == pytest.approx(0.5)
    assert robot.footprint[:, 0].min() == pytest.approx(-0.1)
    assert robot.radius == pytest.approx(math.hypot(0.5, 0.2))
    assert RobotConfig.model_validate_json(robot.model_dump_json()) == robot


@pytest.mark.parametrize("left_out", ["model_type", "geometry_params", "ctrl_omega_limits"])
def test_nothing_of_a_robot_is_guessed(left_out: str) -> None:
    fields = dict(described_robot())
    del fields[left_out]
    with pytest.raises(ValidationError, match=rf"{left_out} left out; a robot is described whole"):
        RobotConfig(**fields)


def test_a_mistyped_field_is_offered_the_nearest() -> None:
    with pytest.raises(ValidationError, match="did you mean 'geometry_params'"):
        described_robot(geometry_parms=[1, 2])
    fields = dict(described_robot())
    fields["modl_type"] = fields.pop("model_type")
    with pytest.raises(ValidationError, match="did you mean 'model_type'") as refused:
        RobotConfig(**fields)
    assert "left out" not in str(refused.value)


def test_a_config_of_another_class_is_named_and_not_told_whole() -> None:
    with pytest.raises(TypeError) as refused:
        Planner(config=DriveManagerConfig())  # type: ignore[arg-type, unused-ignore]
    said = "planner: config, a DriveManagerConfig, is not a PlannerConfig"
    assert str(refused.value) == said


def test_a_robot_of_a_file_that_does_not_fit_is_not_told_whole(tmp_path: Path) -> None:
    path = tmp_path / "robot.json"
    robot = described_robot(geometry_type="CYLINDER", geometry_params=[0.1, 0.2])
    given = {**robot.model_dump(mode="json"), "geometry_params": [0.1, 0.2, 0.3]}
    path.write_text(json.dumps({"planner": {"robot": given}}))
    with pytest.raises(ValueError, match=r"are 2 numbers \(radius, height, in metres\)") as refused:
        Planner(config_file=str(path))
    assert "ctrl_vx_limits" not in str(refused.value)


@pytest.mark.parametrize("value", [math.nan, math.inf, -0.1, 101.0, "fast", None])
@pytest.mark.parametrize("kind", [LinearCtrlLimits, AngularCtrlLimits])
def test_a_speed_that_cannot_be_meant_is_refused(kind: type[Any], value: Any) -> None:
    with pytest.raises(ValidationError, match="max_vel"):
        kind(max_vel=value)


def test_an_axis_that_does_not_move_needs_no_acceleration() -> None:
    assert LinearCtrlLimits(max_vel=0.0, max_acc=0.0, max_decel=0.0).max_acc == 0.0


def test_a_frame_without_a_name_is_refused() -> None:
    with pytest.raises(ValidationError, match="robot_base"):
        RobotFrames(robot_base="")


@pytest.mark.parametrize(
    ("name", "remedy"), [("to_json", r"model_dump_json\(\)"), ("asdict", r"model_dump\(\)")]
)
def test_what_other_settings_are_asked_is_answered(name: str, remedy: str) -> None:
    with pytest.raises(AttributeError, match=f"RobotConfig.{name} is not here: use {remedy}"):
        getattr(described_robot(), name)


def test_nobody_creeps_slower_than_the_base_can_drive() -> None:
    robot = described_robot(
        ctrl_vx_limits=LinearCtrlLimits(max_vel=1.0, min_absolute_val=0.08),
        ctrl_omega_limits=AngularCtrlLimits(max_vel=5.0, min_absolute_val=0.3),
    )
    follower = make_follower(StanleyConfig(), robot)
    assert (follower.config.min_speed, follower.config.min_turn_rate) == (0.08, 0.3)
    stated = make_follower(StanleyConfig(min_speed=0.05), robot)
    assert stated.config.min_speed == 0.05


def test_an_algorithm_that_turns_on_the_spot_is_refused_for_steered_wheels() -> None:
    said = "algorithm = DWA, and model_type of the robot is ACKERMANN: .* choose MPPI"
    with pytest.raises(ValidationError, match=said):
        ControllerConfig(robot=car(), algorithm=ControllersID.DWA)
    controller = Controller()
    controller.algorithm = "DWA"
    with pytest.raises(ValidationError, match=said):
        controller.robot = car()
    assert controller.robot is None
    controller.algorithm = "Stanley"
    controller.robot = car()
    with pytest.raises(ValidationError, match=said):
        controller.algorithm = "DWA"


def test_stanley_steers_the_bicycle_that_the_robot_is() -> None:
    follower = make_follower(StanleyConfig(), car(wheel_base=0.4))
    assert (follower.config.wheel_base, follower.config.max_steer) == pytest.approx((0.4, 0.5))
    assert make_follower(StanleyConfig(), car()).config.wheel_base == pytest.approx(0.6)
    assert make_follower(StanleyConfig(max_steer=0.3), car()).config.max_steer == 0.3
    assert make_follower(StanleyConfig(), described_robot()).config.wheel_base == 0.16


def test_what_is_most_likely_a_slip_of_units_is_told(caplog: pytest.LogCaptureFixture) -> None:
    described_robot()
    assert not caplog.text
    robot = described_robot()
    robot.geometry_params = np.array([10.0, 30.0])
    assert "the robot's radius is 10 m; they are metres" in caplog.text
    robot.ctrl_omega_limits = AngularCtrlLimits(max_vel=90.0)
    assert "90 rad/s: that is 14 turns in a second; it is in radians" in caplog.text
