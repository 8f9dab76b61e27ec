"""Who walks about: what has come into free space between two scans, and where it will be.

A scan's points are taken together where they lie side by side; what is no larger than a person is
followed from scan to scan by a filter of position and velocity (alpha-beta). It counts as moving
only when it stands where the sensor looked through a moment before: the visible part of a wall
wanders, too, when something else hides the rest of it, but not into free space.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.geometry import Floats, Pose2D, transform_points, wrap_angle
from kompass.algorithms.mapping.scan_points import read_rays

PREDICTED = 1.0  # s for which somebody is thought to go straight on; then to stand
LARGEST = 1.0  # m across; what is larger is a wall
SLOWEST, FASTEST = 0.15, 3.0  # m/s of what counts as walking about
_GAP = 0.2  # m between neighbouring points of two things
_LEAST_POINTS = 3
_BEFORE = (0.2, 0.7)  # s, the age of the scan in which its place was free
_BEHIND = 0.1  # m by which that scan must have looked through
_SHARE = 0.25  # of its points
_NEAR = 0.5  # m between where it should be and where it is
_POSITION, _VELOCITY = 0.6, 0.35  # shares of what the filter was off
_TRAVELLED = 0.15  # m from where it was seen first
_BELIEVED, _REMEMBERED = 0.6, 0.5  # s since it came into free space, and since it was seen
_THIN = 0.12  # m: radius of what shows less


@dataclass
class _Track:
    place: Floats
    velocity: Floats
    radius: float
    begin: Floats
    seen: float
    hits: int = 1
    came: float = -math.inf  # last into free space

    def moves(self) -> bool:
        return (
            self.hits >= 3
            and self.seen - self.came <= _BELIEVED
            and SLOWEST <= math.hypot(*self.velocity) <= FASTEST
            and math.hypot(*(self.place - self.begin)) >= _TRAVELLED
        )


@dataclass(frozen=True)
class _Scan:
    made: float
    pose: Pose2D
    first: float
    increment: float
    free_to: Floats

    @property
    def is_whole_turn(self) -> bool:
        """Whether the last ray and the first one lie side by side."""
        step = abs(self.increment)
        return self.free_to.size * step > math.tau - step

    def saw_through(self, points: Floats) -> NDArray[np.bool_]:
        """Whether rays went on behind points (N, 2) in the world."""
        away = points - np.array(self.pose[:2])
        bearing = np.arctan2(away[:, 1], away[:, 0]) - self.pose[2] - self.first
        step = abs(self.increment)
        ray = np.mod(bearing * math.copysign(1.0, self.increment) + step / 2, math.tau) / step
        index, count = ray.astype(np.int64), self.free_to.size
        if self.is_whole_turn:
            known = np.ones(len(points), dtype=bool)
            index %= count
        else:
            known = (index >= 1) & (index < count - 1)
            index = np.where(known, index, 1)
        beside = np.minimum(self.free_to[index - 1], self.free_to[(index + 1) % count])
        least = np.minimum(beside, self.free_to[index])
        out: NDArray[np.bool_] = known & (np.hypot(*away.T) < least - _BEHIND)
        return out


class MovingObstacles:
    """Follows what moves; the world's frame throughout, and time is an argument [s]."""

    def __init__(self) -> None:
        self._tracks: list[_Track] = []
        self._scans: deque[_Scan] = deque(maxlen=32)

    def see(
        self,
        ranges: ArrayLike,
        angle_min: float,
        angle_increment: float,
        range_min: float,
        range_max: float,
        sensor_pose: Pose2D,
        made: float,
    ) -> None:
        """Take a scan in; one that is not newer than the last is left out.

        Parameters
        ----------
        ranges
            (N,) [m], ray i at ``angle_min + i * angle_increment`` in the sensor's frame. +inf and
            what is not below the maximum is free; NaN, 0 and what is too near say nothing.
        angle_min, angle_increment
            [rad]
        range_min, range_max
            Between them the sensor measures [m].
        sensor_pose
            (x, y, yaw), when it was measured.
        made
            When that was [s].
        """
        measured = np.asarray(ranges, dtype=np.float64).ravel()
        if measured.size < _LEAST_POINTS or angle_increment == 0:
            return
        if self._scans and made <= self._scans[-1].made:
            return
        rays = read_rays(measured, angle_min, angle_increment, range_min, range_max, sensor_pose)
        before = self._before(made)
        seen = _Scan(made, sensor_pose, angle_min, angle_increment, rays.free_to)
        self._scans.append(seen)
        none = np.zeros(len(rays.ends), bool)
        came = none if before is None else before.saw_through(rays.ends)
        things = _things(rays.ends, rays.ranges, abs(angle_increment), came, seen.is_whole_turn)
        self._follow(things, made)

    def at(self, now: float) -> Floats:
        """What moves, (M, 5): x, y [m], velocity in x and y [m/s], radius [m]."""
        rows = [
            (*(each.place + each.velocity * (now - each.seen)), *each.velocity, each.radius)
            for each in self._tracks
            if each.moves() and now - each.seen <= _REMEMBERED
        ]
        return np.array(rows, dtype=np.float64).reshape(-1, 5)

    def _before(self, now: float) -> _Scan | None:
        """The scan that is nearest to half a second old, of those that are neither new nor old."""
        young, old = _BEFORE
        fit = [each for each in self._scans if young <= now - each.made <= old]
        return min(fit, key=lambda each: abs(now - each.made - 0.4)) if fit else None

    def _follow(self, things: list[tuple[Floats, float, bool]], now: float) -> None:
        tracks = [each for each in self._tracks if now - each.seen <= _REMEMBERED]
        pairs = sorted(
            (
                float(np.hypot(*(each.place + each.velocity * (now - each.seen) - place))),
                one,
                other,
            )
            for one, each in enumerate(tracks)
            for other, (place, _, _) in enumerate(things)
        )
        followed: set[int] = set()
        taken: set[int] = set()
        for away, one, other in pairs:
            if away > _NEAR or one in followed or other in taken:
                continue
            followed.add(one)
            taken.add(other)
            track, (place, radius, came) = tracks[one], things[other]
            dt = now - track.seen
            expected = track.place + track.velocity * dt
            off = place - expected
            track.place = expected + _POSITION * off
            track.velocity = track.velocity + _VELOCITY * off / dt
            track.radius += 0.5 * (radius - track.radius)
            track.seen = now
            track.hits += 1
            if came:
                track.came = now
        for other, (place, radius, came) in enumerate(things):
            if other not in taken:
                track = _Track(place, np.zeros(2), radius, place, now)
                track.came = now if came else -math.inf
                tracks.append(track)
        self._tracks = tracks


def _things(
    points: Floats, ranges: Floats, increment: float, came: NDArray[np.bool_], whole_turn: bool
) -> list[tuple[Floats, float, bool]]:
    """Middle, radius, and whether it stands where was free: of all that is small enough."""
    if len(points) < _LEAST_POINTS:
        return []
    apart = np.hypot(*np.diff(points, axis=0).T) > _GAP + 2.0 * increment * ranges[:-1]
    parts = np.split(np.arange(len(points)), np.flatnonzero(apart) + 1)
    # Who is where a turn begins is in its first rays and its last ones: right ahead of many robots.
    across_seam = math.dist(points[-1], points[0])
    if whole_turn and len(parts) > 1 and across_seam <= _GAP + 2.0 * increment * ranges[-1]:
        parts[0] = np.concatenate([parts.pop(), parts[0]])
    out = []
    for part in parts:
        if len(part) < _LEAST_POINTS:
            continue
        low, high = points[part].min(axis=0), points[part].max(axis=0)
        across = float(np.hypot(*(high - low)))
        if across <= LARGEST:
            radius = max(across / 2.0, _THIN)
            out.append(((low + high) / 2.0, radius, bool(came[part].mean() >= _SHARE)))
    return out


def predicted(movers: Floats, times: Floats) -> tuple[Floats, Floats]:
    """Where they will be: x and y, (M, T) each [m], of movers (M, 5) after ``times`` (T,) [s]."""
    ahead = np.minimum(times, PREDICTED)[None, :]
    x = movers[:, 0, None] + movers[:, 2, None] * ahead
    y = movers[:, 1, None] + movers[:, 3, None] * ahead
    return x, y


def seen_from(pose: Pose2D, movers: Floats) -> Floats:
    """Movers (M, 5) in the world's frame, in that of a robot at ``pose``."""
    x, y, yaw = pose
    out = movers.copy()
    turn = (0.0, 0.0, float(wrap_angle(-yaw)))
    out[:, :2] = transform_points(turn, movers[:, :2] - (x, y))
    out[:, 2:4] = transform_points(turn, movers[:, 2:4])
    return out
