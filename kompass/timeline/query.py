"""What is asked of the timeline, and what is answered."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, StringConstraints

from kompass.rules.schema.model import Model
from kompass.timeline.entry import Kind, Level, TimelineEntry

MOST_ENTRIES = 500
MOST_SLOTS = 200


class TimelineQuery(Model):
    """Which entries, newest first.

    Attributes
    ----------
    before
        Only those below this number; 0 from the newest on.
    count
        At most so many.
    kinds, level
        Only of these kinds (all where none is named), and at least so bad.
    text
        Only those in which this stands, in whatever case.
    since, until
        Only those that were there between these times (s since the epoch); 0 for any.
    slots
        Into how many parts of equal length the time between ``since`` and ``until`` is divided,
        to be counted (:class:`Slot`); 0 for none.
    """

    before: Annotated[int, Field(ge=0)] = 0
    count: Annotated[int, Field(ge=0, le=MOST_ENTRIES)] = 100
    kinds: tuple[Kind, ...] = ()
    level: Level = "info"
    text: Annotated[str, StringConstraints(max_length=200)] = ""
    since: Annotated[float, Field(ge=0.0)] = 0.0
    until: Annotated[float, Field(ge=0.0)] = 0.0
    slots: Annotated[int, Field(ge=0, le=MOST_SLOTS)] = 0


class Slot(Model):
    """How many of a kind began in one part of the time, and how bad the worst was."""

    kind: Kind
    slot: int
    count: int
    level: Level


class TimelinePage(Model):
    """Entries, newest first.

    Attributes
    ----------
    more
        Whether there are older ones that fit.
    oldest
        When the first began of all that are kept (s since the epoch); 0 where there are none.
    problem
        What an operator must hear; empty for nothing.
    """

    entries: tuple[TimelineEntry, ...] = ()
    more: bool = False
    slots: tuple[Slot, ...] = ()
    oldest: float = 0.0
    problem: str = ""


class TimelineNews(Model):
    """By what those who look know that they have to ask again.

    Attributes
    ----------
    newest
        Number of the newest entry.
    changes
        Counts what was written since the monitor's start.
    """

    available: bool = True
    newest: int = 0
    changes: int = 0
    problem: str = ""
