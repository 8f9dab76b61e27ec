"""The flight recorder's files on this machine: what is kept of the robot, looked at and let go."""

from __future__ import annotations

import os
import shutil
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from kompass.recorder.clip_policy import PREFIX
from kompass.recorder.mcap.contents import NotMcap, read_contents
from kompass.recorder.places import SUFFIX, rotation_folder, saved_folder
from kompass.recorder.rotating_recording import rotation_files


class Inside(NamedTuple):
    """What a file holds.

    Attributes
    ----------
    begin, end
        Seconds since the epoch of its first and last message; 0 for an empty one.
    problem
        Why it cannot be read; empty when it can.
    """

    begin: float
    end: float
    messages: int
    problem: str


class KeptRecording(NamedTuple):
    """A recording that was kept.

    Attributes
    ----------
    name
        Without the suffix; what it is asked for by.
    saved
        Seconds since the epoch at which it was written.
    size
        Bytes.
    of_firing
        Whether a firing had it kept, and not a person.
    """

    name: str
    saved: float
    size: int
    of_firing: bool
    inside: Inside


class RotatingRecordingState(NamedTuple):
    """What the flight recorder has on disk: since when (seconds since the epoch), and bytes."""

    begin: float
    size: int


@dataclass(frozen=True, slots=True)
class _Seen:
    size: int
    mtime_ns: int
    inside: Inside


class Recordings:
    """The folder of all recordings of the robot. Any thread; every call reads the disk.

    Names are looked up among the files of the folder: there is no name that leads out of it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._saved = saved_folder(folder)
        self._seen: dict[str, _Seen] = {}
        self._lock = threading.Lock()

    def kept(self) -> list[KeptRecording]:
        """All that was kept, the newest first.

        Raises
        ------
        OSError
            When the folder cannot be read.
        """
        found: list[KeptRecording] = []
        for entry in self._entries():
            try:
                status = entry.stat(follow_symlinks=False)
            except FileNotFoundError:  # it went while we looked
                continue
            name = entry.name.removesuffix(SUFFIX)
            inside = self._inside(Path(entry.path), status)
            found.append(
                KeptRecording(
                    name, status.st_mtime, status.st_size, name.startswith(PREFIX), inside
                )
            )
        with self._lock:
            there = {kept.name for kept in found}
            self._seen = {name: seen for name, seen in self._seen.items() if name in there}
        return sorted(found, key=lambda kept: (kept.saved, kept.name), reverse=True)

    def rotating(self) -> RotatingRecordingState | None:
        """What the flight recorder has; None when it has nothing."""
        begin, size = 0.0, 0
        for path in rotation_files(rotation_folder(self.folder)):
            try:
                size += path.stat().st_size
                begin = begin or self._read(path).begin
            except FileNotFoundError:  # it was just gone over
                continue
        return RotatingRecordingState(begin, size) if begin else None

    def free(self) -> int:
        """Bytes that are free on the disk of the recordings."""
        folder = self.folder
        while not folder.exists():
            folder = folder.parent
        return shutil.disk_usage(folder).free

    def path(self, name: str) -> Path | None:
        """Where the recording of this name is; None when there is none."""
        found = next((e for e in self._entries() if e.name == name + SUFFIX), None)
        return None if found is None else Path(found.path)

    def delete(self, name: str) -> bool:
        """Delete one; False when there is none. Who reads it keeps what they have opened.

        Raises
        ------
        OSError
            When it cannot be deleted.
        """
        path = self.path(name)
        if path is None:
            return False
        path.unlink(missing_ok=True)
        return True

    def _entries(self) -> list[os.DirEntry[str]]:
        """Whole files of the folder: nothing hidden or half-written, and no links elsewhere."""
        try:
            with os.scandir(self._saved) as found:
                return [
                    entry
                    for entry in found
                    if entry.name.endswith(SUFFIX)
                    and not entry.name.startswith(".")
                    and entry.is_file(follow_symlinks=False)
                ]
        except FileNotFoundError:  # nothing was ever kept
            return []

    def _inside(self, path: Path, status: os.stat_result) -> Inside:
        """What a file holds, read once as long as it does not change."""
        name = path.name.removesuffix(SUFFIX)
        seen = self._seen.get(name)
        if seen and (seen.size, seen.mtime_ns) == (status.st_size, status.st_mtime_ns):
            return seen.inside
        try:
            inside = self._read(path)
        except OSError as error:
            return Inside(0.0, 0.0, 0, f"{path.name} cannot be read: {error.strerror}")
        with self._lock:
            self._seen[name] = _Seen(status.st_size, status.st_mtime_ns, inside)
        return inside

    def _read(self, path: Path) -> Inside:
        try:
            with path.open("rb") as stream:
                contents = read_contents(stream, path.name)
        except NotMcap as error:
            return Inside(0.0, 0.0, 0, str(error))
        begin, end = contents.start_time * 1e-9, contents.end_time * 1e-9
        return Inside(begin, end, sum(contents.counts.values()), "")
