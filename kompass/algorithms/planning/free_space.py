"""The cells where the robot may be, how they hang together, and shortest ways over them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

from kompass.algorithms.distance_field import DistanceField
from kompass.algorithms.geometry import Floats

# Right, up and the two diagonals; the opposite directions are the same edges.
_DIRECTIONS = ((0, 1), (1, 0), (1, 1), (1, -1))
_NEIGHBOURS = tuple((dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if dy or dx)
_FIRST = 24  # of the nearest cells, which are looked at before all others


class FreeSpace:
    """The 8-connected graph of cells whose centre keeps ``required`` [m] from obstacles.

    Two cells are neighbours only if the straight motion between their centres keeps the
    clearance as well, so being in the same region is a promise that a path exists.
    """

    def __init__(self, field: DistanceField, required: float) -> None:
        self.field = field
        self.required = required
        grid = field.grid
        # A little more than asked for: between the points tested here the clearance may dip.
        enough = required + grid.resolution / 50.0
        lattice = field.lattice
        clear = lattice >= enough
        centre = clear[1::2, 1::2]
        # Diagonal motions are also tested a quarter in, amid four lattice values.
        quarter = (lattice[:-1, :-1] + lattice[1:, :-1] + lattice[:-1, 1:] + lattice[1:, 1:]) >= (
            4.0 * enough
        )
        rows, cols = centre.shape
        # Which of its eight neighbours a cell is joined to, in the order of their ids.
        joined = np.zeros((rows, cols, len(_NEIGHBOURS)), dtype=bool)
        for dy, dx in _DIRECTIONS:
            left, right = max(0, -dx), cols - max(0, dx)
            here = (slice(0, rows - dy), slice(left, right))
            there = (slice(dy, rows), slice(left + dx, right + dx))
            midpoint = clear[
                1 + dy : 2 * (rows - dy) + dy : 2, 2 * left + 1 + dx : 2 * right + dx : 2
            ]
            open_ = centre[here] & centre[there] & midpoint
            if dy and dx:
                first = 2 * left + 1 + min(dx, 0)
                second = 2 * left + (2 if dx > 0 else -1)
                width = 2 * (right - left)
                open_ &= quarter[1 : 2 * (rows - dy) : 2, first : first + width : 2]
                open_ &= quarter[2 : 2 * (rows - dy) + 1 : 2, second : second + width : 2]
            joined[here][..., _NEIGHBOURS.index((dy, dx))] = open_
            joined[there][..., _NEIGHBOURS.index((-dy, -dx))] = open_
        flat = joined.reshape(rows * cols, len(_NEIGHBOURS))
        cell, direction = np.divmod(np.flatnonzero(flat).astype(np.int32), len(_NEIGHBOURS))
        steps = np.array([dy * cols + dx for dy, dx in _NEIGHBOURS], dtype=np.int32)
        lengths = np.array([math.hypot(*each) * grid.resolution for each in _NEIGHBOURS])
        starts = np.zeros(rows * cols + 1, dtype=np.int32)
        np.cumsum(flat.sum(axis=1, dtype=np.int32), out=starts[1:])
        self._graph = csr_matrix(
            (lengths[direction], cell + steps[direction], starts), shape=(rows * cols, rows * cols)
        )
        # Each edge is there in both directions, so what is strongly connected is connected.
        _, labels = connected_components(self._graph, directed=True, connection="strong")
        self.labels: NDArray[np.int32] = np.where(centre.ravel(), labels, -1).astype(np.int32)

    def region(self, cell: int) -> NDArray[np.int64]:
        """The ids of all cells that can be reached from ``cell``."""
        return np.flatnonzero(self.labels == self.labels[cell])

    def centres(self, cells: NDArray[np.int64]) -> Floats:
        """World coordinates (N, 2) of cells given by id."""
        width = self.field.grid.width
        return self.field.grid.cell_to_world(np.stack([cells % width, cells // width], axis=1))

    def entry(self, point: tuple[float, float], reach: float, minimum: float) -> int | None:
        """The nearest clear cell within ``reach`` [m] that a straight motion from ``point`` meets.

        On the way the robot comes no closer to obstacles than it is at ``point`` (or than
        ``required``); where that is impossible, no closer than ``minimum`` [m].
        """
        grid = self.field.grid
        col, row = (int(value) for value in grid.world_to_cell([point])[0])
        n = math.ceil(reach / grid.resolution)
        cols = np.arange(max(0, col - n), min(grid.width, col + n + 1))
        rows = np.arange(max(0, row - n), min(grid.height, row + n + 1))
        ids = (rows[:, None] * grid.width + cols[None, :]).ravel().astype(np.int64)
        ids = ids[self.labels[ids] >= 0]
        centres = self.centres(ids)
        away = np.hypot(centres[:, 0] - point[0], centres[:, 1] - point[1])
        order = np.argsort(away, kind="stable")
        order = order[away[order] <= reach]
        here = self.field.at_xy(*point)
        for level in (min(here, self.required), minimum):
            for some in np.split(order, [_FIRST]):
                starts = np.broadcast_to(point, (len(some), 2))
                clear = self.field.segments_clear(starts, centres[some], level)
                if clear.any():
                    return int(ids[some[int(np.argmax(clear))]])
        return None

    def nearest(self, cell: int, point: tuple[float, float]) -> tuple[float, float]:
        """The centre closest to ``point`` among the cells reachable from ``cell``."""
        centres = self.centres(self.region(cell))
        away = np.hypot(centres[:, 0] - point[0], centres[:, 1] - point[1])
        x, y = centres[int(np.argmin(away))]
        return float(x), float(y)

    def bounds(self, cell: int) -> tuple[Floats, Floats]:
        """The world-aligned box (low, high) around the box of cells reachable from ``cell``."""
        width = self.field.grid.width
        rows, cols = divmod(self.region(cell), width)
        corners = [row * width + col for row in _ends(rows) for col in _ends(cols)]
        centres = self.centres(np.array(corners))
        return centres.min(axis=0), centres.max(axis=0)

    def shortest(
        self, start: int, goal: int, limit: float = math.inf
    ) -> tuple[Floats, float] | None:
        """The shortest way over cells as (points (N, 2), length [m]); None if beyond ``limit``.

        Dijkstra's algorithm; the limit keeps the search to the neighbourhood that matters.
        """
        lengths, previous = dijkstra(
            csgraph=self._graph,
            directed=True,
            indices=np.array([start]),
            return_predecessors=True,
            limit=limit,
        )
        length = float(lengths[0, goal])
        if not math.isfinite(length):
            return None
        chain = [goal]
        while chain[-1] != start:
            chain.append(int(previous[0, chain[-1]]))
        return self.centres(np.array(chain[::-1], dtype=np.int64)), length


def _ends(values: NDArray[np.int64]) -> tuple[np.int64, np.int64]:
    return values.min(), values.max()
