"""A pose in the map as a good localizer gives it: never far off, never jumping, never exact.

It believes a person who says where the robot is, and stays off by what that person was wrong by: it
looks at no scan.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from kompass.simulation.physics.motion import BodyMotion

POSITION_ERROR = 0.005  # standard deviation of x and of y, m
HEADING_ERROR = math.radians(0.3)
BOUND = 3.0  # no error exceeds this many standard deviations
CORRELATION = 0.5  # how fast an error is forgotten, 1/s
SPEED_ERROR = 0.01  # of the speed itself; at rest the twist is exact to SPEED_FLOOR
SPEED_FLOOR = (0.001, 0.0002, 0.002)  # standard deviations, m/s, m/s, rad/s


class Localizer:
    """The truth plus errors that wander smoothly.

    Each error follows a second-order Gauss-Markov process (Brown and Hwang, "Introduction to
    Random Signals and Applied Kalman Filtering", 4th ed., section 4.4), whose derivative is finite:
    an operator sees the robot stand still when it stands still. It is stepped with its exact
    discretisation, so its statistics do not depend on the rate. At first the errors are drawn from
    their stationary distribution.

    Parameters
    ----------
    random
        Source of all its noise.
    dt
        Time between updates [s].
    """

    def __init__(self, random: np.random.Generator, dt: float) -> None:
        self._random = random
        self._floor = np.array(SPEED_FLOOR)
        self._sigma = np.array([POSITION_ERROR, POSITION_ERROR, HEADING_ERROR])
        beta = CORRELATION
        stationary = np.diag([1.0, beta**2])
        self._step = math.exp(-beta * dt) * np.array(
            [[1.0 + beta * dt, dt], [-(beta**2) * dt, 1.0 - beta * dt]]
        )
        gained = stationary - self._step @ stationary @ self._step.T
        self._kick = np.linalg.cholesky(gained)
        # Rows: error and its rate, in standard deviations; columns: x, y, yaw.
        self._error = np.array([[1.0], [beta]]) * random.standard_normal((2, 3))
        self._covariance = np.diag(self._sigma**2)
        self._placed = np.zeros(3)  # what a person was wrong by, who has said where the robot is
        self._motion = BodyMotion((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

    def update(self, truth: BodyMotion) -> None:
        """Take in the true motion, ``dt`` seconds after the last one."""
        noise = self._random.standard_normal((3, 3))
        self._error = self._step @ self._error + self._kick @ noise[:2]
        offset = np.minimum(np.maximum(self._error[0], -BOUND), BOUND) * self._sigma + self._placed
        x, y, yaw = (truth.pose + offset).tolist()
        deviation = self._floor + SPEED_ERROR * np.abs(truth.twist)
        vx, vy, omega = (truth.twist + deviation * noise[2]).tolist()
        variance = np.zeros((3, 3))
        variance.flat[::4] = deviation**2
        self._motion = BodyMotion(
            (x, y, math.remainder(yaw, math.tau)),
            (vx, vy, omega),
            self._covariance.copy(),
            variance,
        )

    def relocate(self, pose: tuple[float, float, float]) -> None:
        """Believe that the robot is at ``pose`` now, and go on from there."""
        self._placed += np.subtract(pose, self._motion.pose)
        x, y, yaw = pose
        self._motion = replace(self._motion, pose=(x, y, math.remainder(yaw, math.tau)))

    def read(self) -> BodyMotion:
        """Pose in ``map`` and twist, as of the last update."""
        return self._motion
