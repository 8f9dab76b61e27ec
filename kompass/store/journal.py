"""The journal of firings: written by a thread of its own, bounded, and allowed to lose its tail.

It lives in a file of its own, so that a flood of firings never delays or damages the revisions. The
engine hands an entry over and goes on; the thread writes all that has gathered in one commit. A
commit survives the death of the process; a power cut may take the last moments.
"""

from __future__ import annotations

import logging
import queue
import sqlite3
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import ValidationError

from kompass.rulebook.schema.journal import FiringRecord, Journal
from kompass.store.database import Format, open_database, transaction
from kompass.store.errors import StoreClosed, StoreCorrupt, StoreError
from kompass.store.schema import JOURNAL, JOURNAL_ID

FILE = "journal.db"
FORMAT = Format(JOURNAL_ID, JOURNAL, "NORMAL")
WAITING = 2000  # entries that may wait for the disk; more are lost, and counted
BATCH = 500
NUMBERS = 2 * WAITING  # reserved at a time, so that no number of a lost entry is used again
LARGEST = 256 * 1024  # bytes of one entry; a larger one is stored without its message
REFUSALS = 5000
COMPLAINT_PERIOD = 30.0  # s between two log lines on a disk that does not take entries

_logger = logging.getLogger("kompass.store")
_MINOR = ("shadow", "near miss")
_Work = Callable[[sqlite3.Connection], object]


@dataclass(frozen=True)
class JournalBounds:
    """How much the journal keeps.

    Shadows and near misses are counted apart from all others: there may be many of them, and they
    must not push out what really happened. ``size`` is in bytes, of each of the two.
    """

    count: int = 20_000
    size: int = 32 * 1024 * 1024


DEFAULT_BOUNDS = JournalBounds()


@dataclass(frozen=True)
class _Held:
    """Number of entries of one sort, and their bytes."""

    count: int
    size: int


class Refusal(NamedTuple):
    """Something that a guard rail forbade; ``time`` in seconds since the epoch."""

    time: float
    author: str
    role: str
    what: str
    text: str


class JournalFile:
    """The journal on disk. All methods may be called from any thread.

    Those that write return at once; those that read wait for what was handed over before, and
    belong into a thread that may wait for a disk.
    """

    def __init__(self, folder: Path, bounds: JournalBounds = DEFAULT_BOUNDS) -> None:
        self._path = folder / FILE
        self._bounds = bounds
        self._sql, self.notice = open_database(self._path, FORMAT)
        self._reading = threading.Lock()
        self._numbering = threading.Lock()
        self._queue: queue.Queue[_Work | threading.Event | None] = queue.Queue(WAITING)
        self._lost = 0
        self._trouble = ""
        self._complained = float("-inf")
        self._held = {minor: self._count(minor) for minor in (0, 1)}
        self._next = self._first_number()
        self._reserved = self._next
        self._closed = False
        self._reserve()
        self._thread = threading.Thread(target=self._write, name="journal", daemon=True)
        self._thread.start()

    def close(self, timeout: float = 5.0) -> None:
        """Write what waits, and close the file."""
        if self._closed:
            return
        with self._numbering:
            self._enqueue(lambda sql: sql.execute(_SET_COUNTER, (self._next - 1,)))
        self._closed = True
        with suppress(queue.Full):  # the disk hangs: the thread ends with the process
            self._queue.put(None, timeout=timeout)
        self._thread.join(timeout)
        if not self._thread.is_alive():
            with self._reading:
                self._sql.close()

    # -- writing ------------------------------------------------------------------------------

    def record(self, entry: FiringRecord) -> FiringRecord:
        """Add an entry; the same with its number."""
        with self._numbering:
            number, self._next = self._next, self._next + 1
            if self._reserved - self._next < WAITING:
                self._reserve()
        numbered = entry.model_copy(update={"number": number})
        self._hand_over(lambda sql: self._insert(sql, numbered))
        return numbered

    def change(self, number: int, changes: dict[str, Any]) -> None:
        """Change fields of an entry; one that is not kept any more is none."""
        self._hand_over(lambda sql: self._update(sql, number, changes))

    def abandon(self, epoch: str, at: float) -> None:
        """End the runs of all sessions but this: nobody will say how they ended."""

        def work(sql: sqlite3.Connection) -> None:
            rows = sql.execute("SELECT number FROM firings WHERE open AND epoch != ?", (epoch,))
            changes = {"ended": at, "ok": False, "error": "the monitor ended while it ran"}
            for (number,) in rows.fetchall():
                self._update(sql, number, changes)

        self._hand_over(work)

    def refuse(self, refusal: Refusal) -> None:
        """Add what a guard rail forbade."""

        def work(sql: sqlite3.Connection) -> None:
            sql.execute(
                "INSERT INTO refusals (time, author, role, what, text) VALUES (?, ?, ?, ?, ?)",
                refusal,
            )
            sql.execute(
                "DELETE FROM refusals WHERE number <= (SELECT MAX(number) FROM refusals) - ?",
                (REFUSALS,),
            )

        self._hand_over(work)

    def use(self, stack: str, rule_id: str, rule_hash: str, at: float) -> None:
        """Remember that a rule has had its one firing in this run of the stack."""

        def work(sql: sqlite3.Connection) -> None:
            sql.execute("DELETE FROM used WHERE stack != ?", (stack,))
            sql.execute(
                "INSERT OR IGNORE INTO used VALUES (?, ?, ?, ?)", (stack, rule_id, rule_hash, at)
            )

        self._hand_over(work)

    def forget_use(self, stack: str, rule_id: str) -> None:
        """Let a rule have its one firing again."""
        self._hand_over(
            lambda sql: sql.execute(
                "DELETE FROM used WHERE stack = ? AND rule_id = ?", (stack, rule_id)
            )
        )

    def flush(self, timeout: float = 5.0) -> bool:
        """Wait until all that was handed over is written; whether it was in time."""
        if threading.current_thread() is self._thread or self._closed:
            return self._closed
        done = threading.Event()
        deadline = time.monotonic() + timeout
        try:
            self._queue.put(done, timeout=timeout)
        except queue.Full:
            return False
        return done.wait(max(deadline - time.monotonic(), 0.0))

    # -- reading ------------------------------------------------------------------------------

    def before(self, number: int, count: int, rule_id: str = "") -> Journal:
        """Entries below a number, newest first; from the newest if it is 0; of one rule only."""
        rows = self._read(
            "SELECT json FROM firings WHERE (? = 0 OR number < ?) AND (? = '' OR rule_id = ?) "
            "ORDER BY number DESC LIMIT ?",
            (number, number, rule_id, rule_id, count + 1),
        )
        return Journal(firings=_entries(rows[:count]), more=len(rows) > count)

    def kinds(self, rule_id: str, kind: str, count: int) -> tuple[FiringRecord, ...]:
        """The newest entries of one kind of one rule."""
        rows = self._read(
            "SELECT json FROM firings WHERE rule_id = ? AND json_extract(json, '$.kind') = ? "
            "ORDER BY number DESC LIMIT ?",
            (rule_id, kind, count),
        )
        return _entries(rows)

    def run(self, epoch: str, run_id: int, rule_id: str = "") -> FiringRecord | None:
        """The entry of a run; None if it is not kept."""
        rows = self._read(
            "SELECT json FROM firings WHERE epoch = ? AND run_id = ? "
            "AND (? = '' OR rule_id = ?) ORDER BY number LIMIT 1",
            (epoch, run_id, rule_id, rule_id),
        )
        return next(iter(_entries(rows)), None)

    def refusals(self, count: int) -> list[Refusal]:
        """What guard rails forbade, newest first."""
        rows = self._read(
            "SELECT time, author, role, what, text FROM refusals ORDER BY number DESC LIMIT ?",
            (count,),
        )
        return [Refusal(*row) for row in rows]

    def newest_revision(self) -> int:
        """The greatest number of a revision that any entry tells of; 0 for none."""
        query = "SELECT COALESCE(MAX(json_extract(json, '$.revision')), 0) FROM firings"
        return int(self._read(query, ())[0][0])

    def used(self, stack: str) -> set[tuple[str, str]]:
        """Ids and hashes of the rules that have had their one firing in a run of the stack."""
        rows = self._read("SELECT rule_id, rule_hash FROM used WHERE stack = ?", (stack,))
        return {(rule_id, rule_hash) for rule_id, rule_hash in rows}

    @property
    def lost(self) -> int:
        """Number of entries that could not be written since the start."""
        return self._lost

    @property
    def trouble(self) -> str:
        """Why the last entries could not be written; empty when they were."""
        return self._trouble

    # -- the thread ---------------------------------------------------------------------------

    def _hand_over(self, work: _Work) -> None:
        if not self._enqueue(work):
            self._lose(1, "the disk is too slow")

    def _enqueue(self, work: _Work) -> bool:
        if self._closed:
            raise StoreClosed("the journal is closed")
        try:
            self._queue.put_nowait(work)
        except queue.Full:
            return False
        return True

    def _write(self) -> None:
        ended = False
        while not ended:
            batch = [self._queue.get()]
            while len(batch) < BATCH:
                try:
                    batch.append(self._queue.get_nowait())
                except queue.Empty:
                    break
            ended = batch[-1] is None
            self._commit([work for work in batch if callable(work)])
            for waiting in batch:
                if isinstance(waiting, threading.Event):
                    waiting.set()

    def _commit(self, batch: list[_Work]) -> None:
        held = dict(self._held)
        try:
            with self._reading, transaction(self._sql, self._path):
                for work in batch:
                    work(self._sql)
                self._trim()
        except StoreError as error:
            self._held = held
            self._trouble = str(error)
            self._lose(len(batch), str(error))
        else:
            if batch:
                self._trouble = ""

    def _lose(self, count: int, why: str) -> None:
        self._lost += count
        if time.monotonic() - self._complained >= COMPLAINT_PERIOD:
            self._complained = time.monotonic()
            _logger.error("%d entries of the journal are lost so far: %s", self._lost, why)

    def _insert(self, sql: sqlite3.Connection, entry: FiringRecord) -> None:
        minor = int(entry.kind in _MINOR)
        running = entry.kind == "firing" and entry.ended is None
        text = _text(entry)
        sql.execute(
            "INSERT INTO firings VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
            (
                entry.number,
                entry.epoch,
                entry.run_id,
                entry.rule_id,
                minor,
                running,
                len(text),
                text,
            ),
        )
        self._grow(minor, 1, len(text))

    def _update(self, sql: sqlite3.Connection, number: int, changes: dict[str, Any]) -> None:
        row = sql.execute(
            "SELECT json, minor, size FROM firings WHERE number = ?", (number,)
        ).fetchone()
        if row is None:
            return
        found = _entries([(row[0],)])
        if not found:
            return
        entry = found[0].model_copy(update=changes)
        text = _text(entry)
        sql.execute(
            "UPDATE firings SET json = ?, size = ?, open = ? WHERE number = ?",
            (text, len(text), entry.kind == "firing" and entry.ended is None, number),
        )
        self._grow(row[1], 0, len(text) - row[2])

    def _grow(self, minor: int, count: int, size: int) -> None:
        held = self._held[minor]
        self._held[minor] = _Held(held.count + count, held.size + size)

    def _trim(self) -> None:
        """Delete the oldest entries beyond the bounds, a fiftieth of them at a time."""
        oldest = "SELECT number FROM firings WHERE minor = ? ORDER BY number LIMIT ?"
        for minor in (0, 1):
            while True:
                count, size = self._held[minor].count, self._held[minor].size
                over = count - self._bounds.count
                if count == 0 or (over <= 0 and size <= self._bounds.size):
                    break
                some = (minor, min(max(count // 50, over, 1), count))
                (freed,) = self._sql.execute(
                    f"SELECT SUM(size) FROM firings WHERE number IN ({oldest})", some
                ).fetchone()
                self._sql.execute(f"DELETE FROM firings WHERE number IN ({oldest})", some)
                self._grow(minor, -some[1], -freed)

    # -- helpers ------------------------------------------------------------------------------

    def _read(self, query: str, values: tuple[Any, ...]) -> list[Any]:
        self.flush()
        try:
            with self._reading:
                return self._sql.execute(query, values).fetchall()
        except sqlite3.ProgrammingError:
            raise StoreClosed("the journal is closed") from None
        except sqlite3.Error as error:
            raise StoreCorrupt(f"cannot read {self._path}: {error}; check the disk") from None

    def _count(self, minor: int) -> _Held:
        query = "SELECT COUNT(*), COALESCE(SUM(size), 0) FROM firings WHERE minor = ?"
        return _Held(*self._sql.execute(query, (minor,)).fetchone())

    def _first_number(self) -> int:
        (newest,) = self._sql.execute("SELECT COALESCE(MAX(number), 0) FROM firings").fetchone()
        (reserved,) = self._sql.execute("SELECT reserved FROM counter").fetchone()
        return int(max(newest, reserved)) + 1

    def _reserve(self) -> None:
        wanted = self._next + NUMBERS
        if self._enqueue(lambda sql: sql.execute(_SET_COUNTER, (wanted,))):
            self._reserved = wanted


_SET_COUNTER = "UPDATE counter SET reserved = ?"


def _text(entry: FiringRecord) -> str:
    text = entry.model_dump_json()
    if len(text) <= LARGEST:
        return text
    said = f"{entry.text} (the message was too long to be kept)".strip()
    return entry.model_copy(update={"message": None, "text": said}).model_dump_json()


def _entries(rows: list[Any]) -> tuple[FiringRecord, ...]:
    """Entries from JSON; those that another release wrote and this one cannot read are left out."""
    entries = []
    for (text,) in rows:
        try:
            entries.append(FiringRecord.model_validate_json(text))
        except ValidationError as error:
            _logger.error("an entry of the journal cannot be read by this release: %s", error)
    return tuple(entries)
