"""The last checks before the wheels: limits and the stop zone."""

from kompass.algorithms.safety.stop_zone import StopZone
from kompass.algorithms.safety.velocity_limiter import VelocityLimiter, VelocityLimits

__all__ = ["StopZone", "VelocityLimiter", "VelocityLimits"]
