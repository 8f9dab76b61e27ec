"""Save a clip: out of the rotating recording, into one file that stands alone."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from kompass.recorder.clip import clip_messages
from kompass.recorder.mcap.reader import File, Recorded, Recording, sessions_of
from kompass.recorder.mcap.writer import McapWriter
from kompass.recorder.places import rotation_folder
from kompass.recorder.rotating_recording import RESERVE, rotation_files
from kompass.store.private import private_folder

CHUNK = 1 << 20  # bytes
PARTIAL = ".partial"


class ClipNotSaved(RuntimeError):
    """Nothing was kept; the message says why and what to do."""


def save_clip(recordings: Path, path: Path, start: int, end: int | None = None) -> Path:
    """Copy what the rotating recording has between two times into a new file; returns its path.

    The file says at its beginning which table was in force and what was valid then, so it can be
    replayed without what was before it.

    Parameters
    ----------
    start, end
        Nanoseconds since the epoch; ``end`` None for all there is.

    Raises
    ------
    ClipNotSaved
        When there is such a file already, or nothing to keep.
    OSError
        When it cannot be written.
    """
    if path.exists():
        raise ClipNotSaved(f"there is a recording {path.name} already; choose another name")
    private_folder(path.parent)
    partial = path.with_name(f".{path.name}.{os.getpid()}{PARTIAL}")
    try:
        with Recording(rotation_files(rotation_folder(recordings))) as recording:
            files = [file for file in recording.files if file.contents.end_time >= start]
            if not files:
                raise ClipNotSaved(_why_nothing(path.parent))
            _write(files, partial, start, end)
        try:
            os.link(partial, path)  # unlike a rename, this never replaces another's file
        except FileExistsError:
            raise ClipNotSaved(
                f"there is a recording {path.name} already; choose another name"
            ) from None
    finally:
        partial.unlink(missing_ok=True)
    return path


def _why_nothing(folder: Path) -> str:
    nothing = "the flight recorder has nothing of that time"
    if shutil.disk_usage(folder).free < RESERVE:
        return f"{nothing}: less than {RESERVE >> 20} MB are free, which are left to others"
    return f"{nothing}; is it running?"


def drop_partials(folder: Path) -> None:
    """Throw away what processes that are dead have left half-written."""
    for path in folder.glob(f".*{PARTIAL}"):
        pid = path.name.removesuffix(PARTIAL).rpartition(".")[2]
        if not Path(f"/proc/{pid}").exists():
            path.unlink(missing_ok=True)


def _write(files: list[File], path: Path, start: int, end: int | None) -> None:
    writer = McapWriter(path)
    try:
        writer.add_metadata("kompass", {"life": files[-1].session, "saved": "1"})
        channels: dict[tuple[str, str, str], int] = {}
        for session in sessions_of(files):
            # One after the other: between two sessions the clock may have been set back.
            for message in clip_messages(session, lambda _: True, start, end):
                _put(writer, channels, message)
        writer.finish()
    finally:
        writer.abandon()


def _put(writer: McapWriter, channels: dict[tuple[str, str, str], int], message: Recorded) -> None:
    track = message.track
    key = (track.topic, track.type, track.source)
    channel = channels.get(key)
    if channel is None:
        metadata = {**track.channel.metadata, "source": track.source}
        channel = writer.add_channel(track.topic, track.encoding, track.schema, metadata)
        channels[key] = channel
    writer.add_message(
        channel, message.log_time, message.data, message.publish_time, message.sequence
    )
    if writer.pending >= CHUNK:
        writer.flush()
