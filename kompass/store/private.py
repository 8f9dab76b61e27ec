"""What a robot keeps is its owner's alone, whatever the umask says."""

import os
from pathlib import Path

FOLDER_MODE = 0o700
FILE_MODE = 0o600


def private_folder(folder: Path) -> None:
    """Make a folder, and those above it that are missing, for their owner only.

    Raises
    ------
    OSError
        When it cannot be made, or something else has its name.
    """
    if folder.is_dir():
        return
    if folder.parent != folder:
        private_folder(folder.parent)
    folder.mkdir(mode=FOLDER_MODE, exist_ok=True)


def private_opener(path: str, flags: int) -> int:
    """For ``open(..., opener=private_opener)``: a file that is made is for its owner only."""
    return os.open(path, flags, FILE_MODE)
