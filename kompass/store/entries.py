"""What people keep under a name in a table: saved, changed, deleted, and brought back.

What it is stands in one text: whoever reads a part of it reads the whole.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from typing import Any, Generic, NamedTuple, TypeVar

from kompass.store.errors import EntryRefused, NoSuchEntry, StaleEntry

E = TypeVar("E")


class Row(NamedTuple):
    """An entry as it is stored."""

    id: int
    version: int
    plan: str
    author: str
    role: str
    time: float


class Plan(NamedTuple):
    """What is to be stored.

    Attributes
    ----------
    name
        For people.
    key
        No two entries have one in common.
    json
        The whole.
    """

    name: str
    key: str
    json: str


class Entries(Generic[E]):
    """The entries of a table. To be used within ``reading`` and ``writing`` of its file only.

    Parameters
    ----------
    sql, table
        Where they are; the columns are those of :class:`Row`, ``same_name`` and ``deleted``.
    what, others
        One of them, for people: ``mission``; and where names are unique: ``another mission``.
    most, most_deleted
        How many there may be, and how many of those that were deleted are kept.
    clock
        Gives seconds since the epoch.
    read
        Makes one of a row.
    plan_of
        What was stored of one.
    """

    def __init__(
        self,
        sql: sqlite3.Connection,
        table: str,
        *,
        what: str,
        others: str,
        most: int,
        most_deleted: int,
        clock: Callable[[], float],
        read: Callable[[Row], E],
        plan_of: Callable[[E], Plan],
    ) -> None:
        self._sql, self._table, self._what, self._others = sql, table, what, others
        self._most, self._most_deleted = most, most_deleted
        self._clock, self._read, self._plan_of = clock, read, plan_of

    def all(self) -> tuple[int, tuple[E, ...]]:
        """How often they were changed, and all of them, as they were first saved."""
        (revision,) = self._sql.execute("SELECT revision FROM counter").fetchone()
        rows = self._sql.execute(
            f"SELECT {_COLUMNS} FROM {self._table} WHERE deleted IS NULL ORDER BY id"
        ).fetchall()
        return revision, tuple(self._read(Row(*row)) for row in rows)

    def changed(self) -> None:
        """Count a change."""
        self._sql.execute("UPDATE counter SET revision = revision + 1")

    def save(self, plan: Plan, author: str, role: str) -> E:
        """Keep a new one.

        Raises
        ------
        EntryRefused
            When its name is taken, or there are too many.
        """
        self._check_room()
        self._check_free(plan, 0)
        cursor = self._sql.execute(
            f"INSERT INTO {self._table} (version, same_name, plan, author, role, time) "
            "VALUES (1, ?, ?, ?, ?, ?)",
            (plan.key, plan.json, author, role, self._clock()),
        )
        assert cursor.lastrowid is not None
        return self._found(cursor.lastrowid)

    def edit(self, entry: int, version: int, plan: Plan, author: str, role: str) -> E:
        """Change the one of that number and version.

        Raises
        ------
        NoSuchEntry, StaleEntry, EntryRefused
            When it is not there, is another one by now, or its new name is taken.
        """
        self._fresh(entry, version)
        self._check_free(plan, entry)
        self._sql.execute(
            f"UPDATE {self._table} SET version = version + 1, same_name = ?, plan = ?, "
            "author = ?, role = ?, time = ? WHERE id = ?",
            (plan.key, plan.json, author, role, self._clock(), entry),
        )
        return self._found(entry)

    def delete(self, entry: int, version: int, author: str) -> E:
        """Delete the one of that number and version; as it was.

        Raises
        ------
        NoSuchEntry, StaleEntry
            When it is not there, or is another one by now.
        """
        before = self._fresh(entry, version)
        self._sql.execute(
            f"UPDATE {self._table} SET deleted = ?, author = ?, version = version + 1 WHERE id = ?",
            (self._clock(), author, entry),
        )
        self._sql.execute(
            f"DELETE FROM {self._table} WHERE deleted IS NOT NULL AND id NOT IN (SELECT id FROM "
            f"{self._table} WHERE deleted IS NOT NULL ORDER BY deleted DESC, id DESC LIMIT ?)",
            (self._most_deleted,),
        )
        return before

    def restore(self, entry: int, author: str) -> E:
        """Bring one back that was deleted.

        Its role stays: whoever brings it back gives it no rights that it had not.

        Raises
        ------
        NoSuchEntry, EntryRefused
            When it is not among the deleted ones, its name is taken, or there are too many.
        """
        before = self._row(entry, "deleted IS NOT NULL")
        if before is None:
            raise NoSuchEntry(
                f"{self._what} {entry} is not among the last {self._most_deleted} that were "
                "deleted; look whether it is there already, or save it anew"
            )
        self._check_room()
        self._check_free(self._plan_of(self._read(before)), entry)
        self._sql.execute(
            f"UPDATE {self._table} SET deleted = NULL, version = version + 1, author = ?, "
            "time = ? WHERE id = ?",
            (author, self._clock(), entry),
        )
        return self._found(entry)

    def _fresh(self, entry: int, version: int) -> E:
        row = self._row(entry, "deleted IS NULL")
        if row is not None and row.version != version:
            name = self._plan_of(self._read(row)).name
            raise StaleEntry(
                f"the {self._what} {name!r} was changed meanwhile, by {row.author or 'somebody'}; "
                "look at it as it is now, and try again"
            )
        return self._found(entry)

    def _found(self, entry: int) -> E:
        row = self._row(entry, "deleted IS NULL")
        if row is None:
            raise NoSuchEntry(
                f"there is no {self._what} {entry} any more, somebody has deleted it; "
                "look at the others"
            )
        return self._read(row)

    def _row(self, entry: int, which: str) -> Row | None:
        row: tuple[Any, ...] | None = self._sql.execute(
            f"SELECT {_COLUMNS} FROM {self._table} WHERE id = ? AND {which}", (entry,)
        ).fetchone()
        return None if row is None else Row(*row)

    def _check_free(self, plan: Plan, but: int) -> None:
        row = self._sql.execute(
            f"SELECT id FROM {self._table} WHERE same_name = ? AND id != ? AND deleted IS NULL",
            (plan.key, but),
        ).fetchone()
        if row is not None:
            raise EntryRefused(f"the name {plan.name!r} is taken by {self._others}; choose another")

    def _check_room(self) -> None:
        (count,) = self._sql.execute(
            f"SELECT count(*) FROM {self._table} WHERE deleted IS NULL"
        ).fetchone()
        if count >= self._most:
            raise EntryRefused(
                f"there are {count} {self._what}s, and no robot keeps more; delete those that "
                "nobody needs"
            )


_COLUMNS = ", ".join(Row._fields)
