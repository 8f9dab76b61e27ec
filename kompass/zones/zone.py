"""A zone: a polygon on one map that the robot stays out of, or drives slower in."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import AfterValidator, Field, model_validator

from kompass.places.place import AuthorName, MapIdentity, Metres, PlaceName
from kompass.rules.schema.model import Model

MOST_ZONES = 100  # of a robot, on all of its maps
MOST_CORNERS = 60
SMALLEST = 0.01  # m²
LONGEST_OUTLINE = 2000.0  # m
SLOWEST, FASTEST = 0.05, 10.0  # m/s, what may be a limit
_TOGETHER = 1e-3  # m under which two corners are one

Corner: TypeAlias = tuple[Metres, Metres]


def _corners(corners: tuple[Corner, ...]) -> tuple[Corner, ...]:
    closed = [*corners, corners[0]]
    for one, other in pairwise(closed):
        if math.dist(one, other) < _TOGETHER:
            raise ValueError(f"the corner {_told(one)} is there twice; leave one of them out")
    edges = list(pairwise(closed))
    for n, first in enumerate(edges):
        for m in range(n + 2, len(edges)):
            if (n, m) != (0, len(edges) - 1) and _cross(first, edges[m]):
                raise ValueError(
                    f"the edge from {_told(first[0])} crosses the one from {_told(edges[m][0])}; "
                    "set the corners in the order of the outline"
                )
    length = sum(math.dist(one, other) for one, other in edges)
    if length > LONGEST_OUTLINE:
        raise ValueError(
            f"its outline is {length:.0f} m long; make it of several zones with at most "
            f"{LONGEST_OUTLINE:.0f} m each"
        )
    if abs(area(corners)) < SMALLEST:
        raise ValueError(f"it has less than {SMALLEST} m²; set the corners further apart")
    return corners


def area(corners: tuple[Corner, ...]) -> float:
    """Of a polygon (m²), by the shoelace formula; negative when its corners run clockwise."""
    closed = [*corners, corners[0]]
    return sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairwise(closed)) / 2.0


def _cross(one: tuple[Corner, Corner], other: tuple[Corner, Corner]) -> bool:
    """Whether two edges have a point in common."""
    (a, b), (c, d) = one, other
    sides = _side(a, b, c), _side(a, b, d), _side(c, d, a), _side(c, d, b)
    if sides[0] * sides[1] < 0 and sides[2] * sides[3] < 0:
        return True
    on = ((a, b, c), (a, b, d), (c, d, a), (c, d, b))
    return any(side == 0 and _between(*each) for side, each in zip(sides, on, strict=True))


def _side(a: Corner, b: Corner, c: Corner) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _between(a: Corner, b: Corner, c: Corner) -> bool:
    """Whether c, which is on the line through a and b, is between them."""
    return min(a[0], b[0]) <= c[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= c[1] <= max(a[1], b[1])


def _told(corner: Corner) -> str:
    return f"({corner[0]:z.2f}, {corner[1]:z.2f})"


class ZonePlan(Model):
    """What people decide of a zone.

    Attributes
    ----------
    kind
        ``keep_out``: no part of the robot enters it. ``speed``: while a part of it is inside, it
        is no faster than ``speed``.
    speed
        Of a speed zone (m/s).
    corners
        Of the polygon, in the map's frame (m), in the order of its outline, either way round.
    map
        On which it is.
    """

    name: PlaceName
    kind: Literal["keep_out", "speed"]
    speed: Annotated[float, Field(ge=SLOWEST, le=FASTEST)] | None = None
    corners: Annotated[
        tuple[Corner, ...], Field(min_length=3, max_length=MOST_CORNERS), AfterValidator(_corners)
    ]
    map: MapIdentity

    @model_validator(mode="after")
    def _has_its_speed(self) -> Self:
        if self.kind == "speed" and self.speed is None:
            raise ValueError("a speed zone has no speed; say how fast the robot may be in it")
        if self.kind == "keep_out" and self.speed is not None:
            raise ValueError("a keep-out zone has a speed; leave it out, or make it a speed zone")
        return self


class Zone(ZonePlan):
    """A zone as it is kept.

    Attributes
    ----------
    id
        Never given to another zone.
    version
        Counts its changes, from 1.
    author, role
        Who changed it last.
    time
        When that was (s since the epoch).
    """

    id: Annotated[int, Field(ge=1)]
    version: Annotated[int, Field(ge=1)]
    author: AuthorName
    role: Literal["operator", "engineer"]
    time: float


class ZoneBook(Model):
    """All zones of a robot.

    Attributes
    ----------
    revision
        Counts the changes of all of them.
    problem
        Why zones cannot be kept, or what was lost; empty when all is well.
    available
        Whether they are kept at all.
    """

    revision: Annotated[int, Field(ge=0)] = 0
    problem: str = ""
    available: bool = True
    zones: Annotated[tuple[Zone, ...], Field(max_length=MOST_ZONES)] = ()


class ZonesNow(Model):
    """The zones of the map that the robot has now: those that count.

    Attributes
    ----------
    revision
        Of the book that they are from.
    """

    revision: Annotated[int, Field(ge=0)] = 0
    zones: Annotated[tuple[Zone, ...], Field(max_length=MOST_ZONES)] = ()
