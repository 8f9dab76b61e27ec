"""What people change: a note of theirs, and what is to become of an alarm."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints, TypeAdapter

from kompass.rules.schema.model import Model

LONGEST_SHELF = 7 * 24 * 3600.0  # s
_Filled = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=500)]
_Name = Annotated[str, StringConstraints(min_length=1, max_length=500)]


class AddNote(Model):
    """Write something down: what a person has seen, or done with the robot."""

    kind: Literal["note"] = "note"
    title: _Filled
    text: Annotated[str, StringConstraints(max_length=1000)] = ""


class Acknowledge(Model):
    """Say that somebody has seen an alarm: it stays, and is calm, until it is raised anew."""

    kind: Literal["acknowledge"] = "acknowledge"
    alarm: _Name
    since: Annotated[float, Field(ge=0.0)]  # of the alarm that was looked at


class Shelve(Model):
    """Put an alarm away for so many seconds, whether it stands or comes; 0 takes it back."""

    kind: Literal["shelve"] = "shelve"
    alarm: _Name
    seconds: Annotated[float, Field(ge=0.0, le=LONGEST_SHELF)]


TimelineChange = Annotated[AddNote | Acknowledge | Shelve, Field(discriminator="kind")]
TIMELINE_CHANGE: TypeAdapter[TimelineChange] = TypeAdapter(TimelineChange)
