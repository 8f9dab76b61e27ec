"""Where along a path the robot is, by arc length.

The nearest place on the path is looked for only a short way ahead of the last one, so a path may
cross itself, come back beside itself or end where it began: nothing but driving along it brings
the robot to its end.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from kompass.algorithms.geometry import Floats, wrap_angle

# How far ahead of the last place the next one is looked for [m].
_WINDOW = 0.5
# Among places this much farther than the nearest one, the first along the path is where a robot
# that joins it starts [m].
_JOIN_TOLERANCE = 0.1
# A place farther along must be nearer by this share of the arc between, or the path is not
# skipped: it settles the tie between the two legs of a hairpin.
_SKIP_COST = 0.02
# Half the arc over which the change of heading is taken as curvature [m].
_CURVATURE_ARC = 0.1


class PathTracker:
    """Progress along a path.

    Parameters
    ----------
    poses
        (N, ≥ 2), N ≥ 1: x, y and optionally yaw; the last yaw is the goal's heading.

    Raises
    ------
    ValueError
        No poses, or one that is not finite.
    """

    def __init__(self, poses: ArrayLike) -> None:
        given = np.atleast_2d(np.asarray(poses, dtype=np.float64))
        if given.size == 0 or given.shape[1] < 2:
            raise ValueError(f"poses: shape {given.shape}; give at least one (x, y, yaw)")
        if not np.isfinite(given).all():
            row = int(np.argmin(np.isfinite(given).all(axis=1)))
            raise ValueError(f"poses: row {row} is {given[row].tolist()}; give finite numbers")
        steps = np.hypot(*np.diff(given[:, :2], axis=0).T)
        keep = np.concatenate([[True], steps > 1e-6])
        keep[0] = True
        points = given[keep, :2]
        self._points: Floats = points
        delta = np.diff(points, axis=0)
        lengths = np.hypot(delta[:, 0], delta[:, 1])
        self._along: Floats = np.concatenate([[0.0], np.cumsum(lengths)])
        self.length = float(self._along[-1])
        self.goal: tuple[float, float] = (float(given[-1, 0]), float(given[-1, 1]))
        heading = np.arctan2(delta[:, 1], delta[:, 0])
        if not len(heading):
            heading = given[-1:, 2] if given.shape[1] > 2 else np.zeros(1)
        self._headings: Floats = np.unwrap(heading)
        self._middles: Floats = (
            (self._along[:-1] + self._along[1:]) / 2.0 if len(points) > 1 else np.zeros(1)
        )
        self.end_heading = float(wrap_angle(float(self._headings[-1])))
        self.goal_yaw = float(given[-1, 2]) if given.shape[1] > 2 else self.end_heading
        self.progress = 0.0
        self._joined = False

    @property
    def remaining(self) -> float:
        """Arc length that lies ahead [m]."""
        return self.length - self.progress

    def advance(self, x: float, y: float) -> float:
        """The arc length [m] of the robot's place on the path; never less than before.

        The first call joins the path where it first comes (almost) nearest to the robot.
        """
        if not self._joined:
            _, distance = self._project(x, y, 0.0, self.length)
            if distance.size:
                near = distance <= float(distance.min()) + _JOIN_TOLERANCE
                self.progress = float(self._along[int(np.argmax(near))])
            self._joined = True
        ahead = min(self.progress + _WINDOW, self.length)
        places, distance = self._project(x, y, self.progress, ahead)
        if places.size:
            cost = distance + _SKIP_COST * (places - self.progress)
            self.progress = max(self.progress, float(places[int(np.argmin(cost))]))
        return self.progress

    def point_at(self, s: float) -> tuple[float, float]:
        """The place (x, y) at arc length ``s``; beyond the end, straight on."""
        if s > self.length:
            over = s - self.length
            x, y = self.goal
            return (x + over * math.cos(self.end_heading), y + over * math.sin(self.end_heading))
        return (
            float(np.interp(s, self._along, self._points[:, 0])),
            float(np.interp(s, self._along, self._points[:, 1])),
        )

    def points_at(self, s: Floats) -> Floats:
        """The places (N, 2) at arc lengths ``s`` (N,); as :meth:`point_at`."""
        over = np.maximum(s - self.length, 0.0)
        out = np.empty((len(s), 2))
        out[:, 0] = np.interp(s, self._along, self._points[:, 0])
        out[:, 1] = np.interp(s, self._along, self._points[:, 1])
        out[:, 0] += over * math.cos(self.end_heading)
        out[:, 1] += over * math.sin(self.end_heading)
        return out

    def heading_at(self, s: float) -> float:
        """The path's direction at arc length ``s`` [rad], turning gradually between its legs."""
        return float(wrap_angle(float(np.interp(s, self._middles, self._headings))))

    def headings_at(self, s: Floats) -> Floats:
        """The directions (N,) at arc lengths ``s`` (N,); as :meth:`heading_at`."""
        return wrap_angle(np.interp(s, self._middles, self._headings))

    def curvature_at(self, s: float) -> float:
        """The path's curvature about arc length ``s`` [1/m], positive to the left."""
        arc = min(_CURVATURE_ARC, self.length / 2.0)
        if arc < 1e-6:
            return 0.0
        # At its ends, where there are no two sides, that of the nearest place that has them.
        middle = min(max(s, arc), self.length - arc)
        low, high = np.interp((middle - arc, middle + arc), self._middles, self._headings)
        first, last = float(self._middles[0]), float(self._middles[-1])
        apart = min(middle + arc, last) - max(middle - arc, first)
        return float(high - low) / apart if apart > 1e-6 else 0.0

    def sharpest(self, start: float, end: float) -> float:
        """The largest |curvature| [1/m] between two arc lengths."""
        at = np.linspace(start, end, 8)
        behind = np.interp(at - _CURVATURE_ARC, self._middles, self._headings)
        before = np.interp(at + _CURVATURE_ARC, self._middles, self._headings)
        return float(np.abs(before - behind).max()) / (2.0 * _CURVATURE_ARC)

    def cross_track(self, x: float, y: float) -> float:
        """Distance from the path at the present progress, positive left of it [m]."""
        px, py = self.point_at(self.progress)
        heading = self.heading_at(self.progress)
        return math.cos(heading) * (y - py) - math.sin(heading) * (x - px)

    def _project(self, x: float, y: float, start: float, end: float) -> tuple[Floats, Floats]:
        """Nearest arc length and its distance, per leg of the path between two arc lengths."""
        along, points = self._along, self._points
        first = max(0, int(np.searchsorted(along, start, side="right")) - 1)
        last = min(len(along) - 1, int(np.searchsorted(along, end, side="left")))
        if last <= first:
            return np.empty(0), np.empty(0)
        a = points[first:last]
        legs = along[first + 1 : last + 1] - along[first:last]
        unit = (points[first + 1 : last + 1] - a) / legs[:, None]
        dx, dy = x - a[:, 0], y - a[:, 1]
        t = dx * unit[:, 0] + dy * unit[:, 1]
        low = np.maximum(start - along[first:last], 0.0)
        high = np.minimum(end - along[first:last], legs)
        t = np.clip(t, low, high)
        return along[first:last] + t, np.hypot(dx - t * unit[:, 0], dy - t * unit[:, 1])
