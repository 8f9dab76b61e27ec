"""A robot-centred occupancy grid from one sweep of a planar range sensor."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.geometry import Floats
from kompass.algorithms.grid import OCCUPIED


class LocalMapBuilder:
    """Inverse sensor model per cell: every cell looks up the range measured in its direction.

    A cell nearer than that range is free (0); the cell that holds a reading's end is occupied
    (100); everything else is unknown (-1). No lines are drawn, so there are no gaps between rays
    and no cell is treated differently for its place. Which ray a cell belongs to depends only on
    the sensor's geometry and is worked out once for it.

    Readings, after REP 117: +inf, NaN, 0 and anything from the maximum range up are "no return":
    free up to that range and no obstacle. -inf and what is nearer than the minimum range are
    "too close to measure": they say nothing.

    Parameters
    ----------
    width
        Of the map along the robot's x axis [m].
    height
        Along its y axis [m].
    resolution
        Cell size [m].
    range_max
        Readings are believed up to here [m], if the sensor does not stop earlier.

    Raises
    ------
    ValueError
        An argument is out of range.
    """

    def __init__(
        self, width: float, height: float, resolution: float, range_max: float = 20.0
    ) -> None:
        for name, value in (
            ("width", width),
            ("height", height),
            ("resolution", resolution),
            ("range_max", range_max),
        ):
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name}: {value} m; give a finite number above 0")
        if resolution > min(width, height):
            raise ValueError(
                f"resolution: {resolution} m is coarser than the map of {width} m × {height} m"
            )
        self.resolution = resolution
        self.range_max = range_max
        self.cols = max(1, round(width / resolution))
        self.rows = max(1, round(height / resolution))
        self._geometry: tuple[int, float, float, float, float] | None = None
        count = self.rows * self.cols
        self._range = np.empty(count, dtype=np.float32)
        self._beam = np.empty(count, dtype=np.int32)
        self._measured = np.empty(count, dtype=np.float32)
        self._free = np.empty(count, dtype=bool)

    @property
    def origin(self) -> tuple[float, float, float]:
        """The pose of the map's corner (lowest x and y) in the base frame."""
        return (-self.cols * self.resolution / 2.0, -self.rows * self.resolution / 2.0, 0.0)

    def update(
        self,
        ranges: ArrayLike,
        angle_min: float,
        angle_increment: float,
        range_min: float,
        range_max: float,
        sensor_pose_in_base: ArrayLike = (0.0, 0.0, 0.0),
    ) -> NDArray[np.int8]:
        """The map (rows, cols) of one scan; row 0 is the lowest y, column 0 the lowest x.

        Parameters
        ----------
        ranges
            (N,) [m], ray i at ``angle_min + i * angle_increment`` in the sensor's frame.
        angle_min
            [rad]
        angle_increment
            [rad], may be negative.
        range_min
            Nearest distance the sensor can measure [m].
        range_max
            Farthest [m].
        sensor_pose_in_base
            (x, y, yaw) of the sensor in the base frame.

        Raises
        ------
        ValueError
            No rays, or an increment of 0.
        """
        measured = np.asarray(ranges, dtype=np.float32)
        if measured.ndim != 1 or measured.size == 0:
            raise ValueError(f"ranges: shape {measured.shape}; give one row of at least one ray")
        if angle_increment == 0 or not math.isfinite(angle_increment):
            raise ValueError(f"angle_increment: {angle_increment} rad; give one other than 0")
        x, y, yaw = (float(v) for v in np.asarray(sensor_pose_in_base, dtype=np.float64))
        self._look_up(measured.size, angle_min + yaw, angle_increment, x, y)

        farthest = min(range_max, self.range_max)
        nearest = max(range_min, 1e-6)
        # One extra entry, known to be free up to 0 m, for cells that no ray looks at.
        free_to = np.zeros(measured.size + 1, dtype=np.float32)
        returned = (measured >= nearest) & (measured < farthest)
        empty = np.isnan(measured) | (measured == 0.0) | (measured >= farthest)
        free_to[:-1][empty] = farthest
        free_to[:-1][returned] = measured[returned]
        # Beyond this the cell may hold the reading's end.
        free_to -= np.float32(0.7 * self.resolution)

        np.take(free_to, self._beam, out=self._measured, mode="clip")
        np.less(self._range, self._measured, out=self._free)
        out = np.subtract(self._free.view(np.int8), np.int8(1))

        r = measured[returned]
        left, bottom, _ = self.origin
        col = np.floor((r * self._ray_x[returned] + (x - left)) / self.resolution).astype(np.int32)
        row = np.floor((r * self._ray_y[returned] + (y - bottom)) / self.resolution).astype(
            np.int32
        )
        inside = (col >= 0) & (row >= 0) & (col < self.cols) & (row < self.rows)
        out[row[inside] * self.cols + col[inside]] = OCCUPIED
        return out.reshape(self.rows, self.cols)

    def _look_up(self, rays: int, angle_min: float, increment: float, x: float, y: float) -> None:
        """Range and ray of every cell as seen from the sensor; kept until its geometry changes."""
        geometry = (rays, angle_min, increment, x, y)
        if geometry == self._geometry:
            return
        left, bottom, _ = self.origin
        cx = left + (np.arange(self.cols) + 0.5) * self.resolution - x
        cy = bottom + (np.arange(self.rows) + 0.5) * self.resolution - y
        grid_x, grid_y = np.meshgrid(cx, cy)
        self._range[:] = np.hypot(grid_x, grid_y).ravel()
        bearing = np.arctan2(grid_y, grid_x).ravel() - angle_min
        turn = 2.0 * math.pi
        # Counted from the first ray in the direction of the sweep; half a ray early is ray 0.
        swept = np.mod(bearing * math.copysign(1.0, increment) + abs(increment) / 2.0, turn)
        beam = np.floor(swept / abs(increment)).astype(np.int64)
        # A sweep of a full turn may be one ray short of it or repeat its first ray at the end.
        beam[(beam >= rays) & (rays * abs(increment) > turn - abs(increment) / 2.0)] = rays - 1
        self._beam[:] = np.minimum(beam, rays)
        angles = angle_min + increment * np.arange(rays)
        self._ray_x: Floats = np.cos(angles)
        self._ray_y: Floats = np.sin(angles)
        self._geometry = geometry
