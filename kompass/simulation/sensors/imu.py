"""An inertial measurement unit of hobby grade."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

GYRO_NOISE = 0.002  # standard deviations: rad/s,
ACCELERATION_NOISE = 0.03  # m/s²,
ORIENTATION_NOISE = 0.002  # rad


@dataclass(frozen=True)
class ImuReading:
    """One reading in ``imu_link``.

    Attributes
    ----------
    orientation
        Quaternion (x, y, z, w) of ``imu_link`` in the world.
    angular_velocity
        (3,) rad/s.
    linear_acceleration
        (3,) m/s², gravity included as real accelerometers do.
    """

    orientation: tuple[float, float, float, float]
    angular_velocity: NDArray[np.float64]
    linear_acceleration: NDArray[np.float64]


class Imu:
    """Reads MuJoCo's inertial sensors and adds white noise."""

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, random: np.random.Generator
    ) -> None:
        self._random = random
        self._orientation, self._gyro, self._acceleration = (
            data.sensor(name).data for name in ("orientation", "gyro", "accelerometer")
        )

    def read(self) -> ImuReading:
        """The newest reading."""
        noise = self._random.standard_normal(7)
        half = ORIENTATION_NOISE / 2 * noise[6]  # of the heading, as a small rotation about z
        w, x, y, z = (float(part) for part in self._orientation)
        turned = np.array([x + half * y, y - half * x, z + half * w, w - half * z])
        turned /= np.linalg.norm(turned)
        return ImuReading(
            (float(turned[0]), float(turned[1]), float(turned[2]), float(turned[3])),
            self._gyro + GYRO_NOISE * noise[:3],
            self._acceleration + ACCELERATION_NOISE * noise[3:6],
        )
