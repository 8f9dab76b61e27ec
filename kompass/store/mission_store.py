"""The robot's missions on disk, and how far the one that runs has come: one SQLite file.

A call that changes something returns when that has reached the disk, and either all of it is
stored or nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Self

from pydantic import TypeAdapter

from kompass.missions.change import (
    DeleteMission,
    EditMission,
    MissionEdit,
    RestoreMission,
    SaveMission,
)
from kompass.missions.mission import (
    MOST_MISSIONS,
    Editor,
    Mission,
    MissionBook,
    MissionPlan,
)
from kompass.missions.queue import MissionState
from kompass.places.place import same_name
from kompass.store.database import Format
from kompass.store.entries import Entries, Plan, Row
from kompass.store.schema import MISSIONS, MISSIONS_ID
from kompass.store.sole_file import SoleFile

FILE = "missions.db"
LOCK = "missions.lock"
FORMAT = Format(MISSIONS_ID, MISSIONS, "FULL")
MOST_DELETED = 50  # that can be restored

_EDITOR: TypeAdapter[Editor] = TypeAdapter(Editor)


class MissionStore:
    """Missions of one robot. All methods may be called from any thread.

    Attributes
    ----------
    notice
        What an operator must hear of the file: that it was damaged and is set aside; else empty.
    """

    def __init__(self, folder: Path, clock: Callable[[], float]) -> None:
        self._file = SoleFile(folder / FILE, FORMAT, LOCK, "store of missions")
        self._sql, self.notice = self._file.sql, self._file.notice
        self._entries = Entries(
            *(self._sql, "missions"),
            what="mission",
            others="another mission",
            most=MOST_MISSIONS,
            most_deleted=MOST_DELETED,
            clock=clock,
            read=_mission,
            plan_of=_plan_of,
        )

    @classmethod
    def open(cls, folder: Path, *, clock: Callable[[], float] = time.time) -> Self:
        """Open the missions in a robot's folder (:func:`kompass.store.paths.robot_folder`).

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
            When the folder cannot be written.
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

    def book(self) -> MissionBook:
        """All missions, by the time at which they were first saved.

        Raises
        ------
        StoreCorrupt
            When they cannot be read.
        """
        with self._file.reading():
            revision, missions = self._entries.all()
        return MissionBook(revision=revision, problem=self.notice, missions=missions)

    def state(self) -> MissionState:
        """What ran when it was last kept.

        Raises
        ------
        StoreCorrupt
            When it cannot be read.
        """
        with self._file.reading():
            row = self._sql.execute("SELECT json FROM state").fetchone()
            return MissionState() if row is None else MissionState.model_validate_json(row[0])

    def keep(self, state: MissionState) -> None:
        """Keep what runs.

        Raises
        ------
        StoreError
            When it could not be stored.
        """
        text = state.model_copy(update={"left": None, "notice": ""}).model_dump_json()
        with self._file.writing():
            self._sql.execute("DELETE FROM state")
            self._sql.execute("INSERT INTO state VALUES (?)", (text,))

    def change(self, change: MissionEdit, author: str, role: Editor) -> Mission:
        """Carry a change out; the mission as it is then, or was before it was deleted.

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
                case SaveMission():
                    mission = self._entries.save(_plan(change.plan), author, role)
                case EditMission():
                    mission = self._entries.edit(
                        change.id, change.version, _plan(change.plan), author, role
                    )
                case DeleteMission():
                    mission = self._entries.delete(change.id, change.version, author)
                case RestoreMission():
                    mission = self._entries.restore(change.id, author)
            self._entries.changed()
        return mission


def _plan(plan: MissionPlan) -> Plan:
    return Plan(plan.name, same_name(plan.name), plan.model_dump_json())


def _plan_of(mission: Mission) -> Plan:
    fields = mission.model_dump(include=set(MissionPlan.model_fields))
    return _plan(MissionPlan.model_validate(fields))


def _mission(row: Row) -> Mission:
    return Mission(
        id=row.id,
        version=row.version,
        author=row.author,
        role=_EDITOR.validate_python(row.role),
        time=row.time,
        **MissionPlan.model_validate_json(row.plan).model_dump(),
    )
