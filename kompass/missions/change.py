"""What people do to missions: how they are kept, and how one runs."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, TypeAdapter

from kompass.missions.mission import MissionPlan
from kompass.places.change import Version
from kompass.rules.schema.model import Model

MissionId = Annotated[int, Field(ge=1, le=2**53)]
RunNumber = Annotated[int, Field(ge=1, le=2**53)]
# How often STOP had been pressed, or the wheel taken, when a person asked for it (DriveState): what
# was asked for before a STOP does not begin after it. None where whoever asks has not heard.
Interruptions = Annotated[int, Field(ge=0, lt=2**32)] | None


class SaveMission(Model):
    """Keep a new mission."""

    kind: Literal["save"] = "save"
    plan: MissionPlan


class EditMission(Model):
    """Change a mission of that version; a run of it goes on as it began."""

    kind: Literal["edit"] = "edit"
    id: MissionId
    version: Version
    plan: MissionPlan


class DeleteMission(Model):
    """Delete a mission; one of the last that were deleted can be restored."""

    kind: Literal["delete"] = "delete"
    id: MissionId
    version: Version


class RestoreMission(Model):
    """Bring a deleted mission back."""

    kind: Literal["restore"] = "restore"
    id: MissionId


class StartMission(Model):
    """Begin a mission of that version, or queue it behind the one that runs."""

    kind: Literal["start"] = "start"
    id: MissionId
    version: Version
    interruptions: Interruptions = None


class SteerRun(Model):
    """Pause, resume, skip, confirm or cancel the run of that number.

    Attributes
    ----------
    step
        Of the run that was looked at. What lets it go on is refused when it has come further
        meanwhile: a second press would confirm what nobody has read. To pause and to cancel are
        never too late.
    """

    kind: Literal["steer"] = "steer"
    verb: Literal["pause", "resume", "skip", "confirm", "cancel"]
    run: RunNumber
    step: Annotated[int, Field(ge=0, le=2**53)]
    interruptions: Interruptions = None


class Unqueue(Model):
    """Take what waits in the queue under that number out of it."""

    kind: Literal["unqueue"] = "unqueue"
    number: RunNumber


class StartNext(Model):
    """Begin the first of the queue, which waits since a run before it was cancelled or failed."""

    kind: Literal["next"] = "next"
    interruptions: Interruptions = None


MissionEdit = SaveMission | EditMission | DeleteMission | RestoreMission
MissionChange = Annotated[
    MissionEdit | StartMission | StartNext | SteerRun | Unqueue, Field(discriminator="kind")
]
MISSION_CHANGE: TypeAdapter[MissionChange] = TypeAdapter(MissionChange)
