"""What runs, and what waits for its turn; when a mission is due by its schedule."""

from __future__ import annotations

from datetime import datetime, time, timedelta
from typing import Annotated

from pydantic import Field

from kompass.missions.mission import Schedule
from kompass.missions.run import Run
from kompass.places.place import AuthorName
from kompass.rules.schema.model import Model

MOST_QUEUED = 20
LATEST = timedelta(seconds=90)  # after its hour at which a mission is still begun


class Queued(Model):
    """A mission that is to run when those before it are done.

    Attributes
    ----------
    number
        Counts what was queued.
    mission
        Id of the mission.
    by, time
        Who wanted it, and when (s since the epoch).
    """

    number: Annotated[int, Field(ge=1)]
    mission: Annotated[int, Field(ge=1)]
    by: AuthorName
    time: float


class MissionState(Model):
    """What runs or ran last, and what waits.

    Attributes
    ----------
    runs, queuings
        How many there have been.
    left
        Of a wait that is under way [s]; told, and not kept.
    notice
        What an operator must hear: what did not begin and why, or that nothing can be written
        down; empty when all is well. Told, and not kept.
    """

    runs: Annotated[int, Field(ge=0)] = 0
    queuings: Annotated[int, Field(ge=0)] = 0
    run: Run | None = None
    queue: Annotated[tuple[Queued, ...], Field(max_length=MOST_QUEUED)] = ()
    left: float | None = None
    notice: str = ""

    @property
    def busy(self) -> bool:
        """Whether a run is under way or paused."""
        return self.run is not None and not self.run.over


def is_due(schedule: Schedule, before: datetime, now: datetime) -> bool:
    """Whether the hour of a schedule has come since the last look.

    An hour that passed while nobody looked (the robot was off, its clock was set) is left out: a
    robot does not set off at a time that nobody expects.

    Parameters
    ----------
    before, now
        Of the last look and of this one, local time.
    """
    hour = time.fromisoformat(schedule.at)
    due = datetime.combine(now.date(), hour, tzinfo=now.tzinfo)
    if due > now:
        due -= timedelta(days=1)
    return due.weekday() in schedule.days and before < due and now - due <= LATEST
