"""What a page is told that draws the map flat, by itself: see `/api/map/live`."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, Field


class FlatMapInfo(BaseModel):
    """The map, whose picture is at `/api/map/{version}`, north up and a pixel for each cell.

    `x`, `y`, `yaw` (m, rad) place its lower left corner in the map frame; `resolution` is m per
    pixel, and `bounds` (x0, y0, x1, y1) hold what is known.
    """

    version: int
    x: float
    y: float
    yaw: float
    resolution: float
    width: int
    height: int
    bounds: tuple[float, float, float, float]


class FlatAreas(BaseModel):
    """What the robot sees around it: areas of (x0, y0, x1, y1), in m of a grid that lies at `x`,
    `y`, `yaw` of the map frame; one after the other in `areas`."""

    x: float
    y: float
    yaw: float
    areas: list[float]


class FlatGoal(BaseModel):
    """Where the robot is sent, m and rad."""

    x: float
    y: float
    yaw: float | None


class FlatPoint(BaseModel):
    """A place, m."""

    x: float
    y: float


class FlatText(BaseModel):
    """A text at a place, m."""

    x: float
    y: float
    text: str


class FlatExtra(BaseModel):
    """What is drawn of a further topic, in m of the map frame: points of x, y; lines of x0, y0, x1,
    y1; areas of four corners each; and texts."""

    points: list[float]
    lines: list[float]
    areas: list[float]
    texts: list[FlatText]


class FlatNews(BaseModel):
    """What has changed since the last message: what is left out is as it was, null is not there.

    `extras` are by topic, and only those that have changed. Points are x, y, x, y, … in m of the
    map frame; `footprint` is in the robot's own.
    """

    type: Literal["map"] = "map"
    map: FlatMapInfo | None = None
    local_map: FlatAreas | None = None
    path: list[float] | None = None
    scan: list[float] | None = None
    trail: list[float] | None = None
    footprint: list[float] | None = None
    goal: FlatGoal | None = None
    hindrance: FlatPoint | None = None
    extras: dict[str, FlatExtra | None] = Field(default_factory=dict)
