"""An occupancy grid and the way between its cells and the world."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.geometry import Floats, transform_points

UNKNOWN = -1
FREE = 0
OCCUPIED = 100
OCCUPIED_FROM = 65  # as map_server and RViz draw it
# Of cells a robot drives by [m]; beyond them a number is a slip, or in another unit.
FINEST, COARSEST = 0.001, 10.0
FARTHEST = 1e9  # m, of an origin


@dataclass(frozen=True, eq=False)
class Grid:
    """Cells of a map, as in nav_msgs/OccupancyGrid: -1 unknown, 0 free … 100 occupied.

    ``cells`` is int8 (H, W); ``cells[row, col]`` covers the square from
    ``(col, row) * resolution`` to ``(col + 1, row + 1) * resolution`` in the grid's own frame,
    whose pose in the world is ``origin`` (x, y, yaw).
    """

    cells: NDArray[np.int8]
    resolution: float
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if self.cells.ndim != 2 or self.cells.size == 0:
            raise ValueError(
                f"cells: shape {self.cells.shape} is no map; give rows and columns, (H, W) ≥ (1, 1)"
            )
        if not FINEST <= self.resolution <= COARSEST:  # nor NaN
            raise ValueError(
                f"resolution: {self.resolution:g} m; give cells of {FINEST:g} to {COARSEST:g} m"
            )
        # Not a number compares false. What is further away has no cells left between its figures.
        if not all(abs(value) <= FARTHEST for value in self.origin):
            raise ValueError(
                f"origin: {self.origin}; give x, y [m] and yaw [rad] of at most {FARTHEST:g}"
            )

    @classmethod
    def from_row_major(
        cls,
        data: Sequence[int] | NDArray[np.int8],
        width: int,
        height: int,
        resolution: float,
        origin: tuple[float, float, float],
    ) -> Grid:
        """From the flat ``data`` of a nav_msgs/OccupancyGrid.

        Raises
        ------
        ValueError
            ``data`` does not hold ``width * height`` cells.
        """
        flat = np.asarray(data, dtype=np.int8)
        if flat.size != width * height:
            raise ValueError(
                f"data: {flat.size} cells, but width {width} × height {height} needs "
                f"{width * height}; the message is truncated or its info is wrong"
            )
        return cls(flat.reshape(height, width), float(resolution), origin)

    def around(self, point: ArrayLike, radius: float) -> Grid:
        """The part of it that holds all its cells within ``radius`` [m] of a world point (2,).

        A single cell, the one nearest to them, where there are none.
        """
        [[x, y]] = self.to_grid_frame(point) / self.resolution
        reach = radius / self.resolution
        low_col, high_col = _span(x, reach, self.width)
        low_row, high_row = _span(y, reach, self.height)
        corner = np.array([[low_col, low_row]]) * self.resolution
        [[left, bottom]] = transform_points(self.origin, corner).tolist()
        cells = self.cells[low_row:high_row, low_col:high_col]
        return Grid(cells, self.resolution, (left, bottom, self.origin[2]))

    @property
    def height(self) -> int:
        return int(self.cells.shape[0])

    @property
    def width(self) -> int:
        return int(self.cells.shape[1])

    def to_grid_frame(self, pts: ArrayLike) -> Floats:
        """World points (N, 2) in the grid's own frame [m]."""
        x, y, yaw = self.origin
        points = np.asarray(pts, dtype=np.float64).reshape(-1, 2) - (x, y)
        return transform_points((0.0, 0.0, -yaw), points) if yaw else points

    def world_to_cell(self, pts: ArrayLike) -> NDArray[np.int64]:
        """The cells (N, 2) as (col, row) that hold world points (N, 2); may lie outside."""
        cells: NDArray[np.int64] = np.floor(self.to_grid_frame(pts) / self.resolution).astype(
            np.int64
        )
        return cells

    def cell_to_world(self, cells: ArrayLike) -> Floats:
        """World coordinates (N, 2) of the centres of cells (N, 2) given as (col, row)."""
        centres = (np.asarray(cells, dtype=np.float64).reshape(-1, 2) + 0.5) * self.resolution
        return transform_points(self.origin, centres)

    def contains(self, pts: ArrayLike) -> NDArray[np.bool_]:
        """Which world points (N, 2) lie on the grid; bool (N,)."""
        col, row = self.world_to_cell(pts).T
        inside: NDArray[np.bool_] = (
            (col >= 0) & (col < self.width) & (row >= 0) & (row < self.height)
        )
        return inside

    def occupied(
        self, threshold: int = OCCUPIED_FROM, unknown_is_obstacle: bool = False
    ) -> NDArray[np.bool_]:
        """Obstacle cells, bool (H, W): from ``threshold`` up, and unknown ones if asked."""
        blocked: NDArray[np.bool_] = self.cells >= threshold
        if unknown_is_obstacle:
            blocked = blocked | (self.cells < 0)
        return blocked


def _span(centre: float, reach: float, count: int) -> tuple[int, int]:
    """The first cell and the one after the last, of so many, within a reach [cells]."""
    low = min(max(math.floor(centre - reach), 0), count - 1)
    return low, max(min(math.ceil(centre + reach), count), low + 1)
