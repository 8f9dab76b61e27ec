"""Settings under the older import name."""

import sys

from kompass.config import BaseComponentConfig, ComponentRunType
from kompass.porting import absent_names
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotFrames,
    RobotGeometry,
    RobotType,
)
from kompass.ros import QoSConfig

RobotGeometryType = RobotGeometry.Type

# Recipes name the modules below it too: ``from ros_sugar.config.robot import RobotConfig``.
for _name in ("base_attrs", "base_config", "base_validators", "robot"):
    sys.modules[f"{__name__}.{_name}"] = sys.modules[__name__]

__all__ = [
    "AngularCtrlLimits",
    "BaseComponentConfig",
    "ComponentRunType",
    "LinearCtrlLimits",
    "QoSConfig",
    "RobotConfig",
    "RobotFrames",
    "RobotGeometryType",
    "RobotType",
]

__getattr__ = absent_names("ros_sugar.config")
