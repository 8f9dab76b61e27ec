"""The STOP that a person pressed, remembered outside the process that obeys it."""

import mmap
import struct
import time
from dataclasses import dataclass
from typing import Self

TEXT = 240  # bytes of a name, or of a reason
_SET, _LOADED, _RESTORED = 0, 1, 2
_AT = struct.Struct("d")
_COUNT = struct.Struct("I")
_PRESSES_AT, _AT_AT, _INTERRUPTIONS_AT, _OPERATOR_AT = 4, 8, 16, 24
_REASON_AT = _OPERATOR_AT + TEXT
SIZE = _REASON_AT + TEXT


@dataclass(frozen=True)
class StopRecord:
    """Who pressed STOP, why, and when [s since the epoch; 0 when that is not known]."""

    operator: str
    reason: str
    at: float


class StopLatch:
    """Set by a person, reset by a person, and by nothing else.

    It lives in shared anonymous memory that is made before the drive manager's process is forked:
    when that process dies and is started again, it is still stopped.
    """

    def __init__(self) -> None:
        self._memory = mmap.mmap(-1, SIZE)

    def __deepcopy__(self, _memo: object) -> Self:
        """The same memory: whoever is copied as a fork would copy him shares it, too."""
        return self

    @property
    def is_set(self) -> bool:
        """Whether STOP is latched."""
        return self._memory[_SET] == 1

    @property
    def operator(self) -> str:
        """Who pressed it."""
        return self._read(_OPERATOR_AT)

    @property
    def reason(self) -> str:
        """What was given as the reason."""
        return self._read(_REASON_AT)

    @property
    def account(self) -> str:
        """The reason; and when it was pressed, where that was before this start of the stack."""
        if not self._memory[_RESTORED]:
            return self.reason
        at = self.record.at
        if not at:
            return self.reason
        when = time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(at))
        return f"{self.reason or 'no reason given'} (pressed {when}, before this start)"

    @property
    def record(self) -> StopRecord:
        """All that is known of the press."""
        (at,) = _AT.unpack_from(self._memory, _AT_AT)
        return StopRecord(self.operator, self.reason, at)

    @property
    def presses(self) -> int:
        """How often it was pressed, while it was set too."""
        return self._counted(_PRESSES_AT)

    @property
    def interruptions(self) -> int:
        """How often it was pressed, or somebody took the wheel."""
        return self._counted(_INTERRUPTIONS_AT)

    def interrupt(self) -> None:
        """Count that a person has ended whatever was under way."""
        self._count(_INTERRUPTIONS_AT)

    @property
    def is_loaded(self) -> bool:
        """Whether what was kept from before this start of the stack has been taken over."""
        return self._memory[_LOADED] == 1

    def set(self, operator: str, reason: str, at: float = 0.0) -> None:
        """Latch. Who and why go in first, so that a set latch always tells them."""
        if not self.is_set:
            self._write(_OPERATOR_AT, operator)
            self._write(_REASON_AT, reason)
            _AT.pack_into(self._memory, _AT_AT, at)
            self._memory[_RESTORED] = 0
        self._memory[_SET] = 1
        self._count(_PRESSES_AT)
        self.interrupt()

    def load(self, kept: StopRecord | None) -> None:
        """Take over what was kept from before this start of the stack; None for no STOP."""
        if kept is not None and not self.is_set:
            self.set(kept.operator, kept.reason, kept.at)
            self._memory[_RESTORED] = 1
        self._memory[_LOADED] = 1

    def release(self) -> None:
        """Let the robot move again; only ever on behalf of a person."""
        self._memory[_SET] = 0

    def _counted(self, offset: int) -> int:
        (count,) = _COUNT.unpack_from(self._memory, offset)
        return int(count)

    def _count(self, offset: int) -> None:
        _COUNT.pack_into(self._memory, offset, (self._counted(offset) + 1) % 2**32)

    def _write(self, offset: int, text: str) -> None:
        data = text.encode()[: TEXT - 1]
        self._memory[offset : offset + TEXT] = data.ljust(TEXT, b"\0")

    def _read(self, offset: int) -> str:
        return self._memory[offset : offset + TEXT].rstrip(b"\0").decode(errors="ignore")
