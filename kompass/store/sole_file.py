"""A SQLite file that one process at a time has, and any of its threads may use."""

from __future__ import annotations

import os
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from kompass.store.database import Format, open_alone, transaction
from kompass.store.errors import StoreClosed, StoreCorrupt


class SoleFile:
    """Opened as :func:`kompass.store.database.open_alone` does.

    Attributes
    ----------
    sql
        To be used within :meth:`reading` and :meth:`writing` only.
    notice
        What an operator must hear of the file: that it was damaged and is set aside; else empty.
    """

    def __init__(self, path: Path, kind: Format, lock: str, what: str) -> None:
        self._path, self._what = path, what
        self._guard = threading.RLock()
        self._lock, self.sql, self.notice = open_alone(path, kind, lock, what)
        self._closed = False

    def close(self) -> None:
        """Close the file; nothing is lost by not doing so."""
        with self._guard:
            if not self._closed:
                self._closed = True
                self.sql.close()
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
            with transaction(self.sql, self._path):
                yield

    def _check_open(self) -> None:
        if self._closed:
            raise StoreClosed(f"the {self._what} is closed")
