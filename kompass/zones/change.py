"""What people do to zones."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, TypeAdapter

from kompass.places.change import Version
from kompass.rules.schema.model import Model
from kompass.zones.zone import ZonePlan

ZoneId = Annotated[int, Field(ge=1, le=2**53)]


class SaveZone(Model):
    """Keep a new zone."""

    kind: Literal["save"] = "save"
    plan: ZonePlan


class EditZone(Model):
    """Change a zone of that version."""

    kind: Literal["edit"] = "edit"
    id: ZoneId
    version: Version
    plan: ZonePlan


class DeleteZone(Model):
    """Delete a zone; one of the last that were deleted can be restored."""

    kind: Literal["delete"] = "delete"
    id: ZoneId
    version: Version


class RestoreZone(Model):
    """Bring a deleted zone back."""

    kind: Literal["restore"] = "restore"
    id: ZoneId


ZoneChange = Annotated[SaveZone | EditZone | DeleteZone | RestoreZone, Field(discriminator="kind")]
ZONE_CHANGE: TypeAdapter[ZoneChange] = TypeAdapter(ZoneChange)
