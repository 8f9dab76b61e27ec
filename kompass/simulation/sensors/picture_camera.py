"""A camera that takes pictures in colours: what its rays meet, and how the light falls on it.

No window, no graphics card and no library of the system is asked for: the rays of the physics are
cast, as for the other sensors, and coloured by what they meet.
"""

from __future__ import annotations

import zlib

import mujoco
import numpy as np
from numpy.typing import NDArray

from kompass.simulation.physics.mjcf import FLOOR_GROUP, GLASS_GROUP, SOLID_GROUP
from kompass.simulation.physics.person import PEOPLE
from kompass.simulation.physics.robot_model import PictureModel

_SKY = (206, 218, 230)
_FLOOR = ((196, 190, 180), (178, 172, 162))  # of its tiles
_TILE = 0.5  # m
_GLASS = (170, 205, 214)
_PERSON = (214, 112, 62)
# Of walls and obstacles, by their names: the same one looks the same from everywhere.
_SOLIDS = ((142, 154, 168), (166, 148, 128), (128, 158, 146), (172, 164, 138), (150, 140, 164))
_SUN = np.array([0.35, -0.5, 0.79])  # where the light comes from, of length 1
_SHADE = 0.45  # of the light falls everywhere
_HAZE = 12.0  # m, after which a third of a colour is left


class PictureCamera:
    """Casts a ray for each of its pixels, all at one instant; it draws nothing from chance."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, kind: PictureModel) -> None:
        self._model, self._data, self._kind = model, data, kind
        self._site = model.site("camera").id
        across = np.tan(kind.width_angle / 2) * np.linspace(1.0, -1.0, kind.columns)
        down = np.tan(kind.height_angle / 2) * np.linspace(1.0, -1.0, kind.rows)
        y, z = np.meshgrid(across, down)
        rays = np.stack([np.ones_like(y), y, z], axis=-1).reshape(-1, 3)
        self._rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
        self._groups = np.zeros(6, dtype=np.uint8)
        self._groups[[SOLID_GROUP, FLOOR_GROUP, GLASS_GROUP]] = 1
        self._hit = np.empty(len(rays), dtype=np.int32)
        self._distance = np.empty(len(rays))
        self._normals = np.empty(3 * len(rays))
        self._colours = np.array([self._colour(geom) for geom in range(model.ngeom)], np.float32)

    def picture(self) -> NDArray[np.uint8]:
        """What is ahead, (rows, columns, 3) of red, green and blue."""
        kind, count = self._kind, len(self._rays)
        origin = self._data.site_xpos[self._site]
        rays = self._rays @ self._data.site_xmat[self._site].reshape(3, 3).T
        mujoco.mj_multiRay(
            self._model,
            self._data,
            origin,
            rays.ravel(),
            self._groups,
            True,
            -1,
            self._hit,
            self._distance,
            self._normals,
            count,
            kind.range_max,
        )
        seen = self._hit >= 0
        geoms, distance = self._hit[seen], self._distance[seen, None]
        colours = self._colours[geoms]
        group = self._model.geom_group[geoms]
        colours[group == GLASS_GROUP] = _GLASS
        floor = group == FLOOR_GROUP
        at = origin + distance[floor] * rays[seen][floor]
        odd = np.floor(at[:, :2] / _TILE).astype(np.int64).sum(axis=1) % 2
        colours[floor] = np.array(_FLOOR, np.float32)[odd]
        facing = np.abs(self._normals.reshape(-1, 3)[seen] @ _SUN)[:, None]
        lit = colours * (_SHADE + (1.0 - _SHADE) * facing)
        haze = np.exp(-distance / _HAZE)
        pixels = np.empty((count, 3), np.float32)
        pixels[:] = _SKY
        pixels[seen] = haze * lit + (1.0 - haze) * np.array(_SKY)
        image: NDArray[np.uint8] = pixels.astype(np.uint8).reshape(kind.rows, kind.columns, 3)
        return image

    def _colour(self, geom: int) -> tuple[int, int, int]:
        name = str(self._model.geom(geom).name)
        if name in PEOPLE:
            return _PERSON
        return _SOLIDS[zlib.crc32(name.encode()) % len(_SOLIDS)]
