"""Occupied cells as solid shapes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kompass_console.scene.layers.shapes import Faces, Vertices

# Corners 0..3 are the lower ones, counter-clockwise, and 4..7 those above them.
_TOP = np.array([[4, 5, 6, 7]])
_SIDES = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])


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
