"""Where recordings are on disk, and which names they may have."""

import os
import re
from collections.abc import Mapping
from pathlib import Path

from kompass.store.paths import robot_folder

MAX_NAME = 100
SUFFIX = ".mcap"


class BadName(ValueError):
    """Not the name of a recording; the message names it, says why, and what to do."""


def recordings_folder(environment: Mapping[str, str] = os.environ) -> Path:
    """Folder of all recordings of the robot that the environment names.

    Raises
    ------
    StoreUnwritable
        When there is neither a data folder nor a home folder.
    """
    return robot_folder(environment) / "recordings"


def rotation_folder(recordings: Path) -> Path:
    """Where the newest quarter of an hour is."""
    return recordings / "ring"


def saved_folder(recordings: Path) -> Path:
    """Where kept clips are."""
    return recordings / "saved"


def saved_path(recordings: Path, name: str) -> Path:
    """Where a clip of this name is kept.

    Raises
    ------
    BadName
        When the name could leave the folder, or be hidden in it.
    """
    bare = name.removesuffix(SUFFIX)
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9 _.,+-]*", bare) or len(bare) > MAX_NAME:
        raise BadName(
            f"name = {name[:MAX_NAME]!r} cannot be the name of a recording; begin it with a letter "
            f"or a digit, go on with these, spaces and _ - . , + only, {MAX_NAME} at most"
        )
    return saved_folder(recordings) / f"{bare.rstrip(' .')}{SUFFIX}"


def known_recording(recordings: Path, text: str) -> Path:
    """The recording that a name, or a path within the folder of recordings, stands for.

    Raises
    ------
    BadName
        When it lies elsewhere, or does not exist.
    """
    root = recordings.resolve()
    given = Path(text)
    candidates = [given] if given.is_absolute() else [root / given, saved_folder(root) / given]
    candidates += [path.with_name(path.name + SUFFIX) for path in candidates]
    for path in candidates:
        found = path.resolve()
        if not found.is_relative_to(root):
            continue
        if found.suffix == SUFFIX and found.is_file():
            return found
    raise BadName(
        f"recording = {text!r} is none of the robot's; it must be the name of a kept stretch, or "
        f"the path of an {SUFFIX} file below {root}"
    )
