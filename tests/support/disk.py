"""Disks that are full, read-only or hang, without a disk of one's own to spoil."""

import resource
import sqlite3
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
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


class SmallDisk:
    """A disk of its own, with little room, in a name space of its own; seen through /proc."""

    def __init__(self, size: int) -> None:
        script = f"mount -t tmpfs -o size={size},mode=700 none /mnt && echo ready && exec sh"
        self._shell = subprocess.Popen(
            ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", script],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        if self._said() != "ready":
            self.close()
            pytest.skip("this machine lets nobody mount a disk of their own")
        self.folder = Path(f"/proc/{self._shell.pid}/root/mnt")
        self._ballast = self.folder / "ballast"

    def fill(self) -> None:
        """Leave no byte of room."""
        with self._ballast.open("wb", buffering=0) as file, suppress(OSError):
            while True:
                file.write(b"x" * 4096)

    def make_room(self) -> None:
        """Let there be room again."""
        self._ballast.unlink()

    def write_protect(self) -> None:
        """Let the disk become read-only."""
        self._do("mount -o remount,ro /mnt")

    def allow_writing(self) -> None:
        """Let the disk be written again."""
        self._do("mount -o remount,rw /mnt")

    def close(self) -> None:
        """Let it go."""
        for stream in (self._shell.stdin, self._shell.stdout):
            assert stream is not None
            stream.close()
        self._shell.wait(10)

    def _do(self, command: str) -> None:
        assert self._shell.stdin is not None
        self._shell.stdin.write(f"{command} && echo done || echo failed\n")
        self._shell.stdin.flush()
        assert self._said() == "done", command

    def _said(self) -> str:
        assert self._shell.stdout is not None
        return self._shell.stdout.readline().strip()


@pytest.fixture
def small_disk() -> Iterator[SmallDisk]:
    """A quarter of a megabyte."""
    disk = SmallDisk(256 * 1024)
    try:
        yield disk
    finally:
        disk.close()


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
