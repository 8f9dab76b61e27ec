"""The newest minutes on disk: a row of MCAP files of which the oldest go."""

from __future__ import annotations

import errno
import fcntl
import logging
import os
import re
import shutil
import time
from collections.abc import Callable, Collection
from pathlib import Path
from typing import NamedTuple

from kompass.recorder.mcap.contents import NotMcap
from kompass.recorder.mcap.recover import recover
from kompass.recorder.mcap.writer import McapWriter
from kompass.recorder.places import SUFFIX
from kompass.recorder.streams import REPEAT, Stream
from kompass.store.private import private_folder, private_opener

log = logging.getLogger("kompass.recorder")

_NAME = re.compile(r"(\d{8})-\d{8}T\d{6}Z\.mcap")
# What these minutes may never do is fill the disk.
RESERVE = 64 << 20  # bytes that stay free for others
DAMAGED = ".damaged"
LARGEST_REPEAT = 1 << 20  # bytes of a message, beyond which a new file does not begin with it


class RotationBounds(NamedTuple):
    """How much is kept; whichever is reached first."""

    size: int = 256 << 20  # bytes
    age: float = 900.0  # s
    file_size: int = 16 << 20
    file_age: float = 30.0


class RecordingInUse(RuntimeError):
    """Another recorder writes there; the message says what to do."""


class RotatingRecording:
    """Writes into the newest file, begins another in time, and drops the oldest.

    Parameters
    ----------
    folder
        Made if need be; no other recorder may write there.
    metadata
        Written into each file as the record ``kompass``.
    clock
        Nanoseconds, as of the messages' ``log_time``.
    begins
        Called when a file has begun, with the time of its first message; may write into it.

    Raises
    ------
    RecordingInUse
        When another recorder writes there.
    OSError
        When it cannot be written.
    """

    def __init__(
        self,
        folder: Path,
        metadata: dict[str, str],
        clock: Callable[[], int],
        bounds: RotationBounds = RotationBounds(),  # noqa: B008 - immutable
        begins: Callable[[int], None] = lambda log_time: None,
    ) -> None:
        self._begins = begins
        self._folder, self._metadata, self._clock, self._bounds = folder, metadata, clock, bounds
        private_folder(folder)
        flags = os.O_WRONLY | os.O_CREAT | os.O_CLOEXEC
        self._lock = os.fdopen(private_opener(str(folder / ".lock"), flags), "w")
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self._lock.close()
            raise RecordingInUse(
                f"another recorder writes in {folder}; give each robot of this machine a name of "
                "its own with KOMPASS_ROBOT_NAME, or record nothing with KOMPASS_RECORD=0"
            ) from None
        self._writer: McapWriter | None = None
        self._channels: dict[Stream, int] = {}
        self._began = 0
        self._latest: dict[str, tuple[Stream, bytes, int]] = {}
        try:
            self._mend()
        except BaseException:
            self._lock.close()
            raise

    # -- writing ------------------------------------------------------------------------------

    def write(
        self,
        stream: Stream,
        log_time: int,
        data: bytes,
        sequence: int = 0,
        *,
        publish_time: int | None = None,
        repeat: bool = False,
    ) -> None:
        """Take a message; it is on disk after the next :meth:`flush`.

        Parameters
        ----------
        log_time, publish_time
            Nanoseconds at which it was heard and, where known, said.
        repeat
            Whether it stays valid until the next, so that later files begin with it.
        """
        writer = self._writer or self._begin(log_time)
        said = log_time if publish_time is None else publish_time
        writer.add_message(self._channel(writer, stream), log_time, data, said, sequence)
        if repeat and len(data) <= LARGEST_REPEAT:
            self._latest[stream.topic] = (stream, data, log_time)

    def flush(self) -> None:
        """Bring all to disk; begin another file if this one is full; drop what is too old.

        Raises
        ------
        OSError
            When that fails even after the oldest files have gone; what was taken since the last
            time is given up.
        """
        if self._writer is None:
            return
        while True:
            try:
                self._writer.flush()
                break
            except OSError as error:
                if error.errno in (errno.ENOSPC, errno.EDQUOT) and self._drop_oldest():
                    continue
                self._writer.abandon()
                self._writer = None
                raise
        full = self._writer.size >= self._bounds.file_size
        if full or self._clock() - self._began >= self._bounds.file_age * 1e9:
            self.finish_file()
        self.prune()

    def finish_file(self) -> None:
        """End the file under way; the next message begins another."""
        writer, self._writer = self._writer, None
        if writer is not None:
            try:
                writer.finish()
            finally:
                writer.abandon()

    def close(self) -> None:
        """Finish the file, and let others write here."""
        try:
            self.finish_file()
        finally:
            self._lock.close()

    def remember(self, stream: Stream, data: bytes, log_time: int) -> None:
        """Let later files begin with a message that is on disk already."""
        self._latest[stream.topic] = (stream, data, log_time)

    def keep_only(self, source: str, topics: Collection[str]) -> None:
        """Of what came from ``source``, repeat only these topics from now on."""
        gone = [
            topic
            for topic, (stream, _, _) in self._latest.items()
            if stream.source == source and topic not in topics
        ]
        for topic in gone:
            del self._latest[topic]

    def _begin(self, log_time: int) -> McapWriter:
        self._make_room()
        number = max((int(path.name[:8]) for path in self.files()), default=0) + 1
        stamp = time.strftime("%Y%m%dT%H%M%SZ", time.gmtime(log_time * 1e-9))
        writer = McapWriter(self._folder / f"{number:08d}-{stamp}{SUFFIX}")
        try:
            writer.add_metadata("kompass", self._metadata)
        except OSError:
            writer.abandon()
            raise
        self._writer, self._channels, self._began = writer, {}, self._clock()
        self._begins(log_time)
        for stream, data, said in self._latest.values():
            again = stream._replace(source=f"{stream.source}{REPEAT}")
            channel = self._channel(writer, again)
            writer.add_message(channel, log_time, data, said)
        return writer

    def _channel(self, writer: McapWriter, stream: Stream) -> int:
        found = self._channels.get(stream)
        if found is None:
            metadata = {"source": stream.source, **dict(stream.metadata)}
            found = writer.add_channel(stream.topic, stream.encoding, stream.schema, metadata)
            self._channels[stream] = found
        return found

    # -- keeping house ------------------------------------------------------------------------

    @property
    def current(self) -> Path | None:
        """The file under way."""
        return self._writer.path if self._writer else None

    def files(self) -> list[Path]:
        """All files, oldest first, the one under way included."""
        return rotation_files(self._folder)

    def prune(self) -> None:
        """Drop the oldest files until the bounds are kept.

        Whoever is reading one keeps what they have opened.
        """
        files = [path for path in self.files() if path != self.current]
        sizes = [path.stat().st_size for path in files]
        total = sum(sizes) + (self._writer.size if self._writer else 0)
        oldest = time.time() - self._bounds.age
        for path in self._folder.glob(f"*{DAMAGED}"):
            if path.stat().st_mtime < oldest:
                path.unlink()
        for path, size in zip(files, sizes, strict=True):
            if total > self._bounds.size or path.stat().st_mtime < oldest:
                path.unlink()
                total -= size

    def _drop_oldest(self) -> bool:
        for path in self.files():
            if path != self.current:
                path.unlink()
                log.warning("the disk is full: dropped the recording %s", path.name)
                return True
        return False

    def _make_room(self) -> None:
        while shutil.disk_usage(self._folder).free < RESERVE:
            if not self._drop_oldest():
                raise OSError(
                    errno.ENOSPC,
                    f"less than {RESERVE >> 20} MB are free, which are left to others",
                    str(self._folder),
                )

    def _mend(self) -> None:
        """Bring what a killed recorder left behind to a proper end."""
        for path in self.files():
            try:
                recover(path)
            except NotMcap as error:
                path.rename(path.with_name(path.name + DAMAGED))
                log.error("%s; set aside", error)


def rotation_files(folder: Path) -> list[Path]:
    """Files of a ring, oldest first."""
    if not folder.is_dir():
        return []
    return sorted(path for path in folder.iterdir() if _NAME.fullmatch(path.name))
