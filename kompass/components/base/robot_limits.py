"""Limits of the robot, as the algorithms take them."""

from kompass.algorithms.following.limits import Limits
from kompass.algorithms.safety.velocity_limiter import VelocityLimits
from kompass.robot import AngularCtrlLimits, LinearCtrlLimits, RobotConfig

# A robot whose acceleration nobody stated is taken to reach its speed within this time [s].
DEFAULT_RAMP = 0.5


def velocity_limits(robot: RobotConfig) -> VelocityLimits:
    """Limits of all three axes."""
    return VelocityLimits(
        vx=_axis(robot.ctrl_vx_limits),
        vy=_axis(robot.ctrl_vy_limits),
        omega=_axis(robot.ctrl_omega_limits),
    )


def _axis(limits: LinearCtrlLimits | AngularCtrlLimits) -> Limits:
    default = limits.max_vel / DEFAULT_RAMP
    return Limits(limits.max_vel, limits.max_acc or default, limits.max_decel or default)
