"""What a point cloud shows around the robot: what is in its way, and what was looked through.

A cloud is looked at in the robot's frame. What is within a band of heights is in the way; what is
lower is the floor, what is higher the robot goes under. Both are lines of sight as well: whatever
they have passed through on their way is not there. A planar scan's ray clears all of a cell; a line
of sight of a cloud only what is as high as the line is there, so that a low box is not forgotten
because a camera, near to it by now, looks over it (the thought of a voxel grid, Nav2's spatio-
temporal one among them, with one interval of heights for each cell).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.geometry import Floats
from kompass.algorithms.transforms import Matrix

REACH = 5.0  # m; what is further away is left out
CELL = 0.05  # m; of the points in one of these the nearest to the robot counts
_BEARINGS = 180  # in which lines of sight are told apart, two degrees each
_PITCHES = 360  # and how steep they are, half a degree each
_SAMPLES = 8  # heights of a thing at which it is asked whether lines go on behind it
_LINES = 20_000  # lines of sight that are looked at, of clouds with more points
_BEHIND = 0.1  # m by which a line of sight must go on behind what it passes through
_BELOW = 0.1  # m; what passes so little under what was seen of a thing has gone through it, too

Points3 = NDArray[np.float32]


class HeightBand(NamedTuple):
    """Heights at which the robot would meet something, above the origin of its frame [m]."""

    low: float
    high: float


class CloudView:
    """One cloud, as seen from the robot.

    Parameters
    ----------
    cloud
        Points (3, N) in the sensor's frame [m]; what is not finite is left out.
    mounted
        Matrix (4, 4) that takes points of the sensor's frame to the robot's.
    band
        In which heights something is in the way.
    width
        Points of a row of the cloud.

    Attributes
    ----------
    points
        What is in the way, (M, 2) in the robot's frame [m].
    bottoms, tops
        Lowest and highest point seen in the same place (M,), above the robot's origin [m].
    measured
        How many points of the cloud were finite, at whatever distance.
    """

    def __init__(self, cloud: Points3, mounted: Matrix, band: HeightBand, width: int = 1) -> None:
        with np.errstate(invalid="ignore", over="ignore"):
            x, y, z = mounted[:3, :3].astype(np.float32) @ cloud
            for axis, values in enumerate((x, y, z)):
                values += np.float32(mounted[axis, 3])
            # None of these holds for NaN.
            near = (np.abs(x) < REACH) & (np.abs(y) < REACH) & (np.abs(z) < 2 * REACH)
            barring = near & (z >= band.low) & (z <= band.high)
        self.measured = int(np.isfinite(z).sum())
        self._eye = tuple(float(value) for value in mounted[:3, 3])
        met = np.flatnonzero(barring)
        self.points, self.bottoms, self.tops = _nearest(x[met], y[met], z[met])
        every = max(1, math.ceil(int(near.sum()) / _LINES))
        while math.gcd(every, width) > 1:  # or whole columns of an image would be left out
            every += 1
        some = np.flatnonzero(near)[::every]
        self._ranges = self._look(x[some], y[some], z[some])

    def sees_through(self, points: Floats, bottoms: Floats, tops: Floats) -> NDArray[np.bool_]:
        """Which things are not there, because the sensor looked at what is behind them.

        Parameters
        ----------
        points
            Where they were, (N, 2) in the robot's frame [m].
        bottoms, tops
            Which of their heights have been seen (N,), above the robot's origin [m].
        """
        away = points - np.array(self._eye[:2])
        distance = np.hypot(away[:, 0], away[:, 1])
        low = np.arctan2(bottoms - _BELOW - self._eye[2], distance)
        high = np.arctan2(tops - self._eye[2], distance)
        # Lines that are told apart from those that pass above or below: each was widened by one.
        first = np.ceil(_pitch(low)) + 1.0
        last = np.floor(_pitch(high)) - 2.0
        between = np.linspace(first, last, _SAMPLES, axis=1).round().astype(np.int64)
        between = between.clip(0, _PITCHES - 1)
        reach = self._ranges[_bearing(away[:, 0], away[:, 1])[:, None], between].max(axis=1)
        out: NDArray[np.bool_] = (first <= last) & (reach > distance + _BEHIND)
        return out

    def _look(self, x: Points3, y: Points3, z: Points3) -> NDArray[np.float32]:
        """How far lines of sight go over the floor, by bearing and pitch [m]; 0 where none looks.

        Of a bearing and both beside it the shortest, and only where all three look: what goes on
        beside the edge of a thing says nothing of it.
        """
        away_x, away_y = x - np.float32(self._eye[0]), y - np.float32(self._eye[1])
        distance = np.hypot(away_x, away_y)
        pitch = _pitch(np.arctan2(z - np.float32(self._eye[2]), distance)).astype(np.int64)
        at = _bearing(away_x, away_y) * _PITCHES + pitch.clip(0, _PITCHES - 1)
        nearest = np.full((_BEARINGS, _PITCHES), np.inf, dtype=np.float32)
        np.minimum.at(nearest.reshape(-1), at, distance)
        # Rows of an image do not keep their pitch across it: one more above and below.
        around = nearest.copy()
        np.minimum(around[:, 1:], nearest[:, :-1], out=around[:, 1:])
        np.minimum(around[:, :-1], nearest[:, 1:], out=around[:, :-1])
        beside = np.stack([np.roll(around, 1, axis=0), around, np.roll(around, -1, axis=0)])
        out: NDArray[np.float32] = beside.min(axis=0)
        out[np.isinf(beside).any(axis=0)] = 0.0
        return out


def _pitch(angle: Points3 | Floats) -> Points3 | Floats:
    """In bins from straight down to straight up."""
    return (angle / math.pi + 0.5) * _PITCHES


def _bearing(x: Points3 | Floats, y: Points3 | Floats) -> NDArray[np.int64]:
    turn: NDArray[np.int64] = ((np.arctan2(y, x) / math.tau + 0.5) * _BEARINGS).astype(np.int64)
    return np.minimum(turn, _BEARINGS - 1)


def _nearest(x: Points3, y: Points3, z: Points3) -> tuple[Floats, Floats, Floats]:
    """Of the points in a cell the nearest to the robot, and how low and high they reach."""
    side = math.ceil(2 * REACH / CELL)
    cell = ((y + REACH) / CELL).astype(np.int64) * side + ((x + REACH) / CELL).astype(np.int64)
    cell = np.minimum(cell, side * side - 1)
    away = x * x + y * y
    least = np.full(side * side, np.inf, dtype=np.float32)
    low, high = least.copy(), -least
    np.minimum.at(least, cell, away)
    np.minimum.at(low, cell, z)
    np.maximum.at(high, cell, z)
    kept = np.flatnonzero(away <= least[cell])
    # Several may be equally near.
    cells, first = np.unique(cell[kept], return_index=True)
    kept = kept[first]
    points = np.stack([x[kept], y[kept]], axis=1).astype(np.float64)
    return points, low[cells].astype(np.float64), high[cells].astype(np.float64)
