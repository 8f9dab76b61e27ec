"""Writes the audit log, beside everything else: nobody ever waits for its disk."""

from __future__ import annotations

import contextlib
import fcntl
import logging
import os
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from kompass.store.private import FILE_MODE, private_folder
from kompass_console.audit.files import (
    LARGEST_FILE,
    MOST_FILES,
    file_from,
    following,
    log_files,
    make_room,
    read_end,
    read_tail,
    write_end,
)
from kompass_console.audit.line import AuditEntry, ChainLink, digest, encode, link_of

_logger = logging.getLogger(__name__)

_MOST_WAITING = 2_000  # lines that memory holds while the disk takes none
_BATCH = 200
_RETRY = 2.0  # s
_HANGING = 2.0  # s that a write may take before people are told
_CLOSING = 1.0  # s that the last lines may take when the console ends
LOCK = "audit.lock"

CONSOLE = "console"  # who writes the lines about the log itself
ITSELF = "audit log"  # what these lines are about


class AuditLog:
    """Appends lines to the log in a folder, from a thread of its own.

    Several consoles of one robot may write the same log: each batch is written under a lock, from
    where the log then ends. Lines are on the disk (fdatasync) before the end of the log is noted.

    Parameters
    ----------
    folder
        Is made when the first line is written; None when there is nowhere to write.
    largest_file, most_files
        Bytes after which another file begins, and how many there are before the oldest goes.
    waiting
        Lines that are held while the disk takes none; further ones are counted and lost.
    """

    def __init__(
        self,
        folder: Path | None,
        *,
        largest_file: int = LARGEST_FILE,
        most_files: int = MOST_FILES,
        waiting: int = _MOST_WAITING,
        now: Callable[[], float] = time.time,
    ) -> None:
        self.folder = folder
        self._largest_file = largest_file
        self._most_files = most_files
        self._most_waiting = waiting
        self._now = now
        self._change = threading.Condition()
        self._queue: deque[AuditEntry] = deque()
        self._lost = 0
        self._closing = False
        self._failure = ""
        self._gone = ""  # what is missing of the log; said until the console ends
        self._writing_since: float | None = None
        # Of the writer alone:
        self._last: ChainLink | None = None
        self._size = -1
        self._file: Path | None = None
        self._thread: threading.Thread | None = None
        if folder is None:
            self._failure = "there is no folder for it; set KOMPASS_DATA_DIR"
            _logger.error("no audit log is kept: %s", self._failure)
        else:
            self._thread = threading.Thread(target=self._run, name="audit", daemon=True)
            self._thread.start()

    def append(self, entry: AuditEntry) -> None:
        """Have a line written. Returns at once; any thread."""
        with self._change:
            if self._thread is None:
                return
            if len(self._queue) >= self._most_waiting:
                self._lost += 1
                return
            self._queue.append(entry)
            self._change.notify_all()

    def settle(self, longest: float) -> None:
        """Wait until what was appended so far is written, or cannot be, ``longest`` [s] at most.

        Any thread but the writer's.
        """
        with self._change:
            self._change.wait_for(lambda: not self._queue or bool(self._failure), longest)

    @property
    def problem(self) -> str:
        """What people should know: why the log is not written, what of it is missing. Else empty.

        Any thread; takes no lock that the disk could hold.
        """
        since = self._writing_since
        why = self._failure
        if not why and since is not None and time.monotonic() - since > _HANGING:
            why = "the disk does not answer"
        if why:
            waiting, lost = len(self._queue), self._lost
            tail = f" {waiting} lines wait, {lost} are lost." if waiting or lost else ""
            return f"The audit log is not written: {why}.{tail}"
        return self._gone

    def close(self) -> None:
        """Write what waits, unless the disk refuses or takes longer than a second."""
        thread = self._thread
        if thread is None:
            return
        with self._change:
            self._closing = True
            self._change.notify_all()
        thread.join(_CLOSING)
        left = len(self._queue) + self._lost
        if left:
            _logger.error("%d lines of the audit log were never written", left)

    def _run(self) -> None:
        while True:
            with self._change:
                while not self._queue and not self._closing:
                    self._change.wait()
                batch = list(self._queue)[:_BATCH]
                lost = self._lost if len(batch) == len(self._queue) else 0
                closing = self._closing
            if not batch and not lost:
                return
            self._writing_since = time.monotonic()
            try:
                self._write(batch + self._told(lost))
            except OSError as error:
                self._failed(error)
                if closing:
                    return
            else:
                self._worked(len(batch), lost)
            finally:
                self._writing_since = None
            if self._failure:
                with self._change:
                    self._change.wait_for(lambda: self._closing, _RETRY)

    def _told(self, lost: int) -> list[AuditEntry]:
        if not lost:
            return []
        return [self._own(f"{lost} lines are lost: the disk took none, and no more could wait")]

    def _own(self, outcome: str, **details: object) -> AuditEntry:
        return AuditEntry(self._now(), CONSOLE, "", "", "", ITSELF, outcome, details)

    def _failed(self, error: OSError) -> None:
        why = f"{error.strerror or error} ({error.filename or self.folder})"
        if why != self._failure:
            _logger.error("the audit log is not written: %s; it is tried again", why)
        with self._change:
            self._failure = why
            self._change.notify_all()
        self._size = -1  # whatever was written of it: look again

    def _worked(self, count: int, lost: int) -> None:
        with self._change:
            for _ in range(count):
                self._queue.popleft()
            self._lost -= lost
            self._change.notify_all()
        if self._failure:
            _logger.warning("the audit log is written again; %d lines were lost", lost)
        self._failure = ""

    def _write(self, entries: Sequence[AuditEntry]) -> None:
        assert self.folder is not None  # the writer runs for a folder only
        private_folder(self.folder)
        with _locked(self.folder):
            notes = self._continue(self.folder)
            seq, before = following(self._last)
            if self._file is None or self._size >= self._largest_file:
                self._file, self._size = file_from(self.folder, seq), 0
            text = bytearray()
            for entry in [*notes, *entries]:
                line = encode(entry, seq, before)
                text += line + b"\n"
                seq, before = seq + 1, digest(line)
            fresh = self._size == 0
            _append(self._file, bytes(text), self._size)
            self._size += len(text)
            self._last = ChainLink(seq - 1, "", before)
            try:
                if fresh:
                    make_room(self.folder, self._most_files)
                write_end(self.folder, self._last)
            except OSError as error:  # the lines are written: they must not be written again
                _logger.warning("beside the audit log: %s", error)

    def _continue(self, folder: Path) -> list[AuditEntry]:
        """Find where the log ends; what has to be said of it first."""
        files = log_files(folder)
        if files and files[-1] == self._file and self._file.stat().st_size == self._size:
            return []  # nobody else has written
        tail = read_tail(folder)
        notes: list[AuditEntry] = []
        known = self._last or read_end(folder)
        found = 0 if tail.last is None else tail.last.seq
        if known is not None and known.seq > found:
            # Gone on from where it was: the gap stays visible in the chain.
            self._last = known
            gone = f"lines {found + 1} to {known.seq} are gone from {folder}"
            notes.append(self._own(gone))
            self._gone = f"The audit log is not whole: {gone}."
            _logger.error("the audit log is not whole: %s", gone)
        else:
            self._last = tail.last
        self._file, self._size = tail.file, tail.size
        if tail.unended and tail.file is not None:
            # Torn by a crash or a full disk. Nothing is ever taken away.
            _append(tail.file, b"\n", tail.size)
            self._size = tail.size + 1
            if link_of(tail.unended) is None:
                said = f"healed: the {len(tail.unended)} bytes before are a line that was torn"
                _logger.warning("the audit log in %s: %s", tail.file, said)
                notes.insert(0, self._own(said, torn=digest(tail.unended)))
        return notes


def _append(file: Path, text: bytes, size: int) -> None:
    """Add to a file of this size, all or nothing, and bring it to the disk."""
    descriptor = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, FILE_MODE)
    try:
        try:
            left = memoryview(text)
            while left:
                left = left[os.write(descriptor, left) :]
            os.fdatasync(descriptor)
        except OSError as error:
            # What cannot be taken back either is healed as a torn line.
            with contextlib.suppress(OSError):
                os.ftruncate(descriptor, size)
            error.filename = str(file)
            raise
    finally:
        os.close(descriptor)


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """One console at a time; whoever dies lets go."""
    descriptor = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, FILE_MODE)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
