"""The newest lines of the robot's log, and what is asked of them."""

from __future__ import annotations

import heapq
import threading
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

from kompass_console.schema.log_models import LOG_LEVELS, LogLevel, LogLine, LogPage

_MOST_CALM = 1500  # lines below a warning
_MOST_LOUD = 500  # warnings and worse; so what is written all the time does not push them out
_MOST_NODES = 200  # of which pages are told
_RANK = {level: rank for rank, level in enumerate(LOG_LEVELS)}
_LOUD = _RANK["warning"]


@dataclass(frozen=True, slots=True)
class LogQuery:
    """Which lines are wanted.

    Attributes
    ----------
    after
        Only those above this number.
    count
        So many of the newest.
    level
        At least so bad.
    node
        Of this logger and those below it; empty for all.
    text
        Have these words, in small letters or capitals; empty for all.
    """

    after: int = 0
    count: int = 200
    level: LogLevel = "debug"
    node: str = ""
    text: str = ""

    def wants(self, line: LogLine) -> bool:
        """Whether a line is one of them, `after` and `count` aside."""
        if _RANK[line.level] < _RANK[self.level]:
            return False
        if self.node and line.node != self.node and not line.node.startswith(f"{self.node}."):
            return False
        words = self.text.casefold()
        return words in line.text.casefold() or words in line.node.casefold()


class LogRing:
    """Bounded, whatever comes. Any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._calm: deque[LogLine] = deque(maxlen=_MOST_CALM)
        self._loud: deque[LogLine] = deque(maxlen=_MOST_LOUD)
        self._newest = 0
        self._left_out = 0

    @property
    def newest(self) -> int:
        """Number of the last line; 0 when there is none."""
        return self._newest

    @property
    def newest_warning(self) -> int:
        """Number of the last warning or error; 0 when there is none."""
        with self._lock:
            return self._loud[-1].number if self._loud else 0

    def add(self, lines: Iterable[LogLine], left_out: int = 0) -> None:
        """Number and keep lines, the oldest first; so many before them there was no room for."""
        with self._lock:
            self._left_out += left_out
            for line in lines:
                self._newest += 1
                line.number, line.left_out, self._left_out = self._newest, self._left_out, 0
                (self._loud if _RANK[line.level] >= _LOUD else self._calm).append(line)

    def page(self, query: LogQuery) -> LogPage:
        """The lines that are wanted, newest first. All, if `after` is of another console's life."""
        with self._lock:
            calm, loud, newest = list(self._calm), list(self._loud), self._newest
        after = query.after if query.after <= newest else 0
        lines = list(heapq.merge(reversed(calm), reversed(loud), key=lambda line: -line.number))
        found = [line for line in lines if line.number > after and query.wants(line)]
        return LogPage(
            lines=found[: query.count],
            more=len(found) > query.count,
            newest=newest,
            nodes=sorted({line.node for line in lines})[:_MOST_NODES],
        )
