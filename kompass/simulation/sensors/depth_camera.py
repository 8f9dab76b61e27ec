"""A depth camera, which gives points of what it sees, the floor included."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from kompass.simulation.physics.mjcf import FLOOR_GROUP, SOLID_GROUP
from kompass.simulation.physics.robot_model import CameraModel


class DepthCamera:
    """Casts a ray for each of its pixels, all at one instant."""

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        random: np.random.Generator,
        kind: CameraModel,
    ) -> None:
        self._model, self._data, self._random, self._kind = model, data, random, kind
        self._site = model.site("camera").id
        across = np.tan(kind.width_angle / 2) * np.linspace(1.0, -1.0, kind.columns)
        down = np.tan(kind.height_angle / 2) * np.linspace(1.0, -1.0, kind.rows)
        y, z = np.meshgrid(across, down)
        rays = np.stack([np.ones_like(y), y, z], axis=-1).reshape(-1, 3)
        self._rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
        self._groups = np.zeros(6, dtype=np.uint8)
        self._groups[[SOLID_GROUP, FLOOR_GROUP]] = 1
        self._hit = np.empty(len(rays), dtype=np.int32)
        self._distance = np.empty(len(rays))

    def points(self) -> NDArray[np.float32]:
        """Points (rows, columns, 3) in the camera's frame, x ahead and z up [m]; NaN for none."""
        kind, count = self._kind, len(self._rays)
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
            count,
            kind.range_max,
        )
        distance = self._distance + self._random.normal(0.0, kind.noise, count)
        out = (self._hit < 0) | (distance > kind.range_max) | (distance < kind.range_min)
        points = distance[:, None] * self._rays
        points[out] = np.nan
        image: NDArray[np.float32] = points.astype(np.float32).reshape(kind.rows, kind.columns, 3)
        return image
