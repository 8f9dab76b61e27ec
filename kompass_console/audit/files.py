"""Where the audit log is on disk: files by the number of their first line, and how they end."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from kompass.store.durable import sync_folder
from kompass.store.paths import robot_folder
from kompass.store.private import private_opener
from kompass_console.audit.line import BEGINNING, ChainLink, link_of

FOLDER = "audit"
LARGEST_FILE = 4_000_000  # bytes; the next line begins another file
MOST_FILES = 16  # the oldest goes first

_PREFIX, _SUFFIX = "audit-", ".jsonl"
_END = "end.json"


def audit_folder(environment: Mapping[str, str] = os.environ) -> Path:
    """Folder of the audit log of the robot that the environment names.

    Raises
    ------
    StoreUnwritable
        When there is neither a data folder nor a home folder.
    """
    return robot_folder(environment) / FOLDER


def log_files(folder: Path) -> list[Path]:
    """The files of a log, the oldest first.

    Raises
    ------
    OSError
        When the folder is there and cannot be read.
    """
    try:
        found = [path for path in folder.iterdir() if _is_ours(path.name)]
    except FileNotFoundError:
        return []
    return sorted(found, key=first_number)


def first_number(file: Path) -> int:
    """Number of the first line of a file."""
    return int(file.name[len(_PREFIX) : -len(_SUFFIX)])


def file_from(folder: Path, seq: int) -> Path:
    """The file that begins with this line."""
    return folder / f"{_PREFIX}{seq:012d}{_SUFFIX}"


@dataclass(frozen=True, slots=True)
class Tail:
    """How a log ends.

    Attributes
    ----------
    file
        The newest; None when there is none.
    last
        The last whole line; None when there is none.
    unended
        What the newest file holds after its last line end. It is either `last`, or what there is
        of a line that was never written whole.
    size
        Bytes of the newest file.
    """

    file: Path | None
    last: ChainLink | None
    unended: bytes
    size: int


def read_tail(folder: Path) -> Tail:
    """How the log in a folder ends.

    Raises
    ------
    OSError
        When it cannot be read.
    """
    files = log_files(folder)
    unended, size = b"", 0
    for number, file in enumerate(reversed(files)):
        content = file.read_bytes()
        lines = content.split(b"\n")
        if number == 0:
            unended, size = lines[-1], len(content)
        for line in reversed(lines):
            last = link_of(line)
            if last is not None:
                return Tail(files[-1], last, unended, size)
    return Tail(files[-1] if files else None, None, unended, size)


def read_end(folder: Path) -> ChainLink | None:
    """Where the log ended when it was last written, kept beside it; None when that is not known."""
    try:
        said = json.loads((folder / _END).read_bytes())
        return ChainLink(int(said["seq"]), "", str(said["sha256"]))
    except (OSError, ValueError, TypeError, KeyError):
        return None


def write_end(folder: Path, last: ChainLink) -> None:
    """Keep where the log ends.

    Raises
    ------
    OSError
        When it cannot be written.
    """
    growing = folder / f".{_END}"
    with open(growing, "wb", opener=private_opener) as file:
        file.write(json.dumps({"seq": last.seq, "sha256": last.digest}).encode())
    growing.replace(folder / _END)


def make_room(folder: Path, most: int = MOST_FILES) -> None:
    """Delete the oldest files, until no more than `most` are left."""
    for file in log_files(folder)[:-most]:
        file.unlink(missing_ok=True)
    sync_folder(folder)


def following(last: ChainLink | None) -> tuple[int, str]:
    """Number of the line after this one, and the digest that it names."""
    return (1, BEGINNING) if last is None else (last.seq + 1, last.digest)


def _is_ours(name: str) -> bool:
    number = name[len(_PREFIX) : -len(_SUFFIX)]
    return name.startswith(_PREFIX) and name.endswith(_SUFFIX) and number.isdigit()
