"""Dead reckoning from the wheel encoders: smooth, and wrong a little more with every metre."""

from __future__ import annotations

import math

import numpy as np

from kompass.simulation.physics.motion import BodyMotion
from kompass.simulation.physics.robot_model import TURTLEBOT3, RobotModel

TICKS_PER_TURN = 4096

# How well a base is calibrated: standard deviations of its true dimensions around the nominal.
RADIUS_ERROR = 0.001
SEPARATION_ERROR = 0.01

# Variance that a wheel's travel gains per metre, m²/m; what the covariance is grown with.
TRAVEL_VARIANCE = 1e-5
SPEED_VARIANCE = (2e-3**2, 1e-9, 2e-2**2)  # of the twist, (m/s)², (m/s)², (rad/s)²


class WheelOdometry:
    """Integrates encoder ticks along circular arcs, frame ``odom``, which starts at the robot.

    The covariance grows as in Siegwart, Nourbakhsh and Scaramuzza, "Introduction to Autonomous
    Mobile Robots", 2nd ed., section 5.2.4: independent errors of the two wheels, proportional to
    the way each has rolled.
    """

    def __init__(self, random: np.random.Generator, robot: RobotModel = TURTLEBOT3) -> None:
        radius = robot.wheel_radius * (1.0 + RADIUS_ERROR * random.standard_normal(2))
        self._travel_per_tick = np.asarray(radius) * math.tau / TICKS_PER_TURN
        calibrated = 1.0 + SEPARATION_ERROR * random.standard_normal()
        self._separation = robot.wheel_separation * calibrated
        self._ticks: np.ndarray | None = None
        self._pose = (0.0, 0.0, 0.0)
        self._twist = (0.0, 0.0, 0.0)
        self._covariance = np.zeros((3, 3))

    def update(self, left_angle: float, right_angle: float, dt: float) -> None:
        """Take in the wheel angles (radians) now, ``dt`` seconds after the last ones."""
        angles = np.array([left_angle, right_angle])
        ticks = np.floor(angles * (TICKS_PER_TURN / math.tau))
        if self._ticks is None:
            self._ticks = ticks
        left, right = (ticks - self._ticks) * self._travel_per_tick
        self._ticks = ticks
        if left == 0.0 and right == 0.0:
            self._twist = (0.0, 0.0, 0.0)
            return
        travel = float(left + right) / 2
        turn = float(right - left) / self._separation
        self._grow_covariance(abs(float(left)), abs(float(right)), travel, turn)
        x, y, yaw = self._pose
        # The chord of the arc: its length is travel·sinc(turn/2), its direction the mean heading.
        chord = travel * float(np.sinc(turn / math.tau))
        self._pose = (
            x + chord * math.cos(yaw + turn / 2),
            y + chord * math.sin(yaw + turn / 2),
            math.remainder(yaw + turn, math.tau),
        )
        self._twist = (travel / dt, 0.0, turn / dt)

    def read(self) -> BodyMotion:
        """Pose in ``odom`` with its grown covariance, and the twist of the last update."""
        return BodyMotion(self._pose, self._twist, self._covariance.copy(), np.diag(SPEED_VARIANCE))

    def _grow_covariance(self, left: float, right: float, travel: float, turn: float) -> None:
        heading = self._pose[2] + turn / 2
        cos, sin = math.cos(heading), math.sin(heading)
        by_pose = np.array([[1.0, 0.0, -travel * sin], [0.0, 1.0, travel * cos], [0.0, 0.0, 1.0]])
        lever = travel / (2 * self._separation)
        by_wheels = np.array(
            [
                [cos / 2 + lever * sin, cos / 2 - lever * sin],
                [sin / 2 - lever * cos, sin / 2 + lever * cos],
                [-1.0 / self._separation, 1.0 / self._separation],
            ]
        )
        wheels = np.diag([TRAVEL_VARIANCE * left, TRAVEL_VARIANCE * right])
        self._covariance = by_pose @ self._covariance @ by_pose.T + by_wheels @ wheels @ by_wheels.T
