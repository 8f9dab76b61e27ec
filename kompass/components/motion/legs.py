"""What a test of the base drives: rows (vx, vy, omega, seconds) [m/s, m/s, rad/s, s]."""

from kompass.algorithms.safety.velocity_limiter import VelocityLimits
from kompass.robot import RobotType

Row = tuple[float, float, float, float]
SHARE = 0.5  # of the top speed


def step_legs(limits: VelocityLimits, kind: RobotType, seconds: float) -> list[Row]:
    """Each axis alone, to and back: the robot ends about where it began."""
    vx, omega = SHARE * limits.vx.max_vel, SHARE * limits.omega.max_vel
    legs = [(vx, 0.0, 0.0, seconds), (-vx, 0.0, 0.0, seconds)]
    vy = SHARE * limits.vy.max_vel if kind is RobotType.OMNI else 0.0
    if vy:
        legs += [(0.0, vy, 0.0, seconds), (0.0, -vy, 0.0, seconds)]
    if kind is not RobotType.ACKERMANN:
        legs += [(0.0, 0.0, omega, seconds), (0.0, 0.0, -omega, seconds)]
    return legs


def circle_legs(limits: VelocityLimits, seconds: float) -> list[Row]:
    """All four pairs of signs, in an order in which each arc is driven back along the same way."""
    vx, omega = SHARE * limits.vx.max_vel, SHARE * limits.omega.max_vel
    pairs = ((vx, omega), (-vx, -omega), (vx, -omega), (-vx, omega))
    return [(v, 0.0, turn, seconds) for v, turn in pairs]
