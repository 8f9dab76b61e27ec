"""Every import of a recipe or component of the original packages is answered."""

import importlib
import importlib.util
import subprocess
import sys

import pytest

from kompass import porting
from tests.docs.blocks import ROOT

# What users of the original packages import (measured): module and name, or a module alone.
IMPORTS = """
ros_sugar.core BaseComponent
ros_sugar.core Fallback
ros_sugar.core ComponentFallbacks
ros_sugar.core Status
ros_sugar.core Event
ros_sugar.core Action
ros_sugar.core Monitor
ros_sugar.core.component BaseComponent
ros_sugar.core.fallbacks Fallback
ros_sugar.core.status Status
ros_sugar.io Topic
ros_sugar.io AllowedTopics
ros_sugar.io Publisher
ros_sugar.io GenericCallback
ros_sugar.io get_msg_type
ros_sugar.io get_all_msg_types
ros_sugar.io.publisher Publisher
ros_sugar.io.topic Topic
ros_sugar.config BaseAttrs
ros_sugar.config BaseConfig
ros_sugar.config BaseComponentConfig
ros_sugar.config ComponentRunType
ros_sugar.config QoSConfig
ros_sugar.config RobotFrames
ros_sugar.config base_validators
ros_sugar.config.robot RobotConfig
ros_sugar.config.robot RobotGeometryType
ros_sugar.config.base_attrs BaseAttrs
ros_sugar.utils component_action
ros_sugar.utils component_fallback
ros_sugar.utils IncompatibleSetup
ros_sugar.utils InvalidAction
ros_sugar.launch
ros_sugar.launch.launcher Launcher
ros_sugar.base_clients
ros_sugar.condition
ros_sugar.recording
ros_sugar.robot
ros_sugar.tf
ros_sugar.ui_node
ros_sugar.actions trigger_component_service
ros_sugar.events OnInternalEvent
launch.actions LogInfo
launch.actions Shutdown
launch_ros
kompass.utils
kompass cli
kompass.cli
kompass.callbacks
kompass.data_types
kompass.executable
kompass.ros Publisher
kompass.ros GenericCallback
kompass.config BaseAttrs
kompass.config BaseValidators
kompass.config BaseConfig
kompass.components MotionServer
kompass.components MotionServerConfig
kompass.control VisionRGBFollowerConfig
kompass.control VisionRGBDFollowerConfig
kompass.control DVZConfig
kompass.components.controller Controller
kompass.components.controller ControllerConfig
kompass.components.controller ControllersID
kompass.components.controller CmdPublishType
kompass.components.planner PlannerConfig
kompass.components.drive_manager DriveManager
kompass.components.mapper LocalMapper
kompass.components.map_server MapServer
kompass.components.motion_server MotionServer
kompass.robot Robot
kompass.robot RobotState
ros_sugar.core.event InternalEvent
ros_sugar.core.event OnInternalEvent
ros_sugar.io.topic QoSConfig
kompass_cpp
kompass.event InternalEvent
kompass.event OnInternalEvent
kompass.events InternalEvent
kompass.actions trigger_component_service
kompass.actions send_component_service_request
kompass_core.control DWAConfig
kompass_core.control StanleyConfig
kompass_core.control PurePursuitConfig
kompass_core.control DVZConfig
kompass_core.models Robot
kompass_core.models RobotState
kompass_core.datatypes
kompass_core.mapping
kompass_core.third_party
kompass_core.utils
kompass_core.vision
"""
# They are the thing itself, not an answer.
THERE = {
    *("BaseComponent", "Event", "Action", "Topic", "AllowedTopics", "BaseComponentConfig"),
    *("ComponentRunType", "QoSConfig", "RobotFrames", "RobotConfig", "RobotGeometryType"),
    *("component_action", "DVZConfig", "DWAConfig", "StanleyConfig", "PurePursuitConfig"),
    *("VisionRGBFollowerConfig", "VisionRGBDFollowerConfig"),
    "MotionServerConfig",
}


@pytest.mark.parametrize("line", IMPORTS.split("\n")[1:-1])
def test_an_import_brings_the_thing_or_a_sentence_that_says_what_does(line: str) -> None:
    module, _, name = line.partition(" ")
    statement = f"from {module} import {name}" if name else f"import {module}"
    try:
        exec(statement, {})
    except ImportError as error:
        assert name not in THERE
        text = str(error)
        assert " is not here: " in text, text
        assert "\n" not in text
        assert text.endswith(f"({porting.PAGE})")


def test_the_recipe_that_imports_the_original_first_is_answered_too() -> None:
    done = subprocess.run(
        [sys.executable, "-c", "from kompass_core.datatypes import LaserScanData"],
        capture_output=True,
        text=True,
    )
    assert "kompass_core.datatypes is not here: " in done.stderr


def test_a_name_by_attribute_is_answered_too() -> None:
    robot = importlib.import_module("kompass.robot")
    with pytest.raises(ImportError, match=r"RobotState is not here: a pose is \(x, y, yaw\)"):
        _ = robot.RobotState
    assert not hasattr(robot, "Nonsense")


@pytest.mark.parametrize(
    ("module", "name", "meant"),
    [
        ("kompass.actions", "LogInfoo", "LogInfo"),
        ("kompass.components", "Contoller", "Controller"),
        ("kompass.ros", "Topics", "Topic"),
        ("kompass.robot", "RobotConfg", "RobotConfig"),
        ("ros_sugar.core", "BaseComponents", "BaseComponent"),
    ],
)
def test_a_name_that_is_nearly_one_is_offered_it(module: str, name: str, meant: str) -> None:
    with pytest.raises(ImportError, match=rf"{module}\.{name} is not here: did you mean '{meant}'"):
        exec(f"from {module} import {name}", {})


def test_a_module_below_one_that_answers_is_imported_though_its_name_is_like_another() -> None:
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            "from kompass.components import planner, controller; print(planner)",
        ],
        capture_output=True,
        text=True,
    )
    assert "kompass.components.planner" in done.stdout, done.stderr


def test_a_base_of_the_original_name_makes_components() -> None:
    core, here = (
        importlib.import_module("ros_sugar.core"),
        importlib.import_module("kompass.components"),
    )
    assert issubclass(core.BaseComponent, here.Component)
    assert core.BaseComponent("level").node_name == here.Component("level").node_name


def test_a_module_of_nobody_is_still_missing_in_the_usual_way() -> None:
    assert importlib.util.find_spec("kompass_nobody") is None
    with pytest.raises(ModuleNotFoundError, match="No module named 'kompass"):
        importlib.import_module("kompass.nobody")


def test_what_is_said_to_be_absent_is() -> None:
    """An entry that came true must leave the list."""
    for module, names in porting.NAMES.items():
        found = set(vars(importlib.import_module(module))) & set(names)
        assert not found, f"{module}: {found}"


def test_the_page_on_porting_names_all_that_is_absent() -> None:
    page = (ROOT / porting.PAGE).read_text(encoding="utf-8")
    absent = {name for names in porting.NAMES.values() for name in names} | set(porting.MODULES)
    assert not [name for name in sorted(absent) if f"`{name}`" not in page]
