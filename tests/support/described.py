"""A robot that tests drive, described whole."""

from typing import Any

from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)


def described_robot(**changed: Any) -> RobotConfig:
    """A small differential drive, with some fields other than usual."""
    usual: dict[str, Any] = {
        "model_type": RobotType.DIFFERENTIAL_DRIVE,
        "geometry_type": RobotGeometry.Type.CYLINDER,
        "geometry_params": [0.2, 1.0],
        "ctrl_vx_limits": LinearCtrlLimits(max_vel=1.0, max_acc=3.0, max_decel=5.0),
        "ctrl_omega_limits": AngularCtrlLimits(max_vel=5.0, max_acc=10.0, max_decel=10.0),
    }
    return RobotConfig(**{**usual, **changed})
