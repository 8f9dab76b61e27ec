"""The robot's zones on disk: one SQLite file.

A call that changes something returns when that has reached the disk, and either all of it is
stored or nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Literal, Self

from pydantic import TypeAdapter

from kompass.places.place import same_name
from kompass.store.database import Format
from kompass.store.entries import Entries, Plan, Row
from kompass.store.schema import ZONES, ZONES_ID
from kompass.store.sole_file import SoleFile
from kompass.zones.change import DeleteZone, EditZone, RestoreZone, SaveZone, ZoneChange
from kompass.zones.zone import MOST_ZONES, Zone, ZoneBook, ZonePlan

FILE = "zones.db"
LOCK = "zones.lock"
FORMAT = Format(ZONES_ID, ZONES, "FULL")
MOST_DELETED = 50  # that can be restored

_EDITOR: TypeAdapter[Literal["operator", "engineer"]] = TypeAdapter(Literal["operator", "engineer"])


class ZoneStore:
    """Zones of one robot. All methods may be called from any thread.

    Attributes
    ----------
    notice
        What an operator must hear of the file: that it was damaged and is set aside; else empty.
    unwritable
        Why nothing can be changed, where the file can only be read; else empty.
    """

    def __init__(self, folder: Path, clock: Callable[[], float]) -> None:
        self._file = SoleFile(folder / FILE, FORMAT, LOCK, "store of zones", else_read=True)
        self._sql, self.notice = self._file.sql, self._file.notice
        self.unwritable = self._file.unwritable
        self._entries = Entries(
            *(self._sql, "zones"),
            what="zone",
            others="another zone of this map",
            most=MOST_ZONES,
            most_deleted=MOST_DELETED,
            clock=clock,
            read=_zone,
            plan_of=_plan_of,
        )

    @classmethod
    def open(cls, folder: Path, *, clock: Callable[[], float] = time.time) -> Self:
        """Open the zones in a robot's folder (:func:`kompass.store.paths.robot_folder`).

        Parameters
        ----------
        clock
            Gives seconds since the epoch.

        Raises
        ------
        StoreBusy
            When another process has them open.
        StoreTooNew
            When a newer release has written them.
        StoreUnwritable
            When the folder cannot be written, and there is nothing in it that could be read.
        """
        return cls(folder, clock)

    def close(self) -> None:
        """Close the file; nothing is lost by not doing so."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def book(self) -> ZoneBook:
        """All zones, by the time at which they were first saved.

        Raises
        ------
        StoreCorrupt
            When they cannot be read.
        """
        with self._file.reading():
            revision, zones = self._entries.all()
        return ZoneBook(revision=revision, problem=self.notice, zones=zones)

    def change(
        self, change: ZoneChange, author: str, role: Literal["operator", "engineer"]
    ) -> Zone:
        """Carry a change out; the zone as it is then, or was before it was deleted.

        Raises
        ------
        NoSuchEntry
            When it is not there.
        StaleEntry
            When another version of it is there than the change began from.
        EntryRefused
            When its name is taken, or there are too many.
        StoreError
            When it could not be stored. Whatever is raised, nothing was changed.
        """
        with self._file.writing():
            match change:
                case SaveZone():
                    zone = self._entries.save(_plan(change.plan), author, role)
                case EditZone():
                    zone = self._entries.edit(
                        change.id, change.version, _plan(change.plan), author, role
                    )
                case DeleteZone():
                    zone = self._entries.delete(change.id, change.version, author)
                case RestoreZone():
                    zone = self._entries.restore(change.id, author)
            self._entries.changed()
        return zone


def _plan(plan: ZonePlan) -> Plan:
    # A name is free on another map.
    return Plan(plan.name, f"{plan.map.id} {same_name(plan.name)}", plan.model_dump_json())


def _plan_of(zone: Zone) -> Plan:
    fields = zone.model_dump(include=set(ZonePlan.model_fields))
    return _plan(ZonePlan.model_validate(fields))


def _zone(row: Row) -> Zone:
    return Zone(
        id=row.id,
        version=row.version,
        author=row.author,
        role=_EDITOR.validate_python(row.role),
        time=row.time,
        **ZonePlan.model_validate_json(row.plan).model_dump(),
    )
