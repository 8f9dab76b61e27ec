"""One line of the timeline."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import Field, StringConstraints

from kompass.rules.schema.model import Model

Kind = Literal[
    "stop", "fault", "alarm", "rule", "goal", "mission", "hand", "edit", "person", "robot"
]
KINDS: tuple[Kind, ...] = get_args(Kind)
Level = Literal["info", "warning", "error", "critical"]
LEVELS: tuple[Level, ...] = get_args(Level)  # the least first
LONGEST_TEXT = 1000  # characters

_Short = Annotated[str, StringConstraints(max_length=200)]


class FiringLink(Model):
    """A firing in the journal: of that run, in that life of the monitor."""

    at: Literal["firing"] = "firing"
    rule: str
    run: int
    epoch: str


class RevisionLink(Model):
    """A revision of the rules."""

    at: Literal["revision"] = "revision"
    number: int


Link = Annotated[FiringLink | RevisionLink, Field(discriminator="at")]


class TimelineEntry(Model):
    """Something that happened, or lasted for a while.

    Attributes
    ----------
    number
        Counts the entries of the robot; a change of an entry keeps its number.
    key
        What it is about: what is seen of it later changes this entry, and makes no other.
    time, ended
        When it began, and was over (s since the epoch). Both are the same where it lasted no time.
        ``ended`` is None while it lasts, and where nobody saw how it ended.
    lasts
        Whether it goes on.
    count, last
        How often it came, one shortly after the other, and when last (s since the epoch).
    source
        The component, process or rule that it is about; empty for the robot.
    title, text
        For people.
    who
        Did it; empty where no person did.
    link
        Where more is told of it.
    """

    number: Annotated[int, Field(ge=0)] = 0
    key: _Short = ""
    kind: Kind
    level: Level = "info"
    time: float
    ended: float | None = None
    lasts: bool = False
    count: Annotated[int, Field(ge=1)] = 1
    last: float = 0.0
    source: _Short = ""
    title: _Short
    text: Annotated[str, StringConstraints(max_length=LONGEST_TEXT)] = ""
    who: _Short = ""
    link: Link | None = None


def shortened(text: str, most: int = LONGEST_TEXT) -> str:
    """A text on one line that fits into an entry."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text[: 2 * most]).split())
    return line if len(line) <= most else line[: most - 1] + "…"
