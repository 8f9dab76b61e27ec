"""A hall with nothing in it, wider than the lidar sees, and how a robot is driven there."""

from __future__ import annotations

from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.world import World

PERIOD = 0.02  # s
HALL = World(
    name="hall",
    title="An empty hall",
    floor=((-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)),
    start=(0.0, 0.0, 0.0),
    obstacles=(),
)


def drive(robot: SimulatedRobot, seconds: float, v: float = 0.2, omega: float = 0.0) -> None:
    """Command it for some time [m/s, rad/s]."""
    for _ in range(round(seconds / PERIOD)):
        robot.command(v, omega)
        robot.step(PERIOD)
