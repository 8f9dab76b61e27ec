"""Robot models under the older import name."""

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
