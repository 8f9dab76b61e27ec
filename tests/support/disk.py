"""Disks that are full, read-only or hang, without a disk of one's own to spoil."""

import resource
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest


@contextmanager
def no_larger_than(size: int) -> Iterator[None]:
    """Let no file of this process grow beyond some bytes: the kernel refuses the write."""
    _, most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, most))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))


class Databases:
    """Every SQLite file that is opened while it watches; told by name how its disk behaves."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._opened: dict[str, sqlite3.Connection] = {}
        connect = sqlite3.connect

        def watched(database: Any, *args: Any, **kwargs: Any) -> sqlite3.Connection:
            connection: sqlite3.Connection = connect(database, *args, **kwargs)
            self._opened[Path(str(database).partition("?")[0]).name] = connection
            return connection

        monkeypatch.setattr(sqlite3, "connect", watched)

    def fill(self, name: str) -> None:
        """Let the disk have no room for more pages of a file."""
        self._opened[name].execute("PRAGMA max_page_count = 1")  # never below what it has

    def make_room(self, name: str) -> None:
        """Let it have room again."""
        self._opened[name].execute("PRAGMA max_page_count = 100000")

    def write_protect(self, name: str) -> None:
        """Let the disk become read-only."""
        self._opened[name].execute("PRAGMA query_only = 1")

    def allow_writing(self, name: str) -> None:
        """Let it be written again."""
        self._opened[name].execute("PRAGMA query_only = 0")

    @contextmanager
    def hanging(self, name: str) -> Iterator[None]:
        """Let whoever reads or writes a file wait until the end of the block."""
        goes_on = threading.Event()

        def wait() -> None:
            goes_on.wait(60)

        # It stays: to take it away would wait for whoever is in it, with the interpreter's lock.
        self._opened[name].set_progress_handler(wait, 10)
        try:
            yield
        finally:
            goes_on.set()


@pytest.fixture
def databases(monkeypatch: pytest.MonkeyPatch) -> Databases:
    """What is opened in this test."""
    return Databases(monkeypatch)
