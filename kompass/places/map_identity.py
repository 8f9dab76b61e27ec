"""Which map a place is on: told by the map itself, since a map on ROS has no name."""

from __future__ import annotations

import hashlib
import struct

import numpy as np

from kompass.algorithms.grid import Grid
from kompass.places.place import MapIdentity


def identify(grid: Grid) -> MapIdentity:
    """Identity of a map: of its size, resolution, origin and every cell.

    Two maps of one size would be one without their cells, and a pose of the one a wrong goal on the
    other. The price is that a map that was changed in a single cell is another map.
    """
    digest = hashlib.sha256()
    digest.update(struct.pack("<qq", grid.width, grid.height))
    # A message carries the resolution as float32; a file has more digits.
    digest.update(struct.pack("<f3d", grid.resolution, *grid.origin))
    digest.update(np.ascontiguousarray(grid.cells).data)
    width, height = grid.width * grid.resolution, grid.height * grid.resolution
    return MapIdentity(id=digest.hexdigest()[:32], label=f"{width:.1f} × {height:.1f} m")
