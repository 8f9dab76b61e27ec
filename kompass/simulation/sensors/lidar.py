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

    Attributes
    ----------
    mirrors
        Ids of geoms that throw its rays back instead of scattering them.
    """

    age = 0.0

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
        self.mirrors: tuple[int, ...] = ()
        self._hit = np.empty(RAYS, dtype=np.int32)
        self._distance = np.empty(RAYS)

    def scan(self) -> NDArray[np.float32]:
        """Ranges (360,) in metres; +inf where nothing is within reach."""
        rotation = self._data.site_xmat[self._site].reshape(3, 3)
        rays = self._rays @ rotation.T
        normals = np.empty(3 * RAYS) if self.mirrors else None
        mujoco.mj_multiRay(
            self._model,
            self._data,
            self._data.site_xpos[self._site],
            rays.ravel(),
            self._groups,
            True,
            -1,
            self._hit,
            self._distance,
            normals,
            RAYS,
            RANGE_MAX,
        )
        if normals is not None:
            self._reflect(rays, normals.reshape(RAYS, 3))
        ranges = self._distance + self._random.normal(0.0, NOISE, RAYS)
        ranges = np.maximum(ranges, SATURATED)
        ranges[(self._hit < 0) | (ranges > RANGE_MAX)] = np.inf
        return ranges.astype(np.float32)

    def _reflect(self, rays: NDArray[np.float64], normals: NDArray[np.float64]) -> None:
        """Let the rays (360, 3) that met a mirror go on, once, to what they meet behind it."""
        origin = self._data.site_xpos[self._site]
        for ray in np.flatnonzero(np.isin(self._hit, self.mirrors)):
            normal = normals[ray]
            back = rays[ray] - 2.0 * (rays[ray] @ normal) * normal
            # A hair in front of the mirror, lest the ray meet it again.
            start = origin + self._distance[ray] * rays[ray] + 1e-6 * back
            further = mujoco.mj_ray(
                self._model, self._data, start, back, self._groups, True, -1, self._hit[ray:][:1]
            )
            if further >= 0.0:
                self._distance[ray] += further
