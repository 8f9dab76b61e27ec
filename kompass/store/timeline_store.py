"""The robot's timeline on disk: one SQLite file, bounded, the oldest of each kind left out.

A commit survives the death of the process; a power cut may take the last moments.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple, Self

from pydantic import ValidationError

from kompass.store.database import Format
from kompass.store.schema import TIMELINE, TIMELINE_ID
from kompass.store.sole_file import SoleFile
from kompass.timeline.entry import KINDS, LEVELS, TimelineEntry
from kompass.timeline.query import Slot, TimelinePage, TimelineQuery

FILE = "timeline.db"
LOCK = "timeline.lock"
FORMAT = Format(TIMELINE_ID, TIMELINE, "NORMAL")
MOST_OF_KIND = 10_000
_AT_ONCE = MOST_OF_KIND // 50  # left out at a time
_logger = logging.getLogger("kompass.store")


class Shelf(NamedTuple):
    """An alarm that somebody has put away until a time (s since the epoch)."""

    alarm: str
    until: float
    author: str


class TimelineStore:
    """Entries of one robot. All methods may be called from any thread.

    Attributes
    ----------
    notice
        What an operator must hear of the file: that it was damaged and is set aside; else empty.
    """

    def __init__(
        self, folder: Path, clock: Callable[[], float], most_of_kind: int = MOST_OF_KIND
    ) -> None:
        self._file = SoleFile(folder / FILE, FORMAT, LOCK, "timeline")
        self._sql, self.notice = self._file.sql, self._file.notice
        self._clock, self._most = clock, most_of_kind
        self._held = {
            kind: int(count)
            for kind, count in self._sql.execute("SELECT kind, COUNT(*) FROM entries GROUP BY kind")
        }

    @classmethod
    def open(cls, folder: Path, *, clock: Callable[[], float] = time.time) -> Self:
        """Open the timeline in a robot's folder (:func:`kompass.store.paths.robot_folder`).

        Parameters
        ----------
        clock
            Gives seconds since the epoch.

        Raises
        ------
        StoreBusy
            When another process has it open.
        StoreTooNew
            When a newer release has written it.
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

    # -- writing ------------------------------------------------------------------------------

    def put(self, entries: Iterable[TimelineEntry]) -> None:
        """Keep entries, in place of those of the same number.

        Raises
        ------
        StoreError
            When they could not be stored; none of them was.
        """
        held = dict(self._held)
        try:
            with self._file.writing():
                for entry in entries:
                    self._put(entry)
                self._trim()
        except BaseException:
            self._held = held
            raise

    def shelve(self, shelf: Shelf) -> None:
        """Remember that an alarm is put away; forget it when its time is over already.

        Raises
        ------
        StoreError
            When it could not be stored.
        """
        with self._file.writing():
            self._sql.execute("DELETE FROM shelves WHERE alarm = ?", (shelf.alarm,))
            self._sql.execute("DELETE FROM shelves WHERE until <= ?", (self._clock(),))
            if shelf.until > self._clock():
                self._sql.execute("INSERT INTO shelves VALUES (?, ?, ?)", shelf)

    # -- reading ------------------------------------------------------------------------------

    def newest(self) -> int:
        """Number of the newest entry; 0 for none.

        Raises
        ------
        StoreCorrupt
            When it cannot be read.
        """
        with self._file.reading():
            (number,) = self._sql.execute("SELECT COALESCE(MAX(number), 0) FROM entries").fetchone()
            return int(number)

    def lasting(self) -> list[TimelineEntry]:
        """What had not ended when it was written last.

        Raises
        ------
        StoreCorrupt
            When it cannot be read.
        """
        with self._file.reading():
            rows = self._sql.execute("SELECT json FROM entries WHERE lasts ORDER BY number")
            return _entries(rows.fetchall())

    def shelves(self) -> list[Shelf]:
        """The alarms that are put away now.

        Raises
        ------
        StoreCorrupt
            When they cannot be read.
        """
        with self._file.reading():
            rows = self._sql.execute(
                "SELECT alarm, until, author FROM shelves WHERE until > ?", (self._clock(),)
            )
            return [Shelf(*row) for row in rows.fetchall()]

    def page(self, query: TimelineQuery) -> TimelinePage:
        """What was asked for.

        Raises
        ------
        StoreCorrupt
            When it cannot be read.
        """
        where, values = _where(query)
        with self._file.reading():
            rows = self._sql.execute(
                f"SELECT json FROM entries WHERE {where} AND (? = 0 OR number < ?) "
                "ORDER BY number DESC LIMIT ?",
                (*values, query.before, query.before, query.count + 1),
            ).fetchall()
            (oldest,) = self._sql.execute("SELECT COALESCE(MIN(time), 0) FROM entries").fetchone()
            slots = self._slots(query, where, values)
        return TimelinePage(
            entries=tuple(_entries(rows[: query.count])),
            more=len(rows) > query.count,
            slots=slots,
            oldest=oldest,
            problem=self.notice,
        )

    # -- pieces -------------------------------------------------------------------------------

    def _slots(self, query: TimelineQuery, where: str, values: tuple[Any, ...]) -> tuple[Slot, ...]:
        if not query.slots or query.until <= query.since:
            return ()
        width = (query.until - query.since) / query.slots
        # What began before that time and goes on into it counts at its beginning.
        rows = self._sql.execute(
            "SELECT kind, MAX(0, MIN(?, CAST((time - ?) / ? AS INTEGER))) AS slot, COUNT(*), "
            f"MAX(level) FROM entries WHERE {where} GROUP BY kind, slot ORDER BY kind, slot",
            (query.slots - 1, query.since, width, *values),
        ).fetchall()
        return tuple(
            Slot(kind=kind, slot=slot, count=count, level=LEVELS[level])
            for kind, slot, count, level in rows
        )

    def _put(self, entry: TimelineEntry) -> None:
        known = self._sql.execute(
            "SELECT kind FROM entries WHERE number = ?", (entry.number,)
        ).fetchone()
        words = " ".join((entry.title, entry.text, entry.source, entry.who)).lower()
        self._sql.execute(
            "INSERT OR REPLACE INTO entries VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
            (
                entry.number,
                entry.kind,
                LEVELS.index(entry.level),
                entry.time,
                entry.ended,
                entry.lasts,
                words,
                entry.model_dump_json(),
            ),
        )
        if known is None:
            self._held[entry.kind] = self._held.get(entry.kind, 0) + 1

    def _trim(self) -> None:
        """Leave out the oldest of each kind of which there are too many."""
        for kind in KINDS:
            over = self._held.get(kind, 0) - self._most
            if over <= 0:
                continue
            some = max(over, min(_AT_ONCE, self._most // 2))
            self._sql.execute(
                "DELETE FROM entries WHERE number IN "
                "(SELECT number FROM entries WHERE kind = ? ORDER BY number LIMIT ?)",
                (kind, some),
            )
            self._held[kind] -= some


def _where(query: TimelineQuery) -> tuple[str, tuple[Any, ...]]:
    parts, values = ["level >= ?"], [LEVELS.index(query.level)]
    more: list[Any] = []
    if query.kinds:
        parts.append(f"kind IN ({', '.join('?' * len(query.kinds))})")
        more += query.kinds
    if query.text:
        parts.append("instr(words, ?)")
        more.append(query.text.lower())
    if query.since:
        parts.append("(time >= ? OR lasts OR ended >= ?)")
        more += [query.since, query.since]
    if query.until:
        parts.append("time <= ?")
        more.append(query.until)
    return " AND ".join(parts), (*values, *more)


def _entries(rows: Iterable[tuple[str]]) -> list[TimelineEntry]:
    """Entries from JSON; those that another release wrote and this one cannot read are left out."""
    found = []
    for (text,) in rows:
        try:
            found.append(TimelineEntry.model_validate_json(text))
        except ValidationError as error:
            _logger.error("an entry of the timeline cannot be read by this release: %s", error)
    return found
