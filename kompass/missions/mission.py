"""A mission: places in their order, what is done at each, how often, and when it begins."""

from __future__ import annotations

import re
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from kompass.places.change import PlaceId
from kompass.places.place import AuthorName, MapIdentity, PlaceName, PlaceNote
from kompass.rules.schema.actions import Action
from kompass.rules.schema.model import Model

MOST_MISSIONS = 100  # of a robot, on all of its maps
MOST_WAYPOINTS = 50
MOST_TASKS = 10  # at a waypoint
MOST_ROUNDS = 1000
MOST_ATTEMPTS = 10
LONGEST_WAIT = 86_400.0  # s
Editor = Literal["operator", "engineer"]


class Wait(Model):
    """Stand there for a while."""

    kind: Literal["wait"] = "wait"
    seconds: Annotated[float, Field(gt=0.0, le=LONGEST_WAIT)]


class Ask(Model):
    """Stand there until a person says that it may go on."""

    kind: Literal["ask"] = "ask"
    text: PlaceNote = ""


class Halt(Model):
    """Press STOP there; a person releases it, and resumes the mission."""

    kind: Literal["stop"] = "stop"


class Act(Model):
    """Do what a rule could do."""

    kind: Literal["act"] = "act"
    action: Action


Task = Annotated[Wait | Ask | Halt | Act, Field(discriminator="kind")]


class Waypoint(Model):
    """A place to go to, and what is done there, in this order."""

    place: PlaceId
    tasks: Annotated[tuple[Task, ...], Field(max_length=MOST_TASKS)] = ()


def _time_of_day(text: str) -> str:
    if re.fullmatch(r"([01]\d|2[0-3]):[0-5]\d", text) is None:
        raise ValueError("it is no time of the day: write HH:MM, from 00:00 to 23:59")
    return text


def _days(days: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(sorted(set(days)))


class Schedule(Model):
    """When it begins by itself, by the clock and the time zone of the robot.

    Attributes
    ----------
    at
        Time of the day, ``HH:MM``.
    days
        Of the week, from 0 for Monday; at least one.
    """

    at: Annotated[str, AfterValidator(_time_of_day)]
    days: Annotated[
        tuple[Annotated[int, Field(ge=0, le=6)], ...], Field(min_length=1), AfterValidator(_days)
    ] = (0, 1, 2, 3, 4, 5, 6)


class MissionPlan(Model):
    """What people decide of a mission.

    Attributes
    ----------
    map
        On which all of its places are.
    rounds
        How often all of it is driven; 0 for until somebody cancels it.
    attempts
        How often the robot sets off for a place before that counts as failed.
    on_failure
        What then: ``pause`` until a person decides, ``skip`` the place, ``end`` the mission.
    """

    name: PlaceName
    map: MapIdentity
    waypoints: Annotated[tuple[Waypoint, ...], Field(min_length=1, max_length=MOST_WAYPOINTS)]
    rounds: Annotated[int, Field(ge=0, le=MOST_ROUNDS)] = 1
    attempts: Annotated[int, Field(ge=1, le=MOST_ATTEMPTS)] = 1
    on_failure: Literal["pause", "skip", "end"] = "pause"
    schedule: Schedule | None = None

    @model_validator(mode="after")
    def _gets_anywhere(self) -> Self:
        """A robot that is there already would drive its rounds as fast as it can count them."""
        places = {waypoint.place for waypoint in self.waypoints}
        stands = any(
            isinstance(task, Wait | Ask | Halt)
            for waypoint in self.waypoints
            for task in waypoint.tasks
        )
        if self.rounds != 1 and len(places) == 1 and not stands:
            raise ValueError(
                "it drives rounds and has one place only; add another place, or a wait at this one"
            )
        return self


class Mission(MissionPlan):
    """A mission as it is kept.

    Attributes
    ----------
    id
        Never given to another mission.
    version
        Counts its changes, from 1.
    author, role
        Who changed it last. Its actions have the rights of that person.
    time
        When that was (s since the epoch).
    """

    id: Annotated[int, Field(ge=1)]
    version: Annotated[int, Field(ge=1)]
    author: AuthorName
    role: Editor
    time: float


class MissionBook(Model):
    """All missions of a robot; `revision`, `problem` and `available` as of places."""

    revision: Annotated[int, Field(ge=0)] = 0
    problem: str = ""
    available: bool = True
    missions: Annotated[tuple[Mission, ...], Field(max_length=MOST_MISSIONS)] = ()
