"""Bring a file whose writer was killed to a proper end."""

import os
import struct
from pathlib import Path
from typing import IO

from mcap.opcode import Opcode

from kompass.recorder.mcap.contents import Contents, chunk_records, read_contents
from kompass.recorder.mcap.writer import index_record, summary


def recover(path: Path) -> Contents:
    """Cut a torn tail off a file and write its summary; one that is whole is left alone.

    Raises
    ------
    NotMcap
        If it is no MCAP file.
    OSError
        When it cannot be written.
    """
    with path.open("r+b") as file:
        contents = read_contents(file, str(path))
        if contents.complete:
            return contents
        rest = _missing_indexes(file, contents)
        end = contents.end + len(rest)
        rest += summary(
            end,
            [*contents.schemas.values()],
            [*contents.channels.values()],
            contents.chunks,
            contents.metadata_index,
            contents.counts,
        )
        file.truncate(contents.end)
        file.seek(contents.end)
        file.write(rest)
        file.flush()
        os.fsync(file.fileno())
    contents.complete = True
    contents.end = end
    return contents


def _missing_indexes(file: IO[bytes], contents: Contents) -> bytes:
    """The indexes of the last chunk that did not reach the disk; they come right behind it."""
    if not contents.chunks:
        return b""
    chunk = contents.chunks[-1]
    entries: dict[int, list[int]] = {}
    for opcode, offset, body in chunk_records(file, chunk):
        if opcode == Opcode.MESSAGE:
            channel, _, log_time = struct.unpack_from("<HIQ", body)
            entries.setdefault(channel, []).extend((log_time, offset))
    made = b""
    for channel, times in entries.items():
        if channel not in chunk.message_index_offsets:
            chunk.message_index_offsets[channel] = contents.end + len(made)
            contents.counts[channel] = contents.counts.get(channel, 0) + len(times) // 2
            record = index_record(channel, times)
            chunk.message_index_length += len(record)
            made += record
    return made
