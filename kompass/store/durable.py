"""What has a name in a folder is complete, and keeps it through a power cut."""

import os
from contextlib import suppress
from pathlib import Path


def write_whole(path: Path, data: bytes) -> None:
    """Put a file in the place of another, readable for its owner only; or leave all as it was.

    Raises
    ------
    OSError
        The disk cannot be written.
    """
    growing = path.with_name(f"{path.name}.new")
    growing.unlink(missing_ok=True)
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
    try:
        with os.fdopen(os.open(growing, flags, 0o600), "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        growing.rename(path)
    except OSError:
        growing.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """Bring the names in a folder to the disk."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with suppress(OSError):  # not every file system can; then there is nothing more to do
            os.fsync(descriptor)
    finally:
        os.close(descriptor)
