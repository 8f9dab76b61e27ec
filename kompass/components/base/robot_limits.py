"""Limits of the robot, as the algorithms take them."""

from kompass.algorithms.following.limits import Limits
from kompass.algorithms.motion_model import MotionModel
from kompass.algorithms.safety.velocity_limiter import VelocityLimits
from kompass.robot import AngularCtrlLimits, LinearCtrlLimits, RobotConfig, RobotType

# A robot whose acceleration nobody stated is taken to reach its speed within this time [s].
DEFAULT_RAMP = 0.5


def velocity_limits(robot: RobotConfig) -> VelocityLimits:
    """Limits of all three axes."""
    return VelocityLimits(
        vx=_axis(robot.ctrl_vx_limits),
        vy=_axis(robot.ctrl_vy_limits),
        omega=_axis(robot.ctrl_omega_limits),
    )


def motion_model(robot: RobotConfig) -> MotionModel:
    """What its kind of drive can and cannot do."""
    slides = robot.model_type is RobotType.OMNI and robot.ctrl_vy_limits.max_vel > 0
    aside = _axis(robot.ctrl_vy_limits) if slides else Limits(0.0, 0.0, 0.0)
    return MotionModel(robot.turning_radius, aside)


def _axis(limits: LinearCtrlLimits | AngularCtrlLimits) -> Limits:
    default = limits.max_vel / DEFAULT_RAMP
    return Limits(limits.max_vel, limits.max_acc or default, limits.max_decel or default)
