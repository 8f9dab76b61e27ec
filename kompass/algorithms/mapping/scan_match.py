"""How well a scan fits a map that was made before: is the robot where it thinks it is?

A likelihood field (Thrun, Burgard and Fox, "Probabilistic Robotics", section 6.4): a ray that ends
near something of the map is likely, one that ends in the open is not. Unlike there, a ray that has
gone through a wall of the map is worth nothing wherever it ends, or a robot that is lost would be
praised for walls that it cannot see. The best pose nearby is found by trying all of them (Olson,
"Real-Time Correlative Scan Matching", ICRA 2009).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.distance_field import DistanceField
from kompass.algorithms.geometry import Floats, Pose2D, transform_points, wrap_angle
from kompass.algorithms.grid import Grid

DEVIATION = 0.1  # m; of a ray's end from what the map shows, when all is well
FEWEST_RAYS = 20  # fewer say nothing
MOST_RAYS = 360  # more say no more
REACH = 0.5  # m; how far off a place may be that a person has pointed at
TURN = np.radians(20.0)  # and its heading, rad

_NEAR = 0.2  # m; so near to itself a robot sees nothing, whatever the map says of that place
_BEFORE_END = 3.0 * DEVIATION  # a wall so near to a ray's end may be where it has ended, m
_ALL_OF_IT = 1.0 + 1e-6  # of the square of a reach; sums of steps are not exact
_MATTERS = 10.0 * DEVIATION  # m; what is further from a ray's end makes no difference
_PLACES = 2  # whose surroundings are kept: where a robot believes to be, and where a hand puts it
_SPARE = 5.0  # m that the robot may go until more of the map is read
_THROUGH = 0.2  # cells; a ray that passes a cell so closely goes through it


class _Search(NamedTuple):
    """Poses that are tried: so many steps either way, each so long [m] and so far round [rad].

    For how many rays, how near [m] to a wall they have to end, and how much better a place at the
    end of the reach must fit to be preferred.
    """

    reaches: int
    step: float
    turn: float
    rays: int
    deviation: float
    leash: float


_SEARCHES = (
    _Search(10, 0.05, np.radians(2.0), 120, DEVIATION, 0.03),
    _Search(5, 0.01, np.radians(0.4), MOST_RAYS, 0.04, 0.003),
)


class ScanMatcher:
    """Compares scans with one map, of which it reads what lies around the sensor.

    Any thread may compare.

    Parameters
    ----------
    grid
        The map. Its unknown cells say nothing, and neither does what lies outside of it.
    """

    def __init__(self, grid: Grid) -> None:
        self._grid = grid
        self._read: tuple[_Surroundings, ...] = ()  # the one that was used last comes first

    def agreement(self, points: ArrayLike, sensor: Pose2D) -> float | None:
        """Share of a scan that the map explains, from 0 to 1; None where too little is known.

        Parameters
        ----------
        points
            (N, 2), where the rays met something, in the sensor's frame [m].
        sensor
            (x, y, yaw) of the sensor in the map, when it was measured.
        """
        some = _some(points, MOST_RAYS)
        return self._around(sensor, _length(some)).agreement(some, sensor)

    def fit(self, points: ArrayLike, sensor: Pose2D, robot: Pose2D = (0.0, 0.0, 0.0)) -> Pose2D:
        """The pose within ``REACH`` and ``TURN`` of a pose from which a scan fits best.

        Of poses that fit as well, as along a corridor, the nearest one; none with the robot in an
        obstacle of the map.

        Parameters
        ----------
        points
            As for :meth:`agreement`.
        sensor
            Where to look around.
        robot
            (x, y, yaw) in the sensor's frame.
        """
        some = _some(points, MOST_RAYS)
        reach = max(_length(some), float(np.hypot(*robot[:2]))) + REACH
        return self._around(sensor, reach).fit(some, sensor, robot)

    def _around(self, sensor: Pose2D, reach: float) -> _Surroundings:
        """What holds everything within a reach [m] of the sensor that makes a difference."""
        needed, read = reach + _MATTERS, self._read
        found = next((one for one in read if one.holds(sensor, needed)), None)
        near = found or _Surroundings(self._grid, sensor, needed + _SPARE)
        self._read = (near, *(one for one in read if one is not near))[:_PLACES]
        return near


class _Surroundings:
    """The part of a map around a place (x, y, yaw), as far as a radius [m], to compare with."""

    def __init__(self, whole: Grid, place: Pose2D, radius: float) -> None:
        self._place, self._radius = place, radius
        self._grid = grid = whole.around(place[:2], radius)
        self._field = DistanceField(grid, unknown_is_obstacle=False)
        self._unknown = grid.cells < 0
        self._occupied = grid.occupied()
        self._size = np.array([grid.width, grid.height]) * grid.resolution

    def holds(self, place: Pose2D, radius: float) -> bool:
        """Whether all is in it that lies so near to a place."""
        return math.dist(place[:2], self._place[:2]) + radius <= self._radius

    def agreement(self, points: Floats, sensor: Pose2D) -> float | None:
        """See :meth:`ScanMatcher.agreement`."""
        ends = transform_points(sensor, points)
        known = self._known(ends)
        through = self._goes_through_walls(ends, sensor)
        judged = known | through
        if judged.sum() < FEWEST_RAYS:
            return None
        likely = self._likelihood(ends) * (known & ~through)
        return float(likely.sum() / judged.sum())

    def fit(self, points: Floats, sensor: Pose2D, robot: Pose2D) -> Pose2D:
        """See :meth:`ScanMatcher.fit`."""
        best, given = sensor, np.array(sensor)
        for search in _SEARCHES:
            some = _some(points, search.rays)
            if not len(some):
                return sensor
            offsets = np.arange(-search.reaches, search.reaches + 1)
            shifts = np.stack(np.meshgrid(offsets, offsets), axis=-1).reshape(-1, 2) * search.step
            places = shifts + best[:2]
            away = np.sum((places - given[:2]) ** 2, axis=1) / REACH**2
            found, most = best, -np.inf
            for yaw in (best[2] + offsets * search.turn).tolist():
                turned = (wrap_angle(yaw - given[2]) / TURN) ** 2
                stands = transform_points((0.0, 0.0, yaw), [robot[:2]]) + places
                allowed = (away <= _ALL_OF_IT) & ~self._in_obstacle(stands)
                if turned > _ALL_OF_IT or not allowed.any():
                    continue
                ends = transform_points((0.0, 0.0, yaw), some)
                fits = self._fits(ends, places, search.deviation) - search.leash * (away + turned)
                fits[~allowed] = -np.inf
                index = int(fits.argmax())
                if fits[index] > most:
                    most = float(fits[index])
                    x, y = places[index].tolist()
                    found = (x, y, wrap_angle(yaw))
            best = found
        return best

    def _fits(self, ends: Floats, places: Floats, deviation: float) -> Floats:
        """How well ends (N, 2) of rays fit the map from each of so many places (M, 2); (M,)."""
        lattice, step = self._field.lattice, self._grid.resolution / 2.0
        at = self._grid.to_grid_frame(places)[:, None]
        away = transform_points((0.0, 0.0, -self._grid.origin[2]), ends)[None]
        cells = np.rint((at + away) / step).astype(np.int64)
        col, row = cells[..., 0], cells[..., 1]
        inside = (col >= 0) & (row >= 0) & (col < lattice.shape[1]) & (row < lattice.shape[0])
        distance = lattice[row * inside, col * inside]
        likely = np.exp(-0.5 * (distance / deviation) ** 2) * inside
        fits: Floats = likely.mean(axis=1)
        return fits

    def _in_obstacle(self, places: Floats) -> NDArray[np.bool_]:
        """Which of places (M, 2) lie in an occupied cell; (M,)."""
        col, row = self._grid.world_to_cell(places).T
        inside = self._grid.contains(places)
        occupied: NDArray[np.bool_] = inside & self._occupied[row * inside, col * inside]
        return occupied

    def _likelihood(self, ends: Floats) -> Floats:
        likely: Floats = np.exp(-0.5 * (self._field.at(ends) / DEVIATION) ** 2)
        return likely

    def _known(self, ends: Floats) -> NDArray[np.bool_]:
        """Which points lie in cells of which the map says something."""
        col, row = self._grid.world_to_cell(ends).T
        height, width = self._unknown.shape
        inside = (col >= 0) & (row >= 0) & (col < width) & (row < height)
        known = inside & ~self._unknown[row * inside, col * inside]
        # A wall is as thick as its cells, and all around may be unknown: a ray may end behind it.
        near = inside & (self._field.at(ends) < DEVIATION)
        either: NDArray[np.bool_] = known | near
        return either

    def _goes_through_walls(self, ends: Floats, sensor: Pose2D) -> NDArray[np.bool_]:
        start = np.array(sensor[:2])
        way = ends - start
        length = np.hypot(way[:, 0], way[:, 1])
        direction = way / np.maximum(length, 1e-9)[:, None]
        last = np.minimum(length - _BEFORE_END, self._border(start, direction))
        far = last > _NEAR
        through = np.zeros(len(ends), dtype=bool)
        ahead = direction[far]
        through[far] = ~self._field.segments_clear(
            start + _NEAR * ahead,
            start + last[far, None] * ahead,
            _THROUGH * self._grid.resolution,
        )
        return through

    def _border(self, start: Floats, direction: Floats) -> Floats:
        """How far it is to the map's border (N,) along unit vectors (N, 2); 0 from outside [m]."""
        origin = self._grid.to_grid_frame(start)[0]
        if ((origin <= 0.0) | (origin >= self._size)).any():
            return np.zeros(len(direction))
        turned = transform_points((0.0, 0.0, -self._grid.origin[2]), direction)
        room = np.where(turned > 0.0, self._size - origin, -origin)
        with np.errstate(divide="ignore", invalid="ignore"):
            along = np.where(turned == 0.0, np.inf, room / turned)
        # A millimetre inside: outside the map its field says that all is an obstacle.
        border: Floats = along.min(axis=1) - 1e-3
        return border


def _length(points: Floats) -> float:
    """Of the longest ray [m]."""
    return float(np.hypot(points[:, 0], points[:, 1]).max(initial=0.0))


def _some(points: ArrayLike, most: int) -> Floats:
    """At most so many of points (N, 2), evenly from all of them."""
    all_of_them = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    step = -(-len(all_of_them) // most)
    return all_of_them[::step] if step > 1 else all_of_them
