"""The robot's own store of its rules: revisions, sessions of the monitor, and the journal.

Two SQLite files in the robot's folder. ``rules.db`` has the revisions; a call that changes it
returns when the change has reached the disk, and either all of it is stored or nothing.
``journal.db`` has the firings, and is written behind the engine's back.
"""

from __future__ import annotations

import logging
import os
import sqlite3
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Self

from kompass.rulebook.schema.journal import ActionRecord, FiringRecord, Journal
from kompass.rulebook.schema.revision import History, Origin, Revision
from kompass.rules.schema.table import Table, table_hash
from kompass.store.backup import backup_of, read_backup, write_backup
from kompass.store.boot import Boot, StoreFacts, choose
from kompass.store.database import Format, open_alone, transaction
from kompass.store.errors import (
    StaleRevision,
    StoreClosed,
    StoreCorrupt,
    StoreError,
    StoreUnwritable,
)
from kompass.store.journal import DEFAULT_BOUNDS, JournalBounds, JournalFile, Refusal
from kompass.store.rebuild import rebuild
from kompass.store.revisions import Outcome, RevisionEntry, Revisions
from kompass.store.schema import RULES, RULES_ID
from kompass.store.session import MONITOR, this_machine

_logger = logging.getLogger("kompass.store")
FILE = "rules.db"
LOCK = "store.lock"
FORMAT = Format(RULES_ID, RULES, "FULL")
HANGING = 0.5  # s after which a disk is not waited for


class RuleStore:
    """Revisions and journal of one robot. All methods may be called from any thread.

    Attributes
    ----------
    notices
        What an operator must hear of the files: that one was damaged and is set aside.
    """

    def __init__(self, folder: Path, bounds: JournalBounds, clock: Callable[[], float]) -> None:
        self._folder, self._path, self._clock = folder, folder / FILE, clock
        self._guard = threading.RLock()
        self._recipe, self._epoch, self._stack = Table(), "", ""
        self._active = self._confirmed = self._copied = 0
        # A start that the disk has not taken yet, and when it was.
        self._unnoted: tuple[Boot, float] | None = None
        self._lock, self._sql, notice = open_alone(self._path, FORMAT, LOCK, "rule store")
        try:
            self._journal = JournalFile(folder, bounds)
        except BaseException:
            self._sql.close()
            os.close(self._lock)
            raise
        self._revisions, self._closed = Revisions(self._sql), False
        lost = self._begin_after_damage() if notice else ""
        notices = (lost, notice, self._journal.notice)
        self.notices = tuple(text for text in notices if text)

    @classmethod
    def open(
        cls,
        folder: Path,
        *,
        bounds: JournalBounds = DEFAULT_BOUNDS,
        clock: Callable[[], float] = time.time,
    ) -> Self:
        """Open the store in a robot's folder (:func:`kompass.store.paths.robot_folder`).

        Parameters
        ----------
        bounds
            Of the journal.
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
        return cls(folder, bounds, clock)

    def close(self) -> None:
        """Write what waits and let go of the files.

        Without :meth:`end_session` before it, a crash is assumed.
        """
        with self._guard:
            if self._closed:
                return
            if self._copied != self._confirmed:
                self.keep_copy()
            self._closed = True
            self._journal.close()
            self._sql.close()
            os.close(self._lock)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    # -- sessions ----------------------------------------------------------------------------------

    def facts(self, recipe_table: Table) -> StoreFacts:
        """What is stored, as :func:`kompass.store.boot.choose` wants it."""
        with self._reading():
            return self._revisions.facts(table_hash(recipe_table), this_machine())

    def begin_session(
        self, recipe_table: Table, *, epoch: str, stack: str, safe_mode: bool = False
    ) -> Boot:
        """Begin a session of the monitor: decide on the table, store the decision, note the start.

        Parameters
        ----------
        epoch
            Names this session; unlike any other.
        stack
            Names the run of the stack; the same for all sessions of its monitor.
        safe_mode
            Put the recipe's table in force, whatever is stored.

        Returns
        -------
        Boot
            With ``revision`` set (0 for a table that the disk did not take), and with what there is
            to say of the files in ``notice``.
        """
        now = self._clock()
        recipe = table_hash(recipe_table)
        boot = choose(self.facts(recipe_table), recipe_table, safe_mode, now)
        self._recipe, self._epoch, self._stack = recipe_table, epoch, stack
        self._unnoted = (boot, now)
        full = ""
        try:
            with self._writing():
                pass
        except StoreUnwritable as error:
            # What is confirmed can be read all the same. The start is noted with the next change.
            self._active = boot.revision or 0
            full = f"{error}; until then the rules can be used and not edited"
            _logger.error("%s", full)
        self._confirmed = self._copied = self._revisions.pointers(recipe).confirmed
        if not full and (boot.revision is None or self.notices):
            self._back_up()
        self._journal.abandon(epoch, now)
        notice = "\n".join(text for text in (full, *self.notices, boot.notice) if text)
        return boot._replace(revision=self._active, notice=notice)

    def has_recovered(self) -> bool:
        """Whether the disk has taken this start of the monitor; False while it takes nothing."""
        return self._unnoted is None

    def recover(self) -> None:
        """Try to write down a start that the disk has not taken.

        Raises
        ------
        StoreError
            When it still takes nothing.
        """
        with self._writing():
            pass
        self._confirmed = self._revisions.pointers(table_hash(self._recipe)).confirmed

    def _note_start(self, boot: Boot, now: float) -> None:
        """Write down a start of the monitor, and what it has decided."""
        for number in boot.taken_back:
            self._revisions.settle(number, "taken back", now, MONITOR, MONITOR)
        number = boot.revision or self._append_boot(boot, table_hash(self._recipe), now)
        self._sql.execute(
            "INSERT INTO lives (epoch, stack, machine, started, revision, safe_mode) "
            "VALUES (?, ?, ?, ?, ?, ?)",
            (self._epoch, self._stack, this_machine(), now, number, boot.safe_mode),
        )
        self._active = number

    def _append_boot(self, boot: Boot, recipe: str, now: float) -> int:
        pointers = self._revisions.pointers(recipe)
        known = bool(pointers.confirmed)
        number = self._revisions.append(
            boot.table,
            RevisionEntry(
                pointers.active or None,
                MONITOR,
                MONITOR,
                now,
                boot.reason,
                boot.origin,
                recipe,
                boot.restores,
            ),
        )
        # Safe mode lasts for one run: the next start must find what was confirmed before.
        outcome: Outcome = "superseded" if boot.safe_mode and known else "confirmed"
        self._revisions.settle(number, outcome, now, MONITOR, MONITOR)
        return number

    def end_session(self) -> None:
        """The monitor ends as it should."""
        with self._writing():
            self._sql.execute(
                "UPDATE lives SET ended = ? WHERE epoch = ?", (self._clock(), self._epoch)
            )

    # -- revisions ------------------------------------------------------------------------------

    @property
    def active(self) -> int:
        """Number of the revision in force; 0 before :meth:`begin_session`."""
        return self._active

    @property
    def confirmed(self) -> int:
        """Number of the revision that a start comes back to; 0 for none."""
        return self._confirmed

    def append(
        self,
        table: Table,
        *,
        author: str,
        role: str,
        reason: str = "",
        origin: Origin = "edit",
        parent: int | None = None,
        restores: int | None = None,
        confirmed: bool = False,
        copied: bool = True,
    ) -> Revision:
        """Store a table as the revision in force; returns only when it is on the disk.

        Parameters
        ----------
        parent
            Revision that it began from; the one in force if None.
        confirmed
            Whether it needs no confirmation: it then survives a restart.
        copied
            Whether a confirmed one is copied beside the database, too, before this returns; else
            :meth:`keep_copy` is to follow soon, and does at the latest when the store is closed.

        Raises
        ------
        StaleRevision
            When ``parent`` is not in force.
        StoreError
            When it could not be stored: nothing was changed.
        """
        with self._writing():
            if parent is not None and parent != self._active:
                raise StaleRevision(
                    f"the change began from revision {parent}, and {self._active} is in force; "
                    "look at what changed, and apply again"
                )
            now = self._clock()
            failed = origin in ("rollback", "taken back")
            for number in self._revisions.unsettled():
                self._revisions.settle(
                    number, "taken back" if failed else "superseded", now, author, role
                )
            number = self._revisions.append(
                table,
                RevisionEntry(
                    self._active or None,
                    author,
                    role,
                    now,
                    reason,
                    origin,
                    table_hash(self._recipe),
                    restores,
                ),
            )
            if confirmed:
                self._revisions.settle(number, "confirmed", now, author, role)
            self._sql.execute(
                "UPDATE lives SET revision = ? WHERE epoch = ?", (number, self._epoch)
            )
            revision = self._revisions.get(number)
        # Only now: what was not committed is not in force.
        self._active = number
        if confirmed:
            self._confirmed = number
            if copied:
                self._back_up()
        return revision

    def keep_copy(self) -> None:
        """Bring the copy of the confirmed table, for a damaged database, up to date.

        What hinders it is logged, for the database has the table.
        """
        try:
            self._back_up()
        except StoreError as error:
            _logger.error("the confirmed table is not copied beside the database: %s", error)

    def take_back(self, reason: str, *, author: str = MONITOR, role: str = MONITOR) -> Revision:
        """Put the confirmed revision in force again, as a new and confirmed one.

        Raises
        ------
        StoreError
            When it could not be stored: nothing was changed.
        """
        with self._guard:
            return self.append(
                self.table(self._confirmed),
                author=author,
                role=role,
                reason=reason,
                origin="taken back",
                restores=self._confirmed,
                confirmed=True,
            )

    def set_confirmed(self, number: int, *, author: str, role: str) -> Revision:
        """Keep the revision in force; returns only when that is on the disk.

        Raises
        ------
        StaleRevision
            When another is in force.
        StoreError
            When it could not be stored: nothing was changed.
        """
        with self._writing():
            if number != self._active:
                raise StaleRevision(
                    f"revision {number} is not in force, {self._active} is; only the one in force "
                    "can be confirmed"
                )
            if self._revisions.get(number).outcome != "confirmed":
                self._revisions.settle(number, "confirmed", self._clock(), author, role)
            revision = self._revisions.get(number)
        self._confirmed = number
        self._back_up()
        return revision

    def revision(self, number: int) -> Revision:
        """Who made a revision, when and why, and what it changed.

        Raises
        ------
        NoSuchRevision
        """
        with self._reading():
            return self._revisions.get(number)

    def table(self, number: int) -> Table:
        """The table of a revision.

        Raises
        ------
        NoSuchRevision
        StoreCorrupt
            When it is damaged.
        """
        with self._reading():
            return self._revisions.table(number)

    def history(self, before: int = 0, count: int = 50, largest: int | None = None) -> History:
        """Revisions below a number, newest first; from the newest if it is 0.

        Fewer than ``count`` where what they changed has more than ``largest`` characters.
        """
        with self._reading():
            found, more = self._revisions.before(before, count, largest)
        return History(
            active=self._active, confirmed=self._confirmed, revisions=tuple(found), more=more
        )

    # -- the journal, of this session of the monitor and of this stack ------------------------

    def record_firing(self, entry: FiringRecord) -> FiringRecord:
        """Add an entry to the journal, at once and without waiting; the same with its number."""
        return self._journal.record(entry)

    def finish_firing(
        self,
        number: int,
        *,
        ended: float,
        ok: bool,
        error: str = "",
        actions: Sequence[ActionRecord] = (),
    ) -> None:
        """Say how a run ended; ``ended`` in seconds since the epoch."""
        changes = {"ended": ended, "ok": ok, "error": error, "actions": tuple(actions)}
        self._journal.change(number, changes)

    def keep_recording(self, number: int, path: str) -> None:
        """Note the recording that was kept around a firing."""
        self._journal.change(number, {"recording": path})

    def journal(self, before: int = 0, count: int = 100, rule_id: str = "") -> Journal:
        """Entries below a number, newest first; from the newest if it is 0.

        Waits for entries that are being written: call it where waiting for a disk does no harm.
        """
        return self._journal.before(before, count, rule_id)

    def firing(self, epoch: str, run_id: int, rule_id: str = "") -> FiringRecord | None:
        """The entry of a run; None if the journal does not keep it any more. Waits as above."""
        return self._journal.run(epoch or self._epoch, run_id, rule_id)

    def near_misses(self, rule_id: str, count: int = 10) -> tuple[FiringRecord, ...]:
        """When a rule came close and did not fire, newest first. Waits as above."""
        return self._journal.kinds(rule_id, "near miss", count)

    @property
    def lost_entries(self) -> int:
        """Number of entries that the disk did not take since the start."""
        return self._journal.lost

    @property
    def journal_trouble(self) -> str:
        """Why the last entries could not be written; empty when they were."""
        return self._journal.trouble

    def refuse(self, *, author: str, role: str, what: str, text: str) -> None:
        """Note what a guard rail forbade."""
        self._journal.refuse(Refusal(self._clock(), author, role, what, text))

    def refusals(self, count: int = 100) -> list[Refusal]:
        """What guard rails forbade, newest first. Waits as above."""
        return self._journal.refusals(count)

    def use_once(self, rule_id: str, rule_hash: str) -> None:
        """Remember that a ``once`` rule has fired in this run of the stack.

        Unlike all else in the journal it is written before this returns, so that who is killed in
        the next moment has still had the one firing; a disk that hangs is not waited for.
        """
        self._journal.use(self._stack, rule_id, rule_hash, self._clock())
        self._journal.flush(HANGING)

    def reset_once(self, rule_id: str) -> None:
        """Let a ``once`` rule fire again in this run of the stack."""
        self._journal.forget_use(self._stack, rule_id)

    def used_once(self) -> set[tuple[str, str]]:
        """Ids and hashes of the ``once`` rules that have fired in this run of the stack."""
        return self._journal.used(self._stack)

    def flush(self, timeout: float = 5.0) -> bool:
        """Wait until the journal is written; whether it was within ``timeout`` seconds."""
        return self._journal.flush(timeout)

    # -- helpers --------------------------------------------------------------------------------

    def _begin_after_damage(self) -> str:
        with self._writing():
            return rebuild(
                self._revisions, read_backup(self._folder), self._journal.newest_revision()
            )

    def _back_up(self) -> None:
        """Keep the confirmed table beside the database too."""
        with self._guard:  # of two at a time the newer one is to stay
            revision = self.revision(self._confirmed)
            table = self.table(self._confirmed)
            write_backup(self._folder, backup_of(revision, table, self._recipe))
            self._copied = revision.number

    @contextmanager
    def _writing(self) -> Iterator[None]:
        with self._guard:
            self._check_open()
            if self._unnoted is not None:
                with transaction(self._sql, self._path):
                    self._note_start(*self._unnoted)
                self._unnoted = None
            with transaction(self._sql, self._path):
                yield

    @contextmanager
    def _reading(self) -> Iterator[None]:
        with self._guard:
            self._check_open()
            try:
                yield
            except sqlite3.Error as error:
                raise StoreCorrupt(f"cannot read {self._path}: {error}; check the disk") from None

    def _check_open(self) -> None:
        if self._closed:
            raise StoreClosed(f"the store {self._path} is closed")
