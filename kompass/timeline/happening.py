"""What observers of the robot have to say: something happened, began, or is over."""

from __future__ import annotations

from typing import NamedTuple

from kompass.timeline.entry import Kind, Level, Link


class Happened(NamedTuple):
    """Something that took no time. With a key, what happens again shortly after only counts."""

    time: float
    kind: Kind
    title: str
    text: str = ""
    level: Level = "info"
    source: str = ""
    who: str = ""
    key: str = ""
    link: Link | None = None


class Began(NamedTuple):
    """Something that lasts until it is :class:`Over`; told again while it lasts, it is the same."""

    time: float
    kind: Kind
    key: str
    title: str
    text: str = ""
    level: Level = "info"
    source: str = ""
    who: str = ""
    link: Link | None = None


class Over(NamedTuple):
    """What has that key does not last any more; nothing when it did not.

    Attributes
    ----------
    text, level
        How it ended: stands behind what was said at the beginning; and how bad it was, where that
        is another matter.
    """

    time: float
    key: str
    text: str = ""
    level: Level | None = None


Happening = Happened | Began | Over
