"""What has a name in a folder keeps it through a power cut."""

import os
from contextlib import suppress
from pathlib import Path


def sync_folder(folder: Path) -> None:
    """Bring the names in a folder to the disk."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with suppress(OSError):  # not every file system can; then there is nothing more to do
            os.fsync(descriptor)
    finally:
        os.close(descriptor)
