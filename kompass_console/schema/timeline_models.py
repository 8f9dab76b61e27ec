"""The contract of the timeline, beside what the monitor itself answers."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, StringConstraints

from kompass.timeline.change import LONGEST_SHELF
from kompass_console.schema.models import In

_Name = Annotated[str, StringConstraints(min_length=1, max_length=500)]


class NoteSave(In):
    """A note for the timeline."""

    title: Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=200)]
    text: Annotated[str, StringConstraints(strip_whitespace=True, max_length=1000)] = ""


class AlarmSeen(In):
    """An alarm that somebody has seen; `since` as the alarm has it."""

    alarm: _Name
    since: Annotated[float, Field(ge=0.0)]


class AlarmShelve(In):
    """An alarm that is not to be shown for so many `seconds`; 0 shows it again."""

    alarm: _Name
    seconds: Annotated[float, Field(ge=0.0, le=LONGEST_SHELF)]
