"""The robot's missions on disk, and how far the one that runs has come: one SQLite file.

A call that changes something returns when that has reached the disk, and either all of it is
stored or nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any, Self

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
from kompass.store.errors import EntryRefused, NoSuchEntry, StaleEntry
from kompass.store.schema import MISSIONS, MISSIONS_ID
from kompass.store.sole_file import SoleFile

FILE = "missions.db"
LOCK = "missions.lock"
FORMAT = Format(MISSIONS_ID, MISSIONS, "FULL")
MOST_DELETED = 50  # that can be restored

_COLUMNS = "id, version, plan, author, role, time"


class MissionStore:
    """Missions of one robot. All methods may be called from any thread.

    Attributes
    ----------
    notice
        What an operator must hear of the file: that it was damaged and is set aside; else empty.
    """

    def __init__(self, folder: Path, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._file = SoleFile(folder / FILE, FORMAT, LOCK, "store of missions")
        self._sql, self.notice = self._file.sql, self._file.notice

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
            (revision,) = self._sql.execute("SELECT revision FROM counter").fetchone()
            rows = self._sql.execute(
                f"SELECT {_COLUMNS} FROM missions WHERE deleted IS NULL ORDER BY id"
            ).fetchall()
            missions = tuple(_mission(row) for row in rows)
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
                    mission = self._save(change.plan, author, role)
                case EditMission():
                    mission = self._edit(change, author, role)
                case DeleteMission():
                    mission = self._delete(change, author)
                case RestoreMission():
                    mission = self._restore(change.id, author)
            self._sql.execute("UPDATE counter SET revision = revision + 1")
        return mission

    def _save(self, plan: MissionPlan, author: str, role: Editor) -> Mission:
        self._check_room()
        self._check_free(plan.name, 0)
        cursor = self._sql.execute(
            "INSERT INTO missions (version, same_name, plan, author, role, time) "
            "VALUES (1, ?, ?, ?, ?, ?)",
            (same_name(plan.name), plan.model_dump_json(), author, role, self._clock()),
        )
        assert cursor.lastrowid is not None
        return self._found(cursor.lastrowid)

    def _edit(self, change: EditMission, author: str, role: Editor) -> Mission:
        self._fresh(change.id, change.version)
        plan = change.plan
        self._check_free(plan.name, change.id)
        self._sql.execute(
            "UPDATE missions SET version = version + 1, same_name = ?, plan = ?, author = ?, "
            "role = ?, time = ? WHERE id = ?",
            (same_name(plan.name), plan.model_dump_json(), author, role, self._clock(), change.id),
        )
        return self._found(change.id)

    def _delete(self, change: DeleteMission, author: str) -> Mission:
        before = self._fresh(change.id, change.version)
        self._sql.execute(
            "UPDATE missions SET deleted = ?, author = ?, version = version + 1 WHERE id = ?",
            (self._clock(), author, change.id),
        )
        self._sql.execute(
            "DELETE FROM missions WHERE deleted IS NOT NULL AND id NOT IN (SELECT id FROM missions "
            "WHERE deleted IS NOT NULL ORDER BY deleted DESC, id DESC LIMIT ?)",
            (MOST_DELETED,),
        )
        return before

    def _restore(self, mission_id: int, author: str) -> Mission:
        before = self._row(mission_id, "deleted IS NOT NULL")
        if before is None:
            raise NoSuchEntry(
                f"mission {mission_id} is not among the last {MOST_DELETED} that were deleted; "
                "look whether it is there already, or save it anew"
            )
        self._check_room()
        self._check_free(before.name, before.id)
        # Its role stays: whoever brings it back gives it no rights that it had not.
        self._sql.execute(
            "UPDATE missions SET deleted = NULL, version = version + 1, author = ?, time = ? "
            "WHERE id = ?",
            (author, self._clock(), mission_id),
        )
        return self._found(mission_id)

    def _fresh(self, mission_id: int, version: int) -> Mission:
        mission = self._found(mission_id)
        if mission.version != version:
            raise StaleEntry(
                f"the mission {mission.name!r} was changed meanwhile, by "
                f"{mission.author or 'somebody'}; look at it as it is now, and try again"
            )
        return mission

    def _found(self, mission_id: int) -> Mission:
        mission = self._row(mission_id, "deleted IS NULL")
        if mission is None:
            raise NoSuchEntry(
                f"there is no mission {mission_id} any more, somebody has deleted it; "
                "look at the others"
            )
        return mission

    def _row(self, mission_id: int, which: str) -> Mission | None:
        row = self._sql.execute(
            f"SELECT {_COLUMNS} FROM missions WHERE id = ? AND {which}", (mission_id,)
        ).fetchone()
        return None if row is None else _mission(row)

    def _check_free(self, name: str, but: int) -> None:
        row = self._sql.execute(
            "SELECT plan FROM missions WHERE same_name = ? AND id != ? AND deleted IS NULL",
            (same_name(name), but),
        ).fetchone()
        if row is not None:
            raise EntryRefused(f"the name {name!r} is taken by another mission; choose another")

    def _check_room(self) -> None:
        (count,) = self._sql.execute(
            "SELECT count(*) FROM missions WHERE deleted IS NULL"
        ).fetchone()
        if count >= MOST_MISSIONS:
            raise EntryRefused(
                f"there are {count} missions, and no robot keeps more; delete those that nobody "
                "needs"
            )


def _mission(row: tuple[Any, ...]) -> Mission:
    mission_id, version, plan, author, role, at = row
    return Mission(
        id=mission_id,
        version=version,
        author=author,
        role=role,
        time=at,
        **MissionPlan.model_validate_json(plan).model_dump(),
    )
