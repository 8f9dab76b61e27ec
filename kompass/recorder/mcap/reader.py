"""Read recordings: messages of chosen channels in the order of time, over several files."""

from __future__ import annotations

import heapq
import os
import struct
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import IO, NamedTuple, Self

from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import NonSeekingReader
from mcap.records import Channel, ChunkIndex

from kompass.recorder.mcap.contents import Contents, NotMcap, chunk_records, read_contents

_MESSAGE = struct.Struct("<HIQQ")


class Track(NamedTuple):
    """A channel, as one file has it.

    Attributes
    ----------
    source
        As in :class:`kompass.recorder.streams.Stream`; empty for a file of another recorder.
    rule_topic
        The topic's name in the rules.
    schema
        Name, encoding and text of the definition of its messages.
    """

    topic: str
    type: str
    encoding: str
    source: str
    rule_topic: str
    schema: tuple[str, str, bytes]
    channel: Channel


class Recorded(NamedTuple):
    """One message of a recording; times in nanoseconds."""

    log_time: int
    publish_time: int
    sequence: int
    track: Track
    data: bytes


class File(NamedTuple):
    """An open file of a recording."""

    path: Path
    stream: IO[bytes]
    contents: Contents
    tracks: dict[int, Track]

    @property
    def session(self) -> str:
        """The session of the stack that it was written in; empty for a file of another recorder."""
        return self.contents.metadata.get("kompass", {}).get("life", "")


class Recording:
    """Files that belong together, held open: what is dropped meanwhile can still be read.

    Parameters
    ----------
    paths
        In the order of their making; those that have gone in the meantime are left out.

    Raises
    ------
    NotMcap
        If one is no MCAP file, or damaged.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self._stack = ExitStack()
        self.files: list[File] = []
        try:
            for path in paths:
                self._open(path)
        except BaseException:
            self._stack.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def _open(self, path: Path) -> None:
        try:
            stream = self._stack.enter_context(path.open("rb"))
        except FileNotFoundError:
            return
        if not os.fstat(stream.fileno()).st_size:
            return  # just begun
        contents = read_contents(stream, str(path))
        self.files.append(File(path, stream, contents, _tracks(contents)))

    @property
    def start_time(self) -> int:
        """Nanoseconds of the first message; 0 for an empty recording."""
        return min((f.contents.start_time for f in self.files if f.contents.chunks), default=0)

    @property
    def end_time(self) -> int:
        """Nanoseconds of the last message; 0 for an empty recording."""
        return max((f.contents.end_time for f in self.files), default=0)


def sessions_of(files: Sequence[File]) -> list[list[File]]:
    """Files by the session of the stack that they were written in, in order."""
    found: list[list[File]] = []
    for file in files:
        if found and found[-1][0].session == file.session:
            found[-1].append(file)
        else:
            found.append([file])
    return found


def messages(
    files: Sequence[File],
    wanted: Callable[[Track], bool],
    start: int = 0,
    end: int | None = None,
) -> Iterator[Recorded]:
    """Yield messages in the order of their time; those of one time in the order of the files.

    Parameters
    ----------
    wanted
        Which channels; chunks with none of them are not even unpacked.
    start, end
        Nanoseconds of the first, and of the one behind the last.

    Raises
    ------
    NotMcap
        When a file is damaged.
    """
    parts: list[tuple[int, int, File, ChunkIndex | None, dict[int, Track]]] = []
    number = 0
    for file in files:
        chosen = {id_: track for id_, track in file.tracks.items() if wanted(track)}
        if not chosen:
            continue
        if file.contents.loose:
            parts.append((0, number, file, None, chosen))
        for chunk in file.contents.chunks:
            number += 1
            held = chunk.message_index_offsets
            if (
                chunk.message_end_time >= start
                and (end is None or chunk.message_start_time < end)
                and (not held or any(id_ in held for id_ in chosen))
            ):
                parts.append((chunk.message_start_time, number, file, chunk, chosen))
    parts.sort(key=lambda part: part[:2])
    queue: list[tuple[int, int, Recorded]] = []
    order = 0
    for begins, _, file, part, chosen in parts:
        while queue and queue[0][0] < begins:
            yield heapq.heappop(queue)[2]
        for message in _read(file, part, chosen):
            if message.log_time >= start and (end is None or message.log_time < end):
                order += 1
                heapq.heappush(queue, (message.log_time, order, message))
    while queue:
        yield heapq.heappop(queue)[2]


def _read(file: File, chunk: ChunkIndex | None, chosen: dict[int, Track]) -> Iterator[Recorded]:
    try:
        if chunk is None:
            yield from _loose(file, chosen)
            return
        for opcode, _, body in chunk_records(file.stream, chunk):
            if opcode == Opcode.MESSAGE:
                channel, sequence, log_time, publish_time = _MESSAGE.unpack_from(body)
                track = chosen.get(channel)
                if track is not None:
                    data = bytes(body[_MESSAGE.size :])
                    yield Recorded(log_time, publish_time, sequence, track, data)
    except (ValueError, struct.error) as error:
        raise NotMcap(f"{file.path} is damaged: {error}") from error


def _loose(file: File, chosen: dict[int, Track]) -> Iterator[Recorded]:
    """Messages of a file without chunks, all at once; a torn one up to where it is torn."""
    file.stream.seek(0)
    found = []
    try:
        for _, channel, message in NonSeekingReader(file.stream).iter_messages(
            log_time_order=False
        ):
            track = chosen.get(channel.id)
            if track is not None:
                found.append(
                    Recorded(
                        message.log_time,
                        message.publish_time,
                        message.sequence,
                        track,
                        message.data,
                    )
                )
    except (McapError, struct.error):
        if file.contents.complete:
            raise
    yield from sorted(found, key=lambda message: message.log_time)


def _tracks(contents: Contents) -> dict[int, Track]:
    made = {}
    for channel in contents.channels.values():
        schema = contents.schemas.get(channel.schema_id)
        made[channel.id] = Track(
            topic=channel.topic,
            type=schema.name if schema else "",
            encoding=channel.message_encoding,
            source=channel.metadata.get("source", "") if contents.metadata.get("kompass") else "",
            rule_topic=channel.metadata.get("rule_topic") or channel.topic.removeprefix("/"),
            schema=(schema.name, schema.encoding, schema.data) if schema else ("", "", b""),
            channel=channel,
        )
    return made
