"""STOP on disk: a robot that was stopped comes up stopped, when all of its programs start anew.

One small file, as large as it will ever be from the first start on, and overwritten in place: that
needs no room on a full disk. A write that is cut short leaves a file that cannot be read, and such
a file counts as stopped.
"""

import fcntl
import json
import os
from collections.abc import Callable
from concurrent.futures import Executor as Threads
from pathlib import Path

from kompass.components.drive.stop_latch import StopRecord
from kompass.store.durable import sync_folder, write_whole
from kompass.store.paths import safe_name

SIZE = 4096  # bytes


def stop_path(folder: Path, node_name: str) -> Path:
    """Where a drive manager keeps STOP in the folder of its robot."""
    return folder / f"stop-{safe_name(node_name)}.json"


class StopFile:
    """Reads and writes the file. Its owner alone may do either; one process at a time does.

    Parameters
    ----------
    path
        Of the file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._descriptor = -1

    def load(self) -> StopRecord | None:
        """The STOP that was pressed and not released; None for none.

        What is there and cannot be read, or makes no sense, counts as a STOP.
        """
        try:
            data = self.path.read_bytes()
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as error:
            return _unknown(f"{self.path} cannot be read: {error.strerror}")
        try:
            return _of_text(data.decode())
        except (ValueError, TypeError, KeyError):
            return _unknown(f"{self.path} is damaged")

    def write(self, record: StopRecord | None) -> None:
        """Bring a STOP to the disk, or its release (None); on return it is there.

        Raises
        ------
        OSError
            The disk cannot be written, or another stack has the file; the message says which.
        """
        data = _to_text(record).encode().ljust(SIZE)
        self._open(data)
        os.pwrite(self._descriptor, data, 0)
        os.fdatasync(self._descriptor)

    def close(self) -> None:
        """Let another process have the file."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1

    def _open(self, data: bytes) -> None:
        """Open the file that has the name now; make it where there is none."""
        if self._descriptor >= 0:
            mine = os.fstat(self._descriptor)
            if self.path.exists() and os.path.samestat(mine, self.path.stat()):
                return
            self.close()
        if not self.path.exists():
            self._make(data)
        flags = os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC
        descriptor = os.open(self.path, flags)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            os.fchmod(descriptor, 0o600)
        except BlockingIOError as error:
            os.close(descriptor)
            raise OSError(
                error.errno, f"another stack keeps its STOP in {self.path}; give this one a --name"
            ) from None
        except BaseException:
            os.close(descriptor)
            raise
        self._descriptor = descriptor

    def _make(self, data: bytes) -> None:
        """Make it under another name first: what has the name is always complete."""
        self.path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        write_whole(self.path, data)
        sync_folder(self.path.parent.parent)


class StopKeeper:
    """Writes the file on a thread of its own: nobody who halts a robot waits for a disk.

    Parameters
    ----------
    file
        Written in the order of the calls of :meth:`keep`.
    thread
        One, which does its work in order.
    complain
        Takes what is wrong with the disk, from that thread, when it goes wrong.
    """

    def __init__(self, file: StopFile, thread: Threads, complain: Callable[[str], object]) -> None:
        self._file, self._thread, self._complain = file, thread, complain
        self._orders = 0  # so far
        self._failed: tuple[int, StopRecord | None] | None = None  # the order, and what it was

    def keep(self, record: StopRecord | None, written: Callable[[str], None] | None = None) -> None:
        """Have a STOP, or its release (None), written.

        Parameters
        ----------
        record
            What to write.
        written
            Called once from the thread: with "" when it is on disk, else with what is wrong.
        """
        self._orders += 1
        self._thread.submit(self._do, self._orders, record, written)

    def retry(self) -> None:
        """Try again what could not be written, unless something newer is to be kept."""
        if self._failed is not None and self._failed[0] == self._orders:
            self._thread.submit(self._do, *self._failed, None)

    def close(self) -> None:
        """Write what waits, and end."""
        self._thread.shutdown(wait=True)
        self._file.close()

    def _do(
        self, order: int, record: StopRecord | None, written: Callable[[str], None] | None
    ) -> None:
        problem = self._write(record)
        if written is not None:
            written(problem)
        if problem and self._failed is None:
            self._complain(problem)
        self._failed = (order, record) if problem else None

    def _write(self, record: StopRecord | None) -> str:
        try:
            self._file.write(record)
        except OSError as error:
            return f"cannot write {self._file.path}: {error.strerror}; see to its disk and owner"
        return ""


def _unknown(what: str) -> StopRecord:
    return StopRecord("somebody", f"{what}, so the robot counts as stopped", 0.0)


def _to_text(record: StopRecord | None) -> str:
    if record is None:
        return json.dumps({"stopped": False})
    values = {"operator": record.operator, "reason": record.reason, "at": record.at}
    return json.dumps({"stopped": True, **values}, ensure_ascii=False)


def _of_text(text: str) -> StopRecord | None:
    """As :func:`_to_text` wrote it; raises ValueError, TypeError or KeyError otherwise."""
    values = json.loads(text)
    if values == {"stopped": False}:
        return None
    if values["stopped"] is not True:
        raise ValueError("stopped is neither true nor false")
    return StopRecord(str(values["operator"]), str(values["reason"]), float(values["at"]))
