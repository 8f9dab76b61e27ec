"""A planar lidar."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from kompass.simulation.physics.mjcf import SOLID_GROUP
from kompass.simulation.physics.robot_model import LidarModel


class Lidar:
    """Casts its rays against the solids of the physics, all at one instant.

    Attributes
    ----------
    mirrors
        Ids of geoms that throw its rays back instead of scattering them.
    """

    age = 0.0

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        random: np.random.Generator,
        kind: LidarModel,
        site: str = "lidar",
    ) -> None:
        self._kind = kind
        self._model = model
        self._data = data
        self._random = random
        self._site = model.site(site).id
        angles, rays = kind.angles, kind.rays
        self._rays = np.stack([np.cos(angles), np.sin(angles), np.zeros(rays)], axis=1)
        self._groups = np.zeros(6, dtype=np.uint8)
        self._groups[SOLID_GROUP] = 1
        self.mirrors: tuple[int, ...] = ()
        self._hit = np.empty(rays, dtype=np.int32)
        self._distance = np.empty(rays)

    def scan(self) -> NDArray[np.float32]:
        """Ranges (rays,) in metres; +inf where nothing is within reach."""
        kind, count = self._kind, self._kind.rays
        rotation = self._data.site_xmat[self._site].reshape(3, 3)
        rays = self._rays @ rotation.T
        normals = np.empty(3 * count) if self.mirrors else None
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
            count,
            kind.range_max,
        )
        if normals is not None:
            self._reflect(rays, normals.reshape(count, 3))
        ranges = self._distance + self._random.normal(0.0, kind.noise, count)
        ranges = np.maximum(ranges, kind.saturated)
        ranges[(self._hit < 0) | (ranges > kind.range_max)] = np.inf
        return ranges.astype(np.float32)

    def _reflect(self, rays: NDArray[np.float64], normals: NDArray[np.float64]) -> None:
        """Let the rays (N, 3) that met a mirror go on, once, to what they meet behind it."""
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
