"""The contract of the routes of the flight recorder's recordings."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BaseModel, Field

from kompass_console.schema.models import In


def _visible(name: str) -> str:
    # Past the console a NUL would end the name, and the rest be lost without a word.
    if not name.isprintable():
        raise ValueError("it holds a character that cannot be seen")
    return name


class RecordingRequest(In):
    """Keep the last `seconds` of the flight recorder (0: all it has) under a name."""

    seconds: Annotated[float, Field(ge=0.0, le=1e7, allow_inf_nan=False)] = 0.0
    name: Annotated[str, Field(max_length=200), AfterValidator(_visible)] = ""


class RecordingSaved(BaseModel):
    """Where the recording is, on the robot, and the name it is asked for by."""

    name: str
    path: str
    message: str


class RecordingInfo(BaseModel):
    """A recording that was kept.

    `saved`, `begin` and `end` are seconds since the epoch, the latter two null for one that holds
    nothing. `size` is in bytes. `of_firing` tells those that a firing had kept from those that a
    person did: of the former only the newest stay. `problem` says why it cannot be read.
    """

    name: str
    saved: float
    begin: float | None
    end: float | None
    size: int
    messages: int
    of_firing: bool
    problem: str


class RingInfo(BaseModel):
    """What the flight recorder has and will go over: since when (s since the epoch), and bytes."""

    begin: float
    size: int


class RecordingList(BaseModel):
    """What is kept, newest first.

    `here` is false for a console on another machine than the recordings: it can have some kept,
    and not look at them. `ring` is null when nothing is recorded. `free` are bytes of the disk.
    """

    here: bool
    recordings: list[RecordingInfo]
    ring: RingInfo | None
    free: int
