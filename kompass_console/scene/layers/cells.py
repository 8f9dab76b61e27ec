"""Occupied cells as solid shapes: merged into rectangles first, or a wall is a thousand boxes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kompass_console.scene.layers.shapes import Faces, Vertices

OCCUPIED_FROM = 65  # of 100, as map_server and RViz draw it

# Corners 0..3 are the lower ones, counter-clockwise, and 4..7 those above them.
_TOP = np.array([[4, 5, 6, 7]])
_SIDES = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])


def rectangles(occupied: npt.NDArray[np.bool_]) -> npt.NDArray[np.int64]:
    """Rectangles (N, 4) of (row, column, end row, end column) that cover the true cells once:
    runs along the rows, joined with equal runs in the rows below."""
    padded = np.zeros((occupied.shape[0], occupied.shape[1] + 2), dtype=np.int8)
    padded[:, 1:-1] = occupied
    change = np.diff(padded, axis=1)
    rows, starts = np.nonzero(change == 1)
    ends = np.nonzero(change == -1)[1]
    open_runs: dict[tuple[int, int], list[int]] = {}
    done: list[list[int]] = []
    for row, start, end in zip(rows.tolist(), starts.tolist(), ends.tolist(), strict=True):
        run = open_runs.get((start, end))
        if run is not None and run[2] == row:
            run[2] = row + 1
        else:
            run = [row, start, row + 1, end]
            open_runs[start, end] = run
            done.append(run)
    return np.array(done, dtype=np.int64).reshape(-1, 4)


def blocks(
    areas: npt.NDArray[np.floating], low: float, high: float, *, sides: bool = True
) -> tuple[Vertices, Faces]:
    """Mesh of boxes over areas (N, 4) of (y0, x0, y1, x1), from z `low` to `high`, all in m.

    Without `sides` only the tops. Every face has its own vertices, or shading would round the
    edges off.
    """
    y0, x0, y1, x1 = areas.T
    corners = np.stack(
        [
            np.stack([x, y, np.full_like(x, z)], axis=1)
            for z in (low, high)
            for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
        ],
        axis=1,
    )
    quads = np.concatenate([_TOP, _SIDES]) if sides else _TOP
    vertices = corners[:, quads].reshape(-1, 3).astype(np.float32)
    first = np.arange(len(vertices) // 4, dtype=np.uint32)[:, None] * 4
    halves = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
    return vertices, np.concatenate([first + halves[0], first + halves[1]])
