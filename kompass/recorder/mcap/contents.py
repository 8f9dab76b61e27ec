"""What an MCAP file holds, and where: from its summary, or by walking over one that has none.

A file without a summary is one that is being written, or whose writer was killed. It is read up to
the last complete record.
"""

import os
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from io import BytesIO
from typing import IO, Any

import lz4.frame  # type: ignore[import-untyped]
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import Channel, ChunkIndex, Metadata, MetadataIndex, Schema

from kompass.recorder.mcap.writer import MAGIC

_HEAD = struct.Struct("<BQ")
_CHUNK = struct.Struct("<QQQII")
_LIMIT = 1 << 30  # bytes of a record, beyond which a file is taken for broken


class NotMcap(ValueError):
    """It is no MCAP file, or none that can be read; the message names it and says why."""


@dataclass
class Contents:
    """The index of a file.

    Attributes
    ----------
    end
        Offset behind the last complete record of the data.
    complete
        Whether the file was finished.
    counts
        Messages per channel.
    loose
        Whether messages stand outside of chunks, as some recorders write them.
    """

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    chunks: list[ChunkIndex] = field(default_factory=list)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    metadata_index: list[MetadataIndex] = field(default_factory=list)
    counts: dict[int, int] = field(default_factory=dict)
    end: int = 0
    complete: bool = False
    loose: bool = False

    @property
    def start_time(self) -> int:
        """Nanoseconds of the first message; 0 for none."""
        return min((chunk.message_start_time for chunk in self.chunks), default=0)

    @property
    def end_time(self) -> int:
        """Nanoseconds of the last message; 0 for none."""
        return max((chunk.message_end_time for chunk in self.chunks), default=0)


def read_contents(stream: IO[bytes], name: str) -> Contents:
    """Index a file.

    Parameters
    ----------
    stream
        Open for reading, and able to seek.
    name
        For the message of an error.

    Raises
    ------
    NotMcap
        If it does not begin as an MCAP file does, or is damaged within.
    """
    stream.seek(0)
    if stream.read(len(MAGIC)) != MAGIC:
        raise NotMcap(f"{name} is no MCAP file: it does not begin with the mark of one")
    try:
        return _from_summary(stream) or _walk(stream)
    except (McapError, struct.error, UnicodeDecodeError, ValueError, OverflowError) as error:
        raise NotMcap(f"{name} is damaged: {error}") from error


def _from_summary(stream: IO[bytes]) -> Contents | None:
    size = stream.seek(0, os.SEEK_END)
    tail = len(MAGIC)
    if size < 2 * tail + 29:
        return None
    stream.seek(-tail, os.SEEK_END)
    if stream.read(tail) != MAGIC:
        return None
    stream.seek(0)
    reader = SeekingReader(stream, record_size_limit=_LIMIT)
    found = reader.get_summary()
    if found is None or (not found.chunk_indexes and not found.statistics):
        return None
    return Contents(
        schemas=found.schemas,
        channels=found.channels,
        chunks=found.chunk_indexes,
        metadata={record.name: record.metadata for record in reader.iter_metadata()},
        metadata_index=found.metadata_indexes,
        counts=dict(found.statistics.channel_message_counts) if found.statistics else {},
        end=size,
        complete=True,
        loose=not found.chunk_indexes
        and found.statistics is not None
        and found.statistics.message_count > 0,
    )


def _walk(stream: IO[bytes]) -> Contents:
    size = stream.seek(0, os.SEEK_END)
    made = Contents(end=len(MAGIC))
    at = len(MAGIC)
    while at + _HEAD.size <= size:
        stream.seek(at)
        opcode, length = _HEAD.unpack(stream.read(_HEAD.size))
        if at + _HEAD.size + length > size or opcode in (Opcode.DATA_END, Opcode.FOOTER):
            break
        if opcode == Opcode.CHUNK:
            _enter_chunk(made, stream, at, length)
        elif opcode == Opcode.MESSAGE:
            made.loose = True
        elif opcode != Opcode.ATTACHMENT:
            if length > _LIMIT:
                raise ValueError(f"a record of {length} bytes at byte {at}")
            _enter(made, opcode, stream.read(length), at, _HEAD.size + length)
        at += _HEAD.size + length
        made.end = at
    return made


def _enter(made: Contents, opcode: int, body: bytes, at: int, length: int) -> None:
    if opcode == Opcode.MESSAGE_INDEX:
        channel, size = struct.unpack_from("<HI", body)
        made.counts[channel] = made.counts.get(channel, 0) + size // 16
        if made.chunks:
            made.chunks[-1].message_index_offsets[channel] = at
            made.chunks[-1].message_index_length += length
        return
    data = ReadDataStream(BytesIO(body))
    if opcode == Opcode.SCHEMA:
        schema = Schema.read(data)
        made.schemas[schema.id] = schema
    elif opcode == Opcode.CHANNEL:
        channel = Channel.read(data)
        made.channels[channel.id] = channel
    elif opcode == Opcode.METADATA:
        record = Metadata.read(data)
        made.metadata[record.name] = record.metadata
        made.metadata_index.append(MetadataIndex(offset=at, length=length, name=record.name))


def _enter_chunk(made: Contents, stream: IO[bytes], at: int, length: int) -> None:
    head = stream.read(_CHUNK.size)
    first, last, size, _, kind = _CHUNK.unpack(head)
    compression = stream.read(kind).decode()
    (packed,) = struct.unpack("<Q", stream.read(8))
    index = ChunkIndex(
        chunk_length=_HEAD.size + length,
        chunk_start_offset=at,
        compression=compression,
        compressed_size=packed,
        message_end_time=last,
        message_index_length=0,
        message_index_offsets={},
        message_start_time=first,
        uncompressed_size=size,
    )
    made.chunks.append(index)
    # Our own files have their channels outside; those of others, inside of the chunks.
    if "kompass" not in made.metadata:
        for opcode, _, body in chunk_records(stream, index):
            if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                _enter(made, opcode, bytes(body), 0, 0)


def chunk_records(stream: IO[bytes], chunk: ChunkIndex) -> Iterator[tuple[int, int, memoryview]]:
    """Unpack a chunk and yield opcode, offset in the chunk, and body of each of its records.

    Raises
    ------
    ValueError
        When its compression is not known, or it is damaged.
    """
    data = memoryview(unpack(stream, chunk))
    at, size = 0, len(data)
    head = _HEAD.unpack_from
    while at + 9 <= size:
        opcode, length = head(data, at)
        at += 9
        if at + length > size:
            raise ValueError(f"the chunk at byte {chunk.chunk_start_offset} is cut short")
        yield opcode, at - 9, data[at : at + length]
        at += length


def unpack(stream: IO[bytes], chunk: ChunkIndex) -> bytes:
    """Read a chunk and return its records.

    Raises
    ------
    ValueError
        When its compression is not known, or it is damaged.
    """
    stream.seek(chunk.chunk_start_offset + chunk.chunk_length - chunk.compressed_size)
    packed = stream.read(chunk.compressed_size)
    kind = chunk.compression
    unpacker = _UNPACK.get(kind)
    if unpacker is None:
        raise ValueError(f"compression {kind!r} is not known; known are zstd and lz4")
    try:
        return bytes(unpacker(packed, chunk.uncompressed_size))
    except (zstandard.ZstdError, RuntimeError) as error:
        raise ValueError(f"the chunk at byte {chunk.chunk_start_offset}: {error}") from error


_UNPACK: dict[str, Callable[[bytes, int], Any]] = {
    "": lambda data, size: data,
    "zstd": lambda data, size: zstandard.ZstdDecompressor().decompress(data, max_output_size=size),
    "lz4": lambda data, size: lz4.frame.decompress(data),
}
