"""Small files that only their owner may read, written whole or not at all."""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Iterator
from pathlib import Path

from kompass.store.durable import sync_folder
from kompass.store.private import FILE_MODE, private_folder


@contextlib.contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Nobody else writes here for as long as the block lasts; the folder is made when missing.

    Raises
    ------
    OSError
        When it cannot be made or opened.
    """
    private_folder(folder)
    descriptor = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def replace_file(file: Path, text: str) -> None:
    """Put a new file in the place of one; on the disk when this returns.

    Raises
    ------
    OSError
        When it cannot be written; the old one is then as it was.
    """
    fresh = file.with_name(f".{file.name}.{os.getpid()}")
    fresh.unlink(missing_ok=True)
    try:
        descriptor = os.open(fresh, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, FILE_MODE)
        with os.fdopen(descriptor, "w", encoding="utf-8") as writing:
            writing.write(text)
            writing.flush()
            os.fsync(writing.fileno())
        fresh.replace(file)
    finally:
        fresh.unlink(missing_ok=True)
    sync_folder(file.parent)
