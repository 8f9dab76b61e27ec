"""Open a SQLite file so that it is whole, ours and of this release's schema, or say why not."""

from __future__ import annotations

import logging
import os
import shutil
import sqlite3
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Literal, NamedTuple
from urllib.parse import quote

from kompass.store.durable import sync_folder
from kompass.store.errors import StoreCorrupt, StoreTooNew, StoreUnwritable
from kompass.store.lock import take_lock
from kompass.store.private import private_folder

_logger = logging.getLogger("kompass.store")
BUSY_TIMEOUT = 5.0  # s; nobody else writes, but a person may look with another tool
COMPANIONS = ("-wal", "-shm", "-journal")
_DAMAGE = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)

_NO_ROOM = (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR, sqlite3.SQLITE_CANTOPEN)


class Format(NamedTuple):
    """What kind of file it is.

    Attributes
    ----------
    application
        The number that marks the file as ours.
    steps
        SQL that leads from each version of the schema to the next.
    synchronous
        ``FULL``: a commit has reached the disk. ``NORMAL``: it survives the death of the process,
        and perhaps not a power cut.
    """

    application: int
    steps: Sequence[str]
    synchronous: Literal["FULL", "NORMAL"]


class _Damaged(Exception):
    pass


def open_database(path: Path, kind: Format) -> tuple[sqlite3.Connection, str]:
    """Open a file, made or brought up to date where needed.

    A damaged file is set aside, and a new one made; the second item is then the sentence that says
    so (empty otherwise).

    Raises
    ------
    StoreTooNew
        When a newer release has written the file; it is left alone.
    StoreUnwritable
        When it cannot be read or written.
    """
    notice = ""
    try:
        try:
            return _open(path, kind), notice
        except _Damaged as damage:
            aside = _set_aside(path)
            notice = f"{path.name} was damaged ({damage}) and has been set aside as {aside}"
            _logger.error("%s", notice)
        return _open(path, kind), notice
    except _Damaged as damage:
        raise StoreCorrupt(
            f"{path} is damaged ({damage}) right after it was made; "
            "check the disk, or choose another with --data-dir"
        ) from None
    except (sqlite3.Error, OSError) as error:
        raise unwritable(path, error) from None


def open_alone(
    path: Path, kind: Format, lock: str, what: str
) -> tuple[int, sqlite3.Connection, str]:
    """Open a file that one process at a time has; its folder is made when missing.

    Parameters
    ----------
    lock
        Name of the file that is locked beside it.
    what
        It is, for people.

    Returns
    -------
    tuple
        The descriptor that holds the lock until it is closed, and what :func:`open_database` gives.

    Raises
    ------
    StoreBusy
        When another process has it.
    StoreTooNew, StoreUnwritable
        As :func:`open_database`.
    """
    try:
        private_folder(path.parent)
    except OSError as error:
        raise unwritable(path.parent, error) from None
    held = take_lock(path.parent, lock, what)
    try:
        return held, *open_database(path, kind)
    except BaseException:
        os.close(held)
        raise


def unwritable(path: Path, error: Exception) -> StoreUnwritable:
    """The error for a file that SQLite or the system cannot write."""
    code = getattr(error, "sqlite_errorcode", 0) & 0xFF
    remedy = {
        sqlite3.SQLITE_FULL: "free some space on the disk",
        sqlite3.SQLITE_READONLY: "make the disk and the file writable",
    }.get(code, "give a folder that can be written, with --data-dir")
    text = getattr(error, "strerror", None) or str(error)
    return StoreUnwritable(f"cannot write {path}: {text}; {remedy}")


def open_read_only(path: Path, kind: Format) -> sqlite3.Connection:
    """Open a file that nobody can write, as it was left: of a disk that is read-only, say.

    Raises
    ------
    StoreTooNew
        When a newer release has written it.
    StoreCorrupt
        When it is not there, or cannot be read as it is.
    """
    # Without the log's companions SQLite reads only what it is told will never change.
    how = "mode=ro" if _size(path, "-wal") else "immutable=1"
    try:
        connection = _connect(f"file:{quote(str(path))}?{how}", uri=True)
        try:
            _examine(connection, path, kind)
            (version,) = connection.execute("PRAGMA user_version").fetchone()
            if version < len(kind.steps):
                raise _Damaged("it is of an older release, and cannot be brought up to date here")
        except BaseException:
            connection.close()
            raise
    except (_Damaged, sqlite3.Error) as error:
        raise StoreCorrupt(f"cannot read {path}: {error}; check the disk") from None
    return connection


@contextmanager
def transaction(connection: sqlite3.Connection, path: Path) -> Iterator[None]:
    """All of it or nothing; durable when the block is left, as far as the format says.

    Raises
    ------
    StoreUnwritable
        When it could not be written; nothing of it was.
    StoreCorrupt
        When the file is found to be damaged.
    """
    try:
        connection.execute("BEGIN IMMEDIATE")
        try:
            yield
            connection.execute("COMMIT")
        except BaseException:
            # SQLite itself has rolled back after some errors; there is then nothing left to do.
            if connection.in_transaction:
                connection.execute("ROLLBACK")
            raise
    except sqlite3.Error as error:
        if getattr(error, "sqlite_errorcode", 0) & 0xFF in _DAMAGE:
            raise StoreCorrupt(
                f"{path} is damaged ({error}); it is set aside when the stack is started next"
            ) from None
        raise unwritable(path, error) from None


def _open(path: Path, kind: Format) -> sqlite3.Connection:
    if not path.exists():
        if any(_size(path, companion) for companion in COMPANIONS):
            raise _Damaged("the file is gone, and only its write-ahead log is left")
        _make(path, kind)
    elif path.stat().st_size == 0:
        # Ours are complete before they have this name.
        raise _Damaged("the file is empty")
    try:
        return _opened(path, kind)
    except sqlite3.DatabaseError as error:
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        if code in _DAMAGE:
            raise _Damaged(str(error)) from None
        if code not in _NO_ROOM:
            raise
        # A full disk has no room for the write-ahead log's shared memory; who is alone needs none.
        return _opened(path, kind, alone=True)


def _opened(path: Path, kind: Format, *, alone: bool = False) -> sqlite3.Connection:
    connection = _connect(path)
    try:
        if alone:
            connection.execute("PRAGMA locking_mode = EXCLUSIVE")
        _configure(connection, kind)
        _examine(connection, path, kind)
        _migrate(connection, kind)
    except BaseException:
        connection.close()
        raise
    return connection


def _connect(path: Path | str, *, uri: bool = False) -> sqlite3.Connection:
    return sqlite3.connect(
        path, timeout=BUSY_TIMEOUT, isolation_level=None, check_same_thread=False, uri=uri
    )


def _configure(connection: sqlite3.Connection, kind: Format) -> None:
    connection.execute(f"PRAGMA synchronous = {kind.synchronous}")
    connection.execute("PRAGMA foreign_keys = ON")
    connection.execute("PRAGMA journal_size_limit = 1048576")


def _examine(connection: sqlite3.Connection, path: Path, kind: Format) -> None:
    (application,) = connection.execute("PRAGMA application_id").fetchone()
    if application != kind.application:
        raise _Damaged("it is not a file of this kind")
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    if version > len(kind.steps):
        raise StoreTooNew(
            f"{path} was written by a newer release (schema {version}, this one knows "
            f"{len(kind.steps)}); install that release, or move the file away"
        )
    (found,) = connection.execute("PRAGMA integrity_check(1)").fetchone()
    if found != "ok":
        raise _Damaged(" ".join(str(found).split()))


def _migrate(connection: sqlite3.Connection, kind: Format) -> None:
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    for number, step in enumerate(kind.steps[version:], version + 1):
        connection.executescript(f"BEGIN IMMEDIATE; {step} PRAGMA user_version = {number}; COMMIT;")


def _make(path: Path, kind: Format) -> None:
    """Make the file under another name first: what has the name is always complete."""
    private_folder(path.parent)
    growing = path.with_name(f"{path.name}.new")
    for name in (growing, *(Path(f"{growing}{companion}") for companion in COMPANIONS)):
        name.unlink(missing_ok=True)
    connection = _connect(growing)
    try:
        _configure(connection, kind)
        connection.execute(f"PRAGMA application_id = {kind.application}")
        _migrate(connection, kind)
        connection.execute("PRAGMA journal_mode = WAL")
    finally:
        connection.close()
    growing.chmod(0o600)
    growing.rename(path)
    for folder in (path.parent, path.parent.parent):
        sync_folder(folder)


def _set_aside(path: Path) -> Path:
    """Rename a damaged file and what belongs to it, so that a person can still look into it."""
    stamp = time.strftime("%Y%m%dT%H%M%S", time.gmtime())
    aside, number = path.with_name(f"{path.name}.corrupt-{stamp}"), 1
    while any(Path(f"{aside}{companion}").exists() for companion in ("", *COMPANIONS)):
        number += 1
        aside = path.with_name(f"{path.name}.corrupt-{stamp}-{number}")
    for companion in ("", *COMPANIONS):
        source = Path(f"{path}{companion}")
        if source.exists():
            shutil.move(source, f"{aside}{companion}")
    return aside


def _size(path: Path, companion: str) -> int:
    try:
        return Path(f"{path}{companion}").stat().st_size
    except FileNotFoundError:
        return 0
