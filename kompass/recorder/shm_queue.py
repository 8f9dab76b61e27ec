"""From the monitor to the recorder, without either ever waiting for the other.

A ring in shared memory, made by the supervisor before it forks. The writer never makes a system
call and never blocks: what does not fit is counted. What was written survives the death of the
writer, and of the reader: a frame is given back only when it is on disk. A socket would hold a few
hundred frames at most, and would break with either end.
"""

import mmap
import struct
import time
import zlib
from typing import NamedTuple

CAPACITY = 4 << 20  # bytes: some 15 s of a thousand small messages per second

# The words of the header.
_HEAD, _TAIL, _SEQUENCE, _OFFSET, _SESSION, _COMMITTED = range(6)
_HEADER = 64
_SIZES = struct.Struct("<II")  # of the body, and its checksum
_BODY = struct.Struct("<QIBHH")


class Frame(NamedTuple):
    """One thing that the engine took or did.

    Attributes
    ----------
    sequence
        1, 2, 3 …; a leap tells how many did not fit.
    now_ns
        Monotonic nanoseconds, of the clock reading that the engine used.
    topic, type
        Of a message; for an event of the engine its kind and nothing.
    raw
        The message as it came, or JSON.
    """

    sequence: int
    now_ns: int
    is_event: bool
    topic: str
    type: str
    raw: bytes


class ShmQueue:
    """A queue of frames in shared memory: one process writes from one thread, another reads.

    The head moves when a frame is complete and the tail when it is on disk, each in one store of
    eight bytes.

    Parameters
    ----------
    capacity
        Bytes for frames.
    """

    def __init__(self, capacity: int = CAPACITY) -> None:
        self._capacity = capacity
        self._memory = mmap.mmap(-1, _HEADER + capacity)
        self._words = memoryview(self._memory)[:_HEADER].cast("Q")
        self._frames = memoryview(self._memory)[_HEADER:]
        self._position = 0  # up to where the reader has read
        self._read = 0  # number of the last frame that it has read
        self._words[_OFFSET] = time.time_ns() - time.monotonic_ns()
        self._words[_SESSION] = time.time_ns()

    @property
    def offset_ns(self) -> int:
        """Nanoseconds since the epoch minus monotonic ones, fixed for the session of the stack."""
        return self._words[_OFFSET]

    @property
    def session(self) -> int:
        """Tells the sessions of the stack apart; nanoseconds since the epoch at its beginning."""
        return self._words[_SESSION]

    # -- the writer's end ---------------------------------------------------------------------

    def write(self, now_ns: int, is_event: bool, topic: str, kind: str, raw: bytes) -> bool:
        """Hand a frame over; False when it does not fit, which the reader will see."""
        words = self._words
        sequence = words[_SEQUENCE] + 1
        words[_SEQUENCE] = sequence
        name, type_name = topic.encode(), kind.encode()
        head = _BODY.pack(now_ns, sequence & 0xFFFFFFFF, is_event, len(name), len(type_name))
        body = b"".join((head, name, type_name, raw))
        size = _SIZES.size + len(body)
        at = words[_HEAD]
        if at - words[_TAIL] + size > self._capacity:
            return False
        self._copy_in(at, _SIZES.pack(len(body), zlib.crc32(body)) + body)
        words[_HEAD] = at + size
        return True

    def wait_for_disk(self, timeout: float) -> bool:
        """Wait until all that is on the queue now is on disk; False when it is not in time.

        From any thread.
        """
        head = self._words[_HEAD]
        deadline = time.monotonic() + timeout
        while self._words[_TAIL] < head:
            if time.monotonic() >= deadline:
                return False
            time.sleep(0.02)
        return True

    def _copy_in(self, at: int, data: bytes) -> None:
        begin = at % self._capacity
        room = self._capacity - begin
        if len(data) <= room:
            self._frames[begin : begin + len(data)] = data
        else:
            self._frames[begin:] = data[:room]
            self._frames[: len(data) - room] = data[room:]

    # -- the reader's end ---------------------------------------------------------------------

    def resume(self) -> int:
        """Read again from the first frame that is not on disk, after the death of a reader.

        Returns the number of the frame before it.
        """
        self._position, self._read = self._words[_TAIL], self._words[_COMMITTED]
        return self._read

    def read(self) -> list[Frame]:
        """All frames that have arrived since the last call."""
        frames = []
        head = self._words[_HEAD]
        while self._position < head:
            size, checksum = _SIZES.unpack(self._copy_out(self._position, _SIZES.size))
            body = self._copy_out(self._position + _SIZES.size, size)
            if zlib.crc32(body) != checksum:
                # On a machine that reorders stores the head may be seen before the frame.
                break
            now_ns, sequence, is_event, name, type_name = _BODY.unpack_from(body)
            names = _BODY.size + name
            frames.append(
                Frame(
                    sequence,
                    now_ns,
                    bool(is_event),
                    body[_BODY.size : names].decode(),
                    body[names : names + type_name].decode(),
                    body[names + type_name :],
                )
            )
            self._position += _SIZES.size + size
            self._read = sequence
        return frames

    def commit(self) -> None:
        """Give back what was read: it is on disk."""
        self._words[_COMMITTED] = self._read
        self._words[_TAIL] = self._position

    @property
    def fill(self) -> float:
        """Part of the queue that waits to be read and committed, 0 to 1."""
        return (self._words[_HEAD] - self._words[_TAIL]) / self._capacity

    def _copy_out(self, at: int, size: int) -> bytes:
        begin = at % self._capacity
        room = self._capacity - begin
        if size <= room:
            return bytes(self._frames[begin : begin + size])
        return bytes(self._frames[begin:]) + bytes(self._frames[: size - room])
