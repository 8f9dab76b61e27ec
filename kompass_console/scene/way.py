"""The way of a drive that is over: where its robot was at any moment."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from kompass_console.schema.world import Pose

_STEP = 0.01  # m; a shorter one tells no direction
_DASH, _PITCH = 0.12, 0.2  # m; length of a dash, and from one to the next


class Way:
    """A track, ready to be asked for any moment.

    Parameters
    ----------
    track
        (time, x, y) in s and m, in the order of time.
    heading
        Where the robot faced at first, rad.

    Attributes
    ----------
    points
        (N, 2), m.
    """

    def __init__(self, track: Sequence[tuple[float, float, float]], heading: float) -> None:
        rows = np.array(track, dtype=np.float64).reshape(-1, 3)
        self._times = rows[:, 0]
        self.points: npt.NDArray[np.float64] = rows[:, 1:]
        steps = np.diff(self.points, axis=0)
        lengths = np.hypot(steps[:, 0], steps[:, 1])
        self._along = np.concatenate([[0.0], np.cumsum(lengths)])[: len(rows)]
        headings = [heading]  # with which it came to each point
        for (dx, dy), length in zip(steps, lengths, strict=True):
            headings.append(float(np.arctan2(dy, dx)) if length >= _STEP else headings[-1])
        self._headings = headings

    def at(self, time: float) -> Pose | None:
        """Where it was; before the first and after the last point it stood there. None without
        a way."""
        if not len(self._times):
            return None
        x, y = (float(np.interp(time, self._times, axis)) for axis in self.points.T)
        # Between two points it faces the one to come.
        to_come = int(np.searchsorted(self._times, time, side="right"))
        return Pose(x, y, self._headings[min(to_come, len(self._headings) - 1)])

    def segments(self, *, dashed: bool) -> npt.NDArray[np.float64]:
        """Pieces (M, 2, 2) of the line that it drove, all of them or those of its dashes."""
        pieces = np.stack([self.points[:-1], self.points[1:]], axis=1)
        return pieces[self._drawn(dashed)]

    def driven(self, time: float, *, dashed: bool) -> int:
        """How many of these pieces it had left behind."""
        if not len(self._times):
            return 0
        so_far = np.interp(time, self._times, self._along)
        return int(np.count_nonzero(self._along[1:][self._drawn(dashed)] <= so_far))

    def _drawn(self, dashed: bool) -> npt.NDArray[np.bool_]:
        middles = (self._along[:-1] + self._along[1:]) / 2.0
        return middles % _PITCH < _DASH if dashed else np.ones(len(middles), np.bool_)
