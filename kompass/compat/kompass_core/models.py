"""Robot models under the older import name."""

from kompass.porting import absent_names
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotCtrlLimits,
    RobotGeometry,
    RobotType,
)

__all__ = [
    "AngularCtrlLimits",
    "LinearCtrlLimits",
    "RobotCtrlLimits",
    "RobotGeometry",
    "RobotType",
]

__getattr__ = absent_names("kompass_core.models")
