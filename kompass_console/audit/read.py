"""Reads the audit log: the newest first for people, all of it for who takes it along."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from kompass_console.audit.files import first_number, log_files
from kompass_console.audit.line import decode

_CHUNK = 256 * 1024  # bytes
_LAST_FIELD = b',"prev":'  # digests are not what people look for


def newest(
    folder: Path, *, before: int = 0, count: int = 100, text: str = ""
) -> tuple[list[dict[str, Any]], bool]:
    """Lines below the number `before` (0: from the newest), newest first; and whether there are
    more.

    Parameters
    ----------
    text
        Only lines that hold it, whatever the case of its letters from A to Z.

    Raises
    ------
    OSError
        When the log cannot be read.
    """
    # As it stands in the file: to read each line as JSON would take seconds of the console's time.
    wanted = json.dumps(text)[1:-1].lower().encode("ascii")
    found: list[dict[str, Any]] = []
    for file in reversed(log_files(folder)):
        if before and first_number(file) >= before:
            continue
        for line in reversed(_read(file).split(b"\n")):
            if wanted not in line.rpartition(_LAST_FIELD)[0].lower():
                continue
            said = decode(line)
            if said is None or (before and said["seq"] >= before):
                continue
            if len(found) == count:
                return found, True
            found.append(said)
    return found, False


def lines_after(folder: Path, seq: int) -> list[dict[str, Any]]:
    """Lines above a number, the oldest first.

    Raises
    ------
    OSError
        When the log cannot be read.
    """
    found: list[dict[str, Any]] = []
    files = log_files(folder)
    for index, file in enumerate(files):
        if index + 1 < len(files) and first_number(files[index + 1]) <= seq + 1:
            continue
        said = [decode(line) for line in _read(file).split(b"\n")]
        found += [each for each in said if each is not None and each["seq"] > seq]
    return found


def whole_log(files: Iterable[Path]) -> Iterator[bytes]:
    """Everything as it is on disk, piece by piece."""
    for file in files:
        try:
            with file.open("rb") as stream:
                while chunk := stream.read(_CHUNK):
                    yield chunk
        except FileNotFoundError:  # it went to make room for newer ones
            continue


def _read(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except FileNotFoundError:  # it went to make room for newer ones
        return b""
