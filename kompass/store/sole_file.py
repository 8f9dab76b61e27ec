"""A SQLite file that one process at a time has, and any of its threads may use."""

from __future__ import annotations

import os
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from kompass.store.database import Format, open_alone, open_read_only, transaction
from kompass.store.errors import StoreClosed, StoreCorrupt, StoreUnwritable


class SoleFile:
    """Opened as :func:`kompass.store.database.open_alone` does.

    Parameters
    ----------
    else_read
        Where it cannot be written it is read as it was left.

    Attributes
    ----------
    unwritable
        Why it is only read; empty when it can be written.
    sql
        To be used within :meth:`reading` and :meth:`writing` only.
    notice
        What an operator must hear of the file: that it was damaged and is set aside; else empty.
    """

    def __init__(
        self, path: Path, kind: Format, lock: str, what: str, *, else_read: bool = False
    ) -> None:
        self._path, self._what = path, what
        self._guard = threading.RLock()
        self._lock: int | None = None
        self.unwritable = ""
        try:
            self._lock, self.sql, self.notice = open_alone(path, kind, lock, what)
        except StoreUnwritable as error:
            if not else_read:
                raise
            try:
                self.sql, self.notice = open_read_only(path, kind), ""
            except StoreCorrupt:
                raise error from None
            self.unwritable = str(error)
        self._closed = False

    def close(self) -> None:
        """Close the file; nothing is lost by not doing so."""
        with self._guard:
            if not self._closed:
                self._closed = True
                self.sql.close()
                if self._lock is not None:
                    os.close(self._lock)

    @contextmanager
    def reading(self) -> Iterator[None]:
        """Look at what is stored.

        Raises
        ------
        StoreClosed
            When it was closed.
        StoreCorrupt
            When it cannot be read, or is no sense.
        """
        with self._guard:
            self._check_open()
            try:
                yield
            except (sqlite3.Error, ValueError) as error:
                raise StoreCorrupt(f"cannot read {self._path}: {error}; check the disk") from None

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Change what is stored: all of it, or nothing when something is raised.

        Raises
        ------
        StoreError
            When it could not be stored.
        """
        with self._guard:
            self._check_open()
            if self.unwritable:
                raise StoreUnwritable(self.unwritable)
            with transaction(self.sql, self._path):
                yield

    def _check_open(self) -> None:
        if self._closed:
            raise StoreClosed(f"the {self._what} is closed")
