"""The outlines of patches of cells, for who draws them."""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label

from kompass.algorithms.geometry import Floats

MOST_CELLS = 400  # along a side; more are taken together
MOST_CORNERS = 400  # of an outline
MOST_PATCHES = 100  # the largest


def outlines(cells: NDArray[np.bool_]) -> list[Floats]:
    """Polygons (N, 2) around the patches of true cells (H, W), in (column, row) of their corners.

    A hole is a part of its polygon that is reached and left by the same edge, so that a ray meets
    the edges an odd number of times where a cell is true. It is off by a cell at most, or, of more
    than ``MOST_CELLS`` and of very frayed ones, by so many of them that it can be drawn.
    """
    share = math.ceil(max(cells.shape) / MOST_CELLS)
    coarse = _taken_together(cells, share)
    patches, count = label(coarse)
    sizes = np.bincount(patches.ravel(), minlength=count + 1)
    largest = sorted(range(1, count + 1), key=lambda patch: -sizes[patch])[:MOST_PATCHES]
    return [share * _outline(patches == patch) for patch in largest]


def _taken_together(cells: NDArray[np.bool_], share: int) -> NDArray[np.bool_]:
    """Blocks of so many cells along each side, true where one of them is."""
    if share == 1:
        return cells
    padded = np.pad(cells, [(0, -size % share) for size in cells.shape])
    rows, cols = (size // share for size in padded.shape)
    return np.asarray(padded.reshape(rows, share, cols, share).any(axis=(1, 3)))


def _outline(patch: NDArray[np.bool_]) -> Floats:
    loops = sorted(_loops(patch), key=_area, reverse=True)
    tolerance = 0.75
    while True:
        outer, *holes = (_simple(loop, tolerance) for loop in loops)
        holes = [hole for hole in holes if len(hole) > 2]
        parts = [outer]
        for hole in holes:
            parts += [hole, hole[:1], outer[-1:]]
        corners = np.concatenate(parts)
        if len(corners) <= MOST_CORNERS:
            return corners
        tolerance *= 2.0


def _loops(patch: NDArray[np.bool_]) -> list[Floats]:
    """Closed walks (N, 2) along the border of a patch, which stays on the left."""
    around = np.pad(patch, 1)
    onward: dict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
    for (down, right), begin, end in (
        ((0, 1), (0, 0), (1, 0)),  # nothing below: along the lower side
        ((1, 2), (1, 0), (1, 1)),
        ((2, 1), (1, 1), (0, 1)),
        ((1, 0), (0, 1), (0, 0)),
    ):
        height, width = patch.shape
        beside = around[down : down + height, right : right + width]
        for row, col in np.argwhere(patch & ~beside).tolist():
            onward[col + begin[0], row + begin[1]].append((col + end[0], row + end[1]))
    loops = []
    while onward:
        at = start = next(iter(onward))
        walk = []
        while True:
            walk.append(at)
            ways = onward[at]
            after = ways.pop()
            if not ways:
                del onward[at]
            at = after
            if at == start:
                break
        loops.append(np.array(walk, dtype=np.float64))
    return loops


def _area(loop: Floats) -> float:
    x, y = loop.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum()) / 2.0


def _simple(loop: Floats, tolerance: float) -> Floats:
    """A closed walk with fewer corners, by the method of Ramer, Douglas and Peucker (1972/73)."""
    far = int(np.hypot(*(loop - loop[0]).T).argmax())
    closed = np.concatenate([loop, loop[:1]])
    keep = {0, far}
    open_spans = [(0, far), (far, len(loop))]
    while open_spans:
        first, last = open_spans.pop()
        between = closed[first + 1 : last]
        if not len(between):
            continue
        along = closed[last] - closed[first]
        length = float(np.hypot(*along))
        away = between - closed[first]
        off = (
            np.hypot(*away.T)
            if length == 0.0
            else np.abs(along[0] * away[:, 1] - along[1] * away[:, 0]) / length
        )
        worst = int(off.argmax())
        if off[worst] > tolerance:
            middle = first + 1 + worst
            keep.add(middle)
            open_spans += [(first, middle), (middle, last)]
    return closed[sorted(keep)]
