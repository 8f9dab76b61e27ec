"""The STOP that a person pressed, remembered outside the process that obeys it."""

import mmap

SIZE = 512
TEXT = 240


class StopLatch:
    """Set by a person, reset by a person, and by nothing else.

    It lives in shared anonymous memory that is made before the drive manager's process is forked:
    when that process dies and is started again, it is still stopped.
    """

    def __init__(self) -> None:
        self._memory = mmap.mmap(-1, SIZE)

    @property
    def is_set(self) -> bool:
        """Whether STOP is latched."""
        return self._memory[0] == 1

    @property
    def operator(self) -> str:
        """Who pressed it."""
        return self._read(1)

    @property
    def reason(self) -> str:
        """What was given as the reason."""
        return self._read(1 + TEXT)

    def set(self, operator: str, reason: str) -> None:
        """Latch. Who and why go in first, so that a set latch always tells them."""
        if not self.is_set:
            self._write(1, operator)
            self._write(1 + TEXT, reason)
        self._memory[0] = 1

    def release(self) -> None:
        """Let the robot move again; only ever on behalf of a person."""
        self._memory[0] = 0

    def _write(self, offset: int, text: str) -> None:
        data = text.encode()[: TEXT - 1]
        self._memory[offset : offset + TEXT] = data.ljust(TEXT, b"\0")

    def _read(self, offset: int) -> str:
        return self._memory[offset : offset + TEXT].rstrip(b"\0").decode(errors="ignore")
