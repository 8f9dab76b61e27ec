"""What recipes import is a promise: these names, no fewer and no more without a decision."""

import importlib
from types import ModuleType

import pytest

PUBLIC: dict[str, list[str]] = {
    "kompass.ros": [
        "Action",
        "ActionClientConfig",
        "AllowedTopics",
        "Event",
        "Launcher",
        "QoSConfig",
        "ServiceClientConfig",
        "Topic",
        "actions",
        "logger",
    ],
    "kompass.robot": [
        "AngularCtrlLimits",
        "LinearCtrlLimits",
        "RobotConfig",
        "RobotCtrlLimits",
        "RobotFrames",
        "RobotGeometry",
        "RobotType",
    ],
    "kompass.actions": [
        "Action",
        "ComponentActions",
        "LogInfo",
        "log",
        "publish_message",
        "reconfigure",
        "restart",
        "send_action_goal",
        "send_component_action_server_goal",
        "send_srv_request",
        "start",
        "stop",
        "trigger_action_server",
        "trigger_component_action_server",
        "trigger_service",
        "update_parameter",
        "update_parameters",
    ],
    "kompass.event": [
        "Event",
        "OnAny",
        "OnChange",
        "OnChangeContainsAll",
        "OnChangeContainsAny",
        "OnChangeEqual",
        "OnChangeNotContain",
        "OnContainsAll",
        "OnContainsAny",
        "OnDifferent",
        "OnEqual",
        "OnGreater",
        "OnLess",
    ],
    "kompass.events": [
        "Event",
        "OnAny",
        "OnChange",
        "OnChangeContainsAll",
        "OnChangeContainsAny",
        "OnChangeEqual",
        "OnChangeNotContain",
        "OnContainsAll",
        "OnContainsAny",
        "OnDifferent",
        "OnEqual",
        "OnGreater",
        "OnLess",
    ],
    "kompass.config": [
        "BaseComponentConfig",
        "ComponentConfig",
        "ComponentRunType",
        "Mask",
        "RobotConfig",
        "RobotFrames",
        "Settings",
    ],
    "kompass.control": [
        "ControllersID",
        "DVZConfig",
        "DWAConfig",
        "MPPIConfig",
        "MapConfig",
        "PurePursuitConfig",
        "ScanModelConfig",
        "StanleyConfig",
        "VisionRGBDFollowerConfig",
        "VisionRGBFollowerConfig",
    ],
    "kompass.launcher": [
        "Launcher",
    ],
    "kompass.components": [
        "Component",
        "ComponentConfig",
        "ComponentRunType",
        "Controller",
        "ControllerConfig",
        "DriveManager",
        "DriveManagerConfig",
        "LocalMapper",
        "LocalMapperConfig",
        "MapConfig",
        "MapServer",
        "MapServerConfig",
        "MotionServer",
        "MotionServerConfig",
        "Planner",
        "PlannerConfig",
        "TopicsKeys",
        "component_action",
    ],
    "kompass_core": [],
    "kompass_core.models": [
        "AngularCtrlLimits",
        "LinearCtrlLimits",
        "RobotCtrlLimits",
        "RobotGeometry",
        "RobotType",
    ],
    "kompass_core.control": [
        "ControllersID",
        "DVZConfig",
        "DWAConfig",
        "PurePursuitConfig",
        "StanleyConfig",
        "VisionRGBDFollowerConfig",
        "VisionRGBFollowerConfig",
    ],
    "ros_sugar": [
        "Launcher",
    ],
    "ros_sugar.actions": [
        "Action",
        "ComponentActions",
        "LogInfo",
        "log",
        "publish_message",
        "reconfigure",
        "restart",
        "send_action_goal",
        "send_component_action_server_goal",
        "send_srv_request",
        "start",
        "stop",
        "trigger_action_server",
        "trigger_component_action_server",
        "trigger_service",
        "update_parameter",
        "update_parameters",
    ],
    "ros_sugar.core": [
        "Action",
        "BaseComponent",
        "Event",
    ],
    "ros_sugar.core.action": [
        "Action",
        "BaseComponent",
        "Event",
    ],
    "ros_sugar.core.event": [
        "Action",
        "BaseComponent",
        "Event",
    ],
    "ros_sugar.config": [
        "AngularCtrlLimits",
        "BaseComponentConfig",
        "ComponentRunType",
        "LinearCtrlLimits",
        "QoSConfig",
        "RobotConfig",
        "RobotFrames",
        "RobotGeometryType",
        "RobotType",
    ],
    "ros_sugar.io": [
        "AllowedTopics",
        "QoSConfig",
        "Topic",
    ],
    "ros_sugar.utils": [
        "component_action",
    ],
    "ros_sugar.events": [
        "Event",
        "OnAny",
        "OnChange",
        "OnChangeContainsAll",
        "OnChangeContainsAny",
        "OnChangeEqual",
        "OnChangeNotContain",
        "OnContainsAll",
        "OnContainsAny",
        "OnDifferent",
        "OnEqual",
        "OnGreater",
        "OnLess",
    ],
    "ros_sugar_interfaces": [],
    "ros_sugar_interfaces.msg": [
        "ComponentStatus",
    ],
    "ros_sugar_interfaces.srv": [
        "ChangeParameter",
        "ChangeParameters",
        "ConfigureFromFile",
        "ExecuteMethod",
        "ReplaceTopic",
    ],
    "sugar": [
        "Launcher",
    ],
    "sugar.msg": [
        "ComponentStatus",
    ],
    "sugar.srv": [
        "ChangeParameter",
        "ChangeParameters",
        "ConfigureFromFile",
        "ExecuteMethod",
        "ReplaceTopic",
    ],
}


def public(module: ModuleType) -> list[str]:
    """What a star import brings."""
    names = getattr(module, "__all__", None)
    if names is None:
        found = vars(module).items()
        names = [n for n, v in found if not n.startswith("_") and not isinstance(v, ModuleType)]
    return sorted(names)


@pytest.mark.parametrize("name", PUBLIC)
def test_a_recipe_finds_the_names_that_it_imports(name: str) -> None:
    module = importlib.import_module(name)
    assert public(module) == PUBLIC[name]
    assert all(hasattr(module, each) for each in PUBLIC[name])
