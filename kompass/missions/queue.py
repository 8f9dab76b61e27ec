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
SET_BACK = timedelta(hours=1)  # by which a clock is set back at the end of summer


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


def looked_at(before: datetime, now: datetime) -> datetime:
    """The hour up to which schedules have been looked at, local time.

    A clock that is set back, as at the end of summer, comes to the same hours again: they are not
    due twice. One that was wrong by more than that begins anew.

    Parameters
    ----------
    before, now
        Of the last look and of this one, local time without a zone.
    """
    return before if now < before <= now + SET_BACK else now


def is_due(schedule: Schedule, saved: datetime, before: datetime, now: datetime) -> bool:
    """Whether the hour of a schedule has come since the last look.

    An hour that passed while nobody looked (the robot was off, its clock was set) is left out: a
    robot does not set off at a time that nobody expects.

    Parameters
    ----------
    saved
        When the mission was changed last: an hour before that was none of it. All three are local
        time without a zone.
    before
        Of :func:`looked_at`.
    now
        Of this look.
    """
    hour = time.fromisoformat(schedule.at)
    due = datetime.combine(now.date(), hour)
    if due > now:
        due -= timedelta(days=1)
    return due.weekday() in schedule.days and max(before, saved) < due and now - due <= LATEST
