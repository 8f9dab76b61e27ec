"""What a base was told and what it did, in memory, and as a table on disk.

No ROS and no clock: time is an argument [s].
"""

import csv
import os
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.response import Response, fit_response

AXES = ("vx", "vy", "omega")
COLUMNS = ("t", "x", "y", "yaw", *AXES, *(f"command_{axis}" for axis in AXES))
MOST_ROWS = 100_000  # of one recording; some 10 MB
OWN_NAME = "motion-"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,99}")

Triple = tuple[float, float, float]


class NotRecorded(Exception):
    """A recording cannot be made or kept; the message says why, and what to do."""


@dataclass
class MotionRecording:
    """Commands, and the poses and speeds that were measured.

    Attributes
    ----------
    began
        [s]
    time_step
        Least time between two rows [s]; 0 for every reading.
    """

    began: float
    time_step: float = 0.0
    _commands: list[tuple[float, Triple]] = field(default_factory=list)
    _rows: list[tuple[float, Triple, Triple, Triple]] = field(default_factory=list)

    @property
    def is_full(self) -> bool:
        """Whether it takes no more."""
        return max(len(self._rows), len(self._commands)) >= MOST_ROWS

    @property
    def rows(self) -> int:
        """How many readings it has."""
        return len(self._rows)

    @property
    def has_moved(self) -> bool:
        """Whether the robot was told to move."""
        return any(any(twist) for _, twist in self._commands)

    def told(self, at: float, twist: Triple) -> None:
        """A command (vx, vy, omega) [m/s, m/s, rad/s] that was sent to the wheels."""
        if not self.is_full:
            self._commands.append((at, twist))

    def measured(self, at: float, pose: Triple, speed: Triple) -> None:
        """A pose (x, y, yaw) [m, m, rad] and a speed as of the commands."""
        # A tenth of a step is how uneven readings may come.
        due = not self._rows or at - self._rows[-1][0] >= 0.9 * self.time_step
        if due and not self.is_full:
            command = self._commands[-1][1] if self._commands else (0.0, 0.0, 0.0)
            self._rows.append((at, pose, speed, command))

    def responses(self) -> tuple[dict[str, Response], dict[str, str]]:
        """The response of each axis, and why others have none."""
        found, none = {}, {}
        if not (self._rows and self._commands):
            return {}, dict.fromkeys(AXES, "no readings, or no commands")
        at, speeds = _table([(at, speed) for at, _, speed, _ in self._rows])
        given_at, given = _table(self._commands)
        for index, axis in enumerate(AXES):
            try:
                found[axis] = fit_response(given_at, given[:, index], at, speeds[:, index])
            except ValueError as error:
                none[axis] = str(error)
        return found, none

    def write(self, folder: Path, name: str, most: int) -> Path:
        """Keep it as a table; the oldest of those that the server named itself give way.

        Parameters
        ----------
        folder
            Made when it is not there.
        name
            Of the file, without a folder; ``.csv`` is added where it is missing.
        most
            Tables that the folder may have.

        Raises
        ------
        NotRecorded
            The name is none, the file is there already, the folder is full of others, or the disk
            cannot be written. Nothing was changed then, but tables that gave way.
        """
        path = folder / file_name(name)
        try:
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            _make_room(folder, most)
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
            with os.fdopen(os.open(path, flags, 0o600), "w", encoding="utf-8", newline="") as file:
                table = csv.writer(file)
                table.writerow(COLUMNS)
                for at, pose, speed, command in self._rows:
                    values = (at - self.began, *pose, *speed, *command)
                    table.writerow([f"{value:.5f}" for value in values])
        except FileExistsError:
            raise NotRecorded(f"{path} is there already; give another name") from None
        except OSError as error:
            raise NotRecorded(f"{path} cannot be written: {error.strerror}") from None
        return path


def file_name(name: str) -> str:
    """The name of a table's file.

    Raises
    ------
    NotRecorded
        It is not a plain name.
    """
    if not _NAME.fullmatch(name):
        raise NotRecorded(
            f"csv_file_name = {name!r} is no name of a file; give letters, digits, '.', '_' and "
            "'-', at most 100, and no folder"
        )
    return name if name.endswith(".csv") else f"{name}.csv"


def _make_room(folder: Path, most: int) -> None:
    tables = list(folder.glob("*.csv"))
    # By their names, which begin with the time.
    own = sorted(path for path in tables if path.name.startswith(OWN_NAME))
    spare = len(tables) + 1 - most
    if spare > len(own):
        raise NotRecorded(
            f"{folder} holds {len(tables)} tables; take some away, or raise most_recordings = "
            f"{most}"
        )
    for path in own[: max(0, spare)]:
        path.unlink()


def _table(
    timed: list[tuple[float, Triple]],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times (N,), rising, and what was then (N, 3); of messages that came late as of others."""
    at = np.array([when for when, _ in timed])
    order = np.argsort(at, kind="stable")
    return at[order], np.array([values for _, values in timed])[order]
