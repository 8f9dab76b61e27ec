"""The contract of zones: polygons on the robot's maps that it stays out of, or is slower in."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, Field

from kompass.places.change import Version
from kompass.places.place import LONGEST_NAME, MapIdentity, Metres
from kompass.zones.change import ZoneId
from kompass.zones.zone import MOST_CORNERS
from kompass_console.schema.models import In, OnPicture

# What is too long, or crosses itself, is told by the zone itself, in a sentence.
AnyName = Annotated[str, Field(max_length=10 * LONGEST_NAME)]
_Corner = Annotated[tuple[Metres, Metres], Field(strict=False)]  # a list in JSON
AnyCorners = Annotated[list[_Corner], Field(max_length=MOST_CORNERS + 1)]
Kind = Literal["keep_out", "speed"]


class ZoneSave(In):
    """A zone of the map that the robot has now; `speed` (m/s) only of a speed zone."""

    name: AnyName
    kind: Kind
    speed: float | None = None
    corners: AnyCorners


class ZoneEdit(ZoneSave):
    """A zone as it is to be from now on. `version` is of the one that was looked at."""

    version: Version


class ZoneInfo(BaseModel):
    """A zone. `here` says whether it is on the map that the robot has now, and so in force."""

    id: ZoneId
    version: Version
    name: str
    kind: Kind
    speed: float | None
    corners: list[tuple[float, float]]
    map: MapIdentity
    here: bool
    author: str
    time: float


class MaskInfo(BaseModel):
    """A patch of a mask of the recipe, to be drawn; `speed` (m/s) only of one of speeds."""

    name: str
    kind: Kind
    speed: float | None
    corners: list[tuple[float, float]]


class ZoneList(BaseModel):
    """All zones, in the order in which they were saved, and the recipe's masks, which stay.

    `problem` says why none can be kept, or what was lost; empty when all is well. `most` is how
    many a robot keeps.
    """

    available: bool
    revision: int
    problem: str
    map: MapIdentity | None
    most: int
    zones: list[ZoneInfo]
    masks: list[MaskInfo]


class ZoneSketch(In):
    """A zone that is being drawn, with what the hand has done last: `start` and `end` are fractions
    of the picture of `view`. A press adds a corner; a drag, where there is none yet, a rectangle.
    """

    view: Annotated[str, Field(max_length=64)] | None = None
    corners: AnyCorners
    start: OnPicture | None = None
    end: OnPicture | None = None


class ZoneDrawn(BaseModel):
    """The corners with those that were added. `problem` says why they make no zone yet; empty when
    they do. What would be in it: the robot, and places of the map by their names."""

    corners: list[tuple[float, float]]
    problem: str
    robot_inside: bool
    places_inside: list[str]
