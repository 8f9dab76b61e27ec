"""Occupied cells as a film over them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kompass_console.scene.layers.shapes import Faces, Vertices


def tops(areas: npt.NDArray[np.floating], height: float) -> tuple[Vertices, Faces]:
    """Mesh of rectangles over areas (N, 4) of (y0, x0, y1, x1) at a height, all in m."""
    y0, x0, y1, x1 = areas.T
    corners = [
        np.stack([x, y, np.full_like(x, height)], axis=1)
        for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    ]
    vertices = np.stack(corners, axis=1).reshape(-1, 3).astype(np.float32)
    first = np.arange(len(areas), dtype=np.uint32)[:, None] * 4
    halves = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
    return vertices, np.concatenate([first + halves[0], first + halves[1]])
