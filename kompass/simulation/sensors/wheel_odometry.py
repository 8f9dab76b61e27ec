"""Dead reckoning from the wheel encoders: smooth, and wrong a little more with every metre."""

from __future__ import annotations

import math

import numpy as np

from kompass.simulation.physics.drive import rolling
from kompass.simulation.physics.motion import BodyMotion
from kompass.simulation.physics.robot_model import TURTLEBOT3, OmniWheels, RobotModel

TICKS_PER_TURN = 4096

# How well a base is calibrated: standard deviations of its true dimensions around the nominal.
RADIUS_ERROR = 0.001
SEPARATION_ERROR = 0.01

# Variance that a wheel's travel gains per metre, m²/m; what the covariance is grown with.
TRAVEL_VARIANCE = 1e-5
SPEED_VARIANCE = (2e-3**2, 1e-9, 2e-2**2)  # of the twist, (m/s)², (m/s)², (rad/s)²

_TWIST = np.diag(SPEED_VARIANCE)
_OMNI_TWIST = np.diag((SPEED_VARIANCE[0], SPEED_VARIANCE[0], SPEED_VARIANCE[2]))


class WheelOdometry:
    """Integrates encoder ticks along circular arcs, frame ``odom``, which starts at the robot.

    The covariance grows as in Siegwart, Nourbakhsh and Scaramuzza, "Introduction to Autonomous
    Mobile Robots", 2nd ed., section 5.2.4: independent errors of the two wheels, proportional to
    the way each has rolled.
    """

    def __init__(self, random: np.random.Generator, robot: RobotModel = TURTLEBOT3) -> None:
        radius = robot.wheel_radius * (1.0 + RADIUS_ERROR * random.standard_normal(2))
        left, right = np.broadcast_to(radius * math.tau / TICKS_PER_TURN, 2).tolist()
        self._travel_per_tick: tuple[float, float] = left, right
        calibrated = 1.0 + SEPARATION_ERROR * random.standard_normal()
        self._separation = float(robot.wheel_separation * calibrated)
        self._ticks: tuple[int, int] | None = None
        self._pose = (0.0, 0.0, 0.0)
        self._twist = (0.0, 0.0, 0.0)
        self._covariance = np.zeros((3, 3))

    def update(
        self, left_angle: float, right_angle: float, dt: float, rear_angle: float = 0.0
    ) -> None:
        """Take in the wheel angles (radians) now, ``dt`` seconds after the last ones."""
        per_radian = TICKS_PER_TURN / math.tau
        ticks = math.floor(left_angle * per_radian), math.floor(right_angle * per_radian)
        before, self._ticks = self._ticks or ticks, ticks
        if before == ticks:
            self._twist = (0.0, 0.0, 0.0)
            return
        left = (ticks[0] - before[0]) * self._travel_per_tick[0]
        right = (ticks[1] - before[1]) * self._travel_per_tick[1]
        travel = (left + right) / 2
        turn = (right - left) / self._separation
        self._grow_covariance(abs(left), abs(right), travel, turn)
        x, y, yaw = self._pose
        # The chord of the arc: its length is travel·sinc(turn/2), its direction the mean heading.
        half = turn / 2
        chord = travel * (math.sin(half) / half if half else 1.0)
        self._pose = (
            x + chord * math.cos(yaw + half),
            y + chord * math.sin(yaw + half),
            math.remainder(yaw + turn, math.tau),
        )
        self._twist = (travel / dt, 0.0, turn / dt)

    def read(self) -> BodyMotion:
        """Pose in ``odom`` with its grown covariance, and the twist of the last update."""
        return BodyMotion(self._pose, self._twist, self._covariance.copy(), _TWIST.copy())

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


class OmniOdometry:
    """Integrates the encoders of three omni wheels, frame ``odom``, which starts at the robot.

    The covariance grows with the way that each wheel has rolled, as of :class:`WheelOdometry`.
    """

    def __init__(self, random: np.random.Generator, robot: RobotModel, wheels: OmniWheels) -> None:
        radius = 1.0 + RADIUS_ERROR * random.standard_normal(3)
        self._to_twist = np.linalg.inv(rolling(robot, wheels)) * radius
        self._radius = robot.wheel_radius
        self._ticks: tuple[int, ...] | None = None
        self._pose = (0.0, 0.0, 0.0)
        self._twist = (0.0, 0.0, 0.0)
        self._covariance = np.zeros((3, 3))

    def update(
        self, left_angle: float, right_angle: float, dt: float, rear_angle: float = 0.0
    ) -> None:
        """Take in the wheel angles (radians) now, ``dt`` seconds after the last ones."""
        per_radian = TICKS_PER_TURN / math.tau
        ticks = tuple(
            math.floor(angle * per_radian) for angle in (left_angle, right_angle, rear_angle)
        )
        before, self._ticks = self._ticks or ticks, ticks
        if before == ticks:
            self._twist = (0.0, 0.0, 0.0)
            return
        rolled = np.subtract(ticks, before) / per_radian
        ahead, aside, turn = (self._to_twist @ rolled).tolist()
        x, y, yaw = self._pose
        heading = yaw + turn / 2
        cos, sin = math.cos(heading), math.sin(heading)
        dx, dy = cos * ahead - sin * aside, sin * ahead + cos * aside
        self._pose = (x + dx, y + dy, math.remainder(yaw + turn, math.tau))
        self._twist = (ahead / dt, aside / dt, turn / dt)
        by_pose = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
        turned = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        by_wheels = turned @ self._to_twist / self._radius
        travelled = np.diag(TRAVEL_VARIANCE * self._radius * np.abs(rolled))
        self._covariance = (
            by_pose @ self._covariance @ by_pose.T + by_wheels @ travelled @ by_wheels.T
        )

    def read(self) -> BodyMotion:
        """Pose in ``odom`` with its grown covariance, and the twist of the last update."""
        return BodyMotion(self._pose, self._twist, self._covariance.copy(), _OMNI_TWIST.copy())
