"""What people do to places."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, TypeAdapter

from kompass.places.place import MapIdentity, PlaceName, PlaceNote, PlacePose
from kompass.rules.schema.model import Model

PlaceId = Annotated[int, Field(strict=True, ge=1, le=2**53)]
Version = Annotated[int, Field(strict=True, ge=1, le=2**53)]


class SavePlace(Model):
    """Keep a new place."""

    kind: Literal["save"] = "save"
    name: PlaceName
    note: PlaceNote = ""
    pose: PlacePose
    map: MapIdentity


class EditPlace(Model):
    """Change a place; what is left out stays as it is.

    Attributes
    ----------
    version
        Of the place that the change began from.
    home
        Makes it the home of its map, instead of another one.
    """

    kind: Literal["edit"] = "edit"
    id: PlaceId
    version: Version
    name: PlaceName | None = None
    note: PlaceNote | None = None
    pose: PlacePose | None = None
    map: MapIdentity | None = None
    home: bool | None = None


class DeletePlace(Model):
    """Delete a place; one of the last that were deleted can be restored."""

    kind: Literal["delete"] = "delete"
    id: PlaceId
    version: Version


class RestorePlace(Model):
    """Bring a deleted place back."""

    kind: Literal["restore"] = "restore"
    id: PlaceId


PlaceChange = Annotated[
    SavePlace | EditPlace | DeletePlace | RestorePlace, Field(discriminator="kind")
]
PLACE_CHANGE: TypeAdapter[PlaceChange] = TypeAdapter(PlaceChange)
