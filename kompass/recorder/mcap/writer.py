"""Write an MCAP file that can be read up to its last flush, whatever happens to the writer.

The writer of the ``mcap`` package ends a chunk by its size only. A flight recorder has to end one
by the clock, and must stay whole when the disk is full; so this one writes the same records itself.
Schemas and channels stand outside of the chunks: a torn file is mended without unpacking it.
"""

import io
import os
import struct
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from kompass.store.private import private_opener

MAGIC = b"\x89MCAP0\r\n"
LIBRARY = "kompass-console"
# Twice as fast as the default level; scans and maps come out a few per cent larger.
LEVEL = 1

_MESSAGE = struct.Struct("<BQHIQQ")
_CHUNK = struct.Struct("<BQQQQII")
_LENGTH = struct.Struct("<Q")
_INDEX = struct.Struct("<BQHI")


class McapWriter:
    """A file under way.

    Parameters
    ----------
    path
        Must not exist yet.
    profile
        Of the header; ``ros2`` lets other tools take the messages for those of ROS 2.

    Raises
    ------
    OSError
        When the file exists, or cannot be written. After an error while flushing, the file ends
        where it ended before and the messages are still there to be flushed again.
    """

    def __init__(self, path: Path, *, profile: str = "ros2") -> None:
        self.path = path
        self._file = io.FileIO(path, "xb", opener=private_opener)
        self._compressor = zstandard.ZstdCompressor(level=LEVEL)
        self._size = 0
        self._schemas: dict[tuple[str, str], Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._chunks: list[ChunkIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._counts: dict[int, int] = {}
        self._parts: list[bytes] = []
        self._offset = 0
        self._index: dict[int, list[int]] = {}
        self._first = self._last = 0
        self._put(MAGIC + _record(Header(profile, LIBRARY)))

    @property
    def size(self) -> int:
        """Bytes on disk."""
        return self._size

    @property
    def pending(self) -> int:
        """Bytes that the next flush will take, before compression."""
        return self._offset

    @property
    def chunks(self) -> list[ChunkIndex]:
        """Index of what has been flushed."""
        return self._chunks

    def add_metadata(self, name: str, data: Mapping[str, str]) -> None:
        """Write a record of names and values, at once."""
        blob = _record(Metadata(name, dict(data)))
        index = MetadataIndex(offset=self._size, length=len(blob), name=name)
        self._put(blob)
        self._metadata.append(index)

    def add_channel(
        self,
        topic: str,
        encoding: str,
        schema: tuple[str, str, bytes],
        metadata: Mapping[str, str],
    ) -> int:
        """Announce a channel, at once, and return its number.

        Parameters
        ----------
        schema
            Name, encoding and text of the definition of its messages.
        """
        name, kind, text = schema
        blob = b""
        known = self._schemas.get((name, kind))
        if known is None:
            known = Schema(id=len(self._schemas) + 1, data=text, encoding=kind, name=name)
            blob = _record(known)
        channel = Channel(
            id=len(self._channels) + 1,
            topic=topic,
            message_encoding=encoding,
            metadata=dict(metadata),
            schema_id=known.id,
        )
        self._put(blob + _record(channel))
        self._schemas[(name, kind)] = known
        self._channels[channel.id] = channel
        return channel.id

    def add_message(
        self, channel: int, log_time: int, data: bytes, publish_time: int, sequence: int = 0
    ) -> None:
        """Take a message; it reaches the disk with the next flush.

        Parameters
        ----------
        log_time, publish_time
            Nanoseconds.
        """
        index = self._index.get(channel)
        if index is None:
            index = self._index[channel] = []
        index += (log_time, self._offset)
        if not self._offset:
            self._first = self._last = log_time
        elif log_time < self._first:
            self._first = log_time
        elif log_time > self._last:
            self._last = log_time
        head = _MESSAGE.pack(
            Opcode.MESSAGE, 22 + len(data), channel, sequence, log_time, publish_time
        )
        self._parts += (head, data)
        self._offset += len(head) + len(data)

    def flush(self) -> None:
        """Hand all messages to the operating system, as one chunk."""
        if not self._offset:
            return
        data = b"".join(self._parts)
        packed = self._compressor.compress(data)
        kind = b"zstd"
        head = _CHUNK.pack(
            Opcode.CHUNK,
            8 + 8 + 8 + 4 + 4 + len(kind) + 8 + len(packed),
            self._first,
            self._last,
            len(data),
            zlib.crc32(data),
            len(kind),
        )
        chunk = b"".join((head, kind, _LENGTH.pack(len(packed)), packed))
        blob, offsets = [chunk], {}
        at = self._size + len(chunk)
        for channel, entries in self._index.items():
            offsets[channel] = at
            record = index_record(channel, entries)
            blob.append(record)
            at += len(record)
        made = ChunkIndex(
            chunk_length=len(chunk),
            chunk_start_offset=self._size,
            compression=kind.decode(),
            compressed_size=len(packed),
            message_end_time=self._last,
            message_index_length=at - self._size - len(chunk),
            message_index_offsets=offsets,
            message_start_time=self._first,
            uncompressed_size=len(data),
        )
        self._put(b"".join(blob))
        self._chunks.append(made)
        for channel, entries in self._index.items():
            self._counts[channel] = self._counts.get(channel, 0) + len(entries) // 2
        self._parts, self._index, self._offset = [], {}, 0

    def finish(self) -> None:
        """Flush, write the summary, have all of it on the disk itself, and close."""
        self.flush()
        self._put(
            summary(
                self._size,
                [*self._schemas.values()],
                [*self._channels.values()],
                self._chunks,
                self._metadata,
                self._counts,
            )
        )
        os.fdatasync(self._file.fileno())
        self._file.close()

    def abandon(self) -> None:
        """Close as it is, for :func:`kompass.recorder.mcap.recover.recover` or for the bin."""
        self._file.close()

    def _put(self, blob: bytes) -> None:
        rest = memoryview(blob)
        try:
            while rest:
                rest = rest[self._file.write(rest) or 0 :]
        except OSError:
            # Half a record would hide all that comes after it.
            self._file.truncate(self._size)
            self._file.seek(self._size)
            raise
        self._size += len(blob)


def index_record(channel: int, entries: Sequence[int]) -> bytes:
    """Return where in a chunk the messages of a channel are: time, offset, time, offset, …"""
    size = 8 * len(entries)
    head = _INDEX.pack(Opcode.MESSAGE_INDEX, 6 + size, channel, size)
    return head + struct.pack(f"<{len(entries)}Q", *entries)


def summary(
    at: int,
    schemas: list[Schema],
    channels: list[Channel],
    chunks: list[ChunkIndex],
    metadata: list[MetadataIndex],
    counts: Mapping[int, int],
) -> bytes:
    """Return what ends a file: end of data, summary, footer, magic.

    Parameters
    ----------
    at
        Offset in the file at which it will stand.
    counts
        Messages per channel.
    """
    end = _record(DataEnd(0))
    start = at + len(end)
    statistics = Statistics(
        attachment_count=0,
        channel_count=len(channels),
        channel_message_counts=dict(counts),
        chunk_count=len(chunks),
        message_count=sum(counts.values()),
        message_end_time=max((chunk.message_end_time for chunk in chunks), default=0),
        message_start_time=min((chunk.message_start_time for chunk in chunks), default=0),
        metadata_count=len(metadata),
        schema_count=len(schemas),
    )
    groups: list[tuple[Opcode, list[McapRecord]]] = [
        (Opcode.SCHEMA, [*schemas]),
        (Opcode.CHANNEL, [*channels]),
        (Opcode.STATISTICS, [statistics]),
        (Opcode.CHUNK_INDEX, [*chunks]),
        (Opcode.METADATA_INDEX, [*metadata]),
    ]
    blob, offsets = b"", b""
    for opcode, records in groups:
        if records:
            group = b"".join(map(_record, records))
            offsets += _record(
                SummaryOffset(
                    group_opcode=opcode, group_start=start + len(blob), group_length=len(group)
                )
            )
            blob += group
    offset_start = start + len(blob)
    blob += offsets
    head = struct.pack("<BQQQ", Opcode.FOOTER, 8 + 8 + 4, start, offset_start)
    footer = _record(Footer(start, offset_start, zlib.crc32(head, zlib.crc32(blob))))
    return end + blob + footer + MAGIC


def _record(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())  # type: ignore[no-untyped-call]
