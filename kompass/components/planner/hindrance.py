"""What is in the robot's way, where, and since when: told to people when a goal is hindered.

No ROS and no clock: time is an argument [s].
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from kompass.algorithms.geometry import Floats, Pose2D, wrap_angle
from kompass.components.planner.live_map import LiveMap
from kompass.zones.in_force import ZonesInForce

Kind: TypeAlias = Literal["seen", "moving", "remembered", "map", "keep-out zone", "unknown"]

REACH = 3.0  # m from the robot that is looked at
BESIDE = 0.35  # m beside the body in which something may be in the way of it
OUT_OF_SIGHT = 2.0  # s without a ray, after which what was seen is only remembered
SAME = 0.5  # m between what was in the way before and what is now, for it to be the same
# By these the drive manager holds a robot back that has room: nothing near it is why.
NO_THINGS = frozenset(
    {"second publisher", "odometry stale", "place unknown", "scan stale", "steered wheels"}
)
MOVED = 0.4  # m from where something moved, for it to be what is in the way
_TOGETHER = 0.3  # m from what is in sight: rays do not come to every cell of a thing
_KEPT = 0.15  # m around what was told, within which it is the same
_NOISE = 0.1  # m by which something else must be nearer, to be told instead
_OF_THE_MAP = 0.15  # m from an obstacle of the map: what is seen there is that one
_WORDS = (
    (30.0, "ahead"),
    (75.0, "ahead to the {}"),
    (105.0, "to the {}"),
    (150.0, "behind to the {}"),
)


@dataclass(frozen=True)
class Hindrance:
    """Something in the way.

    Attributes
    ----------
    kind
        What it is known by.
    place
        Of its part that is in the way, (x, y) in the world; the robot's own for ``unknown`` [m].
    since
        When it was first found in the way [s].
    what
        In words; of an ``unknown`` one all that is to be said.
    shut_in
        Whether something stands on all sides of the robot.
    """

    kind: Kind
    place: tuple[float, float]
    since: float
    what: str
    shut_in: bool = False

    def distance(self, pose: Pose2D, radius: float) -> float:
        """From the body of a robot at ``pose``, with that radius [m]."""
        return max(0.0, math.dist(self.place, pose[:2]) - radius)

    def direction(self, pose: Pose2D) -> float:
        """From where the robot faces; left is positive [rad]."""
        dx, dy = self.place[0] - pose[0], self.place[1] - pose[1]
        return float(wrap_angle(math.atan2(dy, dx) - pose[2])) if dx or dy else 0.0

    def told(self, pose: Pose2D, radius: float, now: float) -> str:
        """A sentence for people: what, where, and since when."""
        if self.kind == "unknown":
            return self.what
        x, y = self.place
        where = direction_in_words(self.direction(pose))
        lasted = f", for {now - self.since:.0f} s" if now - self.since >= 1.0 else ""
        away = self.distance(pose, radius)
        told = f"In the way: {self.what} at ({x:z.2f}, {y:z.2f}), {away:.2f} m {where}{lasted}."
        return f"{told} Something stands on all sides of the robot." if self.shut_in else told


def direction_in_words(angle: float) -> str:
    """An angle from where the robot faces, left positive [rad], as people say it."""
    side = "left" if angle > 0 else "right"
    off = abs(math.degrees(angle))
    return next((word.format(side) for most, word in _WORDS if off <= most), "behind")


def find(
    live: LiveMap | None,
    zones: ZonesInForce,
    route: Floats,
    pose: Pose2D,
    radius: float,
    room: float,
    held_by: str,
    before: Hindrance | None,
    now: float,
) -> Hindrance:
    """What is in the way of a robot that does not get on.

    It is what the route comes too near to first, or the nearest beside the robot; with neither in
    reach, what the route comes too near to farther on.

    Parameters
    ----------
    live
        What was seen, and the map; None when nobody looks.
    zones
        In force.
    route
        Poses (N, ≥ 2) that the robot wants to go, from where it is; may be empty.
    pose, radius
        Of the robot [m, m, rad], [m].
    room
        That the route keeps from obstacles to the body [m].
    held_by
        By what the drive manager holds the robot back; empty when it does not.
    before
        What was in the way when it was last looked at.
    now
        [s]
    """
    found, shut_in = None, False
    if held_by not in NO_THINGS:
        around = list(_obstacles(live, zones, pose, now))
        shut_in = _is_shut_in([places for _, places, _ in around], pose, radius)
        found = _nearest(around, route, pose, radius, room, before)
        found = found or _farther_on(live, zones, route, pose, radius + room, now)
    if found is None:
        since = before.since if before is not None and before.kind == "unknown" else now
        return Hindrance("unknown", pose[:2], since, _of_nothing(live, pose, held_by))
    kind, place, age = found
    is_same = before is not None and math.dist(before.place, place) <= SAME
    if kind == "seen" and live is not None:
        came = [t for x, y, t in live.moved if math.dist((x, y), place) <= MOVED]
        if came or (is_same and before is not None and before.kind == "moving"):
            kind = "moving"
    if is_same and before is not None and before.kind == kind:
        since = before.since
    else:
        since = now - age if kind == "remembered" else now
    return Hindrance(kind, place, since, _in_words(kind, place, age, zones), shut_in)


def _in_words(kind: Kind, place: tuple[float, float], age: float, zones: ZonesInForce) -> str:
    match kind:
        case "moving":
            return "somebody, or something that moved"
        case "remembered":
            return f"what the lidar saw {age:.0f} s ago, and does not see from here,"
        case "map":
            return "an obstacle of the map"
        case "keep-out zone":
            zone = zones.barred(*place, SAME)
            return f"the keep-out zone {zone.name!r}" if zone else "a keep-out zone"
    return "something that the lidar sees"


def _of_nothing(live: LiveMap | None, pose: Pose2D, held_by: str) -> str:
    """Why a robot may stand in whose way nothing was found: first what holds it."""
    if held_by and held_by not in NO_THINGS:
        return f"The drive manager holds the robot back: {held_by}. What it is is not known yet."
    why = "Look at wheels and floor"
    if held_by:
        why = f"The drive manager holds the robot back: {held_by}"
    elif live is None:
        why = "The planner has no scan to look at"
    return f"{why}. Nothing is known to be in the way at ({pose[0]:z.2f}, {pose[1]:z.2f})."


_Places: TypeAlias = tuple[Kind, Floats, Floats]  # kind, places (N, 2), ages (N,)


def _obstacles(
    live: LiveMap | None, zones: ZonesInForce, pose: Pose2D, now: float
) -> Iterable[_Places]:
    edges = zones.in_the_way(pose[0], pose[1], REACH)
    yield "keep-out zone", edges, np.zeros(len(edges))
    if live is None or live.model.is_empty:
        return
    seen, ages, known = live.model.near(pose[:2], REACH, now)
    yield "map", known, np.zeros(len(known))
    apart = _apart(seen, known)
    seen, ages = seen[apart > _OF_THE_MAP], ages[apart > _OF_THE_MAP]
    old = ages > OUT_OF_SIGHT
    old &= _apart(seen, seen[~old]) > _TOGETHER
    yield "seen", seen[~old], ages[~old]
    yield "remembered", seen[old], ages[old]


def _apart(places: Floats, others: Floats) -> Floats:
    """From each place (N, 2) to the nearest of others (M, 2), (N,) [m]."""
    if not len(others):
        return np.full(len(places), math.inf)
    away: Floats = np.hypot(*(places[:, None] - others[None]).transpose(2, 0, 1)).min(axis=1)
    return away


def _farther_on(
    live: LiveMap | None,
    zones: ZonesInForce,
    route: Floats,
    pose: Pose2D,
    least: float,
    now: float,
) -> tuple[Kind, tuple[float, float], float] | None:
    """What the route comes nearer to than ``least`` first, out of the robot's reach."""
    way = np.asarray(route, dtype=np.float64)[:, :2] if len(route) else np.empty((0, 2))
    way = way[np.hypot(*(way - pose[:2]).T) > REACH]
    if not len(way):
        return None
    gone = np.concatenate([[0.0], np.hypot(*np.diff(way, axis=0).T).cumsum()])
    for first in np.arange(0.0, gone[-1] + REACH, REACH):
        part = way[(gone >= first) & (gone < first + REACH)]
        if not len(part):
            continue
        middle = part[len(part) // 2]
        met: list[tuple[int, Kind, tuple[float, float], float]] = []
        for kind, places, ages in _obstacles(live, zones, (*middle.tolist(), 0.0), now):
            if not len(places):
                continue
            away = np.hypot(*(places[:, None] - part[None]).transpose(2, 0, 1))
            too_near = (away < least).any(axis=0)
            if too_near.any():
                step = int(np.argmax(too_near))
                which = int(away[:, step].argmin())
                x, y = (float(value) for value in places[which])
                met.append((step, kind, (x, y), float(ages[which])))
        if met:
            _, kind, place, age = min(met)
            return kind, place, age
    return None


def _is_shut_in(obstacles: Sequence[Floats], pose: Pose2D, radius: float) -> bool:
    """Whether something is beside the robot ahead, behind, to the left and to the right."""
    away = np.concatenate([places - pose[:2] for places in obstacles]) if obstacles else None
    if away is None:
        return False
    beside = away[np.hypot(*away.T) < radius + BESIDE]
    turns = np.arctan2(beside[:, 1], beside[:, 0]) - pose[2]
    return len(np.unique(np.round(turns / (math.pi / 2)).astype(int) % 4)) == 4


def _nearest(
    obstacles: Iterable[_Places],
    route: Floats,
    pose: Pose2D,
    radius: float,
    room: float,
    before: Hindrance | None,
) -> tuple[Kind, tuple[float, float], float] | None:
    """The kind, the place, and the age of what the route meets first; None for nothing.

    Of what is beside the robot it stays with what was told before, unless something else is nearer
    by more than a scan's noise.
    """
    here = np.array(pose[:2])
    way = np.asarray(route, dtype=np.float64)[:, :2] if len(route) else np.empty((0, 2))
    way = way[np.hypot(*(way - here).T) <= REACH]
    ahead = way[len(way) // 2] - here if len(way) else np.zeros(2)
    met: list[tuple[float, float, Kind, tuple[float, float], float]] = []
    for kind, places, ages in obstacles:
        if not len(places):
            continue
        beside = np.hypot(*(places - here).T)
        away = np.hypot(*(places[:, None] - way[None]).transpose(2, 0, 1))  # (places, way)
        too_near = (away < radius + room).any(axis=0)
        if too_near.any():
            step = float(np.argmax(too_near))
            which = int(away[:, int(step)].argmin())
        else:
            # What the robot would not come nearer to does not hold it up.
            beside = np.where((places - here) @ ahead < 0.0, math.inf, beside)
            step, which = float(len(way)), int(beside.argmin())
            if before is not None:
                told = np.hypot(*(places - before.place).T) <= _KEPT
                told &= beside <= beside[which] + _NOISE
                which = int(np.where(told, beside, math.inf).argmin()) if told.any() else which
            if beside[which] >= radius + BESIDE:
                continue
        x, y = (float(value) for value in places[which])
        met.append((step, float(beside[which]), kind, (x, y), float(ages[which])))
    if not met:
        return None
    _, _, kind, place, age = min(met)
    return kind, place, age
