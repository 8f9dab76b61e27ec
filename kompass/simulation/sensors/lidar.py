"""A 360-ray planar lidar like the LDS-01."""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from kompass.simulation.physics.mjcf import SOLID_GROUP

RAYS = 360
RANGE_MIN = 0.12  # m
RANGE_MAX = 3.5
NOISE = 0.005  # standard deviation of one range, m

# Reported for anything closer than the sensor can measure. It lies just inside the valid
# interval, so that no reader mistakes an obstacle that touches the robot for free space.
SATURATED = RANGE_MIN + 0.001


class Lidar:
    """Casts its rays against the solids of the physics, all at one instant.

    Ray k looks along k·2π/360 from the robot's x axis, anticlockwise.
    """

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, random: np.random.Generator
    ) -> None:
        self._model = model
        self._data = data
        self._random = random
        self._site = model.site("lidar").id
        angles = np.arange(RAYS) * (math.tau / RAYS)
        self._rays = np.stack([np.cos(angles), np.sin(angles), np.zeros(RAYS)], axis=1)
        self._groups = np.zeros(6, dtype=np.uint8)
        self._groups[SOLID_GROUP] = 1
        self._hit = np.empty(RAYS, dtype=np.int32)
        self._distance = np.empty(RAYS)

    def scan(self) -> NDArray[np.float32]:
        """Ranges (360,) in metres; +inf where nothing is within reach."""
        rotation = self._data.site_xmat[self._site].reshape(3, 3)
        mujoco.mj_multiRay(
            self._model,
            self._data,
            self._data.site_xpos[self._site],
            (self._rays @ rotation.T).ravel(),
            self._groups,
            True,
            -1,
            self._hit,
            self._distance,
            None,
            RAYS,
            RANGE_MAX,
        )
        ranges = self._distance + self._random.normal(0.0, NOISE, RAYS)
        ranges = np.maximum(ranges, SATURATED)
        ranges[(self._hit < 0) | (ranges > RANGE_MAX)] = np.inf
        return ranges.astype(np.float32)
