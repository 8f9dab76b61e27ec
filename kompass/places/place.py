"""A place: a pose with a name, on one map."""

from __future__ import annotations

import unicodedata
from typing import Annotated

from pydantic import AfterValidator, Field

from kompass.rules.schema.model import Model

MOST_PLACES = 300  # of a robot, on all of its maps
LONGEST_NAME = 40  # characters
LONGEST_NOTE = 200
LONGEST_AUTHOR = 200
_FARTHEST = 1e6  # m


def _line(text: str, longest: int) -> str:
    line = " ".join(unicodedata.normalize("NFC", text).split())
    if len(line) > longest:
        raise ValueError(f"it has {len(line)} characters; use at most {longest}")
    if not line.isprintable():
        raise ValueError("it has characters that cannot be seen; type it anew without them")
    return line


def _name(text: str) -> str:
    name = _line(text, LONGEST_NAME)
    if not name:
        raise ValueError("it is empty; give the place a name")
    return name


def _note(text: str) -> str:
    return _line(text, LONGEST_NOTE)


def _author(text: str) -> str:
    return _line(text, LONGEST_AUTHOR)


# A text of megabytes is not looked at as a whole.
PlaceName = Annotated[str, Field(max_length=10 * LONGEST_NAME), AfterValidator(_name)]
PlaceNote = Annotated[str, Field(max_length=10 * LONGEST_NOTE), AfterValidator(_note)]
AuthorName = Annotated[str, AfterValidator(_author)]
MapId = Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]
Metres = Annotated[float, Field(strict=True, ge=-_FARTHEST, le=_FARTHEST)]
Radians = Annotated[float, Field(strict=True, ge=-100.0, le=100.0)]


def same_name(name: str) -> str:
    """What two names have in common that people take for one: case and width do not count."""
    return unicodedata.normalize("NFKC", name).casefold()


class PlacePose(Model):
    """Where it is, in the map's frame (m, rad); without ``yaw`` any heading will do."""

    x: Metres
    y: Metres
    yaw: Radians | None = None


class MapIdentity(Model):
    """Which map it is.

    Attributes
    ----------
    id
        Digest of everything in the map; see :func:`kompass.places.map_identity.identify`.
    label
        Says its size to people.
    """

    id: MapId
    label: Annotated[str, Field(max_length=100), AfterValidator(_note)]


class Place(Model):
    """A place as it is kept.

    Attributes
    ----------
    id
        Never given to another place.
    version
        Counts its changes, from 1.
    home
        Whether it is where the robot belongs: its charger, say. At most one of a map is.
    author
        Who changed it last.
    time
        When that was (s since the epoch).
    """

    id: Annotated[int, Field(ge=1)]
    version: Annotated[int, Field(ge=1)]
    name: PlaceName
    note: PlaceNote
    pose: PlacePose
    map: MapIdentity
    home: bool = False
    author: AuthorName
    time: float


class PlaceBook(Model):
    """All places of a robot.

    Attributes
    ----------
    revision
        Counts the changes of all of them.
    problem
        Why places cannot be kept, or what was lost; empty when all is well.
    available
        Whether they are kept at all.
    """

    revision: Annotated[int, Field(ge=0)] = 0
    problem: str = ""
    available: bool = True
    places: Annotated[tuple[Place, ...], Field(max_length=MOST_PLACES)] = ()
