"""One process at a time writes a store."""

import contextlib
import fcntl
import os
from pathlib import Path

from kompass.store.errors import StoreBusy, StoreUnwritable


def take_lock(folder: Path, name: str, what: str) -> int:
    """Take a lock of a folder until the descriptor is closed, or the process ends in any way.

    Parameters
    ----------
    name
        Of the lock's file.
    what
        It stands before, for people.

    Raises
    ------
    StoreBusy
        When another process has it; names that process.
    StoreUnwritable
        When the lock file cannot be made.
    """
    path = folder / name
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    except OSError as error:
        raise StoreUnwritable(
            f"cannot write {path}: {error.strerror}; give a folder that can be written, "
            "with --data-dir"
        ) from None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        holder = os.read(descriptor, 20).decode(errors="replace").strip()
        os.close(descriptor)
        who = f"process {holder}" if holder else "another process"
        raise StoreBusy(
            f"the {what} in {folder} is in use by {who}; stop that stack, or give this one a "
            "name (--name) or a folder (--data-dir) of its own"
        ) from None
    with contextlib.suppress(OSError):  # a full disk: who holds the lock is told to people only
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, str(os.getpid()).encode(), 0)
    return descriptor
