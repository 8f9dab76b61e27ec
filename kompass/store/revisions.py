"""Revisions in the database: SQL in, models out. Who calls holds the transaction and the lock."""

from __future__ import annotations

import logging
import sqlite3
from typing import Literal, NamedTuple

from kompass.rulebook.diff import diff_tables
from kompass.rulebook.schema.diff_models import TableDiff
from kompass.rulebook.schema.revision import Origin, Revision
from kompass.rules.schema.table import Table, table_hash
from kompass.store.boot import KeptRevision, OlderEdits, StoreFacts
from kompass.store.content import read_table, write_table
from kompass.store.errors import NoSuchRevision, StoreCorrupt
from kompass.store.session import MonitorSession

_logger = logging.getLogger("kompass.store")
Outcome = Literal["confirmed", "taken back", "superseded"]
MADE_BY_PEOPLE = ("edit", "rollback", "merge")
KEPT = 10  # confirmed revisions that a start looks at
SESSIONS = 10

_OUTCOME = """
    (SELECT outcome FROM outcomes o WHERE o.revision = r.number ORDER BY o.rowid DESC LIMIT 1)
"""
_STORED = (
    *("number", "parent", "author", "role", "time", "reason", "origin", "table_hash", "recipe"),
    *("restores", "diff"),
)
_COLUMNS = f"{', '.join(_STORED)}, COALESCE({_OUTCOME}, 'active') AS outcome"
_DIFF = _STORED.index("diff")


class RevisionEntry(NamedTuple):
    """A revision about to be made; the fields are those of :class:`Revision`."""

    parent: int | None
    author: str
    role: str
    time: float
    reason: str
    origin: Origin
    recipe: str
    restores: int | None


class Pointers(NamedTuple):
    """Numbers of the revisions of a recipe; 0 for none."""

    active: int
    confirmed: int


class Revisions:
    """The append-only list of revisions, on one connection."""

    def __init__(self, connection: sqlite3.Connection) -> None:
        self._sql = connection

    def append(self, table: Table, entry: RevisionEntry) -> int:
        """Add a revision and make it the active one of its recipe; its number."""
        before = self._readable(entry.parent)
        diff = diff_tables(before, table, before_revision=entry.parent)
        content = write_table(self._sql, table)
        cursor = self._sql.execute(
            "INSERT INTO revisions (parent, author, role, time, reason, origin, content, "
            "table_hash, recipe, restores, diff) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
            (
                *entry[:6],
                content,
                table_hash(table),
                entry.recipe,
                entry.restores,
                diff.model_dump_json(),
            ),
        )
        number = cursor.lastrowid
        assert number is not None
        self._sql.execute(
            "INSERT INTO pointers (recipe, active) VALUES (?, ?) "
            "ON CONFLICT (recipe) DO UPDATE SET active = excluded.active",
            (entry.recipe, number),
        )
        return number

    def _readable(self, number: int | None) -> Table:
        """The table of a parent; an empty one when it is damaged, which must not stop anybody."""
        if number is None:
            return Table()
        try:
            return self.table(number)
        except StoreCorrupt as error:
            _logger.error("%s", error)
            return Table()

    def settle(self, number: int, outcome: Outcome, time: float, author: str, role: str) -> None:
        """Add what became of a revision."""
        self._sql.execute(
            "INSERT INTO outcomes (revision, outcome, time, author, role) VALUES (?, ?, ?, ?, ?)",
            (number, outcome, time, author, role),
        )
        if outcome == "confirmed":
            self._sql.execute(
                "UPDATE pointers SET confirmed = ? "
                "WHERE recipe = (SELECT recipe FROM revisions WHERE number = ?)",
                (number, number),
            )

    def begin_after(self, number: int) -> None:
        """Give the next revision a greater number than this; only for a list that is empty."""
        self._sql.execute("DELETE FROM sqlite_sequence WHERE name = 'revisions'")
        self._sql.execute("INSERT INTO sqlite_sequence VALUES ('revisions', ?)", (number,))

    def pointers(self, recipe: str) -> Pointers:
        """What is active and what confirmed, for a recipe."""
        row = self._sql.execute(
            "SELECT active, COALESCE(confirmed, 0) FROM pointers WHERE recipe = ?", (recipe,)
        ).fetchone()
        return Pointers(*row) if row else Pointers(0, 0)

    def unsettled(self) -> list[int]:
        """Numbers of those of which nothing has become yet, whatever the recipe."""
        rows = self._sql.execute(
            f"SELECT number FROM revisions r WHERE {_OUTCOME} IS NULL ORDER BY number"
        )
        return [number for (number,) in rows]

    def get(self, number: int) -> Revision:
        """Read one.

        Raises
        ------
        NoSuchRevision
            When there is none with this number.
        """
        found, _ = self.before(number + 1, 1)
        if not found or found[0].number != number:
            (newest,) = self._sql.execute("SELECT MAX(number) FROM revisions").fetchone()
            raise NoSuchRevision(
                f"there is no revision {number}; "
                + (f"there are 1 to {newest}" if newest else "none has been stored yet")
            )
        return found[0]

    def table(self, number: int) -> Table:
        """Read the table of a revision.

        Raises
        ------
        NoSuchRevision, StoreCorrupt
        """
        self.get(number)
        (content,) = self._sql.execute(
            "SELECT content FROM revisions WHERE number = ?", (number,)
        ).fetchone()
        return read_table(self._sql, content, f"revision {number}")

    def before(
        self, number: int, count: int, largest: int | None = None
    ) -> tuple[list[Revision], bool]:
        """Read revisions below a number, newest first; from the newest if it is 0.

        Parameters
        ----------
        largest
            No further one is read once what they changed has so many characters; None for no such
            bound.

        Returns
        -------
        list of Revision, bool
            At most ``count``, and whether there are older ones.
        """
        rows = self._sql.execute(
            f"SELECT {_COLUMNS} FROM revisions r WHERE ? = 0 OR number < ? "
            "ORDER BY number DESC LIMIT ?",
            (number, number, count + 1),
        )
        found: list[Revision] = []
        size = 0
        for row in rows:
            if len(found) == count or (largest is not None and size >= largest):
                return found, True
            found.append(_revision(row))
            size += len(row[_DIFF])
        return found, False

    # -- for a start ----------------------------------------------------------------------------

    def facts(self, recipe: str, machine: str) -> StoreFacts:
        """Collect what a start needs to know."""
        unreadable: list[str] = []
        confirmed = [
            kept
            for number in self._confirmed(recipe)
            if (kept := self._kept(number, unreadable)) is not None
        ]
        unconfirmed = [n for n in self.unsettled() if self.get(n).recipe == recipe]
        active = self.pointers(recipe).active
        return StoreFacts(
            active=self._kept(active, unreadable) if active in unconfirmed else None,
            confirmed=tuple(confirmed),
            unconfirmed=tuple(unconfirmed),
            edited=self._edited(recipe),
            older=self._older(recipe, unreadable),
            sessions=self.sessions(),
            unreadable=tuple(dict.fromkeys(unreadable)),
            machine=machine,
        )

    def sessions(self) -> tuple[MonitorSession, ...]:
        """The last sessions of the monitor, newest first."""
        rows = self._sql.execute(
            "SELECT epoch, stack, machine, started, ended, revision, safe_mode FROM lives "
            "ORDER BY id DESC LIMIT ?",
            (SESSIONS,),
        )
        return tuple(MonitorSession(*row) for row in rows)

    def _confirmed(self, recipe: str) -> list[int]:
        rows = self._sql.execute(
            f"SELECT number FROM revisions r WHERE recipe = ? AND {_OUTCOME} = 'confirmed' "
            "ORDER BY number DESC LIMIT ?",
            (recipe, KEPT),
        )
        return [number for (number,) in rows]

    def _edited(self, recipe: str) -> bool:
        marks = ", ".join("?" * len(MADE_BY_PEOPLE))
        return bool(
            self._sql.execute(
                f"SELECT EXISTS (SELECT 1 FROM revisions r WHERE recipe = ? "
                f"AND origin IN ({marks}) AND {_OUTCOME} = 'confirmed')",
                (recipe, *MADE_BY_PEOPLE),
            ).fetchone()[0]
        )

    def _older(self, recipe: str, unreadable: list[str]) -> OlderEdits | None:
        """The newest edits that people made on another recipe."""
        rows = self._sql.execute(
            "SELECT recipe FROM revisions WHERE recipe != ? GROUP BY recipe "
            "ORDER BY MAX(number) DESC",
            (recipe,),
        ).fetchall()
        for (other,) in rows:
            if not self._edited(other):
                continue
            edited = self._kept(self._confirmed(other)[0], unreadable)
            (declared,) = self._sql.execute(
                "SELECT MAX(number) FROM revisions WHERE recipe = ? AND origin = 'recipe'", (other,)
            ).fetchone()
            original = self._kept(declared, unreadable) if declared else None
            if edited is not None and original is not None and edited.table != original.table:
                return OlderEdits(edited.number, original.table, edited.table)
        return None

    def _kept(self, number: int, unreadable: list[str]) -> KeptRevision | None:
        revision = self.get(number)
        try:
            table = self.table(number)
        except StoreCorrupt as error:
            unreadable.append(str(error))
            return None
        return KeptRevision(number, table, revision.author, revision.time, revision.origin)


def _revision(row: tuple[object, ...]) -> Revision:
    data = dict(zip((*_STORED, "outcome"), row, strict=True))
    diff = TableDiff.model_validate_json(str(data["diff"]))
    data["diff"] = diff.model_copy(update={"after": data["number"]})
    return Revision.model_validate(data)
