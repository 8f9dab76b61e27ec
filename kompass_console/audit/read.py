"""Reads the audit log: the newest first for people, all of it for who takes it along."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from kompass_console.audit.files import first_number, log_files
from kompass_console.audit.line import decode

_CHUNK = 256 * 1024  # bytes


def newest(
    folder: Path, *, before: int = 0, count: int = 100, text: str = ""
) -> tuple[list[dict[str, Any]], bool]:
    """Lines below the number `before` (0: from the newest), newest first; and whether there are
    more.

    Parameters
    ----------
    text
        Only lines that hold it, whatever its case.

    Raises
    ------
    OSError
        When the log cannot be read.
    """
    wanted = text.casefold()
    found: list[dict[str, Any]] = []
    for file in reversed(log_files(folder)):
        if before and first_number(file) >= before:
            continue
        for line in reversed(_read(file).split(b"\n")):
            said = decode(line)
            if said is None or (before and said["seq"] >= before):
                continue
            if wanted and wanted not in _searched(said):
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


def _searched(said: dict[str, Any]) -> str:
    """What of a line a person looks for."""
    shown = {key: value for key, value in said.items() if key not in ("prev", "seq")}
    return " ".join(f"{key} {value}" for key, value in shown.items()).casefold()
