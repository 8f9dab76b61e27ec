"""The robot's places on disk: one SQLite file of its own, beside the rules'.

A damaged file of rules costs no place, and the other way round. A call that changes something
returns when that has reached the disk, and either all of it is stored or nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from kompass.places.change import DeletePlace, EditPlace, PlaceChange, RestorePlace, SavePlace
from kompass.places.place import (
    MOST_PLACES,
    MapIdentity,
    Place,
    PlaceBook,
    PlacePose,
    same_name,
)
from kompass.store.database import Format
from kompass.store.errors import EntryRefused, NoSuchEntry, StaleEntry
from kompass.store.schema import PLACES, PLACES_ID
from kompass.store.sole_file import SoleFile

FILE = "places.db"
LOCK = "places.lock"
FORMAT = Format(PLACES_ID, PLACES, "FULL")
MOST_DELETED = 100  # that can be restored

_COLUMNS = "id, version, name, note, x, y, yaw, map, map_label, home, author, time"


class PlaceStore:
    """Places of one robot. All methods may be called from any thread.

    Attributes
    ----------
    notice
        What an operator must hear of the file: that it was damaged and is set aside; else empty.
    unwritable
        Why nothing can be changed, where the file can only be read; else empty.
    """

    def __init__(self, folder: Path, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._file = SoleFile(folder / FILE, FORMAT, LOCK, "store of places", else_read=True)
        self._sql, self.notice = self._file.sql, self._file.notice
        self.unwritable = self._file.unwritable

    @classmethod
    def open(cls, folder: Path, *, clock: Callable[[], float] = time.time) -> Self:
        """Open the places in a robot's folder (:func:`kompass.store.paths.robot_folder`).

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

    def book(self) -> PlaceBook:
        """All places, by the time at which they were first saved.

        Raises
        ------
        StoreCorrupt
            When they cannot be read.
        """
        with self._file.reading():
            (revision,) = self._sql.execute("SELECT revision FROM counter").fetchone()
            rows = self._sql.execute(
                f"SELECT {_COLUMNS} FROM places WHERE deleted IS NULL ORDER BY id"
            ).fetchall()
            places = tuple(_place(row) for row in rows)
        return PlaceBook(revision=revision, problem=self.notice, places=places)

    def change(self, change: PlaceChange, author: str) -> Place:
        """Carry a change out; the place as it is then, or was before it was deleted.

        Raises
        ------
        NoSuchEntry
            When it is not there.
        StaleEntry
            When another version of it is there than the change began from.
        EntryRefused
            When its name is taken on its map, or there are too many.
        StoreError
            When it could not be stored. Whatever is raised, nothing was changed.
        """
        with self._file.writing():
            match change:
                case SavePlace():
                    place = self._save(change, author)
                case EditPlace():
                    place = self._edit(change, author)
                case DeletePlace():
                    place = self._delete(change, author)
                case RestorePlace():
                    place = self._restore(change, author)
            self._sql.execute("UPDATE counter SET revision = revision + 1")
        return place

    def _save(self, change: SavePlace, author: str) -> Place:
        self._check_room()
        self._check_free(change.name, change.map, 0)
        pose, of_map = change.pose, change.map
        cursor = self._sql.execute(
            "INSERT INTO places (version, name, same_name, note, x, y, yaw, map, map_label, "
            "author, time) VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
            (
                *(change.name, same_name(change.name), change.note, pose.x, pose.y, pose.yaw),
                *(of_map.id, of_map.label, author, self._clock()),
            ),
        )
        assert cursor.lastrowid is not None
        return self._found(cursor.lastrowid)

    def _edit(self, change: EditPlace, author: str) -> Place:
        before = self._fresh(change.id, change.version)
        given = change.model_dump(exclude={"kind", "id", "version"}, exclude_none=True)
        after = Place.model_validate(before.model_dump() | given)
        self._check_free(after.name, after.map, after.id)
        # There is one home of a map: whoever names another one says so of both. Whoever takes a
        # place along to a map that has one leaves that as it is.
        home = after.home and (bool(change.home) or after.map == before.map)
        if home:
            self._sql.execute(
                "UPDATE places SET home = 0, version = version + 1, author = ?, time = ? "
                "WHERE map = ? AND home AND id != ? AND deleted IS NULL",
                (author, self._clock(), after.map.id, after.id),
            )
        pose = after.pose
        self._sql.execute(
            "UPDATE places SET version = version + 1, name = ?, same_name = ?, note = ?, x = ?, "
            "y = ?, yaw = ?, map = ?, map_label = ?, home = ?, author = ?, time = ? WHERE id = ?",
            (
                *(after.name, same_name(after.name), after.note, pose.x, pose.y, pose.yaw),
                *(after.map.id, after.map.label, home, author, self._clock(), after.id),
            ),
        )
        return self._found(after.id)

    def _delete(self, change: DeletePlace, author: str) -> Place:
        before, now = self._fresh(change.id, change.version), self._clock()
        self._sql.execute(
            "UPDATE places SET deleted = ?, author = ?, version = version + 1 WHERE id = ?",
            (now, author, change.id),
        )
        self._sql.execute(
            "DELETE FROM places WHERE deleted IS NOT NULL AND id NOT IN (SELECT id FROM places "
            "WHERE deleted IS NOT NULL ORDER BY deleted DESC, id DESC LIMIT ?)",
            (MOST_DELETED,),
        )
        return before

    def _restore(self, change: RestorePlace, author: str) -> Place:
        before = self._row(change.id, "deleted IS NOT NULL")
        if before is None:
            raise NoSuchEntry(
                f"place {change.id} is not among the last {MOST_DELETED} that were deleted; "
                "look whether it is there already, or save it anew"
            )
        self._check_room()
        self._check_free(before.name, before.map, before.id)
        # It is home again unless another place has become that meanwhile.
        self._sql.execute(
            "UPDATE places SET deleted = NULL, version = version + 1, author = ?, time = ?, "
            "home = home AND NOT EXISTS (SELECT 1 FROM places AS other WHERE other.home "
            "AND other.map = places.map AND other.deleted IS NULL) WHERE id = ?",
            (author, self._clock(), change.id),
        )
        return self._found(change.id)

    def _fresh(self, place_id: int, version: int) -> Place:
        place = self._found(place_id)
        if place.version != version:
            raise StaleEntry(
                f"the place {place.name!r} was changed meanwhile, by {place.author or 'somebody'}; "
                "look at it as it is now, and try again"
            )
        return place

    def _found(self, place_id: int) -> Place:
        place = self._row(place_id, "deleted IS NULL")
        if place is None:
            raise NoSuchEntry(
                f"there is no place {place_id} any more, somebody has deleted it; "
                "look at the others"
            )
        return place

    def _row(self, place_id: int, which: str) -> Place | None:
        row = self._sql.execute(
            f"SELECT {_COLUMNS} FROM places WHERE id = ? AND {which}", (place_id,)
        ).fetchone()
        return None if row is None else _place(row)

    def _check_free(self, name: str, of_map: MapIdentity, but: int) -> None:
        row = self._sql.execute(
            "SELECT name FROM places WHERE map = ? AND same_name = ? AND id != ? "
            "AND deleted IS NULL",
            (of_map.id, same_name(name), but),
        ).fetchone()
        if row is not None:
            raise EntryRefused(
                f"the name {name!r} is taken by a place of this map ({row[0]!r}); choose another"
            )

    def _check_room(self) -> None:
        (count,) = self._sql.execute("SELECT count(*) FROM places WHERE deleted IS NULL").fetchone()
        if count >= MOST_PLACES:
            raise EntryRefused(
                f"there are {count} places, and no robot keeps more; delete those that nobody needs"
            )


def _place(row: tuple[Any, ...]) -> Place:
    place_id, version, name, note, x, y, yaw, of_map, label, home, author, at = row
    return Place(
        id=place_id,
        version=version,
        name=name,
        note=note,
        pose=PlacePose(x=x, y=y, yaw=yaw),
        map=MapIdentity(id=of_map, label=label),
        home=bool(home),
        author=author,
        time=at,
    )
