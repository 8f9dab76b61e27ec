"""The map of a world, made from the geometry that the physics collides with."""

from __future__ import annotations

import math

import numpy as np

from kompass.algorithms.geometry import Floats
from kompass.algorithms.grid import Grid
from kompass.simulation.worlds.world import World

UNKNOWN, FREE, OCCUPIED = -1, 0, 100
MARGIN = 0.25  # of unknown cells around the outer wall, m


def rasterize(world: World, resolution: float = 0.05) -> Grid:
    """The occupancy grid of ``world``, frame ``map``.

    A cell is occupied when its centre lies in a solid or within half a cell of one, free when it
    is elsewhere on the floor, and unknown outside the walls. Corners of the grid fall on multiples
    of the resolution, so that maps of one world at one resolution are identical everywhere.

    Parameters
    ----------
    world
        The geometry.
    resolution
        Edge of a cell in metres.

    Raises
    ------
    ValueError
        The resolution is not a finite length above zero.
    """
    if not (math.isfinite(resolution) and resolution > 0.0):
        raise ValueError(f"resolution is {resolution!r}; give a finite length above 0 (metres)")
    min_x, min_y, max_x, max_y = world.bounds
    first_column = math.floor((min_x - MARGIN) / resolution)
    first_row = math.floor((min_y - MARGIN) / resolution)
    width = math.ceil((max_x + MARGIN) / resolution) - first_column
    height = math.ceil((max_y + MARGIN) / resolution) - first_row

    columns = np.asarray((first_column + np.arange(width) + 0.5) * resolution, dtype=np.float64)
    rows = np.asarray((first_row + np.arange(height) + 0.5) * resolution, dtype=np.float64)

    def centers(rows: Floats, columns: Floats) -> Floats:
        return np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)

    on_floor = world.on_floor(centers(rows, columns)).reshape(height, width)
    cells = np.where(on_floor, FREE, UNKNOWN).astype(np.int8)
    for shape in world.solids:
        far = shape.reach + resolution
        left, right = np.searchsorted(columns, (shape.center[0] - far, shape.center[0] + far))
        low, high = np.searchsorted(rows, (shape.center[1] - far, shape.center[1] + far))
        there = shape.distance(centers(rows[low:high], columns[left:right]))
        # The tolerance settles centres that lie exactly half a cell away, whatever the rounding.
        solid = (there <= resolution / 2 + 1e-9).reshape(high - low, right - left)
        cells[low:high, left:right][solid] = OCCUPIED
    origin = (round(first_column * resolution, 9), round(first_row * resolution, 9), 0.0)
    return Grid(cells, resolution, origin)
