"""Velocity and acceleration limits that bend the path of a command as little as possible."""

from __future__ import annotations

from dataclasses import dataclass, field

from kompass.algorithms.following.command import Command
from kompass.algorithms.following.limits import Limits


@dataclass(frozen=True)
class VelocityLimits:
    """Of the three axes of a planar robot; ``vy`` stays zero unless it can move sideways."""

    vx: Limits
    omega: Limits
    vy: Limits = field(default_factory=lambda: Limits(0.0, 0.0, 0.0))


class VelocityLimiter:
    """Limits commands before they reach the wheels."""

    def __init__(self, limits: VelocityLimits) -> None:
        self.limits = limits

    def limit(self, command: Command, previous: Command, dt: float) -> Command:
        """What may follow ``previous`` after ``dt`` [s] on the way to ``command``.

        An axis that cannot move is dropped first. Then all axes are scaled alike, which keeps
        the curvature and the direction of the motion; only where no common scale fits the
        accelerations does each axis go as far towards the command as it can. A standstill is come
        to along the curve that is being driven: straight on from it there may be something.
        """
        axes = (self.limits.vx, self.limits.vy, self.limits.omega)
        wanted = [
            value if axis.max_vel > 0 else 0.0
            for axis, value in zip(axes, (command.vx, command.vy, command.omega), strict=True)
        ]
        scale = min(
            (
                axis.max_vel / abs(value)
                for axis, value in zip(axes, wanted, strict=True)
                if abs(value) > axis.max_vel
            ),
            default=1.0,
        )
        wanted = [value * scale for value in wanted]
        before = (previous.vx, previous.vy, previous.omega)
        windows = [axis.reachable(value, dt) for axis, value in zip(axes, before, strict=True)]
        low, high = 0.0, 1.0
        for value, (least, most) in zip(wanted, windows, strict=True):
            if value > 0:
                low, high = max(low, least / value), min(high, most / value)
            elif value < 0:
                low, high = max(low, most / value), min(high, least / value)
            elif least > 0 or most < 0:
                high = -1.0  # this axis still turns and the command has no share in it
        if not any(wanted):
            left = max(
                (
                    max(0.0, abs(value) - axis.max_decel * dt) / abs(value)
                    for axis, value in zip(axes, before, strict=True)
                    if value
                ),
                default=0.0,
            )
            values = [value * left for value in before]
        elif low <= high:
            values = [value * high for value in wanted]
        else:
            values = [
                min(max(value, least), most)
                for value, (least, most) in zip(wanted, windows, strict=True)
            ]
        return Command(*values)
