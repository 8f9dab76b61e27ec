"""The contract of places: named poses on the robot's maps."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import BaseModel, Field, model_validator

from kompass.places.change import PlaceId, Version
from kompass.places.place import LONGEST_NAME, LONGEST_NOTE, MapIdentity, PlacePose
from kompass_console.schema.models import In

# What is too long, or cannot be seen, is told by the place itself, in a sentence.
AnyName = Annotated[str, Field(max_length=10 * LONGEST_NAME)]
AnyNote = Annotated[str, Field(max_length=10 * LONGEST_NOTE)]


class PlaceSave(In):
    """A new place on the map that the robot has now. Without `pose` it is where the robot stands,
    with its heading."""

    name: AnyName
    note: AnyNote = ""
    pose: PlacePose | None = None


class PlaceEdit(In):
    """What to change of a place; what is left out stays. `version` is of the place that was looked
    at. `here` takes it along to the map that the robot has now, with the same coordinates;
    `to_robot` moves it to where the robot stands, with its heading. `home` makes it the home of its
    map, or takes that back."""

    version: Version
    name: AnyName | None = None
    note: AnyNote | None = None
    pose: PlacePose | None = None
    here: bool = False
    to_robot: bool = False
    home: bool | None = None

    @model_validator(mode="after")
    def _one_pose(self) -> Self:
        if self.to_robot and self.pose is not None:
            raise ValueError("give a pose, or to_robot")
        return self


class PlaceInfo(BaseModel):
    """A place. `here` says whether it is on the map that the robot has now, `home` whether it is
    where the robot belongs there."""

    id: PlaceId
    version: Version
    name: str
    note: str
    pose: PlacePose
    map: MapIdentity
    here: bool
    home: bool
    author: str
    time: float


class PlaceKept(PlaceInfo):
    """A place as it is kept now. `warning` says why the robot could not be sent there, as far as
    the map alone tells; empty where it tells nothing. Kept it is all the same: what stands there
    may be taken away."""

    warning: str


class PlaceList(BaseModel):
    """All places, in the order in which they were saved.

    `problem` says why none can be kept, or what was lost; empty when all is well. `map` is the one
    that the robot has now; null while it has none. `most` is how many a robot keeps.
    """

    available: bool
    revision: int
    problem: str
    map: MapIdentity | None
    most: int
    places: list[PlaceInfo]
