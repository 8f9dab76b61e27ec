"""The contract of missions: lists of places, and what is done there."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, Field

from kompass.missions.mission import (
    MOST_ATTEMPTS,
    MOST_ROUNDS,
    MOST_WAYPOINTS,
    Editor,
    Schedule,
    Waypoint,
)
from kompass.places.change import Version
from kompass.places.place import MapIdentity
from kompass_console.schema.models import In
from kompass_console.schema.place_models import AnyName


class MissionSave(In):
    """What people decide of a mission on the map that the robot has now; see
    `kompass.missions.mission.MissionPlan`."""

    name: AnyName
    waypoints: Annotated[list[Waypoint], Field(min_length=1, max_length=MOST_WAYPOINTS)]
    rounds: Annotated[int, Field(ge=0, le=MOST_ROUNDS)] = 1
    attempts: Annotated[int, Field(ge=1, le=MOST_ATTEMPTS)] = 1
    on_failure: Literal["pause", "skip", "end"] = "pause"
    schedule: Schedule | None = None


class MissionEdit(MissionSave):
    """A mission as it is to be; `version` is of the one that was looked at."""

    version: Version


class MissionVersion(In):
    """The version of a mission that was looked at."""

    version: Version


class MissionInfo(BaseModel):
    """A mission. `here` says whether it is on the map that the robot has now."""

    id: int
    version: int
    name: str
    map: MapIdentity
    waypoints: list[Waypoint]
    rounds: int
    attempts: int
    on_failure: Literal["pause", "skip", "end"]
    schedule: Schedule | None
    here: bool
    author: str
    role: Editor
    time: float


class MissionList(BaseModel):
    """All missions, in the order in which they were saved; the rest as of places."""

    available: bool
    revision: int
    problem: str
    map: MapIdentity | None
    most: int
    missions: list[MissionInfo]


RunVerb = Literal["pause", "resume", "skip", "confirm", "cancel"]


class RunStep(BaseModel):
    """The step of the run that was looked at; to pause and to cancel are never too late."""

    step: Annotated[int, Field(ge=0, le=2**53)]
