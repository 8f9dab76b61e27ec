"""The true cells of a grid as few rectangles, or a wall is a thousand squares."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


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
