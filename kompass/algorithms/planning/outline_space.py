"""The cells where a body that is not round may be, by the way that it faces there."""

from __future__ import annotations

import copy
import math

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

from kompass.algorithms.distance_field import DistanceField
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats
from kompass.algorithms.planning.free_space import FreeSpace

# Around the cell, by columns and rows, the opposite of each four further on.
_HEADINGS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
# How much longer a way seems where the body just fits through, and where it has the clearance.
_NARROW, _NEAR = 5.0, 0.6
# Beyond the clearance, room still makes a way seem shorter, up to here [m].
_AMPLE = 0.35


class OutlineSpace(FreeSpace):
    """The 8-connected graph of cells, over which the body goes facing where it goes.

    An edge is there if the body, facing along it, keeps ``least`` from obstacles at both ends, on
    the distances at half-cell steps; whoever uses a way checks it closely. An edge seems longer
    than it is where less than ``clearance`` is kept, and a little where there is not ample room.

    Parameters
    ----------
    field
        Of the obstacles.
    footprint
        The body.
    least, clearance
        What must be kept, and what is better kept [m].
    """

    def __init__(
        self, field: DistanceField, footprint: Footprint, least: float, clearance: float
    ) -> None:
        self.field = field
        self.required = footprint.inscribed_radius + least
        self._clearance = clearance
        self.ample = clearance + _AMPLE  # room from which on more makes no way seem shorter [m]
        rows, cols = field.grid.height, field.grid.width
        ids = np.arange(rows * cols, dtype=np.int32).reshape(rows, cols)
        rooms = self._rooms(footprint)
        sources, targets, costs = [], [], []
        open_ = np.zeros((rows, cols), dtype=bool)
        for (dx, dy), room in zip(_HEADINGS, rooms, strict=True):
            clear = room >= least
            open_ |= clear
            here = (slice(max(0, -dy), rows - max(0, dy)), slice(max(0, -dx), cols - max(0, dx)))
            there = (slice(max(0, dy), rows + min(0, dy)), slice(max(0, dx), cols + min(0, dx)))
            leads = clear[here] & clear[there]
            dearer = self.dearer(np.minimum(room[here][leads], room[there][leads]))
            sources.append(ids[here][leads])
            targets.append(ids[there][leads])
            costs.append(dearer * (math.hypot(dx, dy) * field.grid.resolution))
        self._graph = coo_matrix(
            (np.concatenate(costs), (np.concatenate(sources), np.concatenate(targets))),
            shape=(rows * cols, rows * cols),
        ).tocsr()
        _, labels = connected_components(self._graph, directed=False)
        self.labels: NDArray[np.int32] = np.where(open_.ravel(), labels, -1).astype(np.int32)

    def dearer(self, room: Floats) -> Floats:
        """By how many times a way seems longer than it is, where the body has ``room`` [m]."""
        narrow = np.clip(1.0 - room / max(self._clearance, 1e-6), 0.0, 1.0)
        near = np.clip(1.0 - room / self.ample, 0.0, 1.0)
        out: Floats = 1.0 + _NARROW * narrow * narrow + _NEAR * near * near
        return out

    def costs_to(self, goal: int, *, unlikely: float) -> Floats:
        """What the way to a cell costs from each of the cells (rows * cols,) [m].

        Where there is none along which the body faces, as a car may drive back, it is the straight
        line, each metre of which counts for ``unlikely`` many.
        """
        # Against its edges: all of the ways lead to the goal.
        costs: Floats = dijkstra(
            csgraph=self._graph.transpose().tocsr(), directed=True, indices=np.array([goal])
        )[0]
        without = np.flatnonzero(~np.isfinite(costs))
        centres = self.centres(np.append(without, goal))
        costs[without] = unlikely * np.hypot(*(centres[:-1] - centres[-1]).T)
        return costs

    def copied(self) -> OutlineSpace:
        """One of its own to :meth:`avoid` places in."""
        other = copy.copy(self)
        other._graph = self._graph.copy()
        return other

    def avoid(self, points: Floats, reach: float) -> None:
        """Let all that is nearer to places (N, 2) than ``reach`` [m] seem far away from now on."""
        grid = self.field.grid
        cells = grid.world_to_cell(points)
        n = math.ceil(reach / grid.resolution)
        steps = np.arange(-n, n + 1)
        col = (cells[:, 0, None, None] + steps[None, None, :]).clip(0, grid.width - 1)
        row = (cells[:, 1, None, None] + steps[None, :, None]).clip(0, grid.height - 1)
        ids = np.unique(row * grid.width + col)
        begin, end = self._graph.indptr[ids], self._graph.indptr[ids + 1]
        for first, last in zip(begin.tolist(), end.tolist(), strict=True):
            self._graph.data[first:last] *= 4.0

    def _rooms(self, footprint: Footprint) -> list[NDArray[np.float32]]:
        """Distance between body and obstacles at all cells (rows, cols), for each heading [m]."""
        lattice = self.field.lattice
        step = self.field.grid.resolution / 2.0
        rows, cols = self.field.grid.height, self.field.grid.width
        centres, radius = footprint.discs
        pad = math.ceil(footprint.radius / step) + 1
        padded = np.zeros((lattice.shape[0] + 2 * pad, lattice.shape[1] + 2 * pad), np.float32)
        padded[pad:-pad, pad:-pad] = lattice
        # A cell's centre at [2r + 1, 2c + 1]: even rows and columns apart from odd ones.
        parts = [[np.ascontiguousarray(padded[i::2, j::2]) for j in range(2)] for i in range(2)]
        same = _turned_round(footprint)
        middle = lattice[1::2, 1::2] - np.float32(footprint.inscribed_radius)
        rooms: list[NDArray[np.float32]] = []
        for index, (dx, dy) in enumerate(_HEADINGS):
            if index >= 4 and same:
                rooms.append(rooms[index - 4])
                continue
            cos, sin = np.array([dx, dy]) / math.hypot(dx, dy)
            at = np.column_stack(
                [
                    centres[:, 0] * cos - centres[:, 1] * sin,
                    centres[:, 0] * sin + centres[:, 1] * cos,
                ]
            )
            offsets = np.unique(np.rint(at / step).astype(int), axis=0) + pad + 1
            room = np.full((rows, cols), np.inf, dtype=np.float32)
            for across, up in offsets.tolist():
                part = parts[up % 2][across % 2]
                first, left = up // 2, across // 2
                np.minimum(room, part[first : first + rows, left : left + cols], out=room)
            room -= np.float32(radius)
            rooms.append(np.minimum(room, middle, out=room))
        return rooms


def _turned_round(footprint: Footprint) -> bool:
    """Whether the body looks the same when it faces the other way."""
    away = np.linalg.norm(footprint.corners[:, None] + footprint.corners[None], axis=2)
    return bool((away.min(axis=1) < 1e-6).all())
