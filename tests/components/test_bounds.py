"""A setting that nobody can mean is refused where it is read, with its field, value and bounds."""

import dataclasses
from pathlib import Path
from typing import Any

import pytest
from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel, ValidationError

from kompass.algorithms.following.dvz import DVZParams
from kompass.algorithms.following.dwa import DWA, DWAParams
from kompass.algorithms.following.mppi import MPPIParams
from kompass.algorithms.following.pure_pursuit import PurePursuitParams
from kompass.algorithms.following.stanley import StanleyParams
from kompass.algorithms.footprint import Footprint
from kompass.components import (
    Component,
    Controller,
    ControllerConfig,
    DriveManager,
    DriveManagerConfig,
    LocalMapper,
    MapConfig,
    MapServer,
    MotionServer,
    Planner,
    PlannerConfig,
)
from kompass.components.base.config_file import ConfigFileError
from kompass.control import DWAConfig
from kompass.robot import RobotConfig
from kompass.settings import section_of

LOUD: dict[str, Any] = {"log_level": "loud"}
KINDS = (Planner, Controller, LocalMapper, DriveManager, MapServer, MotionServer)


def numbers_of(model: type[BaseModel], path: str = "") -> dict[str, set[type]]:
    """Kinds of bounds of every setting that is a number, by dotted name; those of sections too."""
    found: dict[str, set[type]] = {}
    for name, field in model.model_fields.items():
        section = section_of(model, name)
        if section is not None:
            found |= numbers_of(section, f"{path}{name}.")
        elif "float" in str(field.annotation) or "int" in str(field.annotation):
            found[f"{path}{name}"] = {type(rule) for rule in field.metadata}
    return found


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_every_number_has_an_upper_and_a_lower_bound(kind: type[Component]) -> None:
    found = numbers_of(kind.config_class)
    assert len(found) > 5
    unbounded = [n for n, has in found.items() if not (has & {Le, Lt} and has & {Ge, Gt})]
    assert not [name for name in unbounded if not name.endswith("geometry_params")]


def test_every_number_of_a_robot_has_bounds() -> None:
    found = numbers_of(RobotConfig)
    assert len(found) == 15
    assert not [name for name, has in found.items() if not (has & {Le} and has & {Ge})]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            {"width": 100, "height": 100, "resolution": 0.01},
            r"width = 100 m and height = 100 m with resolution = 0\.01 m are 100000000 cells, "
            r"more than 1000000; give a smaller map, or a resolution of 0\.1 m or more",
        ),
        ({"width": 0.1, "resolution": 0.2}, r"resolution = 0\.2 m is coarser than the map"),
        ({"resolution": 1e-9}, "greater than or equal to 0.001"),
        ({"width": 9, "height": 2, "bayesian_update": True}, "sides of at most 1 to 4"),
        ({"width": 1e9}, "less than or equal to 100"),
        ({"height": float("nan")}, "finite"),
    ],
)
def test_a_local_map_that_does_not_fit_is_refused(given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        MapConfig(**given)


def test_the_largest_local_map_is_taken() -> None:
    assert MapConfig(width=50, height=50, resolution=0.05).width == 50


def test_a_file_with_a_huge_map_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text("mapper: {map_params: {width: 100, height: 100, resolution: 0.01}}\n")
    mapper = LocalMapper()
    with pytest.raises(ConfigFileError, match=r"robot\.yaml: 'map_params' .*100000000 cells"):
        mapper.apply_config_file(str(path))
    assert mapper.config.map_params == MapConfig()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: DWAConfig(linear_samples=100_000), "linear_samples"),
        (lambda: DWAConfig(max_angular_samples=100_000), "angular_samples"),
        (
            lambda: DWAConfig(
                linear_samples=100, angular_samples=200, prediction_time=10.0, time_step=0.01
            ),
            "20000000 places looked at, more than 2000000; give fewer samples or a longer step",
        ),
        (lambda: ControllerConfig(progress_timeout=1e9), "progress_timeout"),
        (lambda: DriveManagerConfig(critical_zone_distance=1e9), "critical_zone_distance"),
        (lambda: PlannerConfig(patience=float("inf")), "patience"),
        (lambda: PlannerConfig(**LOUD), "'debug', 'info', 'warn', 'error' or 'fatal'"),
    ],
)
def test_other_settings_are_refused_with_their_names(make: Any, message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        make()


@pytest.mark.parametrize(
    "kind", [DVZParams, DWAParams, MPPIParams, StanleyParams, PurePursuitParams]
)
def test_the_algorithms_themselves_hold_to_their_bounds(kind: Any) -> None:
    for field in dataclasses.fields(kind):
        for value in (-1.0, 1e9, float("nan")):
            with pytest.raises(ValueError, match=rf"^{field.name}: .*; give from "):
                kind(**{field.name: value})


def test_a_grid_too_fine_for_a_fast_robot_names_what_to_change() -> None:
    with pytest.raises(ValueError, match=r"resolution: 0\.005 m is too fine .*100 m/s × 10 s"):
        DWA(
            DWAParams(resolution=0.005, prediction_time=10.0),
            footprint=Footprint.circle(0.2),
            max_v=100.0,
            max_omega=1.0,
            acc=1.0,
            decel=1.0,
            omega_acc=1.0,
        )
